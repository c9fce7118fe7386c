"""Simulated teacher who knows the truth, and who makes errors at given rates."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

import numpy as np

from al_questioner.domain import (
    NO_SYMBOL,
    Answer,
    Content,
    Outcome,
    Query,
    QueryKind,
    Setting,
    SettingsError,
    random_stream,
)

WRONG_RATE = Setting('wrong_rate', 0.0, 'share of wrong answers', '', 0, 1)
UNKNOWN_RATE = Setting(
    'unknown_rate', 0.0, 'share of queries answered by "I do not know"; with wrong_rate at most 1', '', 0, 1
)
REPEAT_SHOWN = Setting(
    'repeat_shown', False, 'the scripted teacher shows also what is known when other things of the symbol are there'
)
RELEVANCE_OMISSION = Setting(
    'relevance_omission',
    0.0,
    'chance that a thing that matters is left out of the answer to a relevance query',
    '',
    0,
    1,
)
RELEVANCE_FALSE_ALARM = Setting(
    'relevance_false_alarm',
    0.0,
    'chance that a thing of no symbol is named in the answer to a relevance query',
    '',
    0,
    1,
)


@dataclass(frozen=True)
class ScriptedTeacher:
    """Teacher who answers from the ground truth.

    An answer depends on the seed and the query only: a teacher that is restarted in the middle of an episode
    answers as before. If the learner knows an object of the symbol, another one is shown, if there is one. If the
    query does not say what the learner knows, that is taken to be all that this teacher has named before.

    Attributes:
        symbols: the concepts.
        relevant_groups: feature groups that this teacher names when asked which properties matter.
        seed: seed of the errors, and of which object is shown.
        wrong_rate: share of answers that are wrong, in [0, 1]; one that names several groups or things misjudges one.
        unknown_rate: share of queries answered by "I do not know", in [0, 1].
        teacher_id: id in the answers.
        repeat_shown: whether any object of the symbol is shown, known or not.
        relevance_omission: chance that a thing of some symbol is left out of the answer to a relevance query, in
            [0, 1], for each thing by itself.
        relevance_false_alarm: chance that a thing of no symbol is named in it, likewise.

    Raises:
        SettingsError: a rate or chance outside [0, 1], rates that add up to more than 1, or an empty id.
    """

    symbols: Sequence[str]
    relevant_groups: Sequence[str]
    seed: int
    wrong_rate: float = WRONG_RATE.default
    unknown_rate: float = UNKNOWN_RATE.default
    teacher_id: str = 'scripted'
    repeat_shown: bool = REPEAT_SHOWN.default
    relevance_omission: float = RELEVANCE_OMISSION.default
    relevance_false_alarm: float = RELEVANCE_FALSE_ALARM.default
    _named: dict[str, int] = field(default_factory=dict, init=False, repr=False, compare=False)
    """Object that was named, by query, in the order of the queries."""

    def __post_init__(self) -> None:
        if not self.teacher_id:
            raise SettingsError('teacher_id must not be empty')
        for rate in (WRONG_RATE, UNKNOWN_RATE, RELEVANCE_OMISSION, RELEVANCE_FALSE_ALARM):
            rate.check(getattr(self, rate.name))
        if self.wrong_rate + self.unknown_rate > 1.0:
            raise SettingsError(
                f'wrong_rate and unknown_rate add up to {self.wrong_rate + self.unknown_rate}, more than 1'
            )

    def answer(self, query: Query, truth: Mapping[int, str]) -> Answer:
        """Answer a query about a scene; about an object that is not in the scene, the answer is unknown."""
        rng = random_stream(self.seed, f'teacher/{query.query_id}')
        draw = rng.random()
        if draw < self.unknown_rate:
            return self._reply(query, Outcome.UNKNOWN)
        wrong = draw < self.unknown_rate + self.wrong_rate
        if query.action.kind is QueryKind.LABEL:
            content = self._label(query, truth, wrong, rng)
        elif query.action.kind is QueryKind.DEMONSTRATION:
            content = self._demonstration(query, truth, wrong, rng)
        elif query.action.kind is QueryKind.RELEVANCE:
            content = self._relevance(query, truth, wrong, rng)
        else:
            content = self._groups(query, wrong, rng)
        named = content if query.action.kind is QueryKind.DEMONSTRATION else query.action.object_id
        if content is not None and isinstance(named, int):
            self._named.setdefault(query.query_id, named)
        return self._reply(query, Outcome.UNKNOWN if content is None else Outcome.ANSWERED, content)

    def _label(self, query: Query, truth: Mapping[int, str], wrong: bool, rng: np.random.Generator) -> Content:
        label = truth.get(query.action.object_id) if query.action.object_id is not None else None
        if label is None:
            return None
        # The learner may have fewer symbols than the table.
        known = [symbol for symbol in self.symbols if symbol in query.choices or not query.choices]
        if label not in known:
            label = NO_SYMBOL
        return str(rng.choice([other for other in (*known, NO_SYMBOL) if other != label])) if wrong else label

    def _demonstration(self, query: Query, truth: Mapping[int, str], wrong: bool, rng: np.random.Generator) -> Content:
        shown = [object_id for object_id, label in truth.items() if (label == query.action.symbol) != wrong]
        known = self._known(query)
        shown = [object_id for object_id in shown if object_id not in known] or shown
        return int(rng.choice(shown)) if shown else NO_SYMBOL

    def _known(self, query: Query) -> Collection[int]:
        """Return the objects that are only shown if there are no others."""
        if self.repeat_shown:
            return ()
        if query.known is not None:
            return query.known
        return [self._named[earlier] for earlier in takewhile(lambda one: one != query.query_id, self._named)]

    def _groups(self, query: Query, wrong: bool, rng: np.random.Generator) -> Content:
        """Return the relevant groups that the learner has; a wrong answer misjudges one group, if that leaves any."""
        named = [group for group in query.choices if group in self.relevant_groups]
        if wrong and query.choices:
            mistaken = str(rng.choice(list(query.choices)))
            flipped = [group for group in query.choices if (group in named) != (group == mistaken)]
            named = flipped or named
        return tuple(named) or None

    def _relevance(self, query: Query, truth: Mapping[int, str], wrong: bool, rng: np.random.Generator) -> Content:
        """Return the things that matter, each misjudged by its own chance; a wrong answer misjudges one thing more."""
        things = [int(choice) for choice in query.choices if choice.isdecimal() and int(choice) in truth]
        mattering = np.array([truth[object_id] != NO_SYMBOL for object_id in things], dtype=bool)
        chances = np.where(mattering, self.relevance_omission, self.relevance_false_alarm)
        named = mattering ^ (rng.random(len(things)) < chances)
        if wrong and things:
            named[rng.integers(len(things))] ^= True
        return tuple(object_id for object_id, is_named in zip(things, named, strict=True) if is_named)

    def _reply(self, query: Query, outcome: Outcome, content: Content = None) -> Answer:
        return Answer(query.query_id, f'{query.query_id}/{self.teacher_id}', self.teacher_id, outcome, content)
