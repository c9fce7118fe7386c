"""The concepts file: all that a learner knows, as one JSON document that people can read and that is safe to load."""

from __future__ import annotations

import json
import re
from pathlib import Path

from al_questioner.domain import InputError, Knowledge
from al_questioner.messages import documents
from al_questioner.messages.concepts_text import KIND, concepts_text
from al_questioner.messages.knowledge_members import knowledge_of
from al_questioner.messages.schemas import schema_name
from al_questioner.support.files import write_text
from al_questioner.support.text import one_line

_SCHEMA = re.compile(r'al_questioner/concepts/(\d{1,9})')


def concepts_of_text(text: str) -> Knowledge:
    """Return what a document tells, whichever way it is laid out.

    Raises:
        InputError: it is no such document, one of a later version, or damaged; the text is one line.
    """
    try:
        _check_schema(text)
        return knowledge_of(documents.read(KIND, text))
    except InputError as error:
        # A name in it may have several lines.
        raise InputError(one_line(error)) from error


def read_concepts(path: Path) -> Knowledge:
    """Read a concepts file.

    Raises:
        InputError: it cannot be read or used; the text, one line, names it.
    """
    try:
        return concepts_of_text(path.read_text(encoding='utf-8-sig'))
    except IsADirectoryError:
        raise InputError(f'{path} is a folder; if it is that of a session, take concepts.json in it') from None
    except OSError as error:
        raise InputError(f'{path} cannot be read ({error.strerror or error})') from error
    except UnicodeDecodeError:
        raise InputError(f'{path}: not a text file') from None
    except InputError as error:
        raise InputError(f'{path}: {error}') from error


def write_concepts(path: Path, knowledge: Knowledge) -> None:
    """Write a concepts file, as a whole or not at all.

    Raises:
        InputError: it cannot be written.
    """
    write_text(path, concepts_text(knowledge))


def _check_schema(text: str) -> None:
    """Say plainly that a document is of a later version, or another one.

    Raises:
        InputError: it is.
    """
    try:
        document = json.loads(text)
    except (ValueError, RecursionError):
        # What is wrong is said by who reads it.
        return
    schema = document.get('schema') if isinstance(document, dict) else None
    if schema == schema_name(KIND):
        return
    found = _SCHEMA.fullmatch(schema) if isinstance(schema, str) else None
    if found:
        ours = schema_name(KIND)
        raise InputError(f'of another version ({schema}); this version of al_questioner reads {ours}')
    raise InputError(f'no concepts file (its schema is {json.dumps(schema)[:60]})')
