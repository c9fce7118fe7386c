"""The simulated world, on which perception, learner and teacher must agree."""

from __future__ import annotations

from al_questioner.domain import InputError
from al_questioner.messages.documents import Document

WORLD_MEMBERS = ('task', 'seed', 'sample')
"""Members of a document that describe a simulated world."""


def check_world(document: Document, own: Document) -> None:
    """Compare the world of a `turn` or a `query` with one's own; a document that names none is taken.

    Raises:
        InputError: the learner speaks of another world.
    """
    theirs = document.get('world')
    for name in WORLD_MEMBERS:
        if theirs is not None and theirs[name] != own[name]:
            raise InputError(f'the learner has {name} {theirs[name]!r}, this node {own[name]!r}')
