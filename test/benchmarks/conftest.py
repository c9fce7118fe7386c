"""The benchmarks are scripts: their folder is where they import from."""

from __future__ import annotations

import pytest

from checkout import ROOT

BENCHMARKS = ROOT / 'benchmarks'


@pytest.fixture(autouse=True)
def _as_in_a_script(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(BENCHMARKS))
