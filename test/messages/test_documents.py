"""Documents arrive unchanged, and any other text is refused with its reason."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.domain import (
    Action,
    Answer,
    Costs,
    EpisodeSettings,
    InputError,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
)
from al_questioner.messages import documents
from al_questioner.messages.documents import DocumentError
from al_questioner.messages.schemas import SCHEMAS

QUERY = Query('q3', 5, Action(QueryKind.LABEL, object_id=7), ('fruit', 'snack'), 1.0, 12.5, 35, 9, 'What is object 7?')
ANSWERS = [
    Answer('q3', 'a1', 'anna', Outcome.ANSWERED, 'snack'),
    Answer('q3', 'a1', 'anna', Outcome.ANSWERED, 7),
    Answer('q3', 'a1', 'anna', Outcome.ANSWERED, ('colour', 'weight')),
    Answer('q3', 'a1', 'anna', Outcome.UNKNOWN),
]

DIGESTS = {
    'episode': '5a32d5685205343c',
    'turn': '8eb0cae17fdfbbfa',
    'query': '80c276465c88668d',
    'answer': '319db1540a418d8f',
    'answer_ack': '227c4e7bc1f95c28',
    'learner_state': '5bbef5e72f40deb9',
    'concepts': 'eb9e6a6a0622860c',
    'recognition': '508d22ff45a23de0',
    'target_info': '9366f52b72050ff2',
}
"""Of the schemas. If one changes on purpose, tell it in docs/reference/documents.md and copy here what pytest shows."""


def answer_text(**changes: object) -> str:
    members = {'schema': 'al_questioner/answer/1', 'episode_id': 'e', **documents.answer_members(ANSWERS[0]), **changes}
    return json.dumps({key: value for key, value in members.items() if value is not ...})


def sent(kind: str, members: dict[str, object]) -> Any:
    """Return a document as it arrives."""
    return documents.read(kind, documents.write(kind, 'e', members))


def test_the_schemas_are_the_agreed_ones() -> None:
    """Programs of others, and old logs, would no longer be understood."""
    texts = {kind: json.dumps(schema, sort_keys=True) for kind, schema in SCHEMAS.items()}
    assert {kind: hashlib.sha256(text.encode()).hexdigest()[:16] for kind, text in texts.items()} == DIGESTS


def test_query_survives() -> None:
    """Otherwise the teacher would be asked something else than the learner decided."""
    assert documents.query_of(sent('query', documents.query_members(QUERY))) == QUERY


@pytest.mark.parametrize('known', [(), (7, 3)])
def test_what_is_known_survives(known: tuple[int, ...]) -> None:
    """Otherwise the teacher would show what the learner knows; earlier versions tell nothing of it."""
    query = dataclasses.replace(QUERY, action=Action(QueryKind.DEMONSTRATION, symbol='snack'), known=known)
    text = documents.write('query', 'e', documents.query_members(query))
    assert documents.query_of(documents.read('query', text)) == query
    assert 'known' not in documents.query_members(QUERY)
    with pytest.raises(DocumentError, match='known'):
        documents.read('query', text.replace(f'"known":{list(known)}'.replace(' ', ''), '"known":[-1]'))


def test_query_begins_with_its_question() -> None:
    """`ros2 topic echo`, which cuts a message after 128 characters, shows what is asked and not ids."""
    text = documents.write('query', 'kitchen_table-0-0123abcd', documents.query_members(QUERY))
    assert text.startswith('{"text":"What is object 7?","schema":"al_questioner/query/1",')


@pytest.mark.parametrize('answer', ANSWERS)
def test_answer_survives(answer: Answer) -> None:
    """Otherwise the learner would be told something else than the teacher said."""
    assert documents.answer_of(sent('answer', documents.answer_members(answer))) == answer


def test_only_a_correction_names_what_it_replaces() -> None:
    """A learner that knows no corrections takes every other answer; one that does finds what to correct."""
    correction = Answer('q3', 'a2', 'anna', Outcome.ANSWERED, 'fruit', replaces='a1')
    assert sent('answer', documents.answer_members(correction))['replaces'] == 'a1'
    assert 'replaces' not in documents.answer_members(ANSWERS[0])


def test_record_survives() -> None:
    """Otherwise the evaluation would replay another episode than was played."""
    record = QueryRecord(3, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.ANSWERED, ('colour',))
    assert documents.record_of(json.loads(json.dumps(documents.record_members(record)))) == record


@pytest.mark.parametrize('objects', [None, (), (10, 3)])
def test_the_record_of_a_relevance_query_survives(objects: tuple[int, ...] | None) -> None:
    """Otherwise an answer that nothing matters would be taken for none, or other records would have such a member."""
    record = QueryRecord(3, QueryKind.RELEVANCE, None, None, 4.0, Outcome.ANSWERED, objects=objects)
    members = json.loads(json.dumps(documents.record_members(record)))
    assert documents.record_of(members) == record
    assert ('objects' in members) is (objects is not None)


@pytest.mark.parametrize('content', [(), (10, 3)])
def test_things_that_matter_are_a_list_of_numbers(content: tuple[int, ...]) -> None:
    answer = Answer('q1', 'a1', 'anna', Outcome.ANSWERED, content)
    assert documents.answer_of(sent('answer', documents.answer_members(answer))) == answer


@pytest.mark.parametrize('relevance', [None, 0.0, 4.0])
def test_the_cost_of_a_relevance_query_is_told_where_there_is_one(relevance: float | None) -> None:
    """Documents of those who do not use it stay as they are."""
    settings = EpisodeSettings(('a', 'b'), 9.0, 9, 'u_sampling', costs=Costs(relevance=relevance))
    told = documents.settings_members(settings)
    assert ('relevance' in told['costs']) is (relevance is not None)
    assert documents.settings_of(told) == settings
    assert documents.settings_of({**told, 'costs': {**told['costs'], 'relevance': relevance}}) == settings
    assert documents.settings_of(sent('episode', {**told, 'feature_names': [], 'seed': 0, 'world': None})) == settings


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('', 'not valid JSON'),
        ('{', 'not valid JSON'),
        ('[' * 100_000, 'not valid JSON'),
        ('[]', 'expected a JSON object, found list'),
        ('{}', 'document: .* is a required property'),
        (answer_text(schema='al_questioner/answer/2'), 'schema'),
        (answer_text(schema='al_questioner/query/1'), 'schema'),
        (answer_text(episode_id=3), 'episode_id'),
        (answer_text(query_id=...), "'query_id' is a required property"),
        (answer_text(outcome='perhaps'), 'outcome'),
        (answer_text(content={'a': 1}), 'content'),
        (answer_text(content=[1, 'colour']), 'content'),
        (answer_text(content=[-1]), 'content'),
        (answer_text(content=[True]), 'content'),
        (answer_text(content=True), 'content'),
        (answer_text(content=7.0), 'content'),
        (answer_text(content=float('nan')), 'NaN is no JSON number'),
        (answer_text(teacher_id='x' * 5_000_000), 'at most'),
    ],
)
def test_what_is_no_answer_is_refused(text: str, reason: str) -> None:
    """Garbage would reach the episode, or end the node."""
    with pytest.raises(DocumentError, match=reason) as caught:
        documents.read('answer', text)
    assert '\n' not in str(caught.value)
    assert len(str(caught.value)) < 400


@given(st.text(max_size=300))
def test_random_text_never_crashes(text: str) -> None:
    """Otherwise garbage on a topic would raise something else than a refusal."""
    with pytest.raises(InputError):
        documents.read('turn', text)


def test_nan_is_never_written() -> None:
    """Otherwise a document that no JSON reader takes would go out."""
    with pytest.raises(ValueError, match='JSON compliant'):
        documents.write('turn', 'e', {'turn': float('nan')})


def test_unknown_members_are_let_through() -> None:
    """Otherwise a later version could not add a member without breaking this one."""
    assert documents.read('answer', answer_text(mood='good'))['mood'] == 'good'


def test_documents_that_tell_of_no_classifiers_are_of_earlier_learners() -> None:
    """Otherwise an older recording would be replayed with other models than it was made with."""
    settings = EpisodeSettings(('cup', 'plate'), 5.0, 10, 'random_fsq', amplitude=9.0, length_scale=2.0)
    told = documents.settings_members(settings)
    assert documents.settings_of(told) == settings
    later = ('amplitude', 'length_scale', 'kernel_shape', 'class_balance')
    silent = {name: value for name, value in told.items() if name not in later}
    earlier = {'amplitude': 4.0, 'kernel_shape': 'rbf', 'class_balance': 0.0}
    assert documents.settings_of(silent) == dataclasses.replace(settings, **earlier, length_scale=None)
