"""The node around a machine: one thread, timers, refusals, failures, and the end."""

from __future__ import annotations

import inspect
import re
import threading
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node
from std_msgs.msg import String

import al_questioner.ros
from al_questioner.domain import EpisodeError, InputError
from al_questioner.protocol.effects import ClearTimer, Effects, End, Publish, Report, SetTimer, WriteFile
from al_questioner.protocol.events import Now
from al_questioner.protocol.machine import Machine
from al_questioner.ros import qos
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.worker import Worker


class Toy(Machine):
    """Does what it is told, and notes what happens to it."""

    publishes = ('target_info', 'detections')

    def __init__(self) -> None:
        super().__init__('e')
        self.happened: list[str] = []
        self.threads: set[int] = set()
        self.is_closed = False
        self.may_go_on = threading.Event()
        self.on('want', self._obey)
        self.on_entry('key', self._press)
        for timer in ('soon', 'later', 'never'):
            self.on_timer(timer, lambda timer=timer: self._ring(timer))

    def start(self) -> Effects:
        """Begin."""
        yield from self._note('started')
        yield Report('playing')

    def warning(self, now: Now) -> str:
        """Warn."""
        return 'a toy is no robot' if now.steady > 0 else ''

    def counts(self) -> Mapping[str, int]:
        """Count."""
        return {'wishes': len(self.happened)}

    def measurements(self) -> Mapping[str, str]:
        """Measure."""
        return {'weight': '3 kg'}

    def close(self) -> None:
        """Note it."""
        self.is_closed = True

    def _note(self, what: str) -> Effects:
        self.happened.append(what)
        self.threads.add(threading.get_ident())
        yield from ()

    def _press(self, key: str) -> Effects:
        yield from self._note(f'key {key}')

    def _ring(self, timer: str) -> Effects:
        yield from self._note(timer)

    def _obey(self, wish: str) -> Effects:
        yield from self._note(wish)
        if wish == 'timers':
            yield SetTimer('soon', 3600.0)
            yield SetTimer('later', 0.2)
            yield SetTimer('soon', 0.1)
            yield SetTimer('never', 0.0)
            yield ClearTimer('never')
        elif wish == 'refuse':
            raise InputError('not that')
        elif wish == 'fail':
            raise EpisodeError('it cannot go on')
        elif wish == 'end':
            yield End()
        elif wish == 'wait':
            self.may_go_on.wait(30)
            yield Publish('target_info', wish)
        elif wish.startswith('write '):
            try:
                yield WriteFile(Path(wish.removeprefix('write ')), 'text')
            except InputError as error:
                yield Publish('target_info', str(error))
        yield Publish('detections', wish)


class Child:
    """Somebody who plays with a toy."""

    def __init__(self, graph: Any) -> None:
        self.graph = graph
        self.toy = Toy()
        self.heard = graph.listen('target_info', profile=qos.EVENTS)
        self._mouth = graph.ears.create_publisher(String, 'want', qos.EVENTS)
        self.node: Any = graph.start(lambda **arguments: MachineNode('toy', **arguments))
        self.node.run(self.toy)
        graph.wait_for(self._mouth.get_subscription_count, 'the toy')
        (said,) = [one for one in self.node.publishers if one.topic_name.endswith('/target_info')]
        graph.wait_for(said.get_subscription_count, 'the child')

    def wants(self, wish: str) -> None:
        """Say a wish, and wait until it is heard."""
        self._mouth.publish(String(data=wish))
        self.until(wish)

    def until(self, what: str) -> None:
        """Wait until something has happened to the toy."""
        self.graph.wait_for(lambda: what in self.toy.happened, what)


@pytest.fixture
def child(graph: Any, monkeypatch: pytest.MonkeyPatch) -> Child:
    # So that all of this is tried on machines that have the type, too.
    monkeypatch.setattr('al_questioner.ros.topic_messages.detection_types', lambda: None)
    return Child(graph)


def test_a_machine_is_handled_by_one_thread_from_its_start_on(child: Child) -> None:
    """Otherwise what a message changes would be changed by a timer at the same time."""
    child.wants('timers')
    threading.Thread(target=child.node.enter, args=('key', 'q')).start()
    for what in ('key q', 'later'):
        child.until(what)
    assert child.toy.happened[:2] == ['started', 'timers']
    assert len(child.toy.threads) == 1
    assert threading.get_ident() not in child.toy.threads


def test_a_timer_rings_once_and_the_last_that_was_set_counts(child: Child) -> None:
    """Otherwise a message would be repeated that is stopped, or twice as often."""
    child.wants('timers')
    child.until('later')
    assert [what for what in child.toy.happened if what in ('soon', 'later', 'never')] == ['soon', 'later']


def test_refusals_warnings_and_failures_are_on_the_diagnostics(child: Child, diagnostics: Any) -> None:
    """Otherwise nobody would see what is wrong with a node, whatever its machine says."""
    child.wants('refuse')
    # Neither hides the other.
    diagnostics.wait_for('playing; refused want: not that; a toy is no robot', DiagnosticStatus.WARN)
    values = diagnostics.values
    assert (values['refused on want'], values['weight'], values['wishes']) == ('1', '3 kg', '2')
    child.wants('fail')
    diagnostics.wait_for('it cannot go on', DiagnosticStatus.ERROR)


def test_a_warning_of_the_machine_is_on_the_diagnostics(child: Child, diagnostics: Any) -> None:
    """Otherwise nobody would see that the robot waits for somebody, or that two learners disturb each other."""
    diagnostics.wait_for('playing; a toy is no robot', DiagnosticStatus.WARN)


def test_a_refusal_does_not_hide_that_something_takes_too_long(child: Child, diagnostics: Any) -> None:
    """Otherwise nobody would see for a minute after each refusal that the robot waits for something."""
    # By then it has begun, which sets its status, too.
    child.wants('peace')
    child.node.set_status('playing', expected_within=0.0)
    child.node.reject('want', 'not that')
    diagnostics.wait_for('playing for too long; refused want: not that; a toy is no robot', DiagnosticStatus.WARN)


def test_the_error_of_an_effect_goes_back_to_the_machine(child: Child, tmp_path: Path) -> None:
    """Otherwise a file that cannot be written would end the episode."""
    child.wants(f'write {tmp_path}')
    child.graph.wait_for(lambda: child.heard, 'the reason')
    assert 'cannot be written' in child.heard[0].data
    child.wants(f'write {tmp_path / "file"}')
    child.graph.wait_for((tmp_path / 'file').exists, 'the file')


def test_a_machine_can_end_its_process(child: Child, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise a learner that is over would not make room for the next one."""
    ended: list[bool] = []
    monkeypatch.setattr(child.node.context, 'try_shutdown', lambda: ended.append(True))
    child.wants('end')
    child.graph.wait_for(lambda: ended, 'the end')


def test_nothing_is_said_on_a_topic_that_the_machine_has_not_named(child: Child) -> None:
    """Otherwise a message that nobody can hear would be lost in silence."""
    with pytest.raises(KeyError, match='answer'):
        child.node.perform(Publish('answer', 'snack'))


def test_a_job_that_outlasts_its_node_is_no_failure(
    child: Child, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Otherwise a node that is stopped while it fits its models would end with a traceback."""
    monkeypatch.setattr(Worker.stop, '__defaults__', (0.0,))
    child.wants('wait')
    worker = child.node._worker
    child.graph.stop(child.node)
    assert child.toy.is_closed
    child.toy.may_go_on.set()
    worker.stop(30.0)
    assert capfd.readouterr().err == ''
    assert child.node._failure == ''


def test_no_node_hides_what_rclpys_nodes_need(graph: Any) -> None:
    """Otherwise a parameter, a timer or a clock of rclpy's would be lost, and nobody would know why."""
    folder = Path(al_questioner.ros.__file__).parent
    assigned = re.compile(r'self\.(\w+)(?:: [^=\n]+)? = |^    def (\w+)\(self', re.MULTILINE)
    ours = {
        name
        for path in (folder / 'node.py', folder / 'machine_node.py', *(folder / 'nodes').glob('*.py'))
        for found in assigned.findall(path.read_text(encoding='utf-8').split('class MachineNode')[-1])
        for name in found
    }
    theirs = {*dir(Node), *vars(graph.ears), *re.findall(r'self\.(\w+) = ', inspect.getsource(Node))}
    assert ours & theirs == {'__init__', 'destroy_node', 'set_parameters_atomically'}


def test_a_stream_of_nonsense_is_logged_once_a_second(graph: Any, capfd: pytest.CaptureFixture[str]) -> None:
    """Otherwise ten warnings a second would hide all others."""
    node = graph.start(lambda **arguments: QuestionerNode('node', **arguments))
    for number in range(300):
        node.reject('objects', f'feature colour_{number} of object {number} is not finite (nan)')
        node.reject('objects', 'the cloud has no field object_id')
    said = capfd.readouterr().err
    seconds = 1 + said.count('other refusals were only counted')
    assert said.count('is not finite') <= seconds
    assert said.count('has no field') <= seconds
    assert said.count('is not finite') >= 1 <= said.count('has no field')
    assert node.counts() == {'refused on objects': 600}


@pytest.mark.parametrize(('count', 'said'), [(1, '1 other refusal was'), (2, '2 other refusals were')])
def test_refusals_that_were_not_logged_are_counted_in_english(
    graph: Any, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, count: int, said: str
) -> None:
    """Otherwise it would say that 1 other refusals were counted."""
    node = graph.start(lambda **arguments: QuestionerNode('node', **arguments))
    monkeypatch.setattr(node, '_said', SimpleNamespace(passes=lambda *_: True, held_back=lambda: count))
    node.reject('objects', 'the cloud has no field object_id')
    assert f'({said} only counted)' in capfd.readouterr().err
