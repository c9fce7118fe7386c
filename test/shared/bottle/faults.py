"""Faults that are drawn each by its own name, so that one can be left out while all others stay as they are."""

from __future__ import annotations

from collections.abc import Mapping
from hashlib import blake2b

WHOLE = 2**64


class Faults:
    """Decides which faults happen in a run.

    Args:
        seed: of the run.
        rates: chance of each kind of fault, each time it could happen.
        allowed: the only faults that may happen, by name; None for all.

    Attributes:
        happened: names of those that did, in order.
        active: False once no fault is to happen any more.
    """

    def __init__(self, seed: int, rates: Mapping[str, float], allowed: frozenset[str] | None = None) -> None:
        self.happened: list[str] = []
        self.active = True
        self._seed = seed
        self._rates = rates
        self._allowed = allowed

    def draw(self, *name: object) -> float:
        """Return a number in [0, 1) that depends on the seed and the name alone."""
        digest = blake2b(repr((self._seed, *name)).encode(), digest_size=8).digest()
        return int.from_bytes(digest, 'big') / WHOLE

    def happens(self, kind: str, *name: object) -> bool:
        """Return whether a fault happens; each name is to be asked for once."""
        rate = self._rates.get(kind, 0.0)
        if not self.active or rate <= 0.0 or self.draw(kind, *name) >= rate:
            return False
        full = ' '.join(map(str, (kind, *name)))
        if self._allowed is not None and full not in self._allowed:
            return False
        self.happened.append(full)
        return True
