"""The package as each route installs it, built from a copy so that nothing is left in the checkout."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pytest

from shared.checkout import ROOT

ROUTES = ('pip', pytest.param('pip [ros]', marks=pytest.mark.slow), 'colcon', 'colcon --symlink-install')


@dataclass(frozen=True)
class Installation:
    """Folder that a tool put the package into, its prefix for ament, and the environment of a shell that is set up."""

    tool: str
    prefix: Path
    environment: dict[str, str]

    def run(self, *command: str | Path, cwd: Path) -> str:
        """Run a command in this environment and return what it printed; it must succeed."""
        options = {'stdin': subprocess.DEVNULL, 'capture_output': True, 'text': True, 'timeout': 600}
        done = subprocess.run(command, cwd=cwd, env=self.environment, **options)
        assert done.returncode == 0, f'{command} ended with {done.returncode}\n{done.stdout}{done.stderr}'
        return done.stdout

    def tell(self, expression: str, cwd: Path) -> str:
        """Return the value of a Python expression there; it may begin with an import."""
        imports, _, value = expression.rpartition('; ')
        return self.run('python3', '-c', f'{imports}; print({value})', cwd=cwd).strip()


def libraries() -> list[str]:
    """The folders of installed packages that this process knows, but those that hold this package."""
    folders = [path for path in sys.path if Path(path).name in ('site-packages', 'dist-packages')]
    return [path for path in folders if not Path(path, 'al_questioner').exists()]


def outer_environment() -> dict[str, str]:
    """This process's environment without this package, and with this interpreter as `python3`."""
    environment = dict(os.environ)
    paths = [path for path in environment.pop('PYTHONPATH', '').split(os.pathsep) if path in libraries()]
    if paths:
        environment['PYTHONPATH'] = os.pathsep.join(paths)
    environment['PATH'] = os.pathsep.join([str(Path(sys.executable).parent), environment['PATH']])
    return environment


@pytest.fixture(scope='session')
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of all that is shipped, in a folder whose name has a space."""
    copy = tmp_path_factory.mktemp('work space') / 'al_questioner'
    not_shipped = {
        ROOT: {'build', 'install', 'log', 'out', 'test'},
        ROOT / 'docs': {path.name for path in (ROOT / 'docs').iterdir()} - {'examples'},
    }

    def ignored(folder: str, names: list[str]) -> set[str]:
        generated = {name for name in names if name.startswith('.') or name.endswith(('__pycache__', '.egg-info'))}
        return generated | not_shipped.get(Path(folder), set())

    shutil.copytree(ROOT, copy, symlinks=True, ignore=ignored)
    return copy


def install_with_pip(source: Path, place: Path, extras: str = '') -> Installation:
    """A new virtual environment, `pip install .`.

    With extras, all that the package asks for comes from the package index, which takes a minute; without, from this
    process's environment.
    """
    environment = outer_environment()
    prefix = place / 'venv'
    venv.create(prefix, symlinks=True, with_pip=True)
    python = prefix / 'bin' / 'python3'
    pip = (python, '-m', 'pip', '--quiet', '--disable-pip-version-check', 'install')
    if extras:
        Installation('pip', place, environment).run(*pip, f'{source}{extras}', cwd=place)
    else:
        Installation('pip', place, environment).run(*pip, '--no-deps', source, cwd=place)
        environment['PYTHONPATH'] = os.pathsep.join(libraries())
    environment['PATH'] = os.pathsep.join([str(python.parent), environment['PATH']])
    environment['AMENT_PREFIX_PATH'] = str(prefix)
    return Installation('pip', prefix, environment)


def run_colcon(outer: Installation, verb: str, source: Path, *options: str) -> None:
    """Run a verb of colcon on a package, with the place of an installation for the workspace."""
    pytest.importorskip('colcon_core', reason='colcon is not installed: pip install .[dev]')
    place = outer.prefix
    folders = ('--build-base', place / 'build', '--install-base', place / 'install', '--base-paths', source)
    outer.run(sys.executable, '-m', 'colcon', '--log-base', place / 'log', verb, *folders, *options, cwd=place)


def install_with_colcon(source: Path, place: Path, *options: str) -> Installation:
    """A workspace, built and sourced."""
    outer = Installation('colcon', place, outer_environment())
    run_colcon(outer, 'build', source, *options)
    # colcon's setup.bash does not quote the path of the interpreter it runs, which may lie in a folder with a space.
    outer.environment['COLCON_PYTHON_EXECUTABLE'] = str(Path(sys.base_prefix, 'bin', 'python3'))
    dump = outer.run('bash', '-c', 'source "$0" && env -0', place / 'install' / 'setup.bash', cwd=place)
    environment = dict(line.split('=', 1) for line in dump.split('\0') if '=' in line)
    return Installation('colcon', place / 'install' / 'al_questioner', environment)


@pytest.fixture(scope='session', params=ROUTES)
def installation(
    request: pytest.FixtureRequest, source: Path, tmp_path_factory: pytest.TempPathFactory
) -> Installation:
    """The package, installed by each route in turn."""
    tool, *options = request.param.split()
    install = {'pip': install_with_pip, 'colcon': install_with_colcon}[tool]
    return install(source, tmp_path_factory.mktemp(tool), *options)


@pytest.fixture
def workspace(tmp_path: Path) -> Callable[..., None]:
    """Runs a verb of colcon on a package, in a workspace of its own."""
    return partial(run_colcon, Installation('colcon', tmp_path, outer_environment()))
