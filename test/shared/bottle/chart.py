"""The course of a run as a sequence chart that a person can read."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

WIDTH = 46


class Chart:
    """Takes down who said what to whom, who died and what was refused.

    Args:
        clock: seconds of the virtual time.
        is_kept: whether to take anything down; a run without is faster.
    """

    def __init__(self, clock: Callable[[], float], is_kept: bool) -> None:
        self._clock, self._is_kept = clock, is_kept
        self._lines: list[str] = []

    def arrived(self, sender: str, hearer: str, topic: str, content: Any, sent_at: float) -> None:
        if self._is_kept:
            self._arrow(f'{sender} -> {hearer}', topic, content, f'after {self._clock() - sent_at:.3f} s')

    def lost(self, sender: str, hearer: str, topic: str, content: Any) -> None:
        if self._is_kept:
            self._arrow(f'{sender} -x {hearer}', topic, content, 'LOST')

    def note(self, who: str, text: str) -> None:
        if self._is_kept:
            self._lines.append(f'{self._clock():9.3f}  {who:{WIDTH}} {text}')

    @property
    def text(self) -> str:
        return '\n'.join(self._lines)

    def _arrow(self, who: str, topic: str, content: Any, how: str) -> None:
        self._lines.append(f'{self._clock():9.3f}  {who:{WIDTH}} {topic}: {brief(content)}  ({how})')


def brief(content: Any) -> str:
    """Return the part of a message that tells one from another."""
    if not isinstance(content, str):
        return type(content).__name__
    try:
        members = json.loads(content)
    except ValueError:
        return repr(content[:60])
    if not isinstance(members, dict):
        return repr(content[:60])
    names = ('turn', 'query_id', 'kind', 'object_id', 'symbol', 'answer_id', 'replaces', 'outcome', 'content')
    names = (*names, 'accepted', 'reason', 'spent', 'done')
    return ' '.join(f'{name}={members[name]}' for name in names if members.get(name) is not None)[:150]
