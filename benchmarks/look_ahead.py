"""The look-ahead beside its rivals: its time, its error, and how both grow.

python benchmarks/look_ahead.py            # about five minutes
python benchmarks/look_ahead.py --quick
python benchmarks/look_ahead.py --only exactness
python benchmarks/look_ahead.py --whole 1  # every hypothesis of every state: some minutes more
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

from look_ahead_parts import exactness, growth, machine, side_by_side

SIZES, QUICK_SIZES = (20, 50, 150), (20,)
QUICK_STATES = 30
STATES = 1000
APPROXIMATED = 5
"""Number of other states for each one that tells the error of the approximate mode."""

PARTS = ('side_by_side', 'exactness', 'approximation', 'growth', 'pool')

GROWTH = (0, 20, 50, 150, 300, 1000), (12, 40, 200), (4, 20)
QUICK_GROWTH = (0, 50), (12, 40), (4,)
POOL, QUICK_POOL = 3200, 300
POOL_LABELS, POOL_SYMBOLS = 50, 4


def parser() -> argparse.ArgumentParser:
    """The arguments."""
    result = argparse.ArgumentParser(description=(__doc__ or '').splitlines()[0])
    result.add_argument('--repeats', type=int, help='calls of each rival (3; 1 if quick)')
    result.add_argument('--states', type=int, help=f'random states ({STATES}; {QUICK_STATES} if quick)')
    result.add_argument(
        '--whole', type=int, default=4, help='refit the whole table of one state in so many (%(default)s)'
    )
    result.add_argument('--quick', action='store_true', help='small sizes only: within a minute')
    result.add_argument(
        '--only', nargs='+', choices=PARTS, default=PARTS, metavar='PART', help=f'of {", ".join(PARTS)}'
    )
    result.add_argument('--json', type=Path, metavar='FILE', help='write the figures as JSON')
    return result


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, and print the tables."""
    given = parser().parse_args(arguments)
    repeats = (1 if given.quick else 3) if given.repeats is None else given.repeats
    states = (QUICK_STATES if given.quick else STATES) if given.states is None else given.states
    if min(repeats, states, given.whole) < 1:
        print('--repeats, --states and --whole must be 1 or more', file=sys.stderr)
        return 2
    start = time.perf_counter()
    print(machine.conditions())
    peak = machine.peak()
    print(f'Matrix products: {peak / 1e9:.1f} GFLOP/s. All times are those of the CPU.\n')
    parts = {
        'side_by_side': lambda: side_by_side.compare(QUICK_SIZES if given.quick else SIZES, repeats, peak),
        'exactness': lambda: exactness.check(states, given.whole),
        'approximation': lambda: exactness.check_approximation(max(1, states // APPROXIMATED)),
        'growth': lambda: growth.grow(*(QUICK_GROWTH if given.quick else GROWTH)),
        'pool': lambda: growth.score_pool(QUICK_POOL if given.quick else POOL, POOL_LABELS, POOL_SYMBOLS),
    }
    figures = {'peak': peak, **{name: part() for name, part in parts.items() if name in given.only}}
    print(f'All of this took {time.perf_counter() - start:.0f} s. {machine.conditions()}')
    if given.json is not None:
        given.json.write_text(json.dumps(figures, indent=1) + '\n', encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
