"""Location and reading of the YAML files that ship with the package."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from al_questioner.domain import InputError
from al_questioner.domain.names import suggestion
from al_questioner.support import strict_yaml


@lru_cache(maxsize=1)
def config_dir() -> Path:
    """Return the folder that holds `tasks/`, `weights/` and `params/`.

    In a source checkout it lies beside the package. pip, colcon and Debian install it as `share/al_questioner/config`
    somewhere above the package.

    Raises:
        InputError: neither place exists.
    """
    package = Path(__file__).resolve().parents[1]
    installed = (parent / 'share' / 'al_questioner' / 'config' for parent in package.parents)
    for candidate in (package.parent / 'config', *installed):
        if (candidate / 'tasks').is_dir():
            return candidate
    raise InputError(f'the configuration of al_questioner is not installed: no config/tasks found above {package}')


def named_file(folder: str, name_or_path: str, what: str) -> Path:
    """Return the YAML file of a name that ships in `config/FOLDER`, or of a path that the user gives.

    Raises:
        InputError: neither exists; the text lists the known names.
    """
    shipped = config_dir() / folder / f'{name_or_path}.yaml'
    if shipped.is_file():
        return shipped
    path = Path(name_or_path).expanduser()
    if path.suffix in ('.yaml', '.yml'):
        if path.is_file():
            return path
        raise InputError(f'{what} file {name_or_path} does not exist')
    if path.is_file():
        raise InputError(f'{name_or_path} is no {what} file: the name of one ends in .yaml')
    known = shipped_names(folder)
    hint = suggestion(name_or_path, known)
    raise InputError(f'unknown {what} {name_or_path!r}; known: {", ".join(known)}, or the path of a YAML file{hint}')


def named_bag(name_or_path: str) -> Path:
    """Return the bag at a path, or else the shipped bag of that name, in the folder `bags` beside `config`.

    Raises:
        InputError: there is none.
    """
    path, shipped = Path(name_or_path), config_dir().parent / 'bags' / name_or_path
    if path.exists():
        return path
    if not (shipped / 'metadata.yaml').is_file():
        raise InputError(f'{path}: there is no such bag')
    return shipped


def shipped_names(folder: str) -> list[str]:
    """Return the names in `config/FOLDER`."""
    return sorted(path.stem for path in (config_dir() / folder).glob('*.yaml'))


class NoMappingError(InputError):
    """A YAML file that is empty, or holds something other than a mapping."""


def read_yaml(path: Path) -> Mapping[str, Any]:
    """Return the mapping that a YAML file holds.

    Raises:
        InputError: the file cannot be read, is not YAML, holds something other than a mapping, or has an ambiguous
            value or key, see `strict_yaml`; the text names the file and, if there is one, the line.
    """
    return _mapping_in(path, strict_yaml.parse)


def read_parameter_file(path: Path) -> tuple[Mapping[str, Any], list[str]]:
    """Return the mapping in a parameter file of ROS, and the faults of values that ROS may read in another way.

    Raises:
        InputError: the file cannot be read, is not YAML, or holds something other than a mapping.
    """
    doubts: list[yaml.MarkedYAMLError] = []

    def parse(content: bytes) -> Any:
        found, doubts[:] = strict_yaml.parse_for_ros(content)
        return found

    return _mapping_in(path, parse), [_described(path, doubt) for doubt in doubts]


def _mapping_in(path: Path, parse: Callable[[bytes], Any]) -> Mapping[str, Any]:
    try:
        with path.open('rb') as file:
            content = parse(file.read(strict_yaml.MOST_BYTES + 1))
    except OSError as error:
        raise InputError(f'{path}: cannot be read ({error.strerror})') from error
    except yaml.MarkedYAMLError as error:
        raise InputError(_described(path, error)) from error
    if not isinstance(content, Mapping):
        found = 'nothing' if content is None else type(content).__name__
        raise NoMappingError(f'{path}: expected a mapping of settings, found {found}')
    return content


def _described(path: Path, error: yaml.MarkedYAMLError) -> str:
    mark = error.problem_mark or error.context_mark
    line = f', line {mark.line + 1}' if mark else ''
    reason = ' '.join(', '.join(part for part in (error.context, error.problem) if part).split())
    fault = reason if isinstance(error, strict_yaml.RefusedYAMLError) else f'not valid YAML ({reason})'
    return f'{path}{line}: {fault}'
