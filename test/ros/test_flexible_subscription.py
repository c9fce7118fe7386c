"""Every publisher is heard, whatever its quality of service, or the user is told which one is not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String

from al_questioner.bags import read_bag
from al_questioner.domain import InputError
from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.messages.pictures import image
from al_questioner.messages.stamps import SECOND
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recorder import RecorderNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.types import CLOUD_TYPES, header, octets
from al_questioner.simulation import PerceivedWorld, WorldSpec, load_task

OFFERS = {
    'an ordinary publisher': QoSProfile(depth=10),
    'sensor data': QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT),
    'latched': qos.LATCHED,
    'latched, not resent': QoSProfile(
        depth=1, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.TRANSIENT_LOCAL
    ),
}
FAR = (2**31 - 1) * SECOND
"""A time that is no turn's past."""


def cloud() -> PointCloud2:
    scene = PerceivedWorld(WorldSpec(load_task('prepare_lunch'), 4, 4).open()).scene(1)
    return cloud_of_scene(scene, header(FAR, 'camera'), CLOUD_TYPES)


def keep_saying(publisher: Any, message: Any, is_heard: Any) -> Any:
    """Return a function that publishes the message, as drivers do again and again, and tells whether it was heard."""

    def say() -> Any:
        publisher.publish(message)
        return is_heard()

    return say


@pytest.mark.parametrize('offer', OFFERS)
def test_a_driver_of_any_kind_is_heard_and_told_nothing_else(graph: Any, offer: str) -> None:
    """A camera's driver is heard, and does not warn that nobody hears it."""
    decisions, warnings = graph.listen('decision', PointCloud2, qos.EVENTS), []
    callbacks = PublisherEventCallbacks(incompatible_qos=warnings.append)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', OFFERS[offer], event_callbacks=callbacks)
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(keep_saying(eyes, cloud(), lambda: decisions), 'a decision')
    assert not warnings


@pytest.mark.parametrize('offer', OFFERS)
def test_a_picture_of_any_kind_reaches_who_teaches(graph: Any, offer: str) -> None:
    """Otherwise the person at the terminal would see no picture of a robot's own camera."""
    sessions: list[Any] = []
    eyes = graph.ears.create_publisher(Image, 'scene_image', OFFERS[offer])
    graph.start(
        lambda **arguments: TeacherNode(lambda session, ended: (sessions.append(session), ended.wait()), **arguments),
        mode='terminal',
    )
    graph.wait_for(lambda: sessions, 'a person at the terminal')
    seen: list[Any] = []
    sessions[0].see = lambda *arguments: seen.append(arguments)
    picture = image(np.zeros((4, 6, 3), np.uint8), header(FAR, 'camera'), Image, octets)
    graph.wait_for(keep_saying(eyes, picture, lambda: seen), 'the picture')


@pytest.mark.parametrize('offer', OFFERS)
def test_an_answer_of_any_kind_is_taken(graph: Any, offer: str) -> None:
    """Otherwise a page or a microcontroller that sends best effort would not be believed to have answered."""
    queries, states = graph.listen('query'), graph.listen('learner_state')
    mouth = graph.ears.create_publisher(String, 'answer', OFFERS[offer])
    graph.start_robot(strategy='u_sampling', turns=1)
    graph.wait_for(lambda: queries, 'a question')
    graph.wait_for(keep_saying(mouth, String(data='snack'), lambda: states), 'the end of the turn')
    assert states[-1]['labels']['snack'] == 1


def test_what_was_latched_before_is_seen_but_no_answer_of_before_is_heard(graph: Any) -> None:
    """A still camera publishes once for all learners, and yesterday's answer does not teach today's question."""
    queries, states = graph.listen('query'), graph.listen('learner_state')
    mouth = graph.ears.create_publisher(String, 'answer', qos.LATCHED)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    mouth.publish(String(data='fruit'))
    eyes.publish(cloud())
    learner = graph.start(LearnerNode, **{**graph.episode, 'strategy': 'u_sampling', 'turns': 1})
    graph.wait_for(lambda: queries, 'a question about what was latched')
    graph.wait_for(keep_saying(mouth, String(data='snack'), lambda: states), 'the end of the turn')
    assert states[-1]['labels'] == {'main_dish': 0, 'snack': 1, 'fruit': 0, 'beverage': 0}
    assert 'refused on objects' not in learner.counts()


class Listener(QuestionerNode):
    """Hears one topic."""

    def __init__(self, topic: str, **arguments: Any) -> None:
        super().__init__('listener', **arguments)
        self.heard: list[str] = []
        self.listen(String, topic, lambda message: self.heard.append(message.data), qos.LATCHED)


@pytest.mark.parametrize('topic', ['objects', 'turn'])
def test_each_message_is_heard_once_whoever_else_publishes(graph: Any, topic: str) -> None:
    """A message that comes by two subscriptions is not counted, refused or answered twice."""
    mouths = {offer: graph.ears.create_publisher(String, topic, profile) for offer, profile in OFFERS.items()}
    listener = graph.start(lambda **arguments: Listener(topic, **arguments))
    for offer, mouth in mouths.items():
        graph.wait_for(keep_saying(mouth, String(data=offer), lambda: offer in listener.heard), offer)  # noqa: B023
    graph.wait_for(lambda: len(list(listener.subscriptions)) >= 3, 'a subscription of each kind')
    listener.heard.clear()
    said = [f'{number} {offer}' for number in range(5) for offer in OFFERS]
    for text in said:
        mouths[text.split(' ', 1)[1]].publish(String(data=text))
        graph.wait_for(lambda: text in listener.heard, text)  # noqa: B023
    assert [text for text in listener.heard if text in said] == said


def test_a_driver_of_sensor_data_is_recorded(graph: Any, tmp_path: Path) -> None:
    """Otherwise the recording of a robot with eyes of its own would hold no scene."""
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', OFFERS['sensor data'])
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'bag'))
    topic = f'/{graph.namespace}/objects'
    graph.wait_for(keep_saying(eyes, cloud(), lambda: recorder.counts()[f'written of {topic}']), 'a scene')
    graph.stop(recorder)
    assert topic in {message.topic for message in read_bag(tmp_path / 'bag').messages}


@pytest.fixture
def stranger(graph: Any) -> Iterator[Node]:
    """A node as in another process: in one, a topic has one type."""
    context = Context()
    context.init(domain_id=graph.context.get_domain_id())
    node = Node('stranger', namespace=graph.namespace, context=context)
    try:
        yield node
    finally:
        node.destroy_node()
        context.try_shutdown()


def test_a_publisher_of_another_type_is_named(graph: Any, stranger: Node, diagnostics: Any) -> None:
    """Otherwise the learner would wait for objects, and nobody see why."""
    stranger.create_publisher(String, 'objects', qos.LATCHED)
    graph.start(LearnerNode, **graph.episode)
    name, topic = f'/{graph.namespace}/stranger', f'/{graph.namespace}/objects'
    of_type = f'{name} publishes std_msgs/msg/String on {topic}, not sensor_msgs/msg/PointCloud2: unheard'
    diagnostics.wait_for(f'objects; {of_type}')


def test_who_asks_for_more_than_is_offered_is_named(graph: Any, diagnostics: Any) -> None:
    """Otherwise a user who waits for what is not latched would wait for ever."""
    graph.ears.create_subscription(PointCloud2, 'decision', lambda _: None, qos.LATCHED)
    graph.start(LearnerNode, **graph.episode)
    diagnostics.wait_for(
        f'waiting for objects; /{graph.namespace}/ears listens to /{graph.namespace}/decision and hears nothing:'
        ' volatile publisher and transient local subscription'
    )


def override(graph: Any, topic: str, end: str, **policies: Any) -> dict[str, Any]:
    return {f'qos_overrides./{graph.namespace}/{topic}.{end}.{policy}': value for policy, value in policies.items()}


def test_the_user_chooses_the_quality_of_service(graph: Any, diagnostics: Any) -> None:
    """Otherwise `qos_overrides` would be accepted and do nothing."""
    given = override(graph, 'objects', 'subscription', reliability='reliable', durability='transient_local', depth=7)
    given |= override(graph, 'decision', 'publisher', durability='transient_local')
    # A file for all nodes may speak of what others have.
    given |= override(graph, 'scene_image', 'publisher', depth=3)
    learner = graph.start(LearnerNode, **graph.episode, **given)
    graph.ears.create_publisher(PointCloud2, 'objects', OFFERS['sensor data'])
    diagnostics.wait_for('/ears offers less')
    profiles = {one.topic_name.rsplit('/', 1)[-1]: one.qos_profile for one in learner.subscriptions}
    assert (profiles['objects'], profiles['objects'].depth) == (
        QoSProfile(depth=7, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        7,
    )
    assert [one.depth for one in (qos.LATCHED, profiles['turn'])] == [1, 1]
    decisions = [one.qos_profile for one in learner.publishers if one.topic_name.endswith('/decision')]
    assert decisions == [QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)]
    assert learner.get_parameter(f'qos_overrides./{graph.namespace}/objects.subscription.depth').value == 7


@pytest.mark.parametrize(
    ('topic', 'end', 'policies', 'reason'),
    [
        ('objcts', 'subscription', {'depth': 3}, "no topic '/.*/objcts'; known: .*/objects, "),
        ('objects', 'subscriber', {'depth': 3}, 'unknown parameter .*; expected .*publisher|subscription'),
        ('objects', 'subscription', {'deadline': 3}, 'unknown parameter .*; expected .*history|reliability'),
        ('objects', 'subscription', {'reliability': 'maybe'}, "must be one of reliable, .*, not 'maybe'"),
        ('objects', 'subscription', {'durability': True}, 'must be one of transient_local, .*, not True'),
        ('objects', 'subscription', {'depth': 0}, r'must be an integer in \[1, 100000\], not 0'),
        ('objects', 'subscription', {'depth': 1.5}, 'must be an integer in .*, not 1.5'),
        ('query', 'publisher', {'depth': True}, 'must be an integer in .*, not True'),
        ('query', 'publisher', {'depth': 2**40}, 'must be an integer in .*, not 1099511627776'),
    ],
)
def test_unusable_quality_of_service_is_refused(
    graph: Any, topic: str, end: str, policies: dict[str, Any], reason: str
) -> None:
    """A misspelt override is neither ignored in silence nor an error of the middleware's that names nothing."""
    with pytest.raises(InputError, match=reason) as caught:
        graph.start(PerceptionNode, **graph.world, **override(graph, topic, end, **policies))
    assert '\n' not in str(caught.value)
