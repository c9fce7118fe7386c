"""Making strategies that other installed packages contribute."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import EntryPoint

from al_questioner.domain import SettingsError
from al_questioner.questioning.strategies.choice import Strategy, StrategyFactory
from al_questioner.questioning.strategies.names import described


def contributed_factory(entry: EntryPoint) -> StrategyFactory:
    """What makes a contributed strategy. Whatever goes wrong in the other package is told in one line that names it.

    Raises:
        SettingsError: the entry point cannot be imported; from the factory: it fails, or makes something else.
    """
    try:
        factory = entry.load()
    except Exception as error:
        raise SettingsError(f'{described(entry)} cannot be imported ({_reason(error)})') from error

    def make(weights: Mapping[str, float]) -> Strategy:
        try:
            strategy = factory(weights)
        except Exception as error:
            raise SettingsError(f'{described(entry)} makes no strategy ({_reason(error)})') from error
        if not isinstance(strategy, Strategy):
            raise SettingsError(f'{described(entry)} makes a {type(strategy).__name__}, which is no Strategy')
        return strategy

    return make


def _reason(error: Exception) -> str:
    return ' '.join(f'{type(error).__name__}: {error}'.split())
