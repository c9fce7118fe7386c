"""Small change of plain English."""

from __future__ import annotations

from al_questioner.support.text import number_of


def test_one_thing_is_singular() -> None:
    """`1 turns` reads like a program."""
    assert [number_of(n, 'turn') for n in (0, 1, 2)] == ['0 turns', '1 turn', '2 turns']
    assert number_of(2, 'query', 'queries') == '2 queries'
