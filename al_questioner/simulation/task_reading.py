"""Reading a section of a task file into a frozen dataclass whose fields say what they accept."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import MISSING, field, fields
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from al_questioner.domain import COST_RELEVANCE, COSTS, NEVER, Costs, InputError, QueryKind, Setting, SettingsError
from al_questioner.domain.names import check_names, suggestion
from al_questioner.domain.spelling import composed
from al_questioner.questioning.strategies.names import check_strategy

Reader = Callable[[Any, str], Any]
Section = TypeVar('Section')


class Interval(NamedTuple):
    """The ends of a uniform distribution."""

    low: float
    high: float


def setting(reader: Reader, default: Any = MISSING) -> Any:
    """Make a field for `read_section`: `reader(value, where)` returns the value or raises InputError."""
    if isinstance(default, Mapping):
        return field(default_factory=lambda: default, metadata={'reader': reader})
    return field(default=default, metadata={'reader': reader})


def declared(each: Setting[Any]) -> Any:
    """Make the dataclass field of a number that is declared as a setting."""
    if type(each.default) is int:
        return setting(whole(int(each.lower), int(each.largest)), each.default)
    return setting(number(each.lower, each.largest), each.default)


def read_section(section: type[Section], content: Any, where: str) -> Section:
    """Make an instance of the dataclass `section` from the mapping that a YAML file holds.

    Args:
        section: a frozen dataclass all of whose fields were made by `setting`.
        content: what the file holds.
        where: file and key, named in errors.

    Raises:
        InputError: not a mapping, an unknown key, a missing key, or a value that a field does not accept.
    """
    content = mapping(content, where)
    readers = {f.name: f for f in fields(section)}  # type: ignore[arg-type]
    for key in content:
        if key not in readers:
            raise InputError(f'{where}: unknown key {key!r}; known: {", ".join(readers)}{suggestion(key, readers)}')
    for name, entry in readers.items():
        if name not in content and entry.default is MISSING and entry.default_factory is MISSING:
            raise InputError(f'{where}: key {name!r} is missing')
    return section(**{key: readers[key].metadata['reader'](value, f'{where}: {key}') for key, value in content.items()})


def mapping(content: Any, where: str) -> Mapping[str, Any]:
    """Return the content, if it is a mapping with names as keys.

    Raises:
        InputError: it is none.
    """
    if not isinstance(content, Mapping):
        raise InputError(f'{where}: expected a mapping, found {content!r}')
    for key in content:
        if not isinstance(key, str):
            raise InputError(f'{where}: expected names as keys, found {key!r}')
    return content


def number(low: float = -math.inf, high: float = math.inf) -> Reader:
    """Accepts a finite number within [low, high]."""

    def read(value: Any, where: str) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise InputError(f'{where}: expected a finite number, found {value!r}')
        if not low <= value <= high:
            raise InputError(f'{where}: {value} is outside [{low:g}, {high:g}]')
        return float(value)

    return read


def whole(low: int, high: int) -> Reader:
    """Accepts a whole number within [low, high]."""

    def read(value: Any, where: str) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise InputError(f'{where}: expected a whole number, found {value!r}')
        if not low <= value <= high:
            raise InputError(f'{where}: {value} is outside [{low}, {high}]')
        return value

    return read


def pair(first: str, second: str, reader: Reader) -> Reader:
    """Accepts [first, second], both of which `reader` accepts."""

    def read(value: Any, where: str) -> Interval:
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise InputError(f'{where}: expected [{first}, {second}], found {value!r}')
        return Interval(*(reader(each, where) for each in value))

    return read


def interval(low: float = -math.inf, high: float = math.inf) -> Reader:
    """Accepts [a, b] with low <= a <= b <= high."""

    def read(value: Any, where: str) -> Interval:
        ends: Interval = pair('lowest', 'highest', number(low, high))(value, where)
        if ends.low > ends.high:
            raise InputError(f'{where}: the lowest value {ends.low:g} is above the highest {ends.high:g}')
        return ends

    return read


def choice(*known: str) -> Reader:
    """Accepts one of some names."""

    def read(value: Any, where: str) -> str:
        if value not in known:
            hint = suggestion(value, known) if isinstance(value, str) else ''
            raise InputError(f'{where}: unknown {value!r}; known: {", ".join(known)}{hint}')
        return str(value)

    return read


def text(value: Any, where: str) -> str:
    """Accepts a name or a sentence, and composes its Unicode.

    Raises:
        InputError: anything else, or an empty text.
    """
    if not isinstance(value, str) or not value.strip():
        raise InputError(f'{where}: expected a text, found {value!r}')
    return composed(value)


def names_of(what: str, has_key: bool = True) -> Reader:
    """Accepts a list of names that people can say, see `check_names`."""

    def read(value: Any, where: str) -> tuple[str, ...]:
        if not isinstance(value, list) or not value:
            raise InputError(f'{where}: expected a list of names, found {value!r}')
        for name in value:
            text(name, where)
        if len(set(value)) < len(value):
            raise InputError(f'{where}: a name occurs twice in {value}')
        try:
            check_names(value, what, has_key)
        except InputError as error:
            raise InputError(f'{where}: {error}') from error
        return tuple(value)

    return read


def unless_empty(reader: Reader, default: Any) -> Reader:
    """Accepts what `reader` accepts, and nothing at all, which stands for the default."""
    return lambda value, where: default if value in (None, '', []) else reader(value, where)


def table_of(reader: Reader) -> Reader:
    """Accepts a mapping from names, whose Unicode it composes, to what `reader` accepts."""

    def read(value: Any, where: str) -> Mapping[str, Any]:
        found = {composed(k): reader(v, f'{where}: {k}') for k, v in mapping(value, where).items()}
        if len(found) < len(value):
            raise InputError(f'{where}: a name occurs twice in {list(value)}')
        return MappingProxyType(found)

    return read


def costs(value: Any, where: str) -> Costs:
    """Accepts some of the members of `Costs`: prices of kinds of queries, and shares that are charged of them."""
    members = mapping(value, where)
    readers = {name: number(price.lower, price.largest) for name, price in COSTS.items()}
    readers[QueryKind.RELEVANCE.value] = _price_or_never
    for name in members:
        if name not in readers:
            raise InputError(f'{where}: unknown key {name!r}; known: {", ".join(readers)}{suggestion(name, readers)}')
    return Costs(**{name: readers[name](given, f'{where}: {name}') for name, given in members.items()})


def _price_or_never(value: Any, where: str) -> float | None:
    return None if value == NEVER else float(number(COST_RELEVANCE.lower, COST_RELEVANCE.largest)(value, where))


def strategy(value: Any, where: str) -> str:
    """Accepts the name of a questioning strategy, of ours or of an installed package."""
    try:
        return check_strategy(text(value, where))
    except SettingsError as error:
        raise InputError(f'{where}: {error}') from error


def section_of(section: type[Any]) -> Reader:
    """Accepts a mapping that `read_section` can turn into the dataclass."""
    return lambda value, where: read_section(section, value, where)


def defaults_of(section: type[Any]) -> Any:
    """Make a dataclass field for a section of a file that may be left out or empty; each of its keys has a default."""
    return setting(unless_empty(section_of(section), section()), section())
