"""JSON Schemas of the documents on the wire: the contract that `docs/reference/documents.md` explains."""

from __future__ import annotations

import math
from typing import Any

from al_questioner.domain import (
    BUDGET,
    CARRY_LABELS,
    CHANGE_INTERVAL,
    CLASS_BALANCE,
    COST_RELEVANCE,
    COSTS,
    KERNEL_SHAPE,
    LARGEST_TURN,
    SAME_VIEW,
    SAYABLE_OUTCOMES,
    TURNS,
    Outcome,
    QueryKind,
    Setting,
)

JsonSchema = dict[str, Any]

_TEXT: JsonSchema = {'type': 'string', 'minLength': 1, 'maxLength': 10_000}
_COUNT: JsonSchema = {'type': 'integer', 'minimum': 0}
_TURN: JsonSchema = {'type': 'integer', 'minimum': 1, 'maximum': LARGEST_TURN}
_AMOUNT: JsonSchema = {'type': 'number', 'minimum': 0}
_POSITIVE: JsonSchema = {'type': 'number', 'exclusiveMinimum': 0}
_NAMES: JsonSchema = {'type': 'array', 'items': _TEXT}
_OBJECT_ID: JsonSchema = {'type': ['integer', 'null'], 'minimum': 0, 'maximum': 2**32 - 2}
_OBJECT_IDS: JsonSchema = {'type': 'array', 'items': {**_OBJECT_ID, 'type': 'integer'}}
_OPTIONAL_TEXT: JsonSchema = {'type': ['string', 'null']}
_QUERIES = [kind.value for kind in QueryKind if kind is not QueryKind.NO_QUERY]
_OUTCOMES = [outcome.value for outcome in Outcome]
_SAYABLE = [outcome.value for outcome in SAYABLE_OUTCOMES]
_SHARE: JsonSchema = {'type': 'number', 'minimum': 0, 'maximum': 1}


def schema_name(kind: str) -> str:
    """Return the `schema` member of a kind of document."""
    return f'al_questioner/{kind}/1'


def _record(required: JsonSchema, optional: JsonSchema | None = None) -> JsonSchema:
    """Return the schema of a mapping; it accepts other members, so that later versions may add some."""
    return {'type': 'object', 'properties': {**required, **(optional or {})}, 'required': list(required)}


def _member(setting: Setting[Any]) -> JsonSchema:
    """Return the schema of the member that holds a setting."""
    if setting.choices:
        return {'enum': list(setting.choices)}
    if type(setting.default) is bool:
        return {'type': 'boolean'}
    limits = {'minimum': setting.lower, 'maximum': setting.upper}
    number = {
        'type': 'integer' if type(setting.default) is int else 'number',
        **{name: limit for name, limit in limits.items() if math.isfinite(limit)},
    }
    return {'anyOf': [number, {'const': setting.word}]} if setting.word else number


_WORLD = _record({'task': _TEXT, 'seed': _COUNT, 'sample': _COUNT, 'dataset': _OPTIONAL_TEXT})
_STAMP = _record({'sec': {**_COUNT, 'maximum': 2**31 - 1}, 'nanosec': {**_COUNT, 'maximum': 999_999_999}})
_ACTION: JsonSchema = {'kind': {'enum': _QUERIES}, 'object_id': _OBJECT_ID, 'symbol': _OPTIONAL_TEXT}
_QUERY_RECORD = _record(
    {'turn': _TURN, **_ACTION, 'cost': _AMOUNT, 'outcome': {'enum': _OUTCOMES}, 'groups': _NAMES},
    {'answered_in': _TURN, 'objects': _OBJECT_IDS},
)
_TEACHER_COUNTED: JsonSchema = dict.fromkeys(('answered', 'unknown', 'skipped', 'corrected', 'late'), _COUNT)
_TEACHER = _record({**_TEACHER_COUNTED, 'reliability': _SHARE})

_QUERY = _record(
    {
        'query_id': _TEXT,
        'turn': _TURN,
        **_ACTION,
        'choices': _NAMES,
        'cost': _AMOUNT,
        'budget_left': _AMOUNT,
        'turns_left': _COUNT,
        'model_version': _COUNT,
        'text': _TEXT,
    },
    {'world': {'oneOf': [_WORLD, {'type': 'null'}]}, 'known': _OBJECT_IDS},
)
_ANSWER = _record(
    {'query_id': _TEXT, 'answer_id': _TEXT, 'teacher_id': _TEXT, 'outcome': {'enum': _SAYABLE}},
    {
        'content': {
            'type': ['string', 'integer', 'array', 'null'],
            'anyOf': [{'items': _TEXT}, {'items': _OBJECT_IDS['items']}],
        },
        'replaces': {'anyOf': [_TEXT, {'type': 'null'}]},
    },
)

_VIEW: JsonSchema = {'type': 'integer', 'minimum': 1, 'maximum': 2**53}
_LESSON = _record(
    {'episode': _TEXT, 'turn': {**_COUNT, 'minimum': 1}},
    {
        'time': _TEXT,
        'kind': {'enum': _QUERIES},
        'teacher': {'type': 'string'},
        'labels': {
            'type': 'array',
            'items': _record({'view': _VIEW, 'label': _TEXT}, {'left_out': {'type': 'boolean'}, 'carried_from': _VIEW}),
        },
        'judgements': {'type': 'array', 'items': _record({'view': _VIEW, 'matters': {'type': 'boolean'}})},
        'withdrawn': {'type': 'array', 'items': _VIEW},
        'groups': _NAMES,
        'unnameable': {'type': 'array', 'items': _VIEW},
        'hearsay': {'type': 'array', 'items': _record({'view': _VIEW, 'label': _TEXT, 'teacher': _TEXT})},
        # The numbers are checked by who reads them, all at once: there are many.
        'seen': {
            'type': 'array',
            'items': _record({'view': _VIEW, 'object': _OBJECT_IDS['items'], 'features': {'type': 'array'}}),
        },
    },
)
_CONCEPTS = _record(
    {
        'symbols': {'type': 'array', 'items': _TEXT, 'minItems': 2},
        'feature_names': {'type': 'array', 'items': _TEXT, 'minItems': 1},
        'kernel': _record(
            {
                'amplitude': _POSITIVE,
                'kernel_shape': _member(KERNEL_SHAPE),
                'class_balance': _member(CLASS_BALANCE),
                'length_scale': {'anyOf': [_POSITIVE, {'type': 'null'}]},
            }
        ),
        'episodes': {
            'type': 'array',
            'items': _record(
                {'episode_id': _TEXT, 'symbols': _NAMES},
                {
                    'strategy': {'type': 'string'},
                    'version': {'type': 'string'},
                    'teachers': {'type': 'object', 'additionalProperties': _record(_TEACHER_COUNTED)},
                    'world': {'oneOf': [_WORLD, {'type': 'null'}]},
                },
            ),
        },
        'lessons': {'type': 'array', 'items': _LESSON},
    },
    {
        'feature_selection': _TEXT,
        # These follow from the lessons, for those who only read.
        'examples': {'type': 'object', 'additionalProperties': _COUNT},
        'groups': _NAMES,
        'relevant_groups': {'anyOf': [_NAMES, {'type': 'null'}]},
        'features_in_use': _NAMES,
        'teachers': {'type': 'object', 'additionalProperties': _record(_TEACHER_COUNTED, {'reliability': _SHARE})},
        'standardisation': _record(
            {
                'count': _COUNT,
                'mean': {'type': 'array', 'items': {'type': 'number'}},
                'scale': {'type': 'array', 'items': _POSITIVE},
            }
        ),
    },
)

_POSITION: JsonSchema = {'type': 'array', 'items': {'type': 'number'}, 'minItems': 3, 'maxItems': 3}
_CANDIDATE: JsonSchema = {'object_id': _OBJECT_IDS['items'], 'probability': _SHARE, 'position': _POSITION}
_RECOGNISED = _record(
    {
        'object_id': _OBJECT_IDS['items'],
        'known': {'type': 'boolean'},
        'best': _TEXT,
        'probability': _SHARE,
        'position': _POSITION,
        'probabilities': {'type': 'object', 'additionalProperties': _SHARE},
    },
    {'question': _TEXT},
)

SCHEMAS: dict[str, JsonSchema] = {
    'episode': _record(
        {
            'symbols': {'type': 'array', 'items': _TEXT, 'minItems': 2},
            'feature_names': _NAMES,
            'budget': _member(BUDGET),
            'turns': _member(TURNS),
            'change_interval': _member(CHANGE_INTERVAL),
            'costs': _record(
                {name: _member(price) for name, price in COSTS.items() if name in _QUERIES},
                {name: _member(share) for name, share in COSTS.items() if name not in _QUERIES}
                | {
                    QueryKind.RELEVANCE.value: {
                        'anyOf': [{**_AMOUNT, 'minimum': COST_RELEVANCE.lower}, {'type': 'null'}]
                    }
                },
            ),
            'strategy': _TEXT,
            'weights': {'type': 'object', 'additionalProperties': {'type': 'number'}},
            'seed': _COUNT,
            'world': {'oneOf': [_WORLD, {'type': 'null'}]},
        },
        {
            # Of learners of earlier versions, which tuned their kernel every so many turns; 0: never.
            'tune_every': _COUNT,
            # Of sessions that such a learner began: the turns at whose end it did.
            'tuned_turns': {'type': 'array', 'items': _TURN},
            'semantics': _COUNT,
            'amplitude': _POSITIVE,
            'kernel_shape': _member(KERNEL_SHAPE),
            'class_balance': _member(CLASS_BALANCE),
            'length_scale': {'anyOf': [_POSITIVE, {'type': 'null'}]},
            'view_tolerance': _member(SAME_VIEW),
            # Missing: off.
            'carry_labels': _member(CARRY_LABELS),
            # What was known before the first turn: a whole document of this kind.
            'concepts': _CONCEPTS,
            'concepts_sha256': _TEXT,
        },
    ),
    'turn': _record({'turn': _TURN, 'stamp': _STAMP, 'world': {'oneOf': [_WORLD, {'type': 'null'}]}}),
    'query': _QUERY,
    'answer': _ANSWER,
    'answer_ack': _record(
        {
            'query_id': _OPTIONAL_TEXT,
            'answer_id': _OPTIONAL_TEXT,
            'accepted': {'type': 'boolean'},
            'reason': {'type': 'string'},
        }
    ),
    'learner_state': _record(
        {
            'turn': _COUNT,
            'turns': _TURN,
            'budget': _AMOUNT,
            'spent': _AMOUNT,
            'done': {'type': 'boolean'},
            'queries': {'type': 'array', 'items': _QUERY_RECORD},
            'labels': {'type': 'object', 'additionalProperties': _COUNT},
            'model_version': _COUNT,
            'beliefs': {
                'type': 'object',
                'additionalProperties': {'type': 'object', 'additionalProperties': {'type': 'number'}},
            },
        },
        {
            'kernel': _record({'amplitude': _POSITIVE, 'length_scale': _POSITIVE}),
            'last_answer': {'oneOf': [_record({'query': _QUERY, 'answer': _ANSWER}), {'type': 'null'}]},
            'teachers': {'type': 'object', 'additionalProperties': _TEACHER},
        },
    ),
    'concepts': _CONCEPTS,
    'recognition': _record(
        {
            'stamp': _STAMP,
            'frame_id': {'type': 'string'},
            'symbols': {'type': 'array', 'items': _TEXT, 'minItems': 2},
            'examples': _COUNT,
            'threshold': _SHARE,
            'things': {'type': 'array', 'items': _RECOGNISED},
        }
    ),
    'target_info': _record(
        {
            'text': _TEXT,
            'wanted': {'type': 'string'},
            'symbol': _OPTIONAL_TEXT,
            **{name: {'anyOf': [schema, {'type': 'null'}]} for name, schema in _CANDIDATE.items()},
            'runner_up': {'anyOf': [_record(_CANDIDATE), {'type': 'null'}]},
            'reason': {'type': 'string'},
            'stamp': {'anyOf': [_STAMP, {'type': 'null'}]},
            'frame_id': {'type': 'string'},
        }
    ),
}
"""Schema of each kind of document, without the `schema` and `episode_id` that every document carries."""
