"""A node that recognises what a learner was taught, beside the learner, from a file, or from a log."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from al_questioner.cli import main
from al_questioner.concepts.recognition import recognise
from al_questioner.domain import InputError, Scene
from al_questioner.messages import documents
from al_questioner.messages.clouds import cloud_of_scene, scene_of_cloud
from al_questioner.messages.concepts_file import write_concepts
from al_questioner.questioning.review import taught_learner
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recogniser import RecogniserNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.types import CLOUD_TYPES, detection_types, header
from al_questioner.simulation import PerceivedWorld
from shared.durable_sessions import play_turns, start_durable
from shared.lunches import WORLD_SPEC, Taught, taught

SENSOR = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.VOLATILE)


@pytest.fixture
def lunch() -> Taught:
    return taught()


class Robot:
    """Somebody who shows things to a recogniser, wants some of them, and hears it."""

    def __init__(self, graph: Any) -> None:
        self.graph = graph
        self.clouds = graph.listen('recognised', PointCloud2)
        self.documents = graph.listen('recognition')
        self.markers = graph.listen('recognised_markers', MarkerArray)
        self.targets = graph.listen('target', PoseStamped, qos.EVENTS)
        self.answers = graph.listen('target_info', profile=qos.EVENTS)
        self.wish = graph.ears.create_publisher(String, 'want', qos.EVENTS)
        self.eyes = graph.ears.create_publisher(PointCloud2, 'objects', SENSOR)

    def shows(self, scene: Scene, second: int) -> None:
        """Show things as a camera driver does."""
        self.graph.wait_for(self.eyes.get_subscription_count, 'a node that looks')
        self.eyes.publish(cloud_of_scene(scene, header(second * 10**9, 'camera'), CLOUD_TYPES))

    def recognised(self, second: int) -> dict[str, Any]:
        """The document of the cloud of a second."""
        self.graph.wait_for(
            lambda: self.documents and self.documents[-1]['stamp']['sec'] == second, f'what was seen in second {second}'
        )
        return self.documents[-1]

    def wants(self, text: str) -> dict[str, Any]:
        """Say what is wanted, and hear the answer."""
        before = len(self.answers)
        self.graph.wait_for(self.wish.get_subscription_count, 'a node that listens')
        self.wish.publish(String(data=text))
        self.graph.wait_for(lambda: len(self.answers) > before, f'an answer to {text!r}')
        answer = self.answers[-1]
        documents.read('target_info', json.dumps(answer))
        return answer


@pytest.fixture
def robot(graph: Any) -> Robot:
    return Robot(graph)


def probabilities(document: dict[str, Any]) -> list[list[float]]:
    return [list(each['probabilities'].values()) for each in document['things']]


def test_a_live_learner_is_followed_from_its_first_answer_on(graph: Any, robot: Robot) -> None:
    """Otherwise the robot could be asked for nothing before its lessons are over, or would believe two things."""
    told, clouds = graph.listen('concepts'), graph.listen('objects', PointCloud2)
    recogniser = graph.start(RecogniserNode)
    learner = graph.start(LearnerNode, **graph.episode)
    graph.start(PerceptionNode, **graph.world)
    graph.wait_for(lambda: clouds, 'the first scene')
    assert robot.wants('snack')['reason'] == 'nothing has been taught yet'
    graph.start(TeacherNode, **graph.world)
    first = graph.wait_for(lambda: robot.documents and robot.documents[0], 'what is recognised')
    states = graph.listen('learner_state')
    graph.wait_for_end(states)
    examples = sum(told[-1]['examples'].values())
    graph.wait_for(lambda: sum(told[-1]['examples'].values()) > first['examples'], 'more examples')
    graph.wait_for(
        lambda: robot.documents[-1]['examples'] == sum(told[-1]['examples'].values()), 'all that the learner knows'
    )
    assert first['examples'] == 1
    assert examples > 3
    graph.wait_for(lambda: recogniser.machine.recogniser.recognition, 'the last scene')
    features = scene_of_cloud(clouds[-1]).features
    concepts = learner.machine._durable.episode.concepts
    assert np.array_equal(
        recogniser.machine.recogniser.concepts.predict_proba(features), concepts.predict_proba(features)
    ), 'to the last bit'
    last = robot.documents[-1]
    assert probabilities(last) == recognise(concepts, features).tolist()
    assert last['episode_id'] == learner.machine.episode_id
    assert last['frame_id'] == 'table'
    documents.read('recognition', json.dumps(last))


def by_file(lunch: Taught, folder: Path) -> dict[str, str]:
    write_concepts(folder / 'known.json', lunch.knowledge)
    return {'concepts': str(folder / 'known.json')}


def test_a_file_is_put_to_use(graph: Any, robot: Robot, lunch: Taught, tmp_path: Path) -> None:
    """Otherwise what was taught yesterday would be of no use today; a camera driver's clouds are heard, too."""
    expected = recognise(taught_learner(lunch.knowledge), lunch.scene.features)
    column = lunch.symbols.index('snack')
    # So that there is one.
    threshold = float(expected[:, column].max())
    node = graph.start(RecogniserNode, threshold=threshold, **by_file(lunch, tmp_path))
    has_detections = any(name.endswith('/detections') for name in node._advertised)
    assert has_detections is (detection_types() is not None)
    robot.shows(lunch.scene, 11)
    document = robot.recognised(11)
    assert probabilities(document) == expected.tolist()
    assert document['threshold'] == threshold
    assert [each['known'] for each in document['things']] == (expected.max(axis=1) >= threshold).tolist()
    assert [('question' in each) for each in document['things']] == (expected.max(axis=1) < threshold).tolist()
    cloud = graph.wait_for(lambda: robot.clouds and robot.clouds[-1], 'the cloud')
    assert (cloud.header.stamp.sec, cloud.header.frame_id, cloud.width) == (11, 'camera', len(lunch.scene))
    markers = graph.wait_for(lambda: robot.markers and robot.markers[-1].markers, 'the markers')
    assert sum(marker.ns == 'names' for marker in markers) == len(lunch.scene)

    answer = robot.wants('the Snack')
    row = int(expected[:, column].argmax())
    assert (answer['symbol'], answer['object_id']) == ('snack', lunch.scene.object_ids[row])
    assert answer['probability'] == expected[row, column]
    assert answer['runner_up']['probability'] == np.sort(expected[:, column])[-2]
    target = graph.wait_for(lambda: robot.targets and robot.targets[-1], 'the target')
    assert (target.header.frame_id, target.header.stamp.sec) == ('camera', 11)
    position = target.pose.position
    assert [position.x, position.y, position.z] == lunch.scene.positions[row].tolist() == answer['position']
    assert target.pose.orientation.w == 1.0


def test_the_log_of_a_session_is_put_to_use(graph: Any, tmp_path: Path) -> None:
    """A learner may still be writing to it."""
    world = PerceivedWorld(WORLD_SPEC.open())
    durable = start_durable(tmp_path / 'log')
    play_turns(durable, world, 4)
    recogniser = graph.start(RecogniserNode, session=str(tmp_path / 'log'))
    graph.wait_for(lambda: recogniser.machine.recogniser.concepts is not None, 'what the log holds')
    features = world.scene(4).features
    expected = durable.episode.concepts.predict_proba(features)
    assert np.array_equal(recogniser.machine.recogniser.concepts.predict_proba(features), expected)
    durable.close()


def test_detections_are_published_where_their_type_is_installed(
    graph: Any, robot: Robot, lunch: Taught, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Other packages read those; where vision_msgs is missing, all else works."""
    # Any installed type may stand in for one that is not: what is in it is tested without ROS.
    name = 'al_questioner.ros.topic_messages'
    monkeypatch.setattr(f'{name}.detection_types', lambda: SimpleNamespace(array=String))
    monkeypatch.setattr(f'{name}.detections_of_recognition', lambda found, *_: String(data=f'{len(found.things)}'))
    heard = graph.listen('detections')
    graph.start(RecogniserNode, **by_file(lunch, tmp_path))
    robot.shows(lunch.scene, 11)
    graph.wait_for(lambda: heard and heard[-1].data == f'{len(lunch.scene)}', 'detections')


@pytest.mark.parametrize(
    ('parameters', 'said'),
    [
        ({'concepts': 'damaged.json'}, 'damaged.json: concepts: not valid JSON'),
        ({'concepts': 'missing.json'}, 'missing.json cannot be read'),
        ({'session': 'missing'}, 'missing: does not exist'),
        ({'session': '.'}, 'there is no session log in it'),
        ({'concepts': 'damaged.json', 'session': '.'}, 'one of the parameters concepts and session, not both'),
        ({'threshold': 1.5}, 'parameter threshold must lie in'),
        ({'threshold': 'high'}, 'parameter threshold must be of type float'),
        ({'treshold': 0.5}, 'unknown parameter treshold'),
    ],
)
def test_unusable_parameters_are_refused_at_once(
    graph: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parameters: dict[str, Any], said: str
) -> None:
    """Otherwise the robot would seem to be ready, and know nothing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'damaged.json').write_text('{')
    with pytest.raises(InputError, match=said):
        graph.start(RecogniserNode, **parameters)


def test_the_executable_refuses_bad_input_in_one_line(processes: Any, tmp_path: Path) -> None:
    """A script can rely on the status."""
    (tmp_path / 'damaged.json').write_text('{')
    done = processes.run('recognise', '--ros-args', '-p', f'concepts:={tmp_path / "damaged.json"}')
    assert done.returncode == 2
    assert done.stderr.strip().splitlines()[-1].startswith('recognise: ')
    assert 'Traceback' not in done.stderr


def test_a_wrong_argument_needs_no_ros(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(['recognise', '--nonsense']) == 2
    assert capsys.readouterr().err.startswith("recognise: unexpected argument '--nonsense'")
