"""Teachers who answer, err, do not know, leave, come back, say things twice, late, wrongly, and change their minds."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from al_questioner.domain import NO_SYMBOL
from shared.bottle.chart import Chart
from shared.bottle.faults import Faults
from shared.bottle.network import Endpoint, Network
from shared.bottle.scheduler import Scheduler

LONGEST_THOUGHT_S = 6.0
PATIENCE_S = 3.0
"""Seconds after which an answer is said again if nobody has acknowledged it."""
LONGEST_ABSENCE_S = 60.0
LATE_S = 25.0
OF_ANOTHER_EPISODE = json.dumps(
    {
        'schema': 'al_questioner/answer/1',
        'episode_id': 'another',
        'query_id': 'q1',
        'answer_id': 'x',
        'teacher_id': 'x',
        'outcome': 'answered',
        'content': 'snack',
    }
)
GARBAGE = (
    '', '   ', '{', '{}', '[]', 'null', 'snakc!!', '\x00', '{"schema": "al_questioner/answer/1"}', '9' * 400,
    '{"schema": "al_questioner/query/1", "episode_id": "e"}', '1e999', 'snack,fruit,snack', '-1', OF_ANOTHER_EPISODE,
)  # fmt: skip
"""Texts that are no answers to anything."""


class Person:
    """A teacher at a page or a phone, who sends documents and keeps what was sent until it is acknowledged.

    Args:
        name: of the person, with the namespace.
        truth: what each thing is, given its id.
        speaks_plainly: says plain words, as with `ros2 topic pub`, and does not listen to what came of them.
        note_said: takes each text that is said; of a plain word with its outcome and content.

    Attributes:
        garbage: the texts that were said and are no answers.
    """

    def __init__(
        self,
        name: str,
        namespace: str,
        truth: Callable[[int], str],
        speaks_plainly: bool,
        note_said: Callable[..., None],
        scheduler: Scheduler,
        network: Network,
        faults: Faults,
        chart: Chart,
    ) -> None:
        self.name = name
        self._note_said = note_said
        self.garbage: set[str] = set()
        self._truth, self._speaks_plainly = truth, speaks_plainly
        self._scheduler, self._network, self._faults, self._chart = scheduler, network, faults, chart
        self._away_until = 0.0
        self._considered: set[str] = set()
        self._unacknowledged: dict[str, dict[str, Any]] = {}
        self._said_at: dict[str, float] = {}
        self._number = 0
        self._endpoint = Endpoint(name, namespace, {'query': self._hear, 'answer_ack': self._hear_ack})
        network.join(self._endpoint)

    def come_back(self) -> None:
        """Be there from now on."""
        self._away_until = self._scheduler.now

    def unacknowledged(self, episode_id: str, seconds: float) -> list[str]:
        """Return the ids of the answers in an episode, said longer ago than that, of which they were told nothing."""
        return [
            answer_id
            for answer_id, document in self._unacknowledged.items()
            if document['episode_id'] == episode_id and self._scheduler.now - self._said_at[answer_id] > seconds
        ]

    def _hear(self, text: str) -> None:
        query = json.loads(text)
        key = f'{query["episode_id"]} {query["query_id"]}'
        if key in self._considered and not self._speaks_plainly:
            return
        first = key not in self._considered
        self._considered.add(key)
        if first and self._faults.happens('person leaves', self.name, query['query_id']):
            share = self._faults.draw('away', self.name, query['query_id'])
            self._away_until = self._scheduler.now + LONGEST_ABSENCE_S * share
            self._chart.note(self.name, f'LEAVES for {LONGEST_ABSENCE_S * share:.0f} s')
        self._number += 1
        thought = 0.1 + LONGEST_THOUGHT_S * self._faults.draw('thought', self.name, self._number) ** 2
        delay = max(thought, self._away_until - self._scheduler.now + 0.1)
        self._scheduler.after(delay, lambda: self._answer(query, key))

    def _answer(self, query: Mapping[str, Any], key: str) -> None:
        if self._scheduler.now < self._away_until:
            self._scheduler.after(self._away_until - self._scheduler.now + 0.1, lambda: self._answer(query, key))
            return
        name = (self.name, key, self._number)
        happens = self._faults.happens
        if happens('garbage', *name):
            share = self._faults.draw('which garbage', *name)
            self._say_garbage(GARBAGE[int(share * len(GARBAGE))])
        outcome, content = 'answered', self._content(query, is_wrong=happens('wrong', *name))
        if happens('unknown', *name):
            outcome, content = 'unknown', None
        elif happens('skip', *name):
            outcome, content = 'skip', None
        if self._speaks_plainly:
            self._say_plainly(outcome, content)
            return
        document = self._document(query, f'{key.replace(" ", "/")}/{self.name}/{self._number}', outcome, content)
        delay = LATE_S if happens('late', *name) else 0.0
        self._scheduler.after(delay, lambda: self._say(document))
        if happens('answer twice', *name):
            self._scheduler.after(delay + 0.3, lambda: self._publish(document))
        if happens('contradict', *name):
            other = self._document(
                query, f'{document["answer_id"]}/but', 'answered', self._content(query, is_wrong=True)
            )
            self._scheduler.after(delay + 0.2, lambda: self._say(other))

    def _content(self, query: Mapping[str, Any], is_wrong: bool) -> Any:
        choices = query['choices']
        if query['kind'] == 'label':
            true = self._truth(query['object_id'])
            return next(name for name in (*choices, NO_SYMBOL) if (name == true) != is_wrong)
        if query['kind'] == 'demonstration':
            right = [int(i) for i in choices if (self._truth(int(i)) == query['symbol']) != is_wrong]
            return right[0] if right else NO_SYMBOL
        if query['kind'] == 'feature_subset':
            return choices[:1]
        return [int(i) for i in choices if (self._truth(int(i)) != NO_SYMBOL) != is_wrong]

    def _document(self, query: Mapping[str, Any], answer_id: str, outcome: str, content: Any, **more: Any) -> Any:
        return {
            'schema': 'al_questioner/answer/1', 'episode_id': query['episode_id'], 'query_id': query['query_id'],
            'answer_id': answer_id, 'teacher_id': self.name, 'outcome': outcome,
            **({} if content is None else {'content': content}), **more,
        }  # fmt: skip

    def _say(self, document: dict[str, Any]) -> None:
        """Say it until it is acknowledged."""
        self._unacknowledged[document['answer_id']] = document
        self._said_at[document['answer_id']] = self._scheduler.now
        self._repeat(document['answer_id'], 0)

    def _repeat(self, answer_id: str, times: int) -> None:
        document = self._unacknowledged.get(answer_id)
        if document is not None and times < 60:
            self._publish(document)
            self._scheduler.after(PATIENCE_S, lambda: self._repeat(answer_id, times + 1))

    def _publish(self, document: dict[str, Any]) -> None:
        self._note_said(json.dumps(document))
        self._network.publish(self._endpoint, 'answer', json.dumps(document))

    def _say_plainly(self, outcome: str, content: Any) -> None:
        word = {'unknown': '?', 'skip': 'skip'}.get(outcome)
        if word is None:
            # An empty list says that nothing here matters.
            word = (','.join(map(str, content)) or NO_SYMBOL) if isinstance(content, list) else str(content)
        self._note_said(word, outcome, content)
        self._network.publish(self._endpoint, 'answer', word)

    def _say_garbage(self, text: str) -> None:
        self.garbage.add(text)
        self._network.publish(self._endpoint, 'answer', text)

    def _hear_ack(self, text: str) -> None:
        ack = json.loads(text)
        document = self._unacknowledged.get(ack.get('answer_id') or '')
        # Two learners on the same topics may have queries of the same id.
        if document is None or document['episode_id'] != ack['episode_id']:
            return
        del self._unacknowledged[document['answer_id']]
        if not ack['accepted']:
            return
        answer_id = document['answer_id']
        if self._faults.happens('correct', self.name, answer_id):
            delay = 0.5 + 20.0 * self._faults.draw('when corrected', self.name, answer_id)
            correction = {**document, 'answer_id': f'{answer_id}/no', 'replaces': answer_id, 'outcome': 'unknown'}
            correction.pop('content', None)
            self._scheduler.after(delay, lambda: self._say(correction))
