"""Functions of large libraries that are imported at the first call.

A process that shows its help, or refuses an option, calls none of them, and importing scipy takes longer than all the
rest. What is late is so for this reason alone.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any


def late(module: str, name: str) -> Callable[..., Any]:
    """The function of this name in a module, which is imported when the function is called."""

    @cache
    def found() -> Callable[..., Any]:
        function: Callable[..., Any] = getattr(import_module(module), name)
        return function

    def call(*arguments: Any, **named: Any) -> Any:
        return found()(*arguments, **named)

    return call
