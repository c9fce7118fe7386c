"""Making strategies that other installed packages contribute."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import EntryPoint

from al_questioner.domain import SettingsError
from al_questioner.domain.names import listed
from al_questioner.questioning.strategies.choice import Strategy, weight_names
from al_questioner.questioning.strategies.names import described


class ContributedFactory:
    """Makes a contributed strategy. Whatever goes wrong in the other package is told in one line that names it.

    Attributes:
        weight_names: what the strategy declares; None if it declares nothing.

    Raises:
        SettingsError: the entry point cannot be imported, or declares no list of names; when it is called: it fails, or
            makes something else.
    """

    def __init__(self, entry: EntryPoint) -> None:
        self._entry = entry
        try:
            self._factory = entry.load()
        except Exception as error:
            raise SettingsError(f'{described(entry)} cannot be imported ({_reason(error)})') from error
        given = weight_names(self._factory)
        self.weight_names = None if given is None else listed(given)
        if given is not None and self.weight_names is None:
            raise SettingsError(f'{described(entry)} declares weight_names {given!r}, which is no list of names')

    def __call__(self, weights: Mapping[str, float]) -> Strategy:
        """Make the strategy."""
        try:
            strategy = self._factory(weights)
        except Exception as error:
            raise SettingsError(f'{described(self._entry)} makes no strategy ({_reason(error)})') from error
        if not isinstance(strategy, Strategy):
            raise SettingsError(f'{described(self._entry)} makes a {type(strategy).__name__}, which is no Strategy')
        return strategy


def _reason(error: Exception) -> str:
    return ' '.join(f'{type(error).__name__}: {error}'.split())
