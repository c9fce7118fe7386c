"""The fewest faults with which a run still fails."""

from __future__ import annotations

from collections.abc import Callable, Sequence

Fails = Callable[[Sequence[str]], bool]


def shrink(faults: Sequence[str], fails: Fails) -> list[str]:
    """Return some of the faults, with which a run still fails and without any one of which it does not.

    Delta debugging, the algorithm ddmin of Zeller and Hildebrandt, IEEE Transactions on Software Engineering 28 (2002).

    Args:
        faults: with which it fails.
        fails: whether a run with these faults, and no others, fails.
    """
    left, parts = _without_kinds(list(dict.fromkeys(faults)), fails), 2
    while len(left) > 1:
        size = -(-len(left) // parts)
        pieces = [left[i : i + size] for i in range(0, len(left), size)]
        smaller = next((piece for piece in pieces if fails(piece)), None)
        if smaller is not None:
            left, parts = smaller, 2
            continue
        rests = ([one for other in pieces if other is not piece for one in other] for piece in pieces)
        smaller = next((rest for rest in rests if len(pieces) > 2 and fails(rest)), None)
        if smaller is not None:
            left, parts = smaller, max(parts - 1, 2)
        elif parts >= len(left):
            break
        else:
            parts = min(len(left), 2 * parts)
    return [] if left and fails([]) else left


def _without_kinds(faults: list[str], fails: Fails) -> list[str]:
    """Return the faults without the kinds, named by their first two words, that are not needed."""
    left = faults
    for kind in sorted({_kind(fault) for fault in faults}):
        rest = [fault for fault in left if _kind(fault) != kind]
        if len(rest) < len(left) and fails(rest):
            left = rest
    return left


def _kind(fault: str) -> str:
    return ' '.join(fault.split()[:2])
