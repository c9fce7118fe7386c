"""Catalogues of objects for the table of a task."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from al_questioner.domain import NO_SYMBOL, InputError
from al_questioner.domain.names import suggestion
from al_questioner.simulation.kitchen.things.clutter import CLUTTER
from al_questioner.simulation.kitchen.things.kinds import Kind
from al_questioner.simulation.kitchen.things.pack_lunchbox import PACK_LUNCHBOX
from al_questioner.simulation.kitchen.things.prepare_lunch import PREPARE_LUNCH
from al_questioner.simulation.task import Task

CATALOGUES: Mapping[str, tuple[Kind, ...]] = MappingProxyType(
    {'prepare_lunch': PREPARE_LUNCH, 'pack_lunchbox': PACK_LUNCHBOX, 'kitchen_table': PACK_LUNCHBOX + CLUTTER}
)


UNNAMED = ('pack_lunchbox', 'kitchen_table')
"""Catalogues to try for a task that names none; the first with all that the task needs is taken."""


def kinds_by_symbol(task: Task) -> Mapping[str, tuple[Kind, ...]]:
    """Return the kinds of objects of each symbol of the task, and of 'none'.

    Raises:
        InputError: unknown catalogue, a symbol without a kind, or clutter wanted from a catalogue without any.
    """
    kinds = CATALOGUES[_catalogue_of(task)]
    return {symbol: tuple(kind for kind in kinds if kind.symbol == symbol) for symbol in (*task.symbols, NO_SYMBOL)}


def _catalogue_of(task: Task) -> str:
    name = task.appearance.catalogue
    if not name:
        lacks = {each: _lack(task, each) for each in UNNAMED}
        name, lack = min(lacks.items(), key=lambda item: item[1] is not None)
        if lack is not None:
            known = ', '.join(dict.fromkeys(kind.symbol for kind in CATALOGUES[name]))
            raise InputError(
                f'{task.name}: no simulated thing is a {lack!r} (there are {known}); a robot brings things of its own,'
                ' published as `objects` in the place of our perception; demo --dry-run plays on made-up features'
            )
        return name
    if name not in CATALOGUES:
        hint = suggestion(name, CATALOGUES)
        raise InputError(f'{task.name}: appearance: unknown catalogue {name!r}; known: {", ".join(CATALOGUES)}{hint}')
    lack = _lack(task, name)
    if lack == NO_SYMBOL:
        raise InputError(f'{task.name}: clutter_share is above 0, but the catalogue {name!r} holds no clutter')
    if lack is not None:
        raise InputError(f'{task.name}: the catalogue {name!r} holds nothing of the symbol {lack!r}')
    return name


def _lack(task: Task, catalogue: str) -> str | None:
    """Return the first symbol that a catalogue has no object of ('none' for wanted clutter); None if it has all."""
    held = {kind.symbol for kind in CATALOGUES[catalogue]}
    wanted = (*task.symbols, NO_SYMBOL) if task.scenes.clutter_share > 0 else task.symbols
    return next((symbol for symbol in wanted if symbol not in held), None)
