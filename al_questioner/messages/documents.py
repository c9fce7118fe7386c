"""JSON documents: what is written on a String topic, and how what arrives is checked.

Every document is one JSON object with `schema` (`al_questioner/KIND/1`), `episode_id`, and the members that
`schemas.SCHEMAS` demands. Whatever does not fit is a `DocumentError` whose text says where.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import cache
from typing import Any, NoReturn, TypeVar

import jsonschema

from al_questioner.domain import (
    COSTS,
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
from al_questioner.messages.concepts_text import fingerprint
from al_questioner.messages.knowledge_members import knowledge_members, knowledge_of
from al_questioner.messages.schemas import SCHEMAS, schema_name

Document = dict[str, Any]
Item = TypeVar('Item', Query, Answer, QueryRecord, Action)

_SETTINGS = [name for name in SCHEMAS['episode']['properties'] if name in EpisodeSettings.__dataclass_fields__]
"""Members of an `episode` document that are attributes of `EpisodeSettings`, in the order of the document."""
_IF_GIVEN = ('carry_labels', 'concepts')
"""Those of them that are left out where they are not used."""

_ENUMS = {'kind': QueryKind, 'outcome': Outcome}
_READ: Mapping[str, Callable[[Any], Any]] = {**_ENUMS, 'cost': float, 'budget_left': float}
"""Types of members that JSON does not tell."""
_LATER = ('known', 'replaces', 'answered_in', 'objects')
"""Members that documents of earlier versions do not have, and that are left out where they are None."""
_OPTIONAL = ('content', *_LATER)

EARLIER_KERNEL = {'amplitude': 4.0, 'kernel_shape': 'rbf', 'class_balance': 0.0}
"""Classifiers of learners whose `episode` documents do not tell of them."""

MAXIMAL_LENGTH = 4_000_000
"""Characters; a longer text is refused unread."""
LONGER = dict.fromkeys(('concepts', 'episode'), 64_000_000)
"""Such limits of the documents that hold all that was ever taught."""


class DocumentError(InputError):
    """A text that is not the document it should be."""


def write(kind: str, episode_id: str, members: Mapping[str, Any]) -> str:
    """Write a document as JSON; its text for people stands first, where tools that cut a message still show it.

    Raises:
        ValueError: a member is NaN or infinite, which JSON cannot say.
    """
    words = {name: members[name] for name in ('text',) if name in members}
    document = {**words, 'schema': schema_name(kind), 'episode_id': episode_id, **members}
    return json.dumps(document, allow_nan=False, separators=(',', ':'))


def read(kind: str, text: str) -> Document:
    """Read and check the document that a text holds.

    Raises:
        DocumentError: too long, no JSON, another schema, or a member that is missing or of the wrong form.
    """
    longest = LONGER.get(kind, MAXIMAL_LENGTH)
    if len(text) > longest:
        raise DocumentError(f'{kind}: {len(text)} characters, at most {longest} are read')
    try:
        document = json.loads(text, parse_constant=_refuse_constant)
    except DocumentError:
        raise
    except (ValueError, RecursionError) as error:
        raise DocumentError(f'{kind}: not valid JSON ({error})') from error
    if not isinstance(document, dict):
        raise DocumentError(f'{kind}: expected a JSON object, found {type(document).__name__}')
    fault = jsonschema.exceptions.best_match(_validator(kind).iter_errors(document))
    if fault is not None:
        where = '.'.join(str(part) for part in fault.absolute_path) or 'document'
        raise DocumentError(f'{kind}: {where}: {_shorten(fault.message)}')
    return document


def _refuse_constant(name: str) -> NoReturn:
    raise DocumentError(f'{name} is no JSON number')


def _shorten(text: str, length: int = 200) -> str:
    line = ' '.join(text.split())
    return line if len(line) <= length else f'{line[: length - 1]}…'


def _is_integer(_: jsonschema.TypeChecker, value: object) -> bool:
    """JSON Schema's integer, without 2.0, which Python would not take for a number of a turn."""
    return isinstance(value, int) and not isinstance(value, bool)


_BASE = jsonschema.Draft202012Validator
_TYPES = _BASE.TYPE_CHECKER.redefine('integer', _is_integer)
_Validator = jsonschema.validators.extend(_BASE, type_checker=_TYPES)  # type: ignore[no-untyped-call]


@cache
def _validator(kind: str) -> jsonschema.protocols.Validator:
    schema = SCHEMAS[kind]
    common = {'schema': {'const': schema_name(kind)}, 'episode_id': {'type': 'string', 'minLength': 1}}
    validator: jsonschema.protocols.Validator = _Validator(
        {**schema, 'properties': {**common, **schema['properties']}, 'required': [*common, *schema['required']]}
    )
    return validator


def settings_members(settings: EpisodeSettings) -> Document:
    """Return what an `episode` document tells of the settings of its episode.

    What was known before comes last, as it is long, with its `fingerprint` before it; both only if there is any.
    """
    members = {name: getattr(settings, name) for name in _SETTINGS if name not in _IF_GIVEN} | {
        'symbols': list(settings.symbols),
        'costs': costs_members(settings.costs),
        'weights': dict(settings.weights),
    }
    if settings.carry_labels:
        members['carry_labels'] = True
    known = settings.concepts
    if known is not None:
        members |= {'concepts_sha256': fingerprint(known), 'concepts': knowledge_members(known)}
    return members


def costs_members(costs: Costs) -> dict[str, float]:
    """Return the costs by name, without that of a query that cannot be asked."""
    return {name: cost for name, cost in vars(costs).items() if cost is not None}


def settings_of(document: Document) -> EpisodeSettings:
    """Return the settings that a checked `episode` document tells of; what an earlier one did not tell had its default.

    Raises:
        SettingsError: a value outside its range.
    """
    told = {name: document[name] for name in _SETTINGS if name in document}
    told['budget'] = float(document['budget'])
    told['weights'] = {name: float(weight) for name, weight in document['weights'].items()}
    costs = {name: document['costs'].get(name) for name in (*COSTS, QueryKind.RELEVANCE.value)}
    if 'concepts' in told:
        told['concepts'] = knowledge_of(document['concepts'])
    told['costs'] = Costs(**{name: float(cost) for name, cost in costs.items() if cost is not None})
    return EpisodeSettings(**{**EARLIER_KERNEL, **told})


def query_members(query: Query) -> Document:
    """Members of a `query` document."""
    return members_of(query)


def query_of(document: Document) -> Query:
    """Return the query that a checked `query` document describes."""
    return read_as(Query, document)


def answer_members(answer: Answer) -> Document:
    """Members of an `answer` document."""
    return members_of(answer)


def answer_of(document: Document) -> Answer:
    """Return the answer that a checked `answer` document describes."""
    return read_as(Answer, document)


def record_members(record: QueryRecord) -> Document:
    """Return a query and its outcome as they stand in `learner_state` and in an episode's JSON."""
    return members_of(record)


def record_of(members: Document) -> QueryRecord:
    """Return the record that `record_members` wrote."""
    return read_as(QueryRecord, members)


def members_of(item: Query | Answer | QueryRecord | Action) -> Document:
    """Return the attributes of an object as JSON holds them; those of an action stand in the place of the action."""
    members: Document = {}
    for name, value in vars(item).items():
        if isinstance(value, Action):
            members |= members_of(value)
        elif value is not None or name not in _LATER:
            members[name] = list(value) if isinstance(value, tuple) else value.value if name in _ENUMS else value
    return members


def read_as(kind: type[Item], members: Document) -> Item:
    """Return the object that `members_of` wrote; other members are passed over."""
    values: Document = {}
    for name in (field.name for field in fields(kind)):
        if name == 'action':
            values[name] = read_as(Action, members)
        else:
            value = members.get(name) if name in _OPTIONAL else members[name]
            values[name] = tuple(value) if isinstance(value, list) else _READ.get(name, lambda same: same)(value)
    return kind(**values)
