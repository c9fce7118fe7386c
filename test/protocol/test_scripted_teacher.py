"""The machine of a teacher who answers from a script."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from al_questioner.domain import Action, Answer, Outcome, Query, QueryKind
from al_questioner.messages import documents
from al_questioner.protocol.scripted_teacher import ScriptedTeacherMachine
from shared.machine_driver import Driver

WORLD = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}


class Counting:
    """A teacher who says how many questions it was asked."""

    def __init__(self) -> None:
        self.asked = 0

    def answer(self, query: Query, truth: Mapping[int, str]) -> Answer:
        """Answer with what is true, and who heard how much before."""
        self.asked += 1
        assert query.action.object_id is not None
        content = truth[query.action.object_id]
        return Answer(query.query_id, f'{query.query_id}/{self.asked}', 'script', Outcome.ANSWERED, content)


class Steady:
    """A teacher whose answer to a question is always the same."""

    def answer(self, query: Query, _: Mapping[int, str]) -> Answer:
        """Say that it does not know."""
        return Answer(query.query_id, query.query_id, 'script', Outcome.UNKNOWN)


def driver_of(delay: float = 0.0) -> Driver:
    """A teacher who has begun."""
    driver = Driver(ScriptedTeacherMachine(Counting, lambda turn: {7: f'snack {turn}'}, WORLD, delay))
    driver.start()
    return driver


def ask(driver: Driver, number: int, episode_id: str = 'e', world: Any = None) -> None:
    """Ask what object 7 is."""
    query = Query(f'q{number}', number, Action(QueryKind.LABEL, 7), ('snack',), 1, 4, 5, 1, 'What is object 7?')
    driver.hear_document('query', episode_id, {**documents.query_members(query), 'world': world})


def acknowledge(driver: Driver, answer: dict[str, Any], reason: str = '') -> None:
    """Say whether an answer is taken; it is if there is no reason against it."""
    members = {'query_id': answer['query_id'], 'answer_id': answer['answer_id'], 'accepted': not reason}
    driver.hear_document('answer_ack', answer['episode_id'], {**members, 'reason': reason})


def test_the_truth_of_the_turn_is_told_until_it_is_heard() -> None:
    """Otherwise one lost message would stall the episode, or a label of another turn be learnt."""
    driver = driver_of()
    assert driver.status == 'waiting for a query'
    ask(driver, 1)
    driver.pass_until(2.5)
    answers = driver.published('answer')
    assert len(answers) == 3
    assert all(answer == answers[0] for answer in answers)
    assert (answers[0]['episode_id'], answers[0]['query_id'], answers[0]['content']) == ('e', 'q1', 'snack 1')
    assert driver.status == 'q1: What is object 7?'
    acknowledge(driver, answers[0])
    driver.pass_until(100.0)
    assert len(driver.published('answer')) == 3
    assert driver.status == 'waiting for a query'
    assert driver.machine.sender.unacknowledged is None


def test_who_thinks_for_a_while_is_not_delayed_by_the_question_said_again() -> None:
    """Otherwise a learner that repeats its question would never hear the answer."""
    driver = Driver(ScriptedTeacherMachine(Steady, lambda _: {}, WORLD, 3.0))
    for at in (0.0, 2.0):
        driver.pass_until(at)
        ask(driver, 1)
    driver.pass_until(3.5)
    assert len(driver.published('answer')) == 1


def test_another_episode_has_a_teacher_who_has_named_nothing() -> None:
    """Otherwise it would believe that the learner knows what another learner was told."""
    driver = driver_of()
    for number, episode_id in ((1, 'e'), (2, 'e'), (1, 'f')):
        ask(driver, number, episode_id)
    ids = [answer['answer_id'] for answer in driver.published('answer')]
    assert ids == ['q1/1', 'q2/2', 'q1/1']


def test_the_next_episode_is_answered_although_its_question_and_answer_are_those_of_the_last() -> None:
    """Otherwise the answer would be said for ever to a learner that has died, and the next one would wait for ever."""
    driver = Driver(ScriptedTeacherMachine(Steady, lambda _: {}, WORLD))
    for at, episode_id in ((0.0, 'e'), (0.5, 'f')):
        driver.pass_until(at)
        ask(driver, 1, episode_id)
    driver.pass_until(2.0)
    said = [(answer['episode_id'], answer['answer_id']) for answer in driver.published('answer')]
    assert said == [('e', 'q1'), ('f', 'q1'), ('f', 'q1')]


@pytest.mark.parametrize('name', ['task', 'seed', 'sample'])
def test_who_lives_in_another_world_does_not_answer(name: str) -> None:
    """Otherwise wrong labels would be taught."""
    driver = driver_of()
    ask(driver, 1, world={**WORLD, name: 'pack_lunchbox' if name == 'task' else 9})
    ((topic, reason),) = driver.refusals
    assert topic == 'query'
    assert f'the learner has {name}' in reason
    assert driver.published('answer') == []
    ask(driver, 1, world=WORLD)
    assert len(driver.published('answer')) == 1


def test_an_answer_that_is_not_taken_is_said_no_more_and_told() -> None:
    """Otherwise it would be refused for ever, or nobody would know that the learner and its teacher disagree."""
    driver = driver_of()
    ask(driver, 1)
    acknowledge(driver, driver.published('answer')[0], 'it has gone')
    driver.pass_until(10.0)
    assert len(driver.published('answer')) == 1
    assert driver.refusals == [('answer_ack', 'the learner did not accept the answer to q1: it has gone')]


def test_only_the_acknowledgement_of_this_answer_ends_it() -> None:
    """Otherwise what a learner says to another teacher, or said in another episode, would lose an answer."""
    driver = driver_of()
    ask(driver, 1)
    (answer,) = driver.published('answer')
    acknowledge(driver, {**answer, 'answer_id': 'q1/another'})
    acknowledge(driver, {**answer, 'episode_id': 'another'})
    driver.pass_until(1.5)
    assert len(driver.published('answer')) == 2
