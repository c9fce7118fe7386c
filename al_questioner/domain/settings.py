"""What is given to the learner before it asks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from al_questioner.domain.errors import SettingsError
from al_questioner.domain.names import listed
from al_questioner.domain.query import NO_SYMBOL, Outcome, QueryKind

AMPLITUDE = 100.0
"""Variance of the Gaussian processes' kernel of a learner, unless it is told otherwise: see docs/method.md, Beliefs."""

AMPLITUDE_RANGE = (1e-3, 1e3)
LENGTH_SCALE_RANGE = (1e-3, 1e3)
"""Smallest and largest, in standard deviations. Beyond, all things look alike, or none do, and numbers overflow."""

LARGEST_AMOUNT = 1e12
"""Of a budget, or a price: far beyond, a price of 1 would be lost in rounding."""
LARGEST_WEIGHT = 1e9
"""Of either sign; sums of weighted features stay finite."""


AUTO: Final = 'auto'
"""The view tolerance that is found from the looks themselves."""

ViewTolerance = float | Literal['auto']
"""When two looks at a thing are the same view: see `questioning.Episode`."""


@dataclass(frozen=True)
class Costs:
    """What a query takes from the budget; asking nothing is free (section 4.2 of the paper).

    Attributes:
        label: price of a label query.
        demonstration: price of a demonstration query.
        feature_subset: price of a feature subset query.
        unknown: share of the price that is charged, 0 to 1, if the teacher does not know.
        skip: share if the teacher skips the question.
        unanswered: share if it is withdrawn since nobody has answered.
    """

    label: float = 1.0
    demonstration: float = 2.0
    feature_subset: float = 2.0
    unknown: float = 1.0
    skip: float = 1.0
    unanswered: float = 0.0

    def price(self, kind: QueryKind) -> float:
        """Price of a query of this kind."""
        return 0.0 if kind is QueryKind.NO_QUERY else float(getattr(self, kind.value))

    def charged_fraction(self, outcome: Outcome) -> float:
        """Share of the price that is charged in the end."""
        return 1.0 if outcome is Outcome.ANSWERED else float(getattr(self, outcome.value))


@dataclass(frozen=True)
class EpisodeSettings:
    """What is given to the learner before it asks.

    Attributes:
        symbols: the concepts to ground, at least two. Any names will do here; of those of a task, which people are to
            say, more is asked, see `names.check_names`.
        budget: query budget, in the unit of `costs`; 0 or more.
        turns: number of turns, 1 or more.
        strategy: name of a questioning strategy.
        weights: weights and constants of the strategy, by the names that it declares.
        change_interval: turns between scene changes as the robot expects them: the window of the non-query time.
        costs: price of each kind of query.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel in standard deviations of a feature; None for the square root of
            the number of features in use.
        tune_every: turns from one re-optimisation of amplitude and length scale to the next; 0 for never.

    Raises:
        SettingsError: a value outside its range.
    """

    symbols: tuple[str, ...]
    budget: float
    turns: int
    strategy: str
    weights: Mapping[str, float] = field(default_factory=dict)
    change_interval: int = 10
    costs: Costs = Costs()
    amplitude: float = AMPLITUDE
    length_scale: float | None = None
    tune_every: int = 0

    def __post_init__(self) -> None:
        symbols = listed(self.symbols)
        if symbols is None:
            raise SettingsError(f'symbols must be a list of names, not {self.symbols!r}')
        object.__setattr__(self, 'symbols', symbols)
        if len(self.symbols) < 2 or len(set(self.symbols)) < len(self.symbols):
            raise SettingsError(f'symbols must be at least two distinct names, not {list(self.symbols)}')
        if not all(symbol.strip() for symbol in self.symbols):
            raise SettingsError(f'a symbol must not be blank, as one of {list(self.symbols)} is')
        if NO_SYMBOL in self.symbols:
            raise SettingsError(f'{NO_SYMBOL!r} cannot be a symbol: it stands for things that belong to no symbol')
        if not (np.isfinite(self.budget) and self.budget >= 0):
            raise SettingsError(f'budget must be a finite number of 0 or more, not {self.budget}')
        _check_range('budget', self.budget, 0, LARGEST_AMOUNT)
        if self.turns < 1:
            raise SettingsError(f'turns must be 1 or more, not {self.turns}')
        if self.change_interval < 1:
            raise SettingsError(f'change_interval must be 1 or more, not {self.change_interval}')
        for kind in ('label', 'demonstration', 'feature_subset'):
            cost = getattr(self.costs, kind)
            if not (np.isfinite(cost) and cost >= 0):
                raise SettingsError(f'the cost of a {kind} query must be a number of 0 or more, not {cost}')
            _check_range(f'the cost of a {kind} query', cost, 0, LARGEST_AMOUNT)
        for outcome in Outcome:
            share = self.costs.charged_fraction(outcome)
            if not 0.0 <= share <= 1.0:
                raise SettingsError(f'the share charged for outcome {outcome.value} must be in [0, 1], not {share}')
        _check_range('amplitude', self.amplitude, *AMPLITUDE_RANGE)
        if self.length_scale is not None:
            _check_range('length_scale', self.length_scale, *LENGTH_SCALE_RANGE)
        if self.tune_every < 0:
            raise SettingsError(f'tune_every must be 0 or more, not {self.tune_every}')
        for name, weight in self.weights.items():
            if not np.isfinite(weight):
                raise SettingsError(f'the weight of {name} is not finite ({weight})')
            _check_range(f'the weight of {name}', weight, -LARGEST_WEIGHT, LARGEST_WEIGHT)

    def tunes_after(self, turn: int) -> bool:
        """Whether amplitude and length scale are re-optimised at the end of this turn."""
        return self.tune_every > 0 and turn > 0 and turn % self.tune_every == 0


def _check_range(what: str, value: float, lowest: float, highest: float) -> None:
    if not lowest <= value <= highest:
        raise SettingsError(f'{what} must lie in [{lowest:g}, {highest:g}], not {value}')
