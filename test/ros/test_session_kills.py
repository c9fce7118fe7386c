"""Learner processes that are killed, and others that go on: no acknowledged answer is lost, and the same is asked."""

from __future__ import annotations

import contextlib
import random
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import ActionChosen, AnswerAccepted, EpisodeStarted
from al_questioner.event_log.log import SessionLogError, read_log
from al_questioner.ros import qos
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.checkout import ROOT

LEARNER = ROOT / 'test' / 'shared' / 'killed_learner.py'
OVER = 'the episode is over'
EPISODE = {'task': 'prepare_lunch', 'seed': 4, 'budget': 7.0, 'turns': 6, 'strategy': 'random_fsq'}
WRITE_POINTS = 4 * (1 + 6 + 6)
"""Four for each of: the episode, a scene with its decision, an answer; asking in every turn."""

POINTS_OF_A_REFUSAL = 4
KILLS = 40
"""Learners that are killed at random moments; the bottle tries many more."""
LONGEST_LIFE = 0.4
"""Seconds that a learner lives at most after it is up, where it is killed at random."""


class Learners:
    """Learner processes, one after the other, beside a perception and a teacher that stay."""

    def __init__(self, graph: Any, processes: Any) -> None:
        self.acks = graph.listen('answer_ack', profile=qos.EVENTS)
        self._processes = processes
        processes.namespace = graph.namespace
        graph.start(PerceptionNode, **graph.world)
        graph.start(TeacherNode, **graph.world)

    def start(self, session: Path, kill_at: int = 0) -> None:
        program = [sys.executable, str(LEARNER), str(kill_at)]
        self._processes.node('learner', program=program, **EPISODE, session=str(session))

    def wait_for(self, text: str) -> bool:
        """Wait until the learner prints something; false if it was killed before."""
        return self._processes.wait_for_log('learner', text, may_be_killed=True)

    def kill(self) -> None:
        self._processes.kill('learner')

    @property
    def is_over(self) -> bool:
        return OVER in self._processes.log('learner')

    def finish(self, session: Path) -> None:
        """Have a learner go on to the end."""
        self.start(session)
        assert self.wait_for(OVER)
        self.kill()


@pytest.fixture
def learners(graph: Any, processes: Any) -> Learners:
    return Learners(graph, processes)


def decisions(session: Path) -> list[tuple[Any, ...]]:
    """Return the decisions and questions in order, and the answers."""
    found, fault = decoded(read_log(session))
    assert fault is None
    asked = [(event.turn, event.action, event.query) for event in found if isinstance(event, ActionChosen)]
    said = [(event.answer.query_id, event.answer.content) for event in found if isinstance(event, AnswerAccepted)]
    return [*asked, *said]


def events_in(session: Path) -> int:
    """Return the number of events in a log; 0 before there is one."""
    try:
        return len(read_log(session).events)
    except SessionLogError:
        return 0


def check_acknowledged(learners: Learners, session: Path) -> None:
    """Every answer that was acknowledged is in the log, once."""
    found, fault = decoded(read_log(session))
    assert fault is None
    taken = [(event.answer.query_id, event.answer.answer_id) for event in found if isinstance(event, AnswerAccepted)]
    assert len(set(taken)) == len(taken)
    episode_ids = [event.episode_id for event in found if isinstance(event, EpisodeStarted)]
    acks = [ack for ack in learners.acks if ack['accepted'] and ack['episode_id'] in episode_ids]
    acknowledged = {(ack['query_id'], ack['answer_id']) for ack in acks}
    assert acknowledged <= set(taken)


def kill_and_go_on(learners: Learners, session: Path, point: int) -> bool:
    """Kill a learner at a write point and have another one go on; False if the first one was over before."""
    learners.start(session, kill_at=point)
    was_over = learners.wait_for(OVER)
    learners.kill()
    with contextlib.suppress(SessionLogError):
        check_acknowledged(learners, session)
    learners.finish(session)
    check_acknowledged(learners, session)
    return not was_over


@pytest.mark.parametrize('point', [10, *(pytest.param(point, marks=pytest.mark.slow) for point in (6, 12))])
def test_a_killed_learner_is_gone_on_with(learners: Learners, tmp_path: Path, point: int) -> None:
    """A crash at a decision or around an answer neither loses the answer nor leads to other questions."""
    learners.finish(tmp_path / 'whole')
    assert kill_and_go_on(learners, tmp_path / 'killed', point)
    assert decisions(tmp_path / 'killed') == decisions(tmp_path / 'whole')


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_a_learner_killed_at_write_points_of_every_kind_is_gone_on_with(learners: Learners, tmp_path: Path) -> None:
    """Otherwise there would be a moment at which a crash costs an answer.

    Real processes at one write point in five, which meets each of the four kinds; every point is tried in one process,
    see `test_durable_episode.py`, and in virtual time, see `test_bottle.py`.
    """
    learners.finish(tmp_path / 'whole')
    point, kinds = 1, set()
    while kill_and_go_on(learners, tmp_path / f'killed-{point}', point):
        assert decisions(tmp_path / f'killed-{point}') == decisions(tmp_path / 'whole')
        kinds.add(point % 4)
        point += 5
    assert kinds == {0, 1, 2, 3}
    # The teacher may still send the last answer of the session before: refused, and written down once.
    assert point <= WRITE_POINTS + POINTS_OF_A_REFUSAL + 5


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_learners_killed_at_random_moments_are_gone_on_with(learners: Learners, tmp_path: Path) -> None:
    """No answer is lost at a moment that no list of write points foresees."""
    learners.finish(tmp_path / 'whole')
    draw, kills, episodes, longest = random.Random(1), 0, 0, LONGEST_LIFE
    while kills < KILLS:
        session = tmp_path / f'random-{episodes}'
        over, written = False, 0
        while not over:
            learners.start(session)
            learners.wait_for('is up')
            time.sleep(draw.uniform(0, longest))
            learners.kill()
            kills += 1
            before, written = written, events_in(session)
            # On a busy machine no learner would live for long enough to write anything.
            longest = LONGEST_LIFE if written > before else 2 * longest
            over = learners.is_over
        learners.finish(session)
        check_acknowledged(learners, session)
        assert decisions(session) == decisions(tmp_path / 'whole')
        episodes += 1
