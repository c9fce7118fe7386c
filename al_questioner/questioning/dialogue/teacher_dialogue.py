"""Dialogue of a person with the robot: questions, answers, corrections; without a screen and without ROS."""

from __future__ import annotations

import dataclasses
import math
import threading
import time
import uuid
from collections.abc import Callable, Collection

import numpy as np

from al_questioner.domain import Answer, AnswerError, Query, QueryKind, Scene
from al_questioner.questioning.dialogue.answers_in_words import said_in_words
from al_questioner.questioning.dialogue.view_state import EpisodeProgress, PastAnswer, Phase, Picture, Prompt, ViewState
from al_questioner.questioning.plain_answers import read_plain_answer

SECONDS_TO_NOTICE = 0.5
"""Seconds after a new question in which an answer is rejected, because it may be meant for the previous one."""
MOVED_M = 0.02
"""Largest movement of an object, in metres, with which its picture is still valid."""

PATIENCE_S = 5.0
"""Seconds in which a running learner replies to an answer."""


def random_id() -> str:
    """Return a part of an answer's id that no other answer has."""
    return uuid.uuid4().hex[:12]


def _alike(one: Scene, other: Scene) -> bool:
    """Return whether a picture of one scene also shows the other: the same objects in the same places."""
    return one.object_ids == other.object_ids and np.allclose(one.positions, other.positions, rtol=0.0, atol=MOVED_M)


class TeacherDialogue:
    """One person's part in an episode. Any thread may call any method.

    Args:
        teacher_id: id of the person.
        send: sends an answer in the episode of an id, until the learner acknowledges it.
        new_id: makes the part of an answer's id that distinguishes it from all others.
        clock: seconds of a steady clock.
        other_words: words for the program that shows the dialogue, which a person who gives no answer may have meant.

    Attributes:
        on_change: called, one call at a time, whenever the view state may have changed.
    """

    def __init__(
        self,
        teacher_id: str,
        send: Callable[[str, Answer], None],
        new_id: Callable[[], str] = random_id,
        clock: Callable[[], float] = time.monotonic,
        other_words: Collection[str] = (),
    ) -> None:
        self.on_change: Callable[[], None] = lambda: None
        self._teacher_id = teacher_id
        self._send = send
        self._new_id = new_id
        self._clock = clock
        self._other_words = other_words
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
        """Receive the id of the episode; the state of another episode is dropped."""
        with self._changed:
            if episode_id != self._episode_id:
                self._episode_id = episode_id
                self._forget()
            self._tell()

    def ask(self, query: Query) -> None:
        """Receive a question; one of an earlier turn than the last question is ignored."""
        with self._changed:
            if self._query is not None and query.turn < self._query.turn:
                return
            if self._open() not in (None, query):
                self._replaced_at = self._clock()
            self._query = query
            self._tell()

    def follow(self, progress: EpisodeProgress) -> None:
        """Receive the progress of the episode; the progress of an earlier turn is ignored."""
        with self._changed:
            before = self._progress
            if before is not None and (progress.turn, progress.done) < (before.turn, before.done):
                return
            self._progress = progress
            if self._last is None and progress.last is not None and progress.last[1].teacher_id == self._teacher_id:
                # The answer was given before this program began.
                query, answer = progress.last
                self._last = PastAnswer(Prompt(query, None, None), answer)
            self._tell()

    def begin(self, turns: int, budget: float) -> None:
        """Receive the settings of an episode, which stand for its progress until that arrives."""
        with self._changed:
            if self._progress is None:
                self.follow(EpisodeProgress(0, turns, budget, 0.0, done=False))

    def look(self, scene: Scene, stamp: int) -> None:
        """Receive the objects, as they were at a time in nanoseconds."""
        with self._changed:
            if self._scene is not None and not _alike(self._scene, scene):
                self._since = stamp
            self._scene = scene
            self._tell()

    def see(self, picture: Picture, stamp: int) -> None:
        """Receive the picture of the whole scene, as it was at a time in nanoseconds."""
        with self._changed:
            self._picture, self._pictured = picture, stamp
            self._tell()

    def say(self, text: str) -> None:
        """Answer the question that is shown, in the words of `read_plain_answer`.

        Raises:
            AnswerError: no question is open, or this is not an answer to it.
        """
        with self._changed:
            prompt = self._shown()
            if prompt is None or self._on_its_way is not None:
                raise AnswerError('nothing is asked at the moment')
            if self._clock() < self._replaced_at + SECONDS_TO_NOTICE:
                raise AnswerError('the robot has just asked something else: see what it is')
            answer = read_plain_answer(text, prompt.query, self._teacher_id, self._other_words)
            replaces = None if self._corrected is None else self._corrected.answer.answer_id
            answer_id = f'{answer.answer_id}/{self._new_id()}'
            answer = dataclasses.replace(answer, answer_id=answer_id, replaces=replaces)
            self._on_its_way, self._sent_at = PastAnswer(prompt, answer), self._clock()
            self._notice = ''
            self._tell()
            self._send(self._episode_id, answer)

    def undo(self) -> None:
        """Ask the question of the last answer again; a second call cancels that, and the answer is kept.

        Raises:
            AnswerError: there is no answer to take back.
        """
        with self._changed:
            if self._corrected is not None:
                self._corrected, self._notice = None, 'That answer is kept.'
            elif self._last is None:
                raise AnswerError('there is nothing to take back: no answer of yours was the last that was taken')
            elif self._on_its_way is not None:
                raise AnswerError('an answer is on its way to the robot: wait until it is accepted')
            else:
                self._corrected, self._notice = self._recalled(self._last), ''
            self._tell()

    def acknowledge(self, answer_id: str | None, accepted: bool, reason: str) -> None:
        """Receive whether the learner accepted the answer that was sent."""
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

    def view_state(self) -> ViewState:
        """Return the present view state."""
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
        """Wait until a condition on the view state is true; return whether it became true in time."""
        with self._changed:
            return self._changed.wait_for(lambda: is_true(self.view_state()), seconds)

    def wake(self) -> None:
        """Wake the threads that wait, so that they check their condition again."""
        with self._changed:
            self._tell()

    def _recalled(self, said: PastAnswer) -> PastAnswer:
        """Return an answer from before this program began, with the present scene if that shows its objects."""
        prompt, scene = said.prompt, self._scene
        if prompt.scene is not None or scene is None:
            return said
        action, there = prompt.query.action, set(map(str, scene.object_ids))
        is_numbered = action.kind in (QueryKind.DEMONSTRATION, QueryKind.RELEVANCE)
        about = prompt.query.choices if is_numbered else (str(action.object_id),)
        return PastAnswer(Prompt(prompt.query, scene, None), said.answer) if there.issuperset(about) else said

    def _tell(self) -> None:
        self._changed.notify_all()
        self.on_change()

    def _no_reply(self) -> str:
        late = self._on_its_way is not None and self._clock() - self._sent_at > PATIENCE_S
        return 'No reply so far; is the learner running, and can it write to its disk?' if late else ''

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
        """Return the question that waits for its answer: one that has no answer in the learner's records yet."""
        query = self._query
        if query is None or query.query_id in self._answered:
            return None
        # At most one question a turn. Not the turn of the state: that may arrive while its question is open.
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
        # The picture arrives later than the scene: an old one would show objects that have moved.
        return Prompt(query, self._scene, self._picture if self._pictured >= self._since else None)
