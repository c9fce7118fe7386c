"""A run that fails, cut down to the faults that it takes, as a sequence chart."""

from __future__ import annotations

import time
from collections.abc import Sequence

from shared.bottle.bottle import Outcome, run
from shared.bottle.shrinking import shrink

SECONDS_TO_SHRINK = 60.0
LINES_SHOWN = 60


def explain(outcome: Outcome, seconds: float = SECONDS_TO_SHRINK) -> str:
    """Return a text that tells how to play a failing run again, with the fewest faults, and what happens in it.

    Args:
        outcome: of the run as it failed.
        seconds: after which the fewest faults found so far are taken.
    """
    kind, end = _kind(outcome.violation), time.monotonic() + seconds

    def fails(faults: Sequence[str]) -> bool:
        return time.monotonic() < end and _kind(run(outcome.seed, frozenset(faults)).violation) == kind

    faults = shrink(outcome.faults, fails)
    again = run(outcome.seed, frozenset(faults), is_charted=True)
    lines = again.chart.splitlines()
    left_out = [f'          ... {len(lines) - LINES_SHOWN} lines before ...'] if len(lines) > LINES_SHOWN else []
    return '\n'.join(
        [
            f'seed {outcome.seed}: {outcome.violation}',
            f'with {len(faults)} of {len(outcome.faults)} faults: run({outcome.seed}, frozenset({faults!r}))',
            *left_out,
            *lines[-LINES_SHOWN:],
        ]
    )


def _kind(violation: str) -> str:
    """Return a violation without what differs from run to run."""
    return ''.join(letter for letter in violation.split('(')[0] if not letter.isdigit())[:60]
