"""Public names of a package that are imported at the first access."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from importlib import import_module


def lazy_names(package: str, modules: Mapping[str, Collection[str]]) -> tuple[list[str], Callable[[str], object]]:
    """Return the `__all__` and the `__getattr__` of a package whose public names are defined in its modules.

    Modules are relative to the package. Type checkers see the imports under TYPE_CHECKING in their place, `X as X`,
    which a test compares with these.
    """
    homes = {name: module for module, names in modules.items() for name in names}

    def find(name: str) -> object:
        if name not in homes:
            raise AttributeError(f'module {package!r} has no attribute {name!r}')
        return getattr(import_module(f'{package}.{homes[name]}'), name)

    return sorted(homes), find
