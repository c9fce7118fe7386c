"""Compilation of loops that would be hundreds of small passes in numpy."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar, cast

import numba

Function = TypeVar('Function', bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Return a function that numba compiles at the first call, and keeps on disk for the next process if possible.

    Sums may be reordered, so that they run in vector registers. Infinities and NaN keep their meaning, because callers
    detect an overflow by them. Other threads can run at the same time.
    """
    options: dict[str, Any] = {'nogil': True, 'error_model': 'numpy', 'fastmath': {'reassoc', 'contract', 'nsz'}}
    try:
        result = numba.njit(cache=True, **options)(function)
        result._cache.save_overload = _if_there_is_room(result._cache.save_overload)
    except RuntimeError:
        # Neither the package's folder nor the user's cache can be written.
        result = numba.njit(**options)(function)
    return cast(Function, result)


def _if_there_is_room(save: Callable[..., None]) -> Callable[..., None]:
    def save_or_not(*arguments: Any) -> None:
        with suppress(OSError):
            save(*arguments)

    return save_or_not
