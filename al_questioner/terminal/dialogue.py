"""What a person at a terminal is asked, has said, and may take back; without the terminal, and without ROS."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
import uuid
from collections.abc import Callable

import numpy as np

from al_questioner.domain import Answer, AnswerError, Query, QueryKind, Scene
from al_questioner.questioning.plain_words import read_plain_answer
from al_questioner.terminal.commands import WISHES
from al_questioner.terminal.sentences import said_in_words
from al_questioner.terminal.view_state import EpisodeProgress, PastAnswer, Phase, Picture, Prompt, ViewState

SECONDS_TO_NOTICE = 0.5
"""For so long after a question was replaced by another, an answer is not believed to be meant for that one."""
MOVED_M = 0.02
"""By which an object may move and still be where its picture shows it, in metres."""

PATIENCE_S = 5.0
"""Within which a learner that runs replies to an answer."""


def random_id() -> str:
    """Part of an answer's id that no other answer has."""
    return uuid.uuid4().hex[:12]


def _alike(one: Scene, other: Scene) -> bool:
    """Whether a picture of one scene shows the other as well: the same objects where they were."""
    return one.object_ids == other.object_ids and np.allclose(one.positions, other.positions, rtol=0.0, atol=MOVED_M)


class TeacherDialogue:
    """One person's part in an episode. Any thread may call any method.

    Args:
        teacher_id: who answers.
        send: given an episode's id and an answer, brings it to the learner until it is acknowledged.
        new_id: makes the part of an answer's id that tells it from all others.
        clock: seconds of a steady clock.

    Attributes:
        on_change: called, with nothing else going on, whenever there may be something new on the board.
    """

    def __init__(
        self,
        teacher_id: str,
        send: Callable[[str, Answer], None],
        new_id: Callable[[], str] = random_id,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.on_change: Callable[[], None] = lambda: None
        self._teacher_id = teacher_id
        self._send = send
        self._new_id = new_id
        self._clock = clock
        self._sent_at = 0.0
        self._changed = threading.Condition(threading.RLock())
        self._episode_id = ''
        self._scene: Scene | None = None
        self._since = 0
        self._picture: Picture | None = None
        self._pictured = 0
        self._forget()

    def _forget(self) -> None:
        self._query: Query | None = None
        self._progress: EpisodeProgress | None = None
        self._answered: set[str] = set()
        self._on_its_way: PastAnswer | None = None
        self._replaced_at = -math.inf
        self._last: PastAnswer | None = None
        self._corrected: PastAnswer | None = None
        self._notice = ''

    def enter(self, episode_id: str) -> None:
        """Hear of an episode; what belonged to another one is forgotten."""
        with self._changed:
            if episode_id != self._episode_id:
                self._episode_id = episode_id
                self._forget()
            self._tell()

    def ask(self, query: Query) -> None:
        """Hear a question; one of an earlier turn than the last comes too late to be one."""
        with self._changed:
            if self._query is not None and query.turn < self._query.turn:
                return
            if self._open() not in (None, query):
                self._replaced_at = self._clock()
            self._query = query
            self._tell()

    def follow(self, progress: EpisodeProgress) -> None:
        """Hear how far the episode is; what tells of an earlier turn than the last comes too late."""
        with self._changed:
            if self._progress is not None and (progress.turn, progress.done) < (
                self._progress.turn,
                self._progress.done,
            ):
                return
            self._progress = progress
            if self._last is None and progress.last is not None and progress.last[1].teacher_id == self._teacher_id:
                # What was said before this program began.
                query, answer = progress.last
                self._last = PastAnswer(Prompt(query, None, None), answer)
            self._tell()

    def begin(self, turns: int, budget: float) -> None:
        """Hear what an episode is given, which tells how far it is as long as nothing else does."""
        with self._changed:
            if self._progress is None:
                self.follow(EpisodeProgress(0, turns, budget, 0.0, done=False))

    def look(self, scene: Scene, stamp: int) -> None:
        """See the objects, as they were at a time in nanoseconds."""
        with self._changed:
            if self._scene is not None and not _alike(self._scene, scene):
                self._since = stamp
            self._scene = scene
            self._tell()

    def see(self, picture: Picture, stamp: int) -> None:
        """See the picture of the whole scene, as it was at a time in nanoseconds."""
        with self._changed:
            self._picture, self._pictured = picture, stamp
            self._tell()

    def say(self, text: str) -> None:
        """Answer the question that is shown, in the words of `read_plain_answer`.

        Raises:
            AnswerError: nothing is asked, or this is no answer to it.
        """
        with self._changed:
            prompt = self._shown()
            if prompt is None or self._on_its_way is not None:
                raise AnswerError('nothing is asked at the moment')
            if self._clock() < self._replaced_at + SECONDS_TO_NOTICE:
                raise AnswerError('the robot has just asked something else: see what it is')
            answer = read_plain_answer(text, prompt.query, self._teacher_id, WISHES)
            replaces = None if self._corrected is None else self._corrected.answer.answer_id
            answer_id = f'{answer.answer_id}/{self._new_id()}'
            answer = dataclasses.replace(answer, answer_id=answer_id, replaces=replaces)
            self._on_its_way, self._sent_at = PastAnswer(prompt, answer), self._clock()
            self._notice = ''
            self._tell()
            self._send(self._episode_id, answer)

    def undo(self) -> None:
        """Ask the question of the last answer again; once more, and that answer stands as it was.

        Raises:
            AnswerError: there is no answer to take back.
        """
        with self._changed:
            if self._corrected is not None:
                self._corrected, self._notice = None, 'That answer stands as it was.'
            elif self._last is None:
                raise AnswerError('there is nothing to take back: no answer of yours was the last that was taken')
            elif self._on_its_way is not None:
                raise AnswerError('an answer is on its way to the robot: wait until it is taken')
            else:
                self._corrected, self._notice = self._recalled(self._last), ''
            self._tell()

    def acknowledge(self, answer_id: str | None, accepted: bool, reason: str) -> None:
        """Hear whether the answer that is on its way was taken."""
        with self._changed:
            said = self._on_its_way
            if said is None or said.answer.answer_id != answer_id:
                return
            self._on_its_way = None
            if accepted:
                self._last, self._corrected = said, None
                self._answered.add(said.answer.query_id)
                corrected = '' if said.answer.replaces is None else ' instead'
                self._notice = f'Noted: {said_in_words(said.prompt.query.action, said.answer)}{corrected}.'
            elif said.answer.replaces is not None:
                self._corrected = None
                self._notice = f'The robot does not take the correction, the earlier answer stands: {reason}'
            else:
                self._notice = f'The robot did not take that: {reason}'
            self._tell()

    def board(self) -> ViewState:
        """What there is to show now."""
        with self._changed:
            return ViewState(
                self._phase(),
                self._shown(),
                self._corrected,
                self._progress,
                self._last is not None,
                self._notice or self._no_reply(),
                self._teacher_id,
            )

    def wait_for(self, is_true: Callable[[ViewState], bool], seconds: float | None = None) -> bool:
        """Wait until something holds of the board; whether it came to hold in time."""
        with self._changed:
            return self._changed.wait_for(lambda: is_true(self.board()), seconds)

    def wake(self) -> None:
        """Have whoever waits look again."""
        with self._changed:
            self._tell()

    def _recalled(self, said: PastAnswer) -> PastAnswer:
        """An answer of before this program began, with what is on the table now if that is what it was about."""
        prompt, scene = said.prompt, self._scene
        if prompt.scene is not None or scene is None:
            return said
        action, there = prompt.query.action, set(map(str, scene.object_ids))
        about = prompt.query.choices if action.kind is QueryKind.DEMONSTRATION else (str(action.object_id),)
        return PastAnswer(Prompt(prompt.query, scene, None), said.answer) if there.issuperset(about) else said

    def _tell(self) -> None:
        self._changed.notify_all()
        self.on_change()

    def _no_reply(self) -> str:
        late = self._on_its_way is not None and self._clock() - self._sent_at > PATIENCE_S
        return 'No reply so far; is the learner running?' if late else ''

    def _phase(self) -> Phase:
        if self._on_its_way is not None:
            return Phase.SENDING
        if self._corrected is not None:
            return Phase.CORRECTING
        if self._open() is not None:
            return Phase.ASKED
        if self._progress is not None and self._progress.done:
            return Phase.OVER
        return Phase.THINKING if self._episode_id else Phase.ALONE

    def _open(self) -> Query | None:
        """The question that waits for its answer: one that the learner's records do not answer yet."""
        query = self._query
        if query is None or query.query_id in self._answered:
            return None
        # At most one question a turn. Not the turn of the state: that may be told while its question is open.
        records = () if self._progress is None else self._progress.records
        return None if any(record.turn == query.turn for record in reversed(records)) else query

    def _shown(self) -> Prompt | None:
        if self._on_its_way is not None:
            return self._on_its_way.prompt
        if self._corrected is not None:
            return self._corrected.prompt
        query = self._open()
        if query is None:
            return None
        # The picture is drawn when the scene has changed, and comes later: one of what lay there before would mislead.
        return Prompt(query, self._scene, self._picture if self._pictured >= self._since else None)
