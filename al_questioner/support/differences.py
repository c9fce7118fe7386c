"""In which members two documents of settings differ, for the people who have to find out."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any


def differences(theirs: Mapping[str, Any], ours: Mapping[str, Any], ignored: Collection[str] = ()) -> list[str]:
    """What differs, each as `name theirs, not ours`; of inner objects only the members that do, as `outer.name`.

    Args:
        theirs: what is there.
        ours: what was wanted.
        ignored: names that may differ.
    """
    found, wanted = dict(_flat(theirs)), dict(_flat(ours))
    return [
        f'{name} {found.get(name)!r}, not {wanted.get(name)!r}'
        for name in {**found, **wanted}
        if name not in ignored and found.get(name) != wanted.get(name)
    ]


def _flat(members: Mapping[str, Any], prefix: str = '') -> Iterator[tuple[str, Any]]:
    """Names and values, those of inner objects as `outer.name`."""
    for name, value in members.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f'{prefix}{name}.')
        else:
            yield f'{prefix}{name}', value
