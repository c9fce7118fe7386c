"""Parameters that were given for another node than the one that got them: ROS passes over these in silence."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from al_questioner.domain import InputError
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.overrides import given_overrides
from al_questioner.support.configuration import NoMappingError, read_parameter_file, read_yaml

VALUES = 'ros__parameters'
"""Key below the name of a node in a parameter file."""
NEIGHBOURS = frozenset(('learner', 'perception', 'recogniser', 'recorder', 'replay', 'teacher'))
"""Names of our nodes, which may share a parameter file."""


def tell_what_has_no_effect(node: QuestionerNode, arguments: Sequence[str]) -> None:
    """Log which of a node's given parameters have no effect on it; what its neighbours have is no warning."""
    logger, own = node.get_logger(), node.get_fully_qualified_name()
    for source, names in _addressees(arguments, logger.warning):
        missed = _missed(names, own)
        if missed:
            are_neighbours = all(_last_part(name) in NEIGHBOURS - {node.get_name()} for name in missed)
            line = f'{source} sets parameters of {", ".join(missed)}: this node is {own} and takes none of these'
            (logger.info if are_neighbours else logger.warning)(line)
    for override in given_overrides(node):
        if not node.has_parameter(override):
            logger.warning(f'parameter {override} has no effect on {own}, which has no such end')


def with_doubts(reason: str, arguments: Sequence[str]) -> str:
    """Add to a refusal of parameters what ROS may have read in their files otherwise than it was meant."""
    files = dict.fromkeys(value for option, value in _sources(arguments) if option == '--params-file')
    return '; '.join([reason, *(doubt for file in files for doubt in _names_and_doubts(file)[1])])


def _missed(names: Sequence[str], own: str) -> list[str]:
    """Those of the names in a parameter file that were most likely meant for this node, and are not its own."""
    taken = [name for name in names if addresses(name, own)]
    if not taken:
        return list(names)
    namesakes = [name for name in names if _last_part(name) == _last_part(own)]
    # A file for several robots names each of them.
    return [] if set(taken) & set(namesakes) else namesakes


def _last_part(name: str) -> str:
    return name.rsplit('/', 1)[-1]


def addresses(pattern: str, name: str) -> bool:
    """Return whether a name in a parameter file, which may hold wildcards, is that of a node.

    >>> addresses('/**/learner', '/robot/learner'), addresses('learner', '/robot/learner')
    (True, False)
    """
    parts = {'**': r'(/\w+)*', '*': r'/\w+'}
    regex = ''.join(parts.get(part, f'/{re.escape(part)}') for part in pattern.strip('/').split('/'))
    return re.fullmatch(regex, name) is not None


def reject_files_without_parameters(arguments: Sequence[str]) -> None:
    """Refuse what ROS takes for a file without parameters.

    Raises:
        InputError: a parameter file is empty or holds no mapping; the text names it.
    """
    for option, value in _ros_options(arguments):
        if option == '--params-file':
            try:
                read_yaml(Path(value))
            except NoMappingError:
                raise
            except InputError:
                # To be told by the node that takes it.
                continue


def _addressees(arguments: Sequence[str], warn: Callable[[str], None]) -> Iterator[tuple[str, list[str]]]:
    """Every source of parameters among ROS arguments, and the names of the nodes that it speaks of."""
    for option, value in _sources(arguments):
        if option == '--params-file':
            yield value, list(_names_in(value, warn))
        else:
            node, colon, _ = value.split(':=', 1)[0].rpartition(':')
            yield f'-p {value}', [f'/{node.lstrip("/")}'] if colon else []


def _sources(arguments: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Return the options among ROS arguments that give parameters, each with its value."""
    found = _ros_options(arguments)
    return (pair for pair in found if pair[0] in ('--params-file', '-p', '--param'))


def _ros_options(arguments: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Return the ROS arguments, each with the one that follows it."""
    is_ros = False
    for option, value in pairwise([*arguments, '']):
        is_ros = option == '--ros-args' or (is_ros and option != '--')
        if is_ros:
            yield option, value


def _names_in(path: str, warn: Callable[[str], None]) -> Iterator[str]:
    names, doubts = _names_and_doubts(path)
    for doubt in doubts:
        # ROS has read it, and may take the last of two equal keys, or 010 for 8: the author should know.
        warn(f'{doubt}; ROS took the file all the same')
    yield from names


def _names_and_doubts(path: str) -> tuple[list[str], list[str]]:
    """Return the nodes that a parameter file names, and what ROS may read in it otherwise than it was meant."""
    try:
        content, doubts = read_parameter_file(Path(path))
    except InputError as error:
        return [], [str(error)] if Path(path).is_file() else []
    return list(_names_below('', content)), doubts


def _names_below(prefix: str, content: Mapping[str, Any]) -> Iterator[str]:
    for key, value in content.items():
        if not isinstance(value, Mapping):
            continue
        name = f'{prefix}/{str(key).strip("/")}'
        if VALUES in value:
            yield name
        else:
            yield from _names_below(name, value)
