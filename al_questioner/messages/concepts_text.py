"""The text of a concepts file, and its fingerprint."""

from __future__ import annotations

import hashlib
import json

from al_questioner.domain import Knowledge
from al_questioner.messages.knowledge_members import knowledge_members
from al_questioner.messages.schemas import schema_name

KIND = 'concepts'


def concepts_text(knowledge: Knowledge) -> str:
    """Return the document of what is known: a member a line, and in its lists of objects, an object a line.

    The same knowledge is the same text. Its `episode_id` is that of the last episode that it comes from.
    """
    last = knowledge.origins[-1].episode if knowledge.origins else 'none'
    members = {'schema': schema_name(KIND), 'episode_id': last, **knowledge_members(knowledge)}
    return '{\n' + ',\n'.join(f'{json.dumps(name)}: {_laid_out(each)}' for name, each in members.items()) + '\n}\n'


def fingerprint(knowledge: Knowledge) -> str:
    """Return the SHA-256 of the file that `write_concepts` writes, in hexadecimal."""
    return hashlib.sha256(concepts_text(knowledge).encode(errors='replace')).hexdigest()


def _laid_out(value: object) -> str:
    if isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
        return '[\n' + ',\n'.join(f' {_line(each)}' for each in value) + '\n]'
    return _line(value)


def _line(value: object) -> str:
    return json.dumps(value, allow_nan=False, ensure_ascii=False)
