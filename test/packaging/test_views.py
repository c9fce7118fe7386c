"""The RViz configuration and the Foxglove layout show topics that there are, with the types that they have."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest
import yaml
from rclpy.context import Context

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recogniser import RecogniserNode
from al_questioner.ros.settings import PERCEPTION_SETTINGS
from shared.checkout import ROOT

RVIZ = ROOT / 'config' / 'rviz' / 'al_questioner.rviz'
FOXGLOVE = ROOT / 'config' / 'foxglove' / 'al_questioner.json'
TEXT = 'std_msgs/msg/String'
SHOWN_BY_RVIZ = {
    'PointCloud2': 'sensor_msgs/msg/PointCloud2',
    'MarkerArray': 'visualization_msgs/msg/MarkerArray',
    'Pose': 'geometry_msgs/msg/PoseStamped',
    'Image': 'sensor_msgs/msg/Image',
}
SHOWN_IN_3D = set(SHOWN_BY_RVIZ.values()) - {'sensor_msgs/msg/Image'}


@pytest.fixture(scope='module')
def ends() -> Mapping[str, Mapping[str, str]]:
    """Types of the topics that our nodes publish, and of those that they hear, by the names in no namespace."""
    context = Context()
    context.init(domain_id=int(os.environ['ROS_DOMAIN_ID']))
    found: dict[str, dict[str, str]] = {'published': {}, 'heard': {}}
    try:
        for make in (LearnerNode, PerceptionNode, RecogniserNode):
            node = make(context=context)
            for name, list_of in (('published', node.publishers), ('heard', node.subscriptions)):
                found[name] |= {each.topic_name: type_name(each.msg_type) for each in list_of}
            node.destroy_node()
    finally:
        context.try_shutdown()
    return found


def type_name(message_type: type) -> str:
    return f'{message_type.__module__.split(".")[0]}/msg/{message_type.__name__}'


def displays() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = yaml.safe_load(RVIZ.read_text())['Visualization Manager']['Displays']
    return found


def panels() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = json.loads(FOXGLOVE.read_text())['configById']
    return found


def shown_by_foxglove() -> Iterator[tuple[str, Callable[[str], bool]]]:
    """Yield each topic that the layout shows, and whether its panel can show a type."""
    for name, panel in panels().items():
        kind = name.split('!')[0]
        if kind == '3D':
            yield from ((topic, SHOWN_IN_3D.__contains__) for topic in panel['topics'])
        elif kind == 'Image':
            yield panel['imageMode']['imageTopic'], SHOWN_BY_RVIZ['Image'].__eq__
        elif kind == 'RawMessages':
            topic, _, member = panel['topicPath'].partition('.')
            assert member == 'data'
            yield topic, TEXT.__eq__
        elif kind == 'DiagnosticSummary':
            yield panel['topicToRender'], 'diagnostic_msgs/msg/DiagnosticArray'.__eq__
        else:
            assert kind == 'Publish'


def test_rviz_shows_our_topics_as_what_they_are(ends: Mapping[str, Mapping[str, str]]) -> None:
    """A renamed topic leaves an empty window, and a display of another type an error."""
    shown = {each['Topic']['Value']: each['Class'] for each in displays() if 'Topic' in each}
    published = ends['published']
    assert {topic: f'rviz_default_plugins/{kind}' for topic, kind in ((t, _kind(published[t])) for t in shown)} == shown
    assert shown.keys() >= {'/scene_image', '/scene_markers', '/recognised_markers', '/recognised', '/target'}


def _kind(message_type: str) -> str:
    return next(kind for kind, shown in SHOWN_BY_RVIZ.items() if shown == message_type)


def test_rviz_asks_for_no_more_than_is_offered() -> None:
    """It shows nothing otherwise; what is latched is asked for, so that it may be started late."""
    for each in (display['Topic'] for display in displays() if 'Topic' in display):
        name = each['Value'].strip('/')
        is_event, is_sensed = name in ('target',), name in qos.SENSED
        durability = 'Volatile' if is_event or is_sensed else 'Transient Local'
        assert each['Durability Policy'] == durability, name
        assert each['Reliability Policy'] == ('Best Effort' if is_sensed else 'Reliable'), name


def test_both_look_at_the_frame_of_the_simulated_table() -> None:
    """They show nothing in another one without a transform."""
    frame = next(each.default for each in PERCEPTION_SETTINGS if each.name == 'frame_id')
    assert yaml.safe_load(RVIZ.read_text())['Visualization Manager']['Global Options']['Fixed Frame'] == frame
    assert panels()['3D!table']['followTf'] == frame


def test_foxglove_shows_our_topics_as_what_they_are(ends: Mapping[str, Mapping[str, str]]) -> None:
    shown = list(shown_by_foxglove())
    assert [topic for topic, can_show in shown if not can_show(ends['published'].get(topic, ''))] == []
    assert {topic for topic, _ in shown} >= {'/scene_image', '/scene_markers', '/recognised_markers', '/query'}


def test_foxglove_publishes_what_our_nodes_hear(ends: Mapping[str, Mapping[str, str]]) -> None:
    """Its buttons do nothing otherwise."""
    buttons = [panel for name, panel in panels().items() if name.startswith('Publish!')]
    assert {each['topicName'] for each in buttons} == {'/want', '/answer'}
    for each in buttons:
        assert each['datatype'] == ends['heard'][each['topicName']] == TEXT
        assert set(json.loads(each['value'])) == {'data'}


def test_every_panel_of_foxglove_has_its_place() -> None:
    """A panel that is in no place is not shown, and a place without one is empty."""

    def names(place: Any) -> list[str]:
        return [place] if isinstance(place, str) else [*names(place['first']), *names(place['second'])]

    assert sorted(names(json.loads(FOXGLOVE.read_text())['layout'])) == sorted(panels())
