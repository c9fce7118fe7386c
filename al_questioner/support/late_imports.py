"""Functions of large libraries that are imported at the first call.

A process that shows its help, or rejects an option, calls none of them, and importing scipy takes longer than all the
rest. This is the only reason for a late import.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any


def late(module: str, name: str) -> Callable[..., Any]:
    """Return a function that imports a module at its first call and then calls the function of this name in it."""
    found: Callable[..., Any] | None = None

    def call(*arguments: Any, **named: Any) -> Any:
        nonlocal found
        if found is None:
            found = getattr(import_module(module), name)
        return found(*arguments, **named)

    return call
