"""The rules of the house, held against the source text: which module may import which."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest

import al_questioner
from shared.checkout import ROOT

PACKAGE = 'al_questioner'

LAYERS = (
    {'domain'},
    {'support'},
    {'concepts', 'messages', 'perception'},
    {'questioning'},
    {'event_log', 'simulation'},
    {'bags', 'protocol', 'terminal'},
    {'imitation', 'experiments', 'ros'},
    {'commands'},
    {'cli'},
    {'__main__'},
)
"""Each room may import those further up in this list, and none of its own row."""

APART = {('event_log', 'simulation'), ('protocol', 'simulation')}
"""Rooms, the first of which may not import the second wherever that lies: no learner is ever near the truth."""

RANK = {room: rank for rank, rooms in enumerate(LAYERS) for room in rooms}


def imported_modules(source: str, module: str, is_package: bool = False) -> Iterator[str]:
    """Absolute names of all modules that a source imports, wherever in the text, functions and constant names included.

    `from a import b` gives `a.b`, as b may be a module.
    """
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            ancestors = module.split('.')[: None if is_package else -1]
            base = ancestors[: len(ancestors) - node.level + 1] if node.level else []
            prefix = '.'.join([*base, *([node.module] if node.module else [])])
            yield from (f'{prefix}.{alias.name}' for alias in node.names)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            called = getattr(node.func, 'attr', getattr(node.func, 'id', None))
            if called in ('import_module', '__import__', 'late') and isinstance(node.args[0].value, str):
                yield node.args[0].value


def is_ros(module: str) -> bool:
    """Return whether a module is rclpy, another part of ROS, or a generated message package."""
    top = module.split('.')[0]
    return top in ('rclpy', 'ament_index_python', 'launch', 'launch_ros') or top.endswith(('_msgs', '_interfaces'))


def violations(source: str, module: str, is_package: bool = False) -> list[str]:
    """Return the imports of a module that break the rules."""
    room = module.split('.')[1]
    found = []
    for imported in imported_modules(source, module, is_package):
        parts = imported.split('.')
        if is_ros(imported) and room != 'ros':
            found.append(f'{module} imports {imported}; only {PACKAGE}.ros may')
        if parts[0] != PACKAGE or parts[1:] == ['__version__']:
            continue
        other = parts[1] if len(parts) > 1 else ''
        # The names of the root have no rank: they lead, lazily, into any room.
        if other not in RANK or (other != room and RANK[other] >= RANK[room]) or (room, other) in APART:
            found.append(f'{module} imports {imported}, which does not lie below it')
    return found


def module_name(path: Path) -> str:
    """Dotted name of a source file of the package."""
    return '.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__')


def modules_after(program: str) -> list[str]:
    """The modules that a program leaves loaded."""
    told = f'{program}\nimport sys; print(*sys.modules, file=sys.stderr)'
    ended = subprocess.run([sys.executable, '-c', told], capture_output=True, text=True, check=True, cwd=ROOT)
    return ended.stderr.splitlines()[-1].split()


def test_every_import_goes_downwards_and_ros_stays_in_its_room() -> None:
    found = []
    for path in sorted((ROOT / PACKAGE).rglob('*.py')):
        module = module_name(path)
        if module != PACKAGE:
            found += violations(path.read_text(encoding='utf-8'), module, path.name == '__init__.py')
    assert not found, '\n'.join(found)


def test_every_folder_is_a_package() -> None:
    """A folder that setuptools does not find is not installed, which a checkout would hide."""
    folders = {path.parent for path in (ROOT / PACKAGE).rglob('*.py')}
    assert [str(folder) for folder in sorted(folders) if not (folder / '__init__.py').is_file()] == []


def test_the_tests_have_the_folders_of_the_package() -> None:
    """The tests of a module are found in the folder of its name."""
    folders = {path.parent.relative_to(ROOT / 'test') for path in (ROOT / 'test').rglob('test_*.py')}
    mirrored = {folder for folder in folders if folder.parts[:1] not in ((), ('benchmarks',), ('packaging',))}
    assert [str(folder) for folder in sorted(mirrored) if not (ROOT / PACKAGE / folder).is_dir()] == []


def test_no_module_stands_loose() -> None:
    """A newcomer sees from the folders where a thing lives."""
    assert {path.name for path in (ROOT / PACKAGE).glob('*.py')} == {'__init__.py', '__main__.py', 'cli.py'}


LEARNER_HELP = """
import runpy, sys
sys.argv = ['al_questioner', 'learner', '--help']
try:
    runpy.run_module('al_questioner', run_name='__main__')
except SystemExit:
    pass"""
LEARNER_SETTINGS = """
from al_questioner.simulation import WorldSpec, episode_settings, load_task
episode_settings(WorldSpec(load_task('kitchen_table'), 0, 0).task)"""


@pytest.mark.parametrize('program', [LEARNER_HELP, 'import al_questioner.ros.nodes.learner', LEARNER_SETTINGS])
def test_the_learner_loads_no_simulated_kitchen(program: str) -> None:
    """Otherwise a robot would wait for the drawing of foods that it never sees."""
    loaded = modules_after(program)
    assert 'al_questioner.simulation.task' in loaded
    assert [name for name in loaded if 'kitchen' in name or 'rgbd_dataset' in name] == []


def test_the_package_alone_loads_nothing() -> None:
    """The import of a single name, or of the version, does not wait for numpy and scipy."""
    ours = {name for name in modules_after('import al_questioner') if name.startswith(PACKAGE)}
    assert ours == {PACKAGE, f'{PACKAGE}.support', f'{PACKAGE}.support.lazy_names'}


def test_every_room_has_its_place_in_the_order() -> None:
    rooms = {module_name(path).split('.')[1] for path in (ROOT / PACKAGE).rglob('*.py') if module_name(path) != PACKAGE}
    assert rooms <= RANK.keys(), f'say in LAYERS where these belong: {sorted(rooms - RANK.keys())}'


@pytest.mark.parametrize(
    ('module', 'source'),
    [
        ('al_questioner.concepts.concept_models', 'from al_questioner.questioning import Episode'),
        ('al_questioner.concepts.concept_models', 'from al_questioner import questioning'),
        ('al_questioner.concepts.concept_models', 'from ..questioning import Episode'),
        ('al_questioner.concepts.concept_models', 'from .. import questioning'),
        ('al_questioner.concepts.concept_models', 'def late():\n    import al_questioner.questioning.episode'),
        ('al_questioner.concepts.concept_models', "importlib.import_module('al_questioner.questioning')"),
        ('al_questioner.protocol.learner', 'from al_questioner.simulation import WorldSpec'),
        ('al_questioner.simulation.playing', 'from al_questioner.event_log import log'),
        ('al_questioner.perception.scene', 'from ..concepts.concept_models import ConceptModels'),
        ('al_questioner.concepts.concept_models', "late('al_questioner.simulation.task', 'load_task')"),
        ('al_questioner.concepts.concept_models', 'from al_questioner import Episode'),
        ('al_questioner.concepts.concept_models', 'import al_questioner'),
        ('al_questioner.domain.names', 'from .. import Episode'),
        ('al_questioner.domain', 'from al_questioner import support'),
        ('al_questioner.messages.clouds', 'from sensor_msgs.msg import PointCloud2'),
        ('al_questioner.commands.demo.progress', 'if True:\n    import rclpy.node'),
        ('al_questioner.bags.reading', "__import__('rcl_interfaces.msg')"),
    ],
)
def test_the_check_sees_a_forbidden_import(module: str, source: str) -> None:
    assert len(violations(source, module)) == 1


@pytest.mark.parametrize(
    ('module', 'source', 'is_package'),
    [
        ('al_questioner.questioning.episode', 'from ..concepts import concept_models', False),
        ('al_questioner.questioning', 'from .episode import Episode', True),
        ('al_questioner.questioning', 'from ..domain import Scene', True),
        ('al_questioner.questioning.episode', 'from . import candidates', False),
        ('al_questioner.ros.nodes.learner', 'from std_msgs.msg import String', False),
        ('al_questioner.cli', 'from al_questioner import __version__', False),
    ],
)
def test_the_check_lets_a_permitted_import_pass(module: str, source: str, is_package: bool) -> None:
    assert violations(source, module, is_package) == []


def test_the_ros_manifest_has_the_version_of_the_python_package() -> None:
    assert ElementTree.parse(ROOT / 'package.xml').findtext('version') == al_questioner.__version__
