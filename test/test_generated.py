"""Generated files are as their generator writes them."""

from __future__ import annotations

import runpy

import pytest

from shared.checkout import ROOT

FILES = runpy.run_path(str(ROOT / 'tools' / 'generate.py'))['FILES']


@pytest.mark.parametrize('path', FILES)
def test_a_generated_file_is_up_to_date(path: str) -> None:
    """Otherwise a user would read of settings as they were."""
    assert (ROOT / path).read_text(encoding='utf-8') == FILES[path](), 'run `make generated`'
