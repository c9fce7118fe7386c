"""The processes beside a learner: perception, teachers, a recogniser, a recorder, and another learner by mistake."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from al_questioner.domain import AUTO, AnswerError, EpisodeError, EpisodeSettings, Query, QueryKind, Scene
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.perception import PerceptionMachine
from al_questioner.protocol.recogniser import RecogniserMachine
from al_questioner.protocol.recorded_perception import RecordedPerceptionMachine
from al_questioner.protocol.scripted_teacher import ScriptedTeacherMachine
from al_questioner.protocol.terminal_teacher import SAID, TerminalTeacherMachine
from al_questioner.questioning import make_strategy
from al_questioner.questioning.dialogue import Phase, TeacherDialogue
from al_questioner.simulation import ScriptedTeacher
from shared.bottle.faults import Faults
from shared.bottle.process import Process
from shared.bottle.scheduler import Scheduler
from shared.bottle.table import SYMBOLS, Table

NO_WORLD: dict[str, Any] = {}
"""World of processes whose documents name none."""


class SeenTable:
    """A table as the perception of a simulated world sees it."""

    def __init__(self, table: Table, interval: int) -> None:
        self._table, self._interval = table, interval

    def number(self, turn: int) -> int:
        """Return which scene of the table is there in a turn."""
        return (turn - 1) // self._interval

    def scene(self, turn: int) -> Scene:
        return self._table.scene(self.number(turn))

    def observations(self, turn: int) -> Sequence[Any]:
        return ()

    def truth(self, turn: int) -> dict[int, str]:
        return dict(self._table.truth(self.number(turn)))


def make_perception(seen: SeenTable) -> Callable[[Process], Machine]:
    picture = np.zeros((1, 1, 3), np.uint8)
    return lambda _: PerceptionMachine(seen, NO_WORLD, 'table', lambda _: picture)


def make_replay(seen: SeenTable, turns: int) -> Callable[[Process], Machine]:
    """Return what shows the scenes of a bag in place of a perception."""
    clouds = {turn: seen.scene(turn) for turn in range(1, turns + 1)}
    return lambda _: RecordedPerceptionMachine(clouds, None, len, lambda: ())


def make_scripted_teacher(seen: SeenTable, seed: int, delay: float) -> Callable[[Process], Machine]:
    teacher = partial(ScriptedTeacher, SYMBOLS, ('size',), seed, 0.1, 0.1)
    return lambda _: ScriptedTeacherMachine(teacher, seen.truth, NO_WORLD, delay)


def make_recogniser(_: Process) -> Machine:
    return RecogniserMachine(0.5)


def make_rival(episode_id: str, seed: int) -> Callable[[Process], Machine]:
    """Return what makes another learner, which keeps no log, on topics that have one already."""

    def make(_: Process) -> Machine:
        settings = EpisodeSettings(SYMBOLS, 6.0, 5, 'random_fsq')
        started = EpisodeStarted(episode_id, settings, seed, AUTO, None, 'x')
        strategy = make_strategy(settings.strategy, settings.weights)
        return LearnerMachine(
            DurableEpisode(started, strategy, None), None, LearnerOptions(answer_timeout=5.0, yields=True)
        )

    return make


class PersonAtTerminal:
    """Somebody at the screen of a terminal teacher, which may be killed under their hands.

    Args:
        name: of the person, with the namespace.
        truth: what each thing is, given its id.
        said: takes what they say, as the episode's id, the answer's ids and its content.
    """

    def __init__(
        self,
        name: str,
        truth: Callable[[int], str],
        scheduler: Scheduler,
        faults: Faults,
        said: Callable[[str, Any], None],
    ) -> None:
        self._name, self._truth, self._said = name, truth, said
        self._scheduler, self._faults = scheduler, faults
        self._number = 0
        self._dialogue: TeacherDialogue | None = None

    def make_machine(self, process: Process) -> Machine:
        """Sit down at a new screen."""

        def send(episode_id: str, answer: Any) -> None:
            self._said(episode_id, answer)
            process.enter(SAID, (episode_id, answer))

        dialogue = TeacherDialogue(self._name, send, self._new_id, lambda: self._scheduler.now)
        self._dialogue = dialogue
        self._scheduler.after(1.0, lambda: self._look(dialogue))
        return TerminalTeacherMachine(dialogue)

    def _new_id(self) -> str:
        self._number += 1
        return str(self._number)

    def _look(self, dialogue: TeacherDialogue) -> None:
        """Look at the screen now and then, and answer, or take the last answer back."""
        if dialogue is not self._dialogue:
            return
        self._number += 1
        name = (self._name, self._number)
        shown = dialogue.view_state()
        try:
            if shown.prompt is not None and shown.phase in (Phase.ASKED, Phase.CORRECTING):
                dialogue.say(self._word(shown.prompt.query, name))
            elif shown.can_undo and self._faults.happens('undo', *name):
                dialogue.undo()
        except AnswerError:
            # The screen says what was wrong, and they look again.
            pass
        self._scheduler.after(0.5 + 3.0 * self._faults.draw('glance', *name), lambda: self._look(dialogue))

    def _word(self, query: Query, name: tuple[object, ...]) -> str:
        if self._faults.happens('unknown', *name):
            return '?'
        if self._faults.happens('garbage', *name):
            return 'no such word'
        action = query.action
        if action.kind is QueryKind.LABEL:
            return self._truth(int(str(action.object_id)))
        if action.kind is QueryKind.DEMONSTRATION:
            return next((i for i in query.choices if self._truth(int(i)) == action.symbol), 'none')
        return query.choices[0]


class Bag:
    """A recording: what was synced outlives the recorder.

    Attributes:
        kept: topic and text of each message that is on the disk, in order.
        fault: why nothing can be written at present; empty if it can.
    """

    def __init__(self) -> None:
        self.kept: list[tuple[str, str]] = []
        self.fault = ''
        self._unsynced: list[tuple[str, str]] = []

    def write(self, topic: str, data: bytes) -> None:
        if self.fault:
            raise OSError(28, self.fault)
        self._unsynced.append((topic, data.decode()))

    def sync(self) -> None:
        if self.fault:
            raise OSError(28, self.fault)
        self.kept += self._unsynced
        self._unsynced = []

    def lose(self) -> None:
        """Lose what was not synced."""
        self._unsynced = []


def failure_of(error: OSError) -> EpisodeError:
    return EpisodeError(f'the recording failed ({error.strerror})')
