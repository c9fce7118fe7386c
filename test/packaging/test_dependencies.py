"""Whatever the package imports is named for both package managers, pip and rosdep."""

from __future__ import annotations

import ast
import sys
from configparser import ConfigParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from packaging.requirements import Requirement

CHECKOUT = Path(__file__).resolve().parents[2]

DISTRIBUTIONS = {
    'cv2': ('opencv-python-headless', 'python3-opencv'),
    'joblib': ('joblib', 'python3-joblib'),
    'jsonschema': ('jsonschema', 'python3-jsonschema'),
    'matplotlib': ('matplotlib', 'python3-matplotlib'),
    'mcap': ('mcap', 'mcap-ros2-support'),
    'numba': ('numba', 'python3-numba'),
    'numpy': ('numpy', 'python3-numpy'),
    'prompt_toolkit': ('prompt_toolkit', 'python3-prompt-toolkit'),
    'rich': ('rich', 'python3-rich'),
    'rosbags': ('rosbags', 'python3-rosbags-pip'),
    'scipy': ('scipy', 'python3-scipy'),
    'yaml': ('PyYAML', 'python3-yaml'),
}
"""PyPI and rosdep name by imported module, for what is no part of ROS."""

OPTIONAL = {'dask'}
"""Imported only by those who ask for it."""

PIP_ALONE = {'mcap', 'rosbags'}
"""What Ubuntu has not: rosdep would fetch it with pip, which Ubuntu 24.04 refuses, so no node may need it."""


def imported_distributions() -> list[str]:
    """Top-level names of all that the package and its launch files import, but the standard library and itself."""
    found = set()
    for folder in ('al_questioner', 'launch'):
        for path in (CHECKOUT / folder).rglob('*.py'):
            for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
                if isinstance(node, ast.Import):
                    found |= {alias.name.split('.')[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                    found.add(node.module.split('.')[0])
    return sorted(found - set(sys.stdlib_module_names) - {'al_questioner'})


def rosdep_keys() -> set[str | None]:
    """What package.xml asks for at run time."""
    return {element.text for element in ElementTree.parse(CHECKOUT / 'package.xml').iter('exec_depend')}


def requirements(section: str, option: str) -> list[Requirement]:
    """A list of setup.cfg."""
    config = ConfigParser()
    config.read(CHECKOUT / 'setup.cfg', encoding='utf-8')
    return [Requirement(line) for line in config[section][option].split()]


def required_names(section: str, option: str) -> list[str]:
    """The names in a list of setup.cfg, without versions."""
    return [requirement.name for requirement in requirements(section, option)]


def versions_of_noble() -> dict[str, str]:
    """The versions of Ubuntu 24.04, by PyPI name."""
    lines = (CHECKOUT / 'test' / 'noble.txt').read_text(encoding='utf-8').splitlines()
    return dict(line.split('==') for line in lines if not line.startswith('#'))


def test_what_is_imported_only_when_wished_for_is_an_extra() -> None:
    """A user who wants a cluster would have to guess what to install."""
    assert 'dask' in required_names('options.extras_require', 'cluster')


@pytest.mark.parametrize('module', sorted(set(imported_distributions()) - OPTIONAL))
def test_an_imported_module_is_required(module: str) -> None:
    pypi, rosdep = DISTRIBUTIONS.get(module, (None, module))
    assert rosdep in rosdep_keys()
    assert pypi is None or pypi in required_names('options', 'install_requires')


def test_pip_requires_nothing_that_only_ros_can_bring() -> None:
    """A ROS installation knows its packages under no PyPI name: pip would fetch them a second time."""
    assert not [name for name in required_names('options', 'install_requires') if name.startswith('ros-')]


def test_what_ubuntu_has_is_new_enough_and_tested() -> None:
    """It is what rosdep installs: the package would fail where ROS 2 Jazzy runs, and no test would tell."""
    noble = versions_of_noble()
    of_ubuntu = [r for r in requirements('options', 'install_requires') if r.name not in PIP_ALONE]
    assert [r.name for r in of_ubuntu if r.name not in noble] == []
    asked = of_ubuntu + requirements('options.extras_require', 'test')
    assert [str(r) for r in asked if r.name in noble and not r.specifier.contains(noble[r.name])] == []
    assert [str(r) for r in of_ubuntu if not any(one.operator == '>=' for one in r.specifier)] == []
