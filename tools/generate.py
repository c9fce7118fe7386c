"""Writes what is generated from the declarations of settings and options: `make generated`.

That is a parameter file for each task in `config/params`, and the tables of parameters and options in `docs/reference`.
"""

from __future__ import annotations

import argparse
import importlib
import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import zip_longest
from pathlib import Path
from typing import Any

from al_questioner.cli import EXECUTABLES
from al_questioner.domain import Setting
from al_questioner.domain.setting import LARGEST_AMOUNT, LARGEST_INTEGER
from al_questioner.ros.settings import (
    LEARNER_SETTINGS,
    PERCEPTION_SETTINGS,
    RECOGNISER_SETTINGS,
    RECORDER_SETTINGS,
    TEACHER_SETTINGS,
    WAIT_FOR_RECORDER,
    WORLD_SETTINGS,
    Settings,
    learner_settings,
)
from al_questioner.simulation import load_task
from al_questioner.simulation.world_spec import TASK
from al_questioner.support.arguments import DEFAULT, NumberWithin
from al_questioner.support.configuration import shipped_names

ROOT = Path(__file__).resolve().parent.parent
COMMENT_COLUMN, LINE_LENGTH = 27, 130
"""Characters of a parameter file."""
TYPES = {str: 'string', int: 'integer', float: 'double', bool: 'boolean'}
"""Names of the types of ROS parameters."""
NOTE = '<!-- Written by `make generated` from the declarations in the code: change those. -->'
COMMON = 'all of them'
PARAMETERS = """\
A node reads its parameters once, when it starts: `--ros-args -p NAME:=VALUE`, or `--ros-args --params-file FILE`.
For each task that ships, `config/params` has a file with all parameters of all nodes at their defaults."""
COMMANDS = 'After `ros2 run al_questioner`, or with pip `python -m al_questioner`, comes the name, then the options.'
ABOVE = {
    COMMON: """\
Perception, learner and teacher have these, and must have the same `task`, `dataset`, `seed` and `sample`.""",
    'learner': """\
A task can have its own `strategy`, `budget`, `turns`, `change_interval`, costs and charges: see its parameter file. The
defaults here are those of a task that has none of its own.""",
    'recognise': 'The node is called `recogniser`. Give `concepts`, or `session`, or neither.',
    'record': 'The node is called `recorder`.',
}
"""Texts above the tables."""


def parts_of(learner: Settings) -> Mapping[str, Settings]:
    """Return the parameters by the executable that has them, those of several first."""
    own = {
        'perception': PERCEPTION_SETTINGS,
        'learner': learner,
        'teacher': TEACHER_SETTINGS,
        'recognise': RECOGNISER_SETTINGS,
        'record': RECORDER_SETTINGS,
    }
    common = (*WORLD_SETTINGS, WAIT_FOR_RECORDER)
    names = {each.name for each in common}
    return {COMMON: common} | {part: [each for each in own[part] if each.name not in names] for part in own}


def parameter_file(name: str) -> str:
    """Return the parameters of all nodes for a task, at their defaults."""
    task = load_task(name)
    lines = [
        f'# Parameters of all nodes for the task {name}, at their defaults.',
        f'# ros2 run al_questioner learner --ros-args --params-file {name}.yaml',
        '# task, dataset, seed and sample must be the same for all three.',
        '# One list for all nodes: entries for a single node would prevail over -p on the command line.',
        '',
        '/**:',
        '  ros__parameters:',
    ]
    # What depends on the sample has no value of its own.
    unset = {'sample': '', **({'change_interval': '; unless set, that of its kitchen'} if task.variety else {})}
    notes = {**unset, **({'dataset': ': needed here'} if task.source == 'dataset' else {})}
    written: set[str] = set()
    for part, settings in parts_of(learner_settings(task)).items():
        lines.append(f'    # {part}')
        for each in settings:
            if each.name in written:
                # A parameter that two nodes have under one name; a key stands once in a file.
                continue
            written.add(each.name)
            text = f'    {"# " if each.name in unset else ""}{each.name}: {yaml_of(each.default)}'
            is_task = each is TASK
            lines += [f'    task: {name}'] if is_task else commented(text, each.explained + notes.get(each.name, ''))
        lines.append('')
    return '\n'.join(lines)


def commented(text: str, comment: str) -> Iterator[str]:
    """Return the lines of a parameter with its comment beside it."""
    column = max(COMMENT_COLUMN, len(text) + 2)
    for beside, line in zip_longest([text], textwrap.wrap(comment, LINE_LENGTH - column - 2), fillvalue=''):
        yield f'{beside:<{column}}# {line}'


def yaml_of(value: object) -> str:
    """Return a default as it stands in a parameter file."""
    return str(value).lower() if isinstance(value, bool) else str(value) or '""'


def table(*rows: Iterable[str]) -> str:
    """Return a table of Markdown; its first row is the head."""
    head, *others = (f'| {" | ".join(cell.replace("|", chr(92) + "|") for cell in row)} |' for row in rows)
    return '\n'.join([head, re.sub('[^|]+', '---', head.replace(chr(92) + '|', '')), *others])


def parameters_page() -> str:
    """Return the tables of the parameters of every node."""
    parts = ['# Parameters', NOTE, PARAMETERS]
    for part, settings in parts_of(LEARNER_SETTINGS).items():
        parts += [f'## {part}', *([ABOVE[part]] if part in ABOVE else [])]
        head = ('parameter', 'type', 'default', 'range', 'unit', 'what it is')
        parts.append(table(head, *map(parameter_row, settings)))
    return '\n\n'.join(parts) + '\n'


def parameter_row(each: Setting[Any]) -> tuple[str, ...]:
    """Return the cells of a parameter."""
    kind = f'double or `{each.word}`' if each.word else TYPES[type(each.default)]
    accepted = each.limits or quoted(each.choices)
    return f'`{each.name}`', kind, f'`{yaml_of(each.default)}`', accepted, each.unit, each.description


def commands_page() -> str:
    """Return the tables of the options of every executable."""
    parts = ['# Commands', NOTE, COMMANDS]
    for name, (parse, _, description) in EXECUTABLES.items():
        module = importlib.import_module(parse.partition(':')[0])
        parts += [f'## {name}', f'{description[0].upper()}{description[1:]}.']
        if hasattr(module, 'parser'):
            parser = module.parser()
            rows = (option_row(action) for action in parser._actions if action.dest != 'help')
            parts.append(table(('option', 'default', 'range', 'unit', 'what it does'), *rows))
            parts += [f'{parser.epilog[0].upper()}{parser.epilog[1:]}.'] if parser.epilog else []
        else:
            parts.append(f'It has [parameters](parameters.md#{name}): `{name} --ros-args -p NAME:=VALUE`.')
    return '\n\n'.join(parts) + '\n'


def quoted(choices: Iterable[str]) -> str:
    """Return names as code in a cell."""
    return ', '.join(f'`{choice}`' for choice in choices)


def option_row(action: argparse.Action) -> tuple[str, ...]:
    """Return the cells of an option."""
    value = str(action.metavar or action.dest.upper())
    value = {'+': f'{value} ...', '*': f'[{value} ...]', '?': f'[{value}]', 0: ''}.get(action.nargs, value)
    option = ' '.join(filter(None, [*action.option_strings, value]))
    default = ' '.join(map(str, action.default)) if isinstance(action.default, list) else action.default
    shown = '' if default in (None, '') or default is False else f'`{default}`'
    told = re.sub(rf' ?\({re.escape(DEFAULT)}\)', '', action.help or '').replace(f'{DEFAULT}, ', '')
    description, unit, rest = re.fullmatch(r'(.*?)(?: \[(.+?)\])?( \(.*)?', told).groups(default='')
    return f'`{option}`', shown, range_of(action), unit, description + rest


def range_of(action: argparse.Action) -> str:
    """Return what an option accepts, if there are limits."""
    if action.choices:
        return quoted(action.choices)
    kind = action.type
    if not isinstance(kind, NumberWithin):
        return ''
    is_open = kind.upper in (LARGEST_AMOUNT, LARGEST_INTEGER)
    return f'{kind.lower:g} or more' if is_open else f'{kind.lower:g} to {kind.upper:g}'


FILES: Mapping[str, Callable[[], str]] = {
    **{f'config/params/{name}.yaml': partial(parameter_file, name) for name in shipped_names('tasks')},
    'docs/reference/parameters.md': parameters_page,
    'docs/reference/commands.md': commands_page,
}
"""Functions that make the content of each generated file."""


if __name__ == '__main__':
    for path, content in FILES.items():
        (ROOT / path).parent.mkdir(parents=True, exist_ok=True)
        (ROOT / path).write_text(content(), encoding='utf-8')
