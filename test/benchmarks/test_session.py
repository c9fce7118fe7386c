"""The benchmark of the session log."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from shared.checkout import ROOT

SCRIPT = ROOT / 'benchmarks' / 'session.py'


@pytest.mark.slow
def test_every_kind_of_log_is_measured(tmp_path: Path) -> None:
    """The cost of durability can be measured on the disk of another robot."""
    command = [sys.executable, str(SCRIPT), '--answers', '4', '--repeats', '1', '--folder', str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    rows = {line.split('│')[1].strip(): line.split('│')[2:-1] for line in done.stdout.splitlines() if '│' in line}
    assert rows.keys() == {'no log', 'synchronous OFF', 'synchronous FULL'}
    for kind, cells in rows.items():
        numbers = [float(cell) for cell in cells if cell.strip()]
        assert len(numbers) == (2 if kind == 'no log' else 6)
        assert all(number > 0 for number in numbers)
    assert list(tmp_path.iterdir()) == []
