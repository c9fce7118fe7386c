"""Names of questioning strategies: those that ship, and those that other installed packages contribute.

Other packages contribute entry points of the group `al_questioner.strategies`.
"""

from __future__ import annotations

import logging
from importlib.metadata import EntryPoint, entry_points

from al_questioner.domain import Setting, SettingsError
from al_questioner.domain.names import suggestion

SHIPPED = (
    'u_sampling',
    'dt_iros',
    'dt_task',
    'dt_task_env',
    'value_per_cost',
    'u_sampling_fsq',
    'random_fsq',
    'farthest_fsq',
    'rarest_demo',
    'typiclust',
    'probcover',
    'expert',
    'human',
)
"""Names of `questioning.STRATEGIES`, known without loading them."""
STRATEGY = Setting(
    'strategy',
    'value_per_cost',
    f'questioning strategy: {", ".join(sorted(SHIPPED))}, or one that an installed package contributes',
)
GROUP = 'al_questioner.strategies'

_LOGGER = logging.getLogger(__name__)


def contributions() -> dict[str, EntryPoint]:
    """Return the contributed strategies by name, sorted, without importing them; it takes some 20 ms.

    Nobody can contribute a name in `SHIPPED`: such an entry point, like the second of a name, is ignored, and a warning
    in the log says so. An error would take everybody else's strategies away, too.
    """
    found: dict[str, EntryPoint] = {}
    # The order in which packages lie in a folder differs from machine to machine.
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)):
        if entry.name in SHIPPED or entry.name in found:
            _LOGGER.warning('%s is ignored: there is another strategy of that name', described(entry))
        else:
            found[entry.name] = entry
    return found


def contribution(name: str) -> EntryPoint:
    """Return the contributed strategy of a name.

    Raises:
        SettingsError: there is none.
    """
    contributed = contributions()
    if name not in contributed:
        known = (*SHIPPED, *contributed)
        raise SettingsError(f'unknown strategy {name!r}; known: {", ".join(known)}{suggestion(name, known)}')
    return contributed[name]


def check_strategy(name: str) -> str:
    """Return the name of a strategy; other packages are searched only for one that is not in `SHIPPED`.

    Raises:
        SettingsError: it is unknown.
    """
    if name not in SHIPPED:
        contribution(name)
    return name


def described(entry: EntryPoint) -> str:
    """Describe an entry point."""
    package = f' of package {entry.dist.name}' if entry.dist else ''
    return f'entry point "{entry.name} = {entry.value}"{package}'
