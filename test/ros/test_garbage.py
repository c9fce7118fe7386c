"""A flood of garbage on the topics: nothing crashes, nothing is believed, and the node goes on."""

from __future__ import annotations

import contextlib
import itertools
import json
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import String

from al_questioner.domain import DEFAULT_CLASSIFIERS, InputError, Knowledge, Lesson, Origin, SeenView, ViewLabel
from al_questioner.messages.concepts_file import concepts_of_text
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.messages.documents import query_of
from al_questioner.questioning import read_plain_answer
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recogniser import RecogniserNode

MESSAGES = 50_000
JUNK = (None, True, -1, 2**70, 1e308, '', 'x' * 5000, [], {}, [[]], {'a': {}}, '\x00\x1b[2J', 'snack')


def callback_of(node: Any, topic: str) -> Callable[[Any], None]:
    """Return the function that the middleware calls for a message."""
    (found,) = [each for each in node.subscriptions if each.topic_name == node.resolve_topic_name(topic)]
    number = itertools.count(1)
    return lambda message: found.callback(message, {'source_timestamp': next(number), 'publication_sequence_number': 1})


def drained(node: Any) -> None:
    """Wait until the node has dealt with all that it was given."""
    done = threading.Event()
    node.submit(done.set)
    assert done.wait(250)


@contextlib.contextmanager
def in_this_thread(node: Any) -> Iterator[None]:
    """Has the node deal with each message at once: of those that wait for it only the newest would be looked at."""
    submit, node._worker.submit = node._worker.submit, lambda job: job()
    try:
        yield
    finally:
        node._worker.submit = submit


def mutated(document: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """A document with some members replaced, left out, or added."""
    found = dict(document)
    for _ in range(int(rng.integers(1, 4))):
        name = str(rng.choice(list(found) or ['x']))
        draw = rng.random()
        if draw < 0.6:
            found[name] = JUNK[int(rng.integers(len(JUNK)))]
        elif draw < 0.8:
            found.pop(name, None)
        else:
            found[f'{name}_'] = JUNK[int(rng.integers(len(JUNK)))]
    return found


def texts(document: dict[str, Any], rng: np.random.Generator, n: int) -> Iterator[str]:
    """Broken documents, cut ones, and texts of any characters."""
    for _ in range(n):
        draw = rng.random()
        text = json.dumps(mutated(document, rng))
        if draw < 0.5:
            yield text
        elif draw < 0.7:
            yield text[: int(rng.integers(len(text)))]
        elif draw < 0.8:
            yield text.replace(':', ':NaN', 1)
        else:
            yield bytes(rng.integers(0, 256, size=int(rng.integers(0, 60)), dtype=np.uint8)).decode('latin-1')


@pytest.mark.slow
def test_a_flood_of_garbage_answers_is_refused(graph: Any) -> None:
    """Otherwise a broken page, or a mischievous child, would end the robot's day or teach it nonsense."""
    queries, acks = graph.listen('query'), graph.listen('answer_ack', profile=qos.EVENTS)
    states = graph.listen('learner_state')
    graph.start(PerceptionNode, **graph.world)
    learner = graph.start(LearnerNode, **{**graph.episode, 'strategy': 'farthest_fsq', 'answer_timeout': 0.0})
    graph.wait_for(lambda: queries, 'a question')
    query, rng = query_of(queries[0]), np.random.default_rng(0)
    answer = {
        'schema': 'al_questioner/answer/1', 'episode_id': queries[0]['episode_id'], 'query_id': query.query_id,
        'answer_id': 'a1', 'teacher_id': 't', 'outcome': 'answered', 'content': ['colour', 'size'],
    }  # fmt: skip
    hear, sent = callback_of(learner, 'answer'), 0
    for text in texts(answer, rng, MESSAGES):
        if not means_something(text, query, answer):
            hear(String(data=text))
            sent += 1
        if sent % 500 == 0:
            drained(learner)
    drained(learner)
    assert sent > 0.8 * MESSAGES
    assert learner.counts()['refused on answer'] == sent
    assert not states
    hear(String(data=json.dumps(answer)))
    graph.wait_for(lambda: states, 'the end of the turn')
    assert {ack['answer_id'] for ack in acks if ack['accepted']} <= {'a1'}
    assert [(record['turn'], record['groups']) for record in states[0]['queries']] == [(1, ['colour', 'size'])]


def parsed(text: str) -> Any:
    with contextlib.suppress(ValueError, RecursionError):
        return json.loads(text)
    return None


def means_something(text: str, query: Any, answer: dict[str, Any]) -> bool:
    """Return whether chance has made an answer that must be taken."""
    document = parsed(text)
    if text.lstrip().startswith('{'):
        if not isinstance(document, dict):
            return False
        decisive = ('schema', 'episode_id', 'query_id')
        content = document.get('content')
        return (
            all(document.get(name) == answer[name] for name in decisive)
            and isinstance(document.get('answer_id'), str)
            and isinstance(document.get('teacher_id'), str)
            and (document.get('outcome') != 'answered' or content == answer['content'])
        )
    try:
        read_plain_answer(text, query)
    except InputError:
        return False
    return True


@pytest.mark.slow
def test_a_flood_of_garbage_clouds_is_refused(graph: Any) -> None:
    """Otherwise a driver with another layout would end the episode, or have it learn from noise."""
    seen = graph.listen('objects', PointCloud2)
    graph.start_robot()
    graph.wait_for(lambda: seen, 'a scene')
    namespace = f'{graph.namespace}_other'
    queries = graph.listen('other queries', topic=f'/{namespace}/query')
    learner = graph.start(LearnerNode, namespace=namespace, **graph.episode)
    drained(learner)
    look, rng, good, sent = callback_of(learner, 'objects'), np.random.default_rng(1), seen[0], MESSAGES // 2
    good.header.stamp.sec = 2**31 - 1
    with in_this_thread(learner):
        for _ in range(sent):
            look(damaged(good, rng))
    assert learner.counts()['refused on objects'] == sent
    assert not queries
    look(good)
    graph.wait_for(lambda: queries, 'the question about the one scene that makes sense')


def damaged(good: PointCloud2, rng: np.random.Generator) -> PointCloud2:
    """A cloud that cannot be a scene: of another size, step or layout, cut off, or with a position that is NaN."""
    cloud = PointCloud2(
        header=good.header, height=good.height, width=good.width, fields=good.fields,
        is_bigendian=good.is_bigendian, point_step=good.point_step, row_step=good.row_step, data=good.data,
    )  # fmt: skip
    damage = rng.integers(6)
    if damage == 0:
        cloud.width = int(rng.integers(good.width + 1, 2**32))
    elif damage == 1:
        cloud.point_step = int(rng.integers(0, good.point_step))
    elif damage == 2:
        missing = str(rng.choice(['x', 'y', 'z', 'object_id']))
        cloud.fields = [field for field in good.fields if field.name != missing]
    elif damage == 3:
        cloud.data = good.data[: int(rng.integers(len(good.data)))]
    elif damage == 4:
        last = good.fields[-1]
        far = PointField(name=last.name, offset=2**31 - 1, datatype=last.datatype, count=last.count)
        cloud.fields = [*good.fields[:-1], far]
    else:
        cloud.data = np.float32(np.nan).tobytes() + bytes(good.data)[4:]
    return cloud


@pytest.mark.slow
def test_a_flood_of_garbage_turns_is_refused(graph: Any) -> None:
    """Otherwise perception would show another turn, or nothing any more."""
    perception = graph.start(PerceptionNode, **graph.world)
    seen = graph.listen('objects', PointCloud2)
    world = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}
    turn = {
        'schema': 'al_questioner/turn/1', 'episode_id': 'e', 'turn': 1, 'stamp': {'sec': 1, 'nanosec': 0},
        'world': world,
    }  # fmt: skip
    begin, rng, sent = callback_of(perception, 'turn'), np.random.default_rng(2), 0
    for text in texts(turn, rng, MESSAGES // 2):
        document = parsed(text)
        decisive = ('schema', 'turn', 'stamp')
        sensible = isinstance(document, dict) and all(document.get(name) == turn[name] for name in decisive)
        # A learner that knows of no simulated world says null.
        if sensible and document.get('world', 'missing') in (world, None):
            continue
        with in_this_thread(perception):
            begin(String(data=text))
        sent += 1
    assert perception.counts()['refused on turn'] == sent
    assert not seen
    begin(String(data=json.dumps(turn)))
    graph.wait_for(lambda: seen, 'the scene of the one turn that makes sense')


def test_a_recogniser_survives_garbage_and_goes_on(graph: Any) -> None:
    """Otherwise anybody on the network could take from the robot what it knows."""
    rng = np.random.default_rng(3)
    views = tuple(SeenView(n, n, tuple(rng.normal(size=2).astype(np.float32).tolist())) for n in range(1, 5))
    labels = tuple(ViewLabel(n, ('snack', 'fruit', 'none')[n % 3]) for n in range(1, 5))
    origins = (Origin('day', ('snack', 'fruit')),)
    lessons = (Lesson('day', 1, seen=views, labels=labels),)
    names = ('size_height', 'weight_kg')
    good = concepts_text(Knowledge(('snack', 'fruit'), names, DEFAULT_CLASSIFIERS, lessons=lessons, origins=origins))
    recogniser = graph.start(RecogniserNode)
    hear, want = callback_of(recogniser, 'concepts'), callback_of(recogniser, 'want')
    refused = 0
    with in_this_thread(recogniser):
        for text in texts(json.loads(good), rng, 300):
            try:
                concepts_of_text(text)
            except InputError:
                refused += 1
            hear(String(data=text))
            want(String(data=text))
        assert recogniser.counts()['refused on concepts'] == refused > 100
        hear(String(data=good))
    assert recogniser.machine.recogniser.find('snack').symbol == 'snack'
    assert recogniser._failure == ''
