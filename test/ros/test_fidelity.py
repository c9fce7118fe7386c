"""Machines do in nodes what they do without ROS, given the same events at the same times."""

from __future__ import annotations

import dataclasses
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from std_msgs.msg import String

from al_questioner.domain import THRESHOLD
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.protocol.effects import Publish, Refuse
from al_questioner.protocol.events import Heard, Started, TimerFired
from al_questioner.protocol.learner import ANSWER_TIMEOUT, LearnerMachine
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.perception import PerceptionMachine
from al_questioner.protocol.recogniser import RecogniserMachine
from al_questioner.protocol.scripted_teacher import ScriptedTeacherMachine
from al_questioner.questioning import make_strategy
from al_questioner.ros import qos
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recogniser import RecogniserNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.simulation import PerceivedWorld
from al_questioner.simulation.kitchen.table_image import draw_scene
from shared.durable_sessions import WORLD
from shared.lunches import WORLD_SPEC, teacher
from shared.machine_recording import Recording, repeat, value_of

PLAIN = {'label': 'snack', 'feature_subset': 'colour,size'}
ERRING = {'wrong_rate': 0.3, 'unknown_rate': 0.3}
DELAY = 0.25
"""Seconds that the teacher thinks: longer than the learner waits in some turns."""


@pytest.fixture
def recordings(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[Recording]]:
    """Recordings of the machines of all nodes that begin, by the name of the node."""
    found: dict[str, list[Recording]] = {}
    run = MachineNode.run

    def run_recorded(node: MachineNode, machine: Machine) -> None:
        found.setdefault(node.get_name(), []).append(Recording(machine))
        run(node, machine)

    monkeypatch.setattr(MachineNode, 'run', run_recorded)
    return found


def play(graph: Any, person: Any, folder: Path) -> None:
    """An episode with all that may happen to one: garbage, a learner that starts again, and a teacher who errs."""
    learner = {'strategy': 'random_fsq', 'budget': 12.0, 'turns': 14, 'session': str(folder)}
    wish = graph.ears.create_publisher(String, 'want', qos.EVENTS)
    infos = graph.listen('target_info', profile=qos.EVENTS)
    recogniser = graph.start(RecogniserNode)
    graph.start(PerceptionNode, **graph.world)
    first = graph.start(LearnerNode, **graph.episode | learner)
    assert not person.says('pudding')['accepted']
    for number in (1, 2, 3):
        assert person.says(PLAIN[person.query(number)['kind']])['accepted']
    person.query(4)
    graph.wait_for(lambda: recogniser.counts().get('clouds recognised'), 'a thing that is recognised')
    graph.wait_for(wish.get_subscription_count, 'a recogniser that listens')
    wish.publish(String(data='snack'))
    graph.wait_for(lambda: infos, 'what became of the wish')
    graph.stop(first)
    graph.start(LearnerNode, **graph.episode | learner, answer_timeout=0.1)
    graph.start(TeacherNode, **graph.world, **ERRING, delay=DELAY)
    graph.wait_for_end(person.states)
    for node in list(graph.nodes):
        graph.stop(node)


def other_learner(machine: LearnerMachine, folder: Path) -> LearnerMachine:
    """A learner of the same episode, with a session of its own."""
    started = machine._durable.started
    strategy = make_strategy(started.settings.strategy, started.settings.weights)
    return LearnerMachine(DurableEpisode(started, strategy, SessionLog(folder)), WORLD, machine._options)


def written(folder: Path) -> list[tuple[str, bytes]]:
    """Kind and content of all events of a session; when they were written is told by a clock of the log's own."""
    contents = read_log(folder)
    assert contents.damage is None
    return [(event.kind, event.content) for event in contents.events]


def check_repeated(recording: Recording, machine: Machine) -> None:
    """Have another machine repeat a recording, and compare what it wants done."""
    for number, (before, again) in enumerate(repeat(recording.steps, machine)):
        where = f'step {number}: {before.event}'
        assert [type(effect) for effect in again.effects] == [type(effect) for effect in before.effects], where
        assert value_of(again.effects) == value_of(before.effects), where
        assert again.failure == before.failure, where
    machine.close()


def test_a_recorded_run_is_repeated_without_ros(
    graph: Any, person: Any, recordings: dict[str, list[Recording]], tmp_path: Path
) -> None:
    """Otherwise what is tried with machines alone would prove nothing of the nodes, whose wiring decides something."""
    play(graph, person, tmp_path / 'session')
    ((looks,), (thinks,), (recognises,), learners) = (
        recordings[name] for name in ('perception', 'teacher', 'recogniser', 'learner')
    )
    check_repeated(
        looks,
        PerceptionMachine(
            PerceivedWorld(WORLD_SPEC.open()), WORLD, 'table', lambda observations: draw_scene(observations).image
        ),
    )
    script = partial(dataclasses.replace, teacher(**ERRING))
    check_repeated(thinks, ScriptedTeacherMachine(script, WORLD_SPEC.open().truth, WORLD, DELAY))
    check_repeated(recognises, RecogniserMachine(THRESHOLD.default))
    assert len(learners) == 2
    for learns in learners:
        check_repeated(learns, other_learner(learns.machine, tmp_path / 'again'))
    assert written(tmp_path / 'again') == written(tmp_path / 'session')
    check_heard(looks, learners)
    check_variety(learners, thinks)


def check_heard(looks: Recording, learners: list[Recording]) -> None:
    """Make sure that learners hear scenes to the last bit as perception shows them."""
    shown = {
        effect.content.stamp: effect.content
        for effect in looks.effects
        if isinstance(effect, Publish) and effect.topic == 'objects'
    }
    heard = [
        step.event.content
        for learns in learners
        for step in learns.steps
        if isinstance(step.event, Heard) and step.event.topic == 'objects'
    ]
    assert heard
    for look in heard:
        assert value_of(look.read(())) == value_of(shown[look.stamp].scene)
        assert look.frame_id == shown[look.stamp].frame_id


def check_variety(learners: list[Recording], thinks: Recording) -> None:
    """Make sure that all kinds of things have happened, so that the repetition says something."""
    steps = [step for learns in learners for step in learns.steps]
    events = [step.event for step in steps]
    assert sum(isinstance(event, Started) for event in events) == 2
    assert {event.topic for event in events if isinstance(event, Heard)} == {'objects', 'answer', 'turn'}
    assert ANSWER_TIMEOUT in {event.timer for event in events if isinstance(event, TimerFired)}
    assert any(isinstance(effect, Refuse) for step in steps for effect in step.effects)
    topics = {effect.topic for learns in learners for effect in learns.effects if isinstance(effect, Publish)}
    assert topics == set(LearnerMachine.publishes)
    assert any('"unknown"' in effect.content for effect in thinks.effects if isinstance(effect, Publish))
