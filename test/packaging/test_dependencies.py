"""Whatever the package imports is named for both package managers, pip and rosdep."""

from __future__ import annotations

import ast
import subprocess
import sys
from configparser import ConfigParser
from xml.etree import ElementTree

import pytest
from packaging.requirements import Requirement

from al_questioner.support.missing_modules import FOR_BAGS
from shared.checkout import ROOT

DISTRIBUTIONS = {
    'cv2': ('opencv-python-headless', 'python3-opencv'),
    'joblib': ('joblib', 'python3-joblib'),
    'jsonschema': ('jsonschema', 'python3-jsonschema'),
    'matplotlib': ('matplotlib', 'python3-matplotlib'),
    'mcap': ('mcap', None),
    'numba': ('numba', 'python3-numba'),
    'numpy': ('numpy', 'python3-numpy'),
    'prompt_toolkit': ('prompt_toolkit', 'python3-prompt-toolkit'),
    'rich': ('rich', 'python3-rich'),
    'rosbags': ('rosbags', None),
    'scipy': ('scipy', 'python3-scipy'),
    'yaml': ('PyYAML', 'python3-yaml'),
}
"""PyPI and rosdep name by imported module, for what is no part of ROS; no rosdep name of what Ubuntu does not have.

What rosdep would fetch with pip, Ubuntu 24.04 refuses to install.
"""

OPTIONAL = {'dask', 'sklearn', 'vision_msgs'}
"""Imported only by those who ask for it, or where it is there."""


def imported_distributions() -> list[str]:
    """Top-level names of all that the package and its launch files import, but the standard library and itself."""
    found = set()
    for folder in ('al_questioner', 'launch'):
        for path in (ROOT / folder).rglob('*.py'):
            for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
                if isinstance(node, ast.Import):
                    found |= {alias.name.split('.')[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                    found.add(node.module.split('.')[0])
    return sorted(found - set(sys.stdlib_module_names) - {'al_questioner'})


def rosdep_keys(kind: str = 'exec_depend') -> set[str]:
    """Return the packages that package.xml asks for, at run time or for the tests."""
    return {str(element.text) for element in ElementTree.parse(ROOT / 'package.xml').iter(kind)}


def requirements(section: str, option: str) -> list[Requirement]:
    """A list of setup.cfg."""
    config = ConfigParser()
    config.read(ROOT / 'setup.cfg', encoding='utf-8')
    return [Requirement(line) for line in config[section][option].split()]


def required_names(section: str, option: str) -> list[str]:
    """The names in a list of setup.cfg, without versions."""
    return [requirement.name for requirement in requirements(section, option)]


def versions_of_noble() -> dict[str, str]:
    """The versions of Ubuntu 24.04, by PyPI name."""
    lines = (ROOT / 'test' / 'noble.txt').read_text(encoding='utf-8').splitlines()
    return dict(line.split('==') for line in lines if not line.startswith('#'))


def test_what_is_imported_only_when_wished_for_is_an_extra() -> None:
    """Otherwise a user who wants a cluster, or the estimator, would have to guess what to install."""
    assert 'dask' in required_names('options.extras_require', 'cluster')
    estimator = requirements('options.extras_require', 'sklearn')
    assert estimator == [r for r in requirements('options.extras_require', 'test') if r.name == 'scikit-learn']


@pytest.mark.parametrize('module', sorted(set(imported_distributions()) - OPTIONAL))
def test_an_imported_module_is_required(module: str) -> None:
    pypi, rosdep = DISTRIBUTIONS.get(module, (None, module))
    assert rosdep in rosdep_keys() or (rosdep is None and module in FOR_BAGS)
    assert pypi is None or pypi in required_names('options', 'install_requires')


def test_pip_requires_nothing_that_only_ros_can_bring() -> None:
    """Otherwise pip would fetch again what a ROS installation has, under names that PyPI does not know."""
    assert not [name for name in required_names('options', 'install_requires') if name.startswith('ros-')]


def test_rosdep_fetches_nothing_with_pip() -> None:
    """Otherwise Ubuntu 24.04 refuses it, and the installation would end there."""
    pip_keys = [key for key in rosdep_keys() | rosdep_keys('test_depend') if key.endswith('-pip') or 'mcap' in key]
    assert pip_keys == []


def test_what_ubuntu_has_is_new_enough_and_tested() -> None:
    """Otherwise the package would fail with what rosdep installs for ROS 2 Jazzy, and no test would tell."""
    noble = versions_of_noble()
    of_ubuntu = [r for r in requirements('options', 'install_requires') if r.name not in FOR_BAGS]
    assert [r.name for r in of_ubuntu if r.name not in noble] == []
    asked = of_ubuntu + requirements('options.extras_require', 'test')
    assert [str(r) for r in asked if r.name in noble and not r.specifier.contains(noble[r.name])] == []
    assert [str(r) for r in of_ubuntu if not any(one.operator == '>=' for one in r.specifier)] == []


@pytest.mark.parametrize('module', FOR_BAGS)
def test_what_bags_need_is_told_as_it_is_required(module: str) -> None:
    """Otherwise people would install a version that cannot write bags."""
    assert Requirement(FOR_BAGS[module]) in requirements('options', 'install_requires')
    assert f"'{FOR_BAGS[module]}'" in (ROOT / 'docs' / 'how_to' / 'install.md').read_text(encoding='utf-8')


def without_bags(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run code where nothing is installed that only bags need."""
    blocked = f'import sys; sys.modules.update(dict.fromkeys({list(FOR_BAGS)})); '
    return subprocess.run([sys.executable, '-c', blocked + code, *arguments], capture_output=True, text=True)


def test_all_but_bags_works_without_what_bags_need() -> None:
    """A robot has nothing but what rosdep installs."""
    nodes = ('learner', 'perception', 'teacher')
    modules = [f'al_questioner.ros.nodes.{name}' for name in nodes]
    modules += [f'al_questioner.commands.{name}.command' for name in ('demo', 'experiment', 'session')]
    done = without_bags('from importlib import import_module; [import_module(name) for name in sys.argv[1:]]', *modules)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    'arguments',
    [('replay', 'expert_0'), ('train_weights', 'expert_0', '--out', 'w.yaml'), ('record', '--repair', 'expert_0')],
)
def test_bags_say_what_they_need(arguments: tuple[str, ...]) -> None:
    """Otherwise there would be a traceback, or advice that does not help."""
    done = without_bags('from al_questioner.cli import main; sys.exit(main(sys.argv[1:]))', *arguments)
    assert done.returncode == 2
    assert done.stderr.startswith(f'{arguments[0]}: ')
    assert done.stderr.count('\n') == 1
    assert f"pip install '{FOR_BAGS['rosbags']}' '{FOR_BAGS['mcap']}'" in done.stderr
