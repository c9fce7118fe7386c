"""Writes docs/reference/python_api.md: `make generated`.

That is the public names, their signatures, and the first line of their docstrings.
"""

from __future__ import annotations

import enum
import inspect
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

PAGE = Path(__file__).resolve().parents[1] / 'docs' / 'reference' / 'python_api.md'
MODULES = (
    'domain',
    'concepts',
    'concepts.concept_classifier',
    'questioning',
    'simulation',
    'experiments.pool_comparison',
    'perception',
    'event_log',
    'bags',
    'imitation.bags',
    'imitation.demonstration',
    'imitation.settings',
    'imitation.training',
)
HEAD = """\
# Python API

<!-- Written by `make generated` from the docstrings: change those. -->

`help(NAME)` shows the whole docstrings, and so does the site that `make docs` builds. There are
[examples](../how_to/use_it_in_python.md).

Import the names from the module under which they stand. `import al_questioner` itself offers these, each of which is
imported when it is asked for:

{face}.
"""


class Plain(str):
    """A text that stands in a signature as it is."""

    __slots__ = ()
    __repr__ = str.__str__


def public_names(module: ModuleType) -> list[str]:
    """Return what a module exports, or, if it does not say, what it defines."""
    own = (name for name, thing in vars(module).items() if getattr(thing, '__module__', '') == module.__name__)
    return sorted(getattr(module, '__all__', None) or (name for name in own if not name.startswith('_')))


def default(value: object) -> object:
    """Return a default as it is shown: functions by their names, larger things left out."""
    if value is inspect.Parameter.empty or isinstance(value, (bool, int, float, str, tuple, type(None))):
        return value
    return Plain(getattr(value, '__name__', '...'))


def signature(thing: object) -> str:
    """Return the signature of a function or class, its annotations as they stand in the source."""
    found = inspect.signature(thing)  # type: ignore[arg-type]
    shown = [
        each.replace(
            annotation=Plain(each.annotation) if isinstance(each.annotation, str) else each.annotation,
            default=default(each.default),
        )
        for each in found.parameters.values()
        if each.name != 'self'
    ]
    result = found.return_annotation
    if inspect.isclass(thing):
        result = inspect.Signature.empty
    elif isinstance(result, str):
        result = Plain(result)
    return str(found.replace(parameters=shown, return_annotation=result))


def first_line(thing: object) -> str:
    """Return the first sentence of a docstring that a thing has itself."""
    text = inspect.getdoc(thing) or ''
    return ' '.join(text.partition('\n\n')[0].split())


def members(kind: type) -> Iterator[str]:
    """Yield a line for each public method and property that a class defines."""
    for name, thing in vars(kind).items():
        function = getattr(thing, '__func__', thing)
        is_added = type(thing).__module__.startswith('sklearn')
        if name.startswith('_') or is_added or not hasattr(thing, '__get__') or not first_line(function):
            continue
        yield f'- `{name}{signature(function) if inspect.isfunction(function) else ""}`: {first_line(function)}'


def has_entry(thing: object) -> bool:
    """Return whether a public name is a class or a function; Python 3.10 takes `list[int]` for a class."""
    return inspect.isfunction(thing) or (inspect.isclass(thing) and not hasattr(thing, '__origin__'))


def entry(name: str, thing: object) -> Iterator[str]:
    """Yield the lines of one public name."""
    yield f'### {name}\n'
    if inspect.isclass(thing):
        if issubclass(thing, enum.Enum):
            yield f'{first_line(thing)} One of {", ".join(f"`{member.name}`" for member in thing)}.\n'
            return
        is_plain = not issubclass(thing, Exception) and not getattr(thing, '_is_protocol', False)
        yield f'`{name}{signature(thing) if is_plain else ""}`\n'
        yield f'{first_line(thing)}\n'
        yield from (lines := list(members(thing)))
        if lines:
            yield ''
    else:
        yield f'`{name}{signature(thing)}`\n'
        yield f'{first_line(thing)}\n'


def other(name: str, thing: object) -> str:
    """Return the line of a constant or a type."""
    if isinstance(thing, (bool, int, float, str, tuple)):
        return f'- `{name} = {thing!r}`'
    return f'- `{name}`: a {"table" if isinstance(thing, dict) else "type"}'


def page() -> str:
    """Return the whole page."""
    face = import_module('al_questioner')
    lines = [HEAD.format(face=', '.join(f'`{name}`' for name in face.__all__))]
    for path in MODULES:
        module = import_module(f'al_questioner.{path}')
        lines += [f'## al_questioner.{path}\n', f'{first_line(module)}\n']
        named = {name: getattr(module, name) for name in public_names(module)}
        described = {name: thing for name, thing in named.items() if has_entry(thing)}
        lines += [line for name, thing in described.items() for line in entry(name, thing)]
        if others := [other(name, thing) for name, thing in named.items() if name not in described]:
            lines += [f'### Constants and types of {path}\n', *others, '']
    return '\n'.join(lines).rstrip() + '\n'


if __name__ == '__main__':
    PAGE.write_text(page(), encoding='utf-8')
