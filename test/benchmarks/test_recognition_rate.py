"""The benchmark of the recogniser."""

from __future__ import annotations

import subprocess
import sys

import pytest

from shared.checkout import ROOT

SCRIPT = ROOT / 'benchmarks' / 'recognition_rate.py'
SMALL = ('--things', '3', '--examples', '6', '--symbols', '2', '--clouds', '5')


def figures(*arguments: str) -> dict[str, float]:
    """Return the numbers of all tables by what they are of."""
    done = subprocess.run([sys.executable, str(SCRIPT), *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = [line.split('│')[1:3] for line in done.stdout.splitlines() if line.startswith('│')]
    return {name.strip(): float(value) for name, value in rows}


def test_the_work_on_a_cloud_is_measured_part_by_part() -> None:
    """The page tells figures that nobody could measure again otherwise."""
    found = figures('--offline', *SMALL)
    parts = ('recognise', 'read objects', 'write recognised', 'write recognition', 'write recognised_markers')
    assert all(found[part] >= 0 for part in parts)
    assert found['all'] == pytest.approx(sum(found[part] for part in parts), abs=0.05)
    assert found['size, kB'] > 0


@pytest.mark.slow
def test_the_way_through_ros_is_measured() -> None:
    found = figures('--rate', '50', *SMALL)
    assert 1 <= found['recognised of 5 at 50 a second'] <= 5
    assert 0 < found['from objects to recognised, median, ms'] <= found['99 %, ms']
    assert found['clouds a second, one after another'] > 0
