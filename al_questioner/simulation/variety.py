"""Tables that differ from sample to sample: settings of a task file that are drawn at random."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from al_questioner.domain import random_stream
from al_questioner.simulation.task_reading import Interval, interval, number, setting


@dataclass(frozen=True)
class Variety:
    """Intervals of uniform distributions, ends included, from which each sample draws its own table.

    Attributes:
        objects, change_interval, persistence, clutter_share: intervals of these settings of the scenes.
        frequency_concentration: parameter of the Dirichlet distribution of the class frequencies, the same for every
            symbol: the larger, the more alike they are.
    """

    objects: Interval = setting(interval(1, 200))
    change_interval: Interval = setting(interval(1, 1_000_000))
    persistence: Interval = setting(interval(0, 1))
    clutter_share: Interval = setting(interval(0, 0.95))
    frequency_concentration: float = setting(number(0.1, 1000), 3.0)

    def draw(self, symbols: Sequence[str], sample: int) -> dict[str, Any]:
        """Return the scene parameters of the sample of this number, by name."""
        rng = random_stream(sample, 'world/variety')
        objects, change_interval = (
            int(rng.integers(round(ends.low), round(ends.high), endpoint=True))
            for ends in (self.objects, self.change_interval)
        )
        persistence, clutter_share = (float(rng.uniform(*ends)) for ends in (self.persistence, self.clutter_share))
        shares = rng.dirichlet([self.frequency_concentration] * len(symbols))
        return {
            'objects': objects,
            'change_interval': change_interval,
            'persistence': persistence,
            'clutter_share': clutter_share,
            'class_frequencies': dict(zip(symbols, map(float, shares), strict=True)),
        }
