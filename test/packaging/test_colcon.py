"""`colcon test` runs the tests."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest

TESTS = """
import pytest

def test_quick():
    import al_questioner

@pytest.mark.slow
def test_slow():
    raise SystemExit('a change should not wait for this')
"""


@pytest.mark.slow
def test_colcon_runs_all_tests_but_the_slow_ones(source: Path, workspace, tmp_path: Path) -> None:
    """Otherwise it would say that there is no test, and fail."""
    package = tmp_path / 'al_questioner'
    shutil.copytree(source, package, symlinks=True)
    (package / 'test').mkdir()
    (package / 'test' / 'test_two.py').write_text(TESTS, encoding='utf-8')
    workspace('build', package)
    workspace('test', package, '--return-code-on-test-failure')
    (suite,) = ElementTree.parse(tmp_path / 'build' / 'al_questioner' / 'pytest.xml').iter('testsuite')
    assert [suite.get(name) for name in ('tests', 'errors', 'failures', 'skipped')] == ['1', '0', '0', '0']
