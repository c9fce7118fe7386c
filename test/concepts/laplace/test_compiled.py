"""Compilation, where what was compiled cannot be kept."""

from __future__ import annotations

import resource
import sys
from pathlib import Path

import pytest

from al_questioner.concepts.laplace.compiled import compiled


def test_a_full_disk_does_not_keep_the_compiled_from_being_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a robot whose disk is full could no longer decide anything."""
    (tmp_path / 'doubling.py').write_text('def double(x):\n    return 2 * x\n')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, 'dont_write_bytecode', True)
    import doubling

    double = compiled(doubling.double)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10, before[1]))
    try:
        assert double(21) == 42
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert [path.stat().st_size for path in tmp_path.rglob('*.nb?')] == []
