"""The recorder: everything that makes up a demonstration is in the bag, from the first turn to the last."""

from __future__ import annotations

import errno
import json
import threading
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import String

from al_questioner.bags import BagError, BagWriter, deserialize, read_bag, read_episodes, repair
from al_questioner.cli import main
from al_questioner.domain import InputError
from al_questioner.event_log.events import ActionChosen, AnswerAccepted
from al_questioner.event_log.replay import first_divergence
from al_questioner.messages.documents import write as write_document
from al_questioner.protocol.events import Heard, TimerFired
from al_questioner.protocol.recorder import SYNC
from al_questioner.protocol.topics import Recorded
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recorder import RecorderNode, text_of
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.bags import TOPICS, text

EPISODE = {'strategy': 'expert', 'budget': 8.0, 'turns': 10}


def documents(bag: Any, name: str) -> list[dict[str, Any]]:
    return [json.loads(deserialize(m).data) for m in bag.messages if m.topic.endswith(f'/{name}')]


def test_a_recording_holds_the_whole_episode(graph: Any, tmp_path: Path) -> None:
    """A demonstration with holes cannot be learnt from. The nodes wait for the recorder, however late it comes."""
    graph.start(PerceptionNode, **graph.world, wait_for_recorder=True)
    graph.start(TeacherNode, **graph.world, wait_for_recorder=True)
    graph.start(LearnerNode, **{**graph.episode, **EPISODE, 'wait_for_recorder': True})
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'b'), until_done=True)
    graph.wait_for(lambda: recorder.machine.done, 'the end of the recording')
    graph.stop(recorder)
    assert recorder.machine.failure is None
    bag = read_bag(tmp_path / 'b')
    assert list(dict.fromkeys(document['turn'] for document in documents(bag, 'turn'))) == list(range(1, 11))
    counts = Counter(message.topic.rsplit('/', 1)[-1] for message in bag.messages)
    assert counts['decision'] == 10
    assert min(counts['objects'], counts['turn']) >= 10
    asked = [document['query_id'] for document in documents(bag, 'query')]
    assert {document['query_id'] for document in documents(bag, 'answer')} == set(asked)
    assert {d['query_id'] for d in documents(bag, 'answer_ack') if d['accepted']} == set(asked)
    assert documents(bag, 'learner_state')[-1]['done']
    (episode,) = read_episodes(tmp_path / 'b')
    assert len(episode.turns) == 10
    assert [turn.record.turn for turn in episode.turns if turn.record] == [
        query['turn'] for query in documents(bag, 'learner_state')[-1]['queries']
    ]
    assert first_divergence(episode.started, episode.events) is None


def test_a_correction_is_replayed_in_the_turn_in_which_it_was_made(graph: Any, tmp_path: Path) -> None:
    """Otherwise the bag of a person who was wrong once would lead to other decisions than those in it."""
    person = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    queries, states = graph.listen('query'), graph.listen('learner_state')
    graph.start(PerceptionNode, **graph.world, wait_for_recorder=True)
    robot = {**graph.episode, 'strategy': 'u_sampling', 'turns': 4}
    graph.start(LearnerNode, **robot, wait_for_recorder=True)
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'b'), until_done=True)
    decisions = f'written of /{graph.namespace}/decision'

    def says(number: int, **members: Any) -> None:
        said = {'query_id': f'q{number}', 'teacher_id': 'anna', 'outcome': 'answered', 'content': 'snack', **members}
        person.publish(String(data=write_document('answer', queries[-1]['episode_id'], said)))

    for number in range(1, 5):
        graph.wait_for(lambda n=number: queries and queries[-1]['query_id'] == f'q{n}', f'question {number}')
        if number == 3:
            # Recorders do not keep to the order between topics.
            graph.wait_for(lambda: recorder.counts()[decisions] == 3, 'the third decision in the bag')
            says(1, answer_id='a2', content='fruit', replaces='a1')
            graph.wait_for(lambda: states and states[-1]['labels']['fruit'], 'the correction')
            assert states[-1]['turn'] == 2
        says(number, answer_id='a1')
    graph.wait_for(lambda: recorder.machine.done, 'the end of the recording')
    graph.stop(recorder)
    (episode,) = read_episodes(tmp_path / 'b')
    answered = [event for event in episode.events if isinstance(event, (ActionChosen, AnswerAccepted))]
    assert [event.turn if isinstance(event, ActionChosen) else event.answer.query_id for event in answered] == [
        *(1, 'q1', 2, 'q2', 3, 'q1', 'q3', 4, 'q4')
    ]
    assert first_divergence(episode.started, episode.events) is None


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_late_end_keeps_everything(graph: Any, tmp_path: Path, storage: str) -> None:
    """A recording that is ended by hand holds all that still waited to be written."""
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'b'), storage=storage)
    for number in range(200):
        recorder.tell(Heard('answer', Recorded(text(str(number)), number, lambda: '')))
    graph.stop(recorder)
    assert [deserialize(message).data for message in read_bag(tmp_path / 'b').messages] == list(map(str, range(200)))
    assert any((tmp_path / 'b').glob('*.db3' if storage == 'sqlite3' else '*.mcap'))


def test_the_text_of_a_message_is_read_or_refused() -> None:
    """Otherwise garbage on a topic would end the recording."""
    assert text_of(text('snack')) == 'snack'
    with pytest.raises(InputError):
        text_of(b'?')


@pytest.mark.parametrize(
    ('wanted', 'expected'), [('', None), ('robot', '/robot'), ('/lab/robot/', '/lab/robot'), ('/', '')]
)
def test_the_bag_names_its_topics_as_wanted(graph: Any, tmp_path: Path, wanted: str, expected: str | None) -> None:
    """Otherwise a recording that is handed on would name a namespace that was made up for one process."""
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'b'), namespace_in_bag=wanted)
    publisher = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    graph.wait_for(publisher.get_subscription_count, 'the recorder')
    publisher.publish(String(data='snack'))
    topic = f'{f"/{graph.namespace}" if expected is None else expected}/answer'
    graph.wait_for(lambda: recorder.counts()[f'written of {topic}'], 'a message')
    graph.stop(recorder)
    assert [message.topic for message in read_bag(tmp_path / 'b').messages] == [topic]


def test_a_bag_that_cannot_be_begun_is_refused(graph: Any, tmp_path: Path) -> None:
    """Otherwise it would hold names that no tool takes; or a demonstration be lost, which cannot be given twice."""
    with pytest.raises(InputError, match='parameter namespace_in_bag'):
        graph.start(RecorderNode, bag=str(tmp_path / 'b'), namespace_in_bag='my robot')
    assert not (tmp_path / 'b').exists()
    (tmp_path / 'b').mkdir()
    with pytest.raises(InputError, match='exists already'):
        graph.start(RecorderNode, bag=str(tmp_path / 'b'))


def test_repairing_says_what_was_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a user would not know whether the repair was worth anything."""
    bag = BagWriter(tmp_path / 'b', TOPICS)
    bag.write('/x/turn', text('a'), 5)
    bag.sync()
    assert main(['record', '--repair', str(tmp_path / 'b')]) == 0
    assert '1 messages kept' in capsys.readouterr().out
    assert main(['record', '--repair', str(tmp_path / 'b')]) == 0
    assert 'is whole: 1 messages' in capsys.readouterr().out


def test_a_full_disk_ends_the_recording_and_is_on_the_diagnostics(
    graph: Any, diagnostics: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a robot would go on for hours without being recorded."""
    path = tmp_path / 'b'
    publisher = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    recorder = graph.start(RecorderNode, bag=str(path))
    topic = f'written of /{graph.namespace}/answer'
    graph.wait_for(publisher.get_subscription_count, 'the recorder')
    publisher.publish(String(data='snack'))
    graph.wait_for(lambda: recorder.counts()[topic] == 1, 'a message')
    # By the worker, which syncs by itself now and then.
    synced = threading.Event()
    recorder.tell(TimerFired(SYNC))
    recorder.submit(synced.set)
    graph.wait_for(synced.is_set, 'the message on the disk')

    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, 'No space left on device')

    monkeypatch.setattr(recorder._bag._writer.storage, 'sync', fail)
    graph.wait_for(lambda: recorder.machine.failure, 'the failure')
    publisher.publish(String(data='fruit'))
    graph.stop(recorder)
    assert 'No space left on device' in str(recorder.machine.failure)
    ours = (f'{graph.namespace}/recorder', DiagnosticStatus.ERROR)
    graph.wait_for(lambda: ours in [(s.name, s.level) for s in diagnostics.statuses], 'an error on /diagnostics')
    with pytest.raises(BagError, match='record --repair'):
        read_bag(path)
    assert dict(repair(path).kept) == {f'/{graph.namespace}/answer': 1}
