"""Naming what differs between two documents of settings."""

from __future__ import annotations

from al_questioner.support.differences import differences


def test_only_what_differs_is_named() -> None:
    """Otherwise people would have to find it themselves in two pages of settings."""
    theirs = {'a': 1, 'inner': {'b': 2, 'deep': {'c': [1, 2]}}, 'gone': 'x'}
    ours = {'a': 1.0, 'inner': {'b': 3, 'deep': {'c': [1, 2]}}, 'new': 0}
    assert differences(theirs, ours) == ['inner.b 2, not 3', "gone 'x', not None", 'new None, not 0']
    assert differences(theirs, ours, {'gone', 'inner.b', 'new'}) == []
