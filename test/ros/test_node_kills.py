"""Perception, teacher and recorder are killed while a learner lives, and come back in any order: the same is asked."""

from __future__ import annotations

import random
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from al_questioner.bags import BagError, deserialize, read_bag, repair
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import AnswerAccepted
from al_questioner.event_log.log import read_log
from al_questioner.messages import documents
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from shared.bags import wait_for_content
from shared.offline import offline_queries

WORLD = {'task': 'prepare_lunch', 'seed': 4}
RATES = {'wrong_rate': 0.1, 'unknown_rate': 0.1}


class Others:
    """Processes beside a learner, each of which may have been several, one after the other.

    Attributes:
        bags: of the recorders, in order.
    """

    def __init__(self, graph: Any, processes: Any, folder: Path) -> None:
        self.bags: list[Path] = []
        self._processes, self._folder = processes, folder
        processes.namespace = graph.namespace

    def start(self, *names: str, delay: float = 0.02) -> None:
        """Start some, with a teacher that thinks for `delay` seconds."""
        for name in names:
            parameters: dict[str, Any] = {**WORLD}
            if name == 'record':
                self.bags.append(self._folder / f'bag-{len(self.bags)}')
                parameters = {'bag': str(self.bags[-1])}
            elif name == 'teacher':
                parameters |= {**RATES, 'delay': delay}
            self._processes.node(name, **parameters)

    def kill(self, names: Iterable[str]) -> None:
        for name in names:
            assert self._processes.is_running(name), f'{name} had ended by itself'
            self._processes.kill(name)


def turns_in(bag: Path) -> list[int]:
    """Return the turns that a bag tells of."""
    found = [m for m in read_bag(bag).messages if m.topic.endswith('/turn')]
    return sorted({documents.read('turn', deserialize(message).data)['turn'] for message in found})


def start_learner(graph: Any, session: Path, budget: float, turns: int) -> Any:
    episode = {'strategy': 'u_sampling_fsq', 'budget': budget, 'turns': turns, 'turn_period': 0.05}
    return graph.start(LearnerNode, **WORLD, **episode, session=str(session))


def check(state: dict[str, Any], session: Path, budget: float, turns: int) -> None:
    """The episode ended as it does when nobody is killed, and every answer counted once."""
    assert state['queries'] == offline_queries('u_sampling_fsq', budget, turns, teacher=RATES)
    events, damage = decoded(read_log(session))
    assert damage is None
    told = [event.answer.query_id for event in events if isinstance(event, AnswerAccepted)]
    assert told == [f'q{number}' for number in range(1, len(told) + 1)]


def test_whoever_is_killed_comes_back_and_the_same_is_asked(graph: Any, processes: Any, tmp_path: Path) -> None:
    """Otherwise the robot's driver, or the teacher's laptop, would end the episode, or change what is learnt."""
    states = graph.listen('learner_state')
    learner = start_learner(graph, tmp_path / 'log', 9.0, 14)
    others = Others(graph, processes, tmp_path)
    others.start('record', 'perception')
    wait_for_content(others.bags[0], b'al_questioner/turn/1')
    # Whose answers to the other queries would take longer than it lives.
    others.start('teacher', delay=1.0)
    graph.wait_for(lambda: states and states[-1]['turn'] >= 2, 'two turns')
    others.kill(('perception', 'teacher', 'record'))
    assert not states[-1]['done']
    others.start('teacher', 'record', 'perception')
    check(graph.wait_for_end(states), tmp_path / 'log', 9.0, 14)
    assert not learner._failure
    repair(others.bags[0])
    recorded = turns_in(others.bags[0])
    assert recorded == list(range(recorded[0], recorded[-1] + 1))


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_nodes_killed_at_random_moments_come_back(graph: Any, processes: Any, tmp_path: Path) -> None:
    """Otherwise there would be a moment at which the death of a node costs an answer, or ends the episode."""
    draw, kills, episodes = random.Random(1), 0, 0
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    others = Others(graph, processes, tmp_path)
    others.start('record', 'perception', 'teacher')
    while kills < 200:
        session, names = tmp_path / f'log-{episodes}', ['perception', 'teacher', 'record']
        learner = start_learner(graph, session, 25.0, 40)
        while kills < 200 and not (states and states[-1]['done']):
            if draw.random() < 0.7:
                # At work, not only while they start.
                before = len(states)
                graph.wait_for(lambda before=before: len(states) > before, 'another turn')
            time.sleep(draw.uniform(0, 0.5))
            some = draw.sample(names, draw.randint(1, 3))
            others.kill(some)
            kills += len(some)
            time.sleep(draw.choice((0, draw.uniform(0, 0.5))))
            others.start(*draw.sample(some, len(some)))
        check(graph.wait_for_end(states), session, 25.0, 40)
        assert not learner._failure
        graph.stop(learner)
        states.clear()
        episodes += 1
    read, reasons = 0, set()
    for bag in filter(Path.is_dir, others.bags[:-1]):
        try:
            repair(bag)
            read += len(read_bag(bag).messages)
        except BagError as error:
            reasons.add(str(error).split(': ', 1)[1].split(' from ')[0])
    # Of those that were killed before they had written anything.
    assert reasons <= {'no message can be read', 'is no bag (no metadata.yaml and no file with messages in it)'}
    assert read > 100
