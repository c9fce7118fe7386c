"""Comparison of two documents of settings, in words for people."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any


def differences(theirs: Mapping[str, Any], ours: Mapping[str, Any], ignored: Collection[str] = ()) -> list[str]:
    """Return what differs between the document that was found, theirs, and the one that was expected, ours.

    Each reads `name theirs, not ours`; a member of an inner object is `outer.name`. Ignored names may differ; what is
    in an inner object of an ignored name, too.
    """
    found, wanted = (
        dict(_flat({name: value for name, value in members.items() if name not in ignored}))
        for members in (theirs, ours)
    )
    return [
        f'{name} {found.get(name)!r}, not {wanted.get(name)!r}'
        for name in {**found, **wanted}
        if name not in ignored and found.get(name) != wanted.get(name)
    ]


def _flat(members: Mapping[str, Any], prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Yield names and values; a member of an inner object is `outer.name`."""
    for name, value in members.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f'{prefix}{name}.')
        else:
            yield f'{prefix}{name}', value
