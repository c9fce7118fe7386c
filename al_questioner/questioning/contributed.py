"""Strategies that other installed packages contribute, as entry points of the group `al_questioner.strategies`."""

from __future__ import annotations

import logging
from collections.abc import Container, Mapping
from importlib.metadata import EntryPoint, entry_points

from al_questioner.domain import SettingsError
from al_questioner.questioning.choice import Strategy, StrategyFactory

GROUP = 'al_questioner.strategies'

_LOGGER = logging.getLogger(__name__)


def contributions(taken: Container[str]) -> dict[str, EntryPoint]:
    """The contributed strategies by name, sorted, none of them imported yet. It takes some 20 ms, so call it last.

    Args:
        taken: names that nobody can contribute: such an entry point, like the second of a name, is ignored, and a
            warning in the log says so. An error would take everybody else's strategies away, too.
    """
    found: dict[str, EntryPoint] = {}
    # The order in which packages lie in a folder differs from machine to machine.
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)):
        if entry.name in taken or entry.name in found:
            _LOGGER.warning('%s is ignored: there is another strategy of that name', _described(entry))
        else:
            found[entry.name] = entry
    return found


def contributed_factory(entry: EntryPoint) -> StrategyFactory:
    """What makes a contributed strategy. Whatever goes wrong in the other package is told in one line that names it.

    Raises:
        SettingsError: the entry point cannot be imported; from the factory: it fails, or makes something else.
    """
    try:
        factory = entry.load()
    except Exception as error:
        raise SettingsError(f'{_described(entry)} cannot be imported ({_reason(error)})') from error

    def make(weights: Mapping[str, float]) -> Strategy:
        try:
            strategy = factory(weights)
        except Exception as error:
            raise SettingsError(f'{_described(entry)} makes no strategy ({_reason(error)})') from error
        if not isinstance(strategy, Strategy):
            raise SettingsError(f'{_described(entry)} makes a {type(strategy).__name__}, which is no Strategy')
        return strategy

    return make


def _described(entry: EntryPoint) -> str:
    package = f' of package {entry.dist.name}' if entry.dist else ''
    return f'entry point "{entry.name} = {entry.value}"{package}'


def _reason(error: Exception) -> str:
    return ' '.join(f'{type(error).__name__}: {error}'.split())
