"""The needs of ROS tools, for packages installed by pip and by colcon."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from al_questioner.cli import EXECUTABLES
from shared.checkout import ROOT


def test_ament_index_finds_the_package(installation, tmp_path):
    code = "from ament_index_python.packages import get_package_prefix; get_package_prefix('al_questioner')"
    found = installation.tell(code, tmp_path)
    assert Path(found).resolve() == installation.prefix.resolve()


def test_the_installed_package_is_what_runs(installation, source, tmp_path):
    module = Path(installation.tell('import al_questioner; al_questioner.__file__', tmp_path)).resolve()
    assert any(module.is_relative_to(place.resolve()) for place in (installation.prefix, source))
    assert not module.is_relative_to(ROOT)


def test_the_installed_package_has_its_types(installation, tmp_path):
    """Otherwise Mypy would take everything that is imported from it for Any."""
    code = 'from importlib.resources import files; (files("al_questioner") / "py.typed").is_file()'
    assert installation.tell(code, tmp_path) == 'True'


def test_manifest_configuration_and_launch_files_are_shared(installation):
    share = installation.prefix / 'share' / 'al_questioner'
    expected = [Path('package.xml'), Path('launch/demo.launch.py')]
    expected += [path.relative_to(ROOT) for path in (ROOT / 'config').rglob('*.*')]
    assert [str(path) for path in expected if not (share / path).is_file()] == []


def test_bags_and_examples_are_shared(installation, source):
    """Otherwise the commands of the README would work in a checkout alone."""
    share = installation.prefix / 'share' / 'al_questioner'
    for folder in (source / 'bags', source / 'docs' / 'examples'):
        files = {path: share / folder.name / path.relative_to(folder) for path in folder.rglob('*') if path.is_file()}
        assert [path for path, shared in files.items() if shared.read_bytes() != path.read_bytes()] == []


@pytest.mark.parametrize(
    ('call', 'file'), [("named_bag('expert_0')", 'metadata.yaml'), ('config_dir()', 'tasks/kitchen_table.yaml')]
)
def test_the_installed_bags_and_configuration_are_found(installation, tmp_path, call, file):
    folder = Path(installation.tell(f'from al_questioner.support.configuration import *; {call}', tmp_path))
    assert (folder / file).is_file()
    assert not folder.resolve().is_relative_to(ROOT)


def test_every_executable_is_where_ros2_run_looks_and_all_are_one_file(installation):
    """So that to run one of them is enough."""
    found = {path.name: path.read_bytes() for path in (installation.prefix / 'lib' / 'al_questioner').iterdir()}
    assert found.keys() == set(EXECUTABLES)
    assert len(set(found.values())) == 1


@pytest.mark.parametrize(
    'name', ['learner', *(pytest.param(name, marks=pytest.mark.slow) for name in EXECUTABLES if name != 'learner')]
)
def test_executable_runs(installation, name, tmp_path):
    if installation.tool == 'colcon' and name != 'learner':
        pytest.skip('learner stands for all')
    assert installation.run(installation.prefix / 'lib' / 'al_questioner' / name, '--help', cwd=tmp_path).strip()


def test_no_executable_lands_in_the_bin_folder(installation):
    """Otherwise names such as `demo` would shadow other people's commands."""
    folder = installation.prefix / 'bin'
    present = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    assert present.isdisjoint(EXECUTABLES)


@pytest.mark.skipif(sys.version_info < (3, 11), reason='Python 3.10 always looks into the working directory first')
def test_a_checkout_in_the_working_directory_does_not_shadow_the_installation(installation, tmp_path):
    (tmp_path / 'al_questioner').mkdir()
    (tmp_path / 'al_questioner' / '__init__.py').write_text("raise SystemExit('the wrong package')", encoding='utf-8')
    assert installation.run(installation.prefix / 'lib' / 'al_questioner' / 'demo', '--help', cwd=tmp_path)


@pytest.mark.skipif(shutil.which('ros2') is None, reason='no ros2 command on the PATH: only what it needs is tested')
def test_ros2_run(installation, tmp_path):
    assert installation.run('ros2', 'run', 'al_questioner', 'learner', '--help', cwd=tmp_path)
