"""A flood of garbage on the topics: nothing crashes, nothing is believed, and the machine goes on."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from al_questioner.domain import (
    DEFAULT_CLASSIFIERS,
    THRESHOLD,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    SeenView,
    ViewLabel,
)
from al_questioner.messages.concepts_file import concepts_of_text
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.messages.documents import query_of
from al_questioner.protocol.effects import Refuse
from al_questioner.protocol.perception import PerceptionMachine
from al_questioner.protocol.recogniser import RecogniserMachine
from al_questioner.questioning import read_plain_answer
from al_questioner.simulation import PerceivedWorld
from shared.durable_sessions import WORLD
from shared.learner_robot import Robot
from shared.machine_driver import Driver

MESSAGES = 50_000
JUNK = (None, True, -1, 2**70, 1e308, '', 'x' * 5000, [], {}, [[]], {'a': {}}, '\x00\x1b[2J', 'snack')


def refusals_of(driver: Driver, topic: str) -> int:
    """Number of the refusals on a topic among what was done last; what was done is forgotten."""
    count = sum(isinstance(effect, Refuse) and effect.topic == topic for _, effect in driver.done)
    driver.done.clear()
    return count


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
def test_a_flood_of_garbage_answers_is_refused(make: Callable[..., Robot]) -> None:
    """Otherwise a broken page, or a mischievous child, would end the robot's day or teach it nonsense."""
    robot = make()
    robot.sees()
    (asked,) = robot.said('query')
    query, rng = query_of(asked), np.random.default_rng(0)
    answer = {
        'schema': 'al_questioner/answer/1', 'episode_id': asked['episode_id'], 'query_id': query.query_id,
        'answer_id': 'a1', 'teacher_id': 't', 'outcome': 'answered', 'content': ['colour', 'size'],
    }  # fmt: skip
    sent = refused = 0
    for text in texts(answer, rng, MESSAGES):
        if not means_something(text, query, answer):
            robot.driver.hear('answer', text)
            sent += 1
            assert robot.said('learner_state') == []
            refused += refusals_of(robot.driver, 'answer')
    assert refused == sent > 0.8 * MESSAGES
    robot.driver.hear('answer', json.dumps(answer))
    assert [ack['answer_id'] for ack in robot.said('answer_ack')] == ['a1']
    (record,) = robot.said('learner_state')[-1]['queries']
    assert (record['turn'], record['groups']) == (1, ['colour', 'size'])


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
def test_a_flood_of_garbage_turns_is_refused(world: PerceivedWorld) -> None:
    """Otherwise perception would show another turn, or nothing any more."""
    driver = Driver(PerceptionMachine(world, WORLD, 'table', lambda _: np.zeros((1, 1, 3), np.uint8)))
    driver.start()
    driver.done.clear()
    turn = {
        'schema': 'al_questioner/turn/1', 'episode_id': 'e', 'turn': 1, 'stamp': {'sec': 1, 'nanosec': 0},
        'world': WORLD,
    }  # fmt: skip
    rng, sent, refused = np.random.default_rng(2), 0, 0
    for text in texts(turn, rng, MESSAGES // 2):
        document = parsed(text)
        decisive = ('schema', 'turn', 'stamp')
        sensible = isinstance(document, dict) and all(document.get(name) == turn[name] for name in decisive)
        # A learner that knows of no simulated world says null.
        if sensible and document.get('world', 'missing') in (WORLD, None):
            continue
        driver.hear('turn', text)
        sent += 1
        assert len(driver.done) == 1
        refused += refusals_of(driver, 'turn')
    assert refused == sent
    driver.hear('turn', json.dumps(turn))
    assert len(driver.published('objects')) == 1


def test_a_recogniser_survives_garbage_and_goes_on() -> None:
    """Otherwise anybody on the network could take from the robot what it knows."""
    rng = np.random.default_rng(3)
    views = tuple(SeenView(n, n, tuple(rng.normal(size=2).astype(np.float32).tolist())) for n in range(1, 5))
    labels = tuple(ViewLabel(n, ('snack', 'fruit', 'none')[n % 3]) for n in range(1, 5))
    origins = (Origin('day', ('snack', 'fruit')),)
    lessons = (Lesson('day', 1, seen=views, labels=labels),)
    names = ('size_height', 'weight_kg')
    good = concepts_text(Knowledge(('snack', 'fruit'), names, DEFAULT_CLASSIFIERS, lessons=lessons, origins=origins))
    driver = Driver(RecogniserMachine(THRESHOLD.default))
    driver.start()
    unusable = refused = 0
    for text in texts(json.loads(good), rng, 300):
        try:
            concepts_of_text(text)
        except InputError:
            unusable += 1
        driver.hear('concepts', text)
        refused += refusals_of(driver, 'concepts')
        driver.hear('want', text)
    assert refused == unusable > 100
    driver.hear('concepts', good)
    assert driver.machine.recogniser.find('snack').symbol == 'snack'
