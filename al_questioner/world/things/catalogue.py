"""What may lie on the table of a task."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from al_questioner.domain import NO_SYMBOL, InputError
from al_questioner.world.task import Task
from al_questioner.world.things.clutter import CLUTTER
from al_questioner.world.things.kinds import Kind
from al_questioner.world.things.pack_lunchbox import PACK_LUNCHBOX
from al_questioner.world.things.prepare_lunch import PREPARE_LUNCH

CATALOGUES: Mapping[str, tuple[Kind, ...]] = MappingProxyType(
    {'prepare_lunch': PREPARE_LUNCH, 'pack_lunchbox': PACK_LUNCHBOX, 'kitchen_table': PACK_LUNCHBOX + CLUTTER}
)


def kinds_by_symbol(task: Task) -> Mapping[str, tuple[Kind, ...]]:
    """The kinds of things of each symbol of the task, and of 'none'.

    Raises:
        InputError: unknown catalogue, a symbol without a kind, or clutter wanted where there is none.
    """
    name = task.appearance.catalogue
    if name not in CATALOGUES:
        raise InputError(f'{task.name}: appearance: unknown catalogue {name!r}; known: {", ".join(CATALOGUES)}')
    kinds = {s: tuple(k for k in CATALOGUES[name] if k.symbol == s) for s in (*task.symbols, NO_SYMBOL)}
    for symbol in task.symbols:
        if not kinds[symbol]:
            raise InputError(f'{task.name}: the catalogue {name!r} holds nothing of the symbol {symbol!r}')
    if task.scenes.clutter_share > 0 and not kinds[NO_SYMBOL]:
        raise InputError(f'{task.name}: clutter_share is above 0, but the catalogue {name!r} holds no clutter')
    return kinds
