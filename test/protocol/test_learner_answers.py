"""Usable and unusable answers of a person to a learner, and corrections of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest

from al_questioner.event_log.events import AnswerAccepted, InputRejected, LateAnswerKept
from al_questioner.protocol.effects import Effect, Publish, WriteFile
from al_questioner.simulation import episode_settings
from shared.durable_sessions import WITH_RELEVANCE, ask_what_matters, events
from shared.learner_robot import Robot, answer_text
from shared.lunches import TASK

PLAIN = {'label': 'snack', 'demonstration': 'none', 'feature_subset': 'colour,size'}
LABELS = episode_settings(TASK, 'u_sampling', 6.0, 5)
"""Settings of an episode in which every question is about a thing."""


def told(folder: Path, kind: type) -> list[object]:
    """The events of a kind in a session."""
    return [event for event in events(folder) if isinstance(event, kind)]


def test_plain_words_teach(make: Callable[..., Robot]) -> None:
    """Otherwise a person with nothing but `ros2 topic pub` could not answer."""
    robot = make(settings=episode_settings(TASK, 'random_fsq', 5.0, 4))
    while not robot.durable.episode.done:
        robot.sees()
        if robot.durable.episode.awaits_answer:
            assert robot.says(PLAIN[robot.said('query')[-1]['kind']])['accepted']
    asked = robot.said('learner_state')[-1]['queries']
    assert {query['kind'] for query in asked} == {'feature_subset', 'label'}
    assert [query['outcome'] for query in asked] == ['answered'] * len(asked)


def test_unusable_answers_are_refused_and_the_question_stays(make: Callable[..., Robot]) -> None:
    """Otherwise nonsense would be learnt, or the question lost."""
    robot = make(settings=LABELS)
    robot.sees()
    (query,) = robot.said('query')
    refused = {
        'pudding': 'does not answer',
        '': 'does not answer',
        '{"schema"': 'not valid JSON',
        answer_text(query, 'pudding'): 'unknown label',
        answer_text(query, 3): 'a label is one of',
        answer_text(query, None): 'a label is one of',
        answer_text(query, 'snack', query_id='q9'): "'q9'",
        answer_text(query, 'snack', episode_id='another'): 'episode another',
        answer_text(query, 'snack', outcome='unknown'): 'no content',
        answer_text(query, 'snack', schema='al_questioner/answer/7'): 'schema',
    }
    for text, reason in refused.items():
        ack = robot.says(text)
        assert not ack['accepted'], text
        assert reason in ack['reason']
    assert robot.said('learner_state') == []
    assert robot.answers(query, 'snack')['accepted']
    assert robot.answers(query, 'snack')['reason'] == 'already taken'
    assert not robot.answers(query, 'fruit')['accepted']
    state = robot.said('learner_state')[-1]
    assert len(state['queries']) == 1
    assert (state['labels']['snack'], state['labels']['fruit']) == (1, 0)
    assert len(robot.driver.refusals) == len(refused) + 1


def test_demonstration_of_an_object_that_has_gone_is_refused(make: Callable[..., Robot]) -> None:
    """Otherwise a label would be attached to features that nobody named."""
    robot = make(settings=episode_settings(TASK, 'rarest_demo', 6.0, 4))
    robot.sees()
    while (query := robot.said('query')[-1])['kind'] != 'demonstration':
        assert robot.says(PLAIN[query['kind']])['accepted']
        robot.sees()
    ack = robot.answers(query, 9999)
    assert not ack['accepted']
    assert 'object 9999 is not in the scene' in ack['reason']
    assert robot.answers(query, int(query['choices'][0]))['accepted']


def test_a_person_says_which_things_matter(make: Callable[..., Robot]) -> None:
    """Otherwise the question would be of use to the scripted teacher alone."""
    settings = dataclasses.replace(WITH_RELEVANCE, budget=9.0, turns=2)
    robot = make(settings=settings, pick=ask_what_matters)
    robot.sees()
    (query,) = robot.said('query')
    assert (query['kind'], query['cost'], query['text']) == ('relevance', 4.0, 'Which of these things matter?')
    first, second, *_ = ids = query['choices']
    for text, reason in {
        f'{first},999': "'999' does not answer",
        f'{first},none': 'stands alone',
        'snack': 'does not answer',
        answer_text(query, 'none'): 'a list of object ids',
        answer_text(query, [999]): 'object 999 is not in the scene',
        answer_text(query, ['colour']): 'are object ids',
        answer_text(query, [int(first), 'colour']): 'content',
    }.items():
        ack = robot.says(text)
        assert not ack['accepted'], text
        assert reason in ack['reason']
    assert robot.says(f'{second}, {first}')['accepted']
    state = robot.said('learner_state')[-1]
    assert state['queries'][0]['objects'] == [int(second), int(first)]
    assert state['last_answer']['answer']['content'] == [int(second), int(first)]
    said = state['last_answer']['answer']['answer_id']
    assert robot.answers(query, [], answer_id='c1', replaces=said)['accepted']
    assert robot.said('learner_state')[-1]['queries'][0]['objects'] == []
    assert len(ids) == 10


def test_an_answer_is_on_the_disk_before_it_is_acknowledged(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise an answer would be lost whose teacher was told that it was taken."""
    on_disk: list[int] = []

    def look(effect: Effect) -> None:
        if isinstance(effect, Publish) and effect.topic == 'answer_ack':
            on_disk.append(len(told(tmp_path, AnswerAccepted)))

    robot = make(tmp_path, settings=LABELS, do=look)
    robot.sees()
    (query,) = robot.said('query')
    assert not robot.answers(query, 'pudding')['accepted']
    assert robot.answers(query, 'snack')['accepted']
    assert on_disk == [0, 1]
    assert [event.answer.content for event in told(tmp_path, AnswerAccepted)] == ['snack']
    assert [event.reason[:13] for event in told(tmp_path, InputRejected)] == ['unknown label']


def test_a_late_answer_is_refused_and_kept(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise the second of two teachers would label what is asked about now with what was asked before."""
    robot = make(tmp_path, settings=LABELS)
    robot.sees()
    (query,) = robot.said('query')
    robot.answers(query, 'snack')
    robot.sees()
    for _ in range(2):
        ack = robot.answers(query, 'fruit', answer_id='b1', teacher_id='bert')
        assert (ack['accepted'], ack['answer_id']) == (False, 'b1')
        assert "query 'q1' was answered already, by 'a1'" in ack['reason']
    state = robot.said('learner_state')[-1]
    assert (state['turn'], state['teachers']['bert']['late'], state['labels']['fruit']) == (1, 1, 0)
    assert [event.answer.teacher_id for event in told(tmp_path, LateAnswerKept)] == ['bert']
    assert told(tmp_path, InputRejected) == []
    assert [one['query_id'] for one in robot.said('query')] == ['q1', 'q2']


@pytest.mark.parametrize('with_log', [True, False])
def test_corrections_of_corrections_cost_nothing_and_ask_nothing(
    make: Callable[..., Robot], tmp_path: Path, with_log: bool
) -> None:
    """Otherwise a person who was wrong could not take it back, and take that back, too."""
    robot = make(tmp_path if with_log else None, settings=LABELS)
    robot.sees()
    (query,) = robot.said('query')
    robot.answers(query, 'snack')
    robot.sees()
    for reason in ('', 'already taken'):
        ack = robot.answers(query, 'fruit', answer_id='a2', replaces='a1')
        assert (ack['accepted'], ack['reason']) == (True, reason)
    state = robot.said('learner_state')[-1]
    assert (state['labels']['snack'], state['labels']['fruit'], state['spent']) == (0, 1, 1.0)
    assert robot.answers(query, None, outcome='skip', answer_id='a3', replaces='a2')['accepted']
    state = robot.said('learner_state')[-1]
    assert (state['queries'][0]['outcome'], sum(state['labels'].values())) == ('skip', 0)
    ack = robot.answers(query, 'fruit', answer_id='a4', replaces='a9')
    assert (ack['accepted'], ack['reason']) == (False, "no answer 'a9' to query 'q1' was taken")
    assert [one['query_id'] for one in robot.said('query')] == ['q1', 'q2']
    assert robot.answers(robot.said('query')[-1], 'snack')['accepted']


def test_a_late_answer_changes_what_is_told_of_its_teacher(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a concepts file would hold how reliable a teacher was before, until the next answer is taken."""
    robot = make(settings=LABELS, concepts_files=[tmp_path / 'concepts.json'])
    robot.sees()
    (query,) = robot.said('query')
    robot.answers(query, 'snack')
    robot.sees()
    before = len(robot.said('concepts'))
    for _ in range(2):
        robot.answers(query, 'fruit', answer_id='b1', teacher_id='bert')
        assert len(robot.said('concepts')) == len(robot.driver.effects(WriteFile)) == before + 1
    assert robot.said('concepts')[-1] != robot.said('concepts')[-2]
