"""The way in which the effects of a machine are performed."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing

from al_questioner.protocol.effects import Effect, Effects


def perform_all(effects: Effects, perform: Callable[[Effect], None]) -> None:
    """Perform effects one by one; the error of one is thrown back to the machine, which may know what to do.

    Raises:
        Exception: the machine does not.
    """
    with closing(effects):
        try:
            effect = next(effects)
            while True:
                try:
                    perform(effect)
                except Exception as error:  # noqa: BLE001 - it is the machine's
                    effect = effects.throw(error)
                else:
                    effect = next(effects)
        except StopIteration:
            return
