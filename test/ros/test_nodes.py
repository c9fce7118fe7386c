"""The three nodes together."""

from __future__ import annotations

import dataclasses
import threading
from collections import Counter
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import Header, String
from visualization_msgs.msg import Marker, MarkerArray

from al_questioner.domain import DECISION_FEATURES, Action, Query, QueryKind, random_stream
from al_questioner.messages.clouds import decision_of_cloud, scene_of_cloud
from al_questioner.messages.documents import query_members, write
from al_questioner.questioning import STRATEGIES, Episode
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings, load_task
from al_questioner.simulation.kitchen.table_image import draw_scene
from shared.offline import offline_queries

TASK = 'prepare_lunch'
SYMBOLS = ('main_dish', 'snack', 'fruit', 'beverage')
DEADLINE = 60.0


@pytest.mark.parametrize('strategy', [name for name in STRATEGIES if name != 'human'])
def test_graph_asks_what_an_offline_run_asks(graph: Any, strategy: str) -> None:
    """A result that is found offline holds for the robot."""
    state = graph.play(strategy=strategy, budget=8.0, turns=14)
    assert state['queries'] == offline_queries(strategy, 8.0, 14)
    assert state['spent'] <= 8.0


def test_the_teacher_shows_what_is_known_if_told_to(graph: Any) -> None:
    """Otherwise a parameter would do nothing, or be the only way."""
    states = graph.listen('learner_state')
    graph.start_robot(strategy='rarest_demo', budget=40.0, turns=14)
    graph.start(TeacherNode, **graph.world, repeat_shown=True)
    asked = graph.wait_for_end(states)['queries']
    assert asked == offline_queries('rarest_demo', 40.0, 14, teacher={'repeat_shown': True})
    assert asked != offline_queries('rarest_demo', 40.0, 14)


def test_labels_follow_things_if_told_to(graph: Any) -> None:
    """The parameter does not reach the learner, or bags do not tell of it."""
    states, episodes = graph.listen('learner_state'), graph.listen('episode')
    wanted = {'strategy': 'farthest_fsq', 'budget': 30.0, 'turns': 14}
    graph.start_robot(**wanted, carry_labels=True)
    graph.start(TeacherNode, **graph.world)
    asked = graph.wait_for_end(states)['queries']
    assert asked == offline_queries(*wanted.values(), carry_labels=True)
    assert asked != offline_queries(*wanted.values())
    graph.wait_for(lambda: episodes, 'what the episode is about')
    assert episodes[-1]['carry_labels'] is True


def test_a_learner_with_another_kernel_asks_what_an_offline_run_asks_and_tells_it(graph: Any) -> None:
    """Otherwise the parameter would not reach the models, or nobody could see with which kernel it learns."""
    states, episodes = graph.listen('learner_state'), graph.listen('episode')
    kernel = {'amplitude': 4.0, 'kernel_shape': 'rbf'}
    graph.start_robot(strategy='u_sampling', budget=8.0, turns=12, **kernel)
    graph.start(TeacherNode, **graph.world)
    asked = graph.wait_for_end(states)['queries']
    assert asked == offline_queries('u_sampling', 8.0, 12, **kernel)
    assert asked != offline_queries('u_sampling', 8.0, 12)
    graph.wait_for(lambda: episodes, 'what the episode is about')
    assert {name: episodes[-1][name] for name in kernel} == kernel
    assert states[-1]['kernel']['amplitude'] == 4.0


def test_every_topic_tells_the_same_story(graph: Any) -> None:
    """Otherwise a page, a bag or RViz would show something else than the learner does."""
    heard = {kind: graph.listen(kind) for kind in ('episode', 'turn', 'query', 'learner_state')}
    acks = graph.listen('answer_ack', profile=qos.EVENTS)
    clouds = graph.listen('objects', PointCloud2)
    pictures = graph.listen('scene_image', Image)
    arrays = graph.listen('scene_markers', MarkerArray)
    decisions = graph.listen('decision', PointCloud2, qos.EVENTS)
    graph.start_robot(strategy='dt_task', turns=4)
    query = graph.wait_for(lambda: heard['query'] and heard['query'][-1], 'a query')

    def all_tell_of_its_turn() -> bool:
        turns = [turn['stamp'] for turn in heard['turn'] if turn['turn'] == query['turn']]
        newest = [messages[-1].header.stamp for messages in (clouds, decisions) if messages]
        newest += [marker.header.stamp for array in arrays[-1:] for marker in array.markers[-1:]]
        stamps = [{'sec': stamp.sec, 'nanosec': stamp.nanosec} for stamp in newest]
        # A turn that is not served soon is said again.
        return bool(turns) and stamps == 3 * turns[:1] and bool(pictures and heard['episode'])

    # Messages of different topics arrive in any order.
    graph.wait_for(all_tell_of_its_turn, 'all topics of the turn of the query')
    scene = scene_of_cloud(clouds[-1])
    decision = decision_of_cloud(decisions[-1], SYMBOLS, query['turn'])
    chosen = decision.candidates[decision.chosen]
    assert heard['episode'][-1]['feature_names'] == list(scene.feature_names)
    assert len(decision.candidates) == len(SYMBOLS) + len(scene) + 2
    assert decision.utilities[decision.chosen] == max(decision.utilities)
    weights = heard['episode'][-1]['weights']
    vector = [weights.get(name, 0.0) for name in DECISION_FEATURES]
    np.testing.assert_allclose(decision.features @ vector, decision.utilities, atol=1e-12)
    assert (chosen.kind.value, chosen.object_id, chosen.symbol) == (query['kind'], query['object_id'], query['symbol'])
    assert pictures[-1].encoding == 'rgb8'
    assert len(pictures[-1].data) == pictures[-1].height * pictures[-1].step
    named = Counter(marker.ns for marker in arrays[-1].markers)
    assert named['objects'] == named['beliefs'] == len(scene)
    assert [marker.text for marker in arrays[-1].markers if marker.ns == 'question'] == [query['text']]
    assert not acks


def test_the_turn_does_not_wait_for_the_picture(graph: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise each new scene would hold the learner up, and pictures of scenes long gone would pile up."""
    may_draw = threading.Semaphore(0)
    drawn: list[Any] = []

    def draw_slowly(observations: Any) -> Any:
        drawn.append([observation.object_id for observation in observations])
        may_draw.acquire(timeout=DEADLINE)
        return draw_scene(observations)

    monkeypatch.setattr('al_questioner.ros.nodes.perception.draw_scene', draw_slowly)
    clouds = graph.listen('objects', PointCloud2)
    pictures = graph.listen('scene_image', Image)
    perception = graph.start(PerceptionNode, **graph.world)
    mouth = graph.ears.create_publisher(String, 'turn', qos.LATCHED)
    world = PerceivedWorld(WorldSpec(load_task(TASK), 4, 4).open())
    turns = world.change_turns(1000)[:3]
    for seen, turn in enumerate(turns, start=1):
        stamp = {'sec': turn, 'nanosec': 0}
        mouth.publish(String(data=write('turn', 'e', {'turn': turn, 'stamp': stamp, 'world': None})))
        graph.wait_for(lambda seen=seen: len(clouds) == seen, f'the objects of turn {turn}')
        graph.wait_for(lambda: drawn, 'the first picture')
    assert not pictures
    looked = threading.Event()
    perception.submit(looked.set)
    graph.wait_for(looked.is_set, 'the order for the last picture')
    for count in (1, 2):
        # One by one, as a latched topic holds no more than its last message for a listener that is behind.
        may_draw.release()
        graph.wait_for(lambda count=count: len(pictures) == count, f'picture {count}')
    assert [picture.header.stamp.sec for picture in pictures] == [turns[0], turns[2]]
    assert drawn == [[observation.object_id for observation in world.observations(turn)] for turn in turns[::2]]


def test_last_markers_show_what_was_believed_in_the_end(graph: Any) -> None:
    """Otherwise people would see a question that nobody asks any more, or beliefs from before the last answer."""
    arrays = graph.listen('scene_markers', MarkerArray)
    beliefs = graph.play()['beliefs']
    expected = {f'{i}: {max(q, key=q.get)} {max(q.values()):.0%}' for i, q in beliefs.items()}

    def shown() -> set[str]:
        return {marker.text for marker in arrays[-1].markers if marker.text}

    graph.wait_for(lambda: arrays and shown() == expected, f'markers that say {expected}')
    drawn = [(marker.ns, marker.id) for marker in arrays[-1].markers[1:]]
    assert sorted(drawn) == [(ns, row) for ns in ('beliefs', 'objects') for row in range(len(beliefs))]
    assert arrays[-1].markers[0].action == Marker.DELETEALL
    assert len({(m.pose.position.x, m.pose.position.y) for m in arrays[-1].markers[1:]}) == len(beliefs)


def test_late_nodes_catch_up(graph: Any) -> None:
    """Otherwise the order in which nodes are started would matter."""
    states, queries, turns = map(graph.listen, ('learner_state', 'query', 'turn'))
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: turns, 'the first turn')
    graph.start(PerceptionNode, **graph.world)
    graph.wait_for(lambda: queries, 'the first query')
    graph.start(TeacherNode, **graph.world)
    graph.wait_for_end(states)


def test_nodes_of_another_world_do_not_answer(graph: Any, diagnostics: Any) -> None:
    """Otherwise one who looks at another table would teach wrong labels, or show what the teacher does not know."""
    answers, clouds = graph.listen('answer', profile=qos.EVENTS), graph.listen('objects', PointCloud2)
    reason = 'the learner has seed 4, this node 5'
    graph.start(PerceptionNode, task=TASK, seed=5)
    graph.start(LearnerNode, **graph.episode)
    diagnostics.wait_for(reason)
    assert not clouds
    graph.stop(graph.nodes[0])
    graph.start(PerceptionNode, **graph.world)
    teacher = graph.start(TeacherNode, task=TASK, seed=5)
    name = teacher.get_fully_qualified_name().lstrip('/')
    graph.wait_for(lambda: any(reason in s.message and s.name == name for s in diagnostics.statuses), reason)
    assert not answers


def test_a_second_learner_takes_no_scene_of_the_first(graph: Any) -> None:
    """Otherwise the latched scene of the last episode's last turn would be taken for the first of the next."""
    states = graph.listen('learner_state')
    episode = {**graph.episode, 'strategy': 'farthest_fsq', 'turns': 12}

    def is_over_for(learner: LearnerNode) -> bool:
        return states and states[-1]['done'] and states[-1]['episode_id'] == learner.machine.episode_id

    graph.start(PerceptionNode, **graph.world)
    graph.start(TeacherNode, **graph.world)
    ends = []
    for _ in range(2):
        learner = graph.start(LearnerNode, **episode)
        graph.wait_for(lambda learner=learner: is_over_for(learner), 'the end of the episode')
        ends.append({key: states[-1][key] for key in ('queries', 'beliefs', 'model_version')})
        graph.stop(learner)
    assert ends[0] == ends[1]


@pytest.mark.parametrize('is_over', [False, True])
def test_another_learner_on_the_same_topics_is_noticed(
    graph: Any, diagnostics: Any, monkeypatch: pytest.MonkeyPatch, is_over: bool
) -> None:
    """Otherwise nobody would know why two robots mistake each other, or why a teacher says that all is over."""
    ended = []
    monkeypatch.setattr(graph.context, 'try_shutdown', lambda: ended.append(True))
    states, queries = graph.listen('learner_state'), graph.listen('query')
    concern = 'another learner publishes turn'
    graph.start_robot(turns=1, budget=0.0 if is_over else 6.0)
    machine = graph.nodes[-1].machine
    machine._options = dataclasses.replace(machine._options, yields=True)
    if is_over:
        graph.wait_for(lambda: states and states[-1]['done'], 'the end of the first episode')
    else:
        graph.wait_for(lambda: queries, 'a question of the first learner')
    assert not ended
    assert not diagnostics.tell(concern)
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: ended if is_over else diagnostics.tell(concern), 'that the first learner notices')
    assert bool(ended) == is_over


def test_turns_are_paced(graph: Any) -> None:
    """Otherwise `turn_period` would be ignored, and a person could not follow."""
    turns = graph.listen('turn')
    states = graph.listen('learner_state')
    graph.start_robot(budget=0.0, turns=4, turn_period=0.2)
    graph.wait_for_end(states)
    graph.wait_for(lambda: turns and turns[-1]['turn'] == 4, 'the last turn')
    stamps = {turn['turn']: turn['stamp']['sec'] + turn['stamp']['nanosec'] / 1e9 for turn in turns}
    assert stamps[4] - stamps[min(stamps)] >= 0.2 * (4 - min(stamps)) - 0.01


def test_an_acknowledged_answer_is_not_repeated(graph: Any) -> None:
    """Otherwise every answer would be said for ever, and each time refused."""
    acks = graph.listen('answer_ack', profile=qos.EVENTS)
    graph.play(turns=6)
    graph.wait_for(lambda: graph.nodes[-1].unacknowledged is None, 'the last acknowledgement')
    assert all(ack['accepted'] for ack in acks)


def test_largest_object_id_passes_through(graph: Any) -> None:
    """Otherwise an id that a tracker gives, and PointCloud2 can hold, would stall the learner."""
    decisions = graph.listen('decision', PointCloud2, qos.EVENTS)
    clouds = graph.listen('objects', PointCloud2)
    arrays = graph.listen('scene_markers', MarkerArray)
    perception = graph.start(PerceptionNode, **graph.world)
    learner = graph.start(LearnerNode, **graph.episode)
    cloud = graph.wait_for(lambda: clouds and clouds[-1], 'a scene')
    graph.wait_for(lambda: decisions, 'a decision')
    graph.stop(perception)
    graph.stop(learner)
    data = bytearray(cloud.data)
    data[12:16] = np.uint32(2**32 - 2).tobytes()
    cloud.data = bytes(data)
    cloud.header.frame_id = 'camera'
    cloud.header.stamp.sec += 3600
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    eyes.publish(cloud)
    graph.start(LearnerNode, **graph.episode)

    def is_shown() -> bool:
        return bool(arrays) and {marker.header.frame_id for marker in arrays[-1].markers} == {'camera'}

    # Of the first learner there may still be something under way.
    graph.wait_for(lambda: decisions[-1].header.frame_id == 'camera' and is_shown(), 'a decision about it, and markers')
    decision = decision_of_cloud(decisions[-1], SYMBOLS, 1)
    assert 2**32 - 2 in {action.object_id for action in decision.candidates}


def test_scenes_older_than_the_turn_are_reported(graph: Any, diagnostics: Any) -> None:
    """Otherwise a camera whose clock is behind would be ignored in silence."""
    turns = graph.listen('turn')
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: turns and eyes.get_subscription_count(), 'a learner that looks')

    def reported(stamp: Time, reason: str) -> bool:
        eyes.publish(PointCloud2(header=Header(stamp=stamp)))
        return diagnostics.tell(reason)

    graph.wait_for(lambda: reported(Time(sec=1), 'is the clock of their sender behind?'), 'a warning')
    graph.wait_for(lambda: reported(Time(), 'the stamp of the cloud is 0'), 'a warning that it has no stamp')


def test_two_robots_in_two_namespaces_do_not_hear_each_other(graph: Any) -> None:
    """Otherwise the answers to one robot would teach the other."""
    robots = {'left': (TASK, 4), 'right': ('pack_lunchbox', 5)}
    kinds = ('episode', 'turn', 'query', 'learner_state', 'answer', 'answer_ack')
    heard: dict[str, dict[str, list[Any]]] = {robot: {} for robot in robots}
    nodes = []
    for robot, (task, seed) in robots.items():
        namespace = f'{graph.namespace}/{robot}'
        for kind in kinds:
            profile = qos.RECORDED_EVENTS if kind.startswith('answer') else qos.RECORDED_LATCHED
            heard[robot][kind] = graph.listen(f'{robot} {kind}', profile=profile, topic=f'/{namespace}/{kind}')
        world = {'task': task, 'seed': seed}
        for make, parameters in ((PerceptionNode, world), (TeacherNode, world), (LearnerNode, graph.episode | world)):
            nodes.append(graph.start(make, namespace=namespace, **parameters))
    for robot, (task, seed) in robots.items():
        state = graph.wait_for_end(heard[robot]['learner_state'])
        assert state['queries'] == offline_queries('random_fsq', 6.0, 8, task=task, seed=seed)
    for robot in robots:
        said = [document for kind in kinds for document in heard[robot][kind]]
        assert len({document['episode_id'] for document in said}) == 1
    # Whatever a node had heard of the other robot's world or episode, it would have refused.
    assert not any(node.counts() for node in nodes)


def test_erring_teacher_with_delay_ends_the_episode(graph: Any) -> None:
    """Otherwise a teacher who does not know, errs, or thinks for a while would stall the learner."""
    states = graph.listen('learner_state')
    graph.start_robot(strategy='rarest_demo')
    graph.start(TeacherNode, **graph.world, wrong_rate=0.3, unknown_rate=0.6, delay=0.02)
    assert 'unknown' in {query['outcome'] for query in graph.wait_for_end(states)['queries']}


def test_lost_answers_are_repeated(graph: Any) -> None:
    """Otherwise one lost message would stall the episode for ever."""
    answers = graph.listen('answer', profile=qos.EVENTS)
    mouth = graph.ears.create_publisher(String, 'query', qos.LATCHED)
    graph.start(TeacherNode, **graph.world)
    query = Query('q1', 1, Action(QueryKind.FEATURE_SUBSET), ('colour',), 2, 3, 4, 0, 'What?')
    mouth.publish(String(data=write('query', 'e', query_members(query))))
    graph.wait_for(lambda: len(answers) >= 3, 'the third time of the same answer')
    assert all(each == answers[0] for each in answers)


def test_scene_of_the_graph_is_the_scene_offline(graph: Any) -> None:
    """Otherwise features would lose bits on the way, and a later query would differ."""
    clouds = graph.listen('objects', PointCloud2)
    graph.start_robot()
    graph.wait_for(lambda: clouds, 'a scene')
    seen = scene_of_cloud(clouds[0])
    offline = PerceivedWorld(WorldSpec(load_task(TASK), 4, 4).open()).scene(1)
    assert seen.features.tobytes() == offline.features.tobytes()
    assert seen.object_ids == offline.object_ids
    episode = Episode(episode_settings(load_task(TASK), 'u_sampling'), random_stream(4, 'learner'))
    assert episode.ask(seen).query is not None


def test_nothing_is_amiss_in_an_episode_among_ourselves(graph: Any, diagnostics: Any) -> None:
    """Otherwise a warning that means nothing would teach people to overlook those that do."""
    graph.play(turns=12, turn_period=0.2)

    def names() -> set[str]:
        return {status.name.rsplit('/', 1)[-1] for status in diagnostics.statuses}

    graph.wait_for(lambda: names() == {'perception', 'learner', 'teacher'}, 'the diagnostics of all')
    assert [status.message for status in diagnostics.statuses if status.level != DiagnosticStatus.OK] == []


def test_a_node_that_waits_in_vain_names_the_topic_and_who_publishes_there(
    graph: Any, diagnostics: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise nobody would know what is missing, or under which name."""
    monkeypatch.setattr('al_questioner.ros.node.SECONDS_FOR_PUBLISHER', 0.0)
    monkeypatch.setattr('al_questioner.protocol.learner.SECONDS_FOR_OBJECTS', 0.0)

    def says(node: Node, end: str) -> bool:
        name = node.get_fully_qualified_name().lstrip('/')
        found = [status for status in diagnostics.statuses if status.name == name]
        return bool(found) and found[-1].level == DiagnosticStatus.WARN and found[-1].message.endswith(end)

    topic = f'/{graph.namespace}/'
    teacher = graph.start(TeacherNode, **graph.world)
    end = f'waiting for a query for too long: nobody publishes {topic}query'
    graph.wait_for(lambda: says(teacher, end), 'the warning of a teacher without a learner')
    learner = graph.start(LearnerNode, **graph.episode)
    end = f'turn 1: waiting for objects for too long: nobody publishes {topic}objects'
    graph.wait_for(lambda: says(learner, end), 'the warning of a learner without eyes')
    graph.wait_for(lambda: not says(teacher, 'query'), 'the end of the warning')
    graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    end = f'turn 1: waiting for objects for too long: {topic}objects is published by {topic}ears'
    graph.wait_for(lambda: says(learner, end), 'the name of who publishes nothing of use')
