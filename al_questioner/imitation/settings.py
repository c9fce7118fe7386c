"""Settings of a training."""

from __future__ import annotations

from dataclasses import dataclass, field

METHODS = ('maxent', 'choice')

RIDGE = 0.01
"""Strength of the normal prior on the weights, a step, in units of the features' scale; it bounds them where the
choices are separable."""


@dataclass(frozen=True)
class MatchingSettings:
    """Settings of the matching of feature counts.

    Attributes:
        iterations: at most.
        rollouts: of each demonstration at each iteration, 2 or more: a single one tells nothing of its neighbours.
        patience: iterations without a new smallest gap, training or validation, mean of the window, until it stops.
        seed: of the rollouts.
        jobs: number of processes.
    """

    iterations: int = 100
    rollouts: int = 4
    patience: int = 12
    seed: int = 0
    jobs: int = 1


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of a training.

    Attributes:
        method: 'maxent', see `max_entropy_irl`, or 'choice', see `choice_likelihood`.
        validation: number of demonstrations, the last ones, that choose among the iterations of maxent.
        ridge: of the choice likelihood.
        matching: settings of maxent.
    """

    method: str = 'maxent'
    validation: int = 1
    ridge: float = RIDGE
    matching: MatchingSettings = field(default_factory=MatchingSettings)

    def held_out_of(self, count: int) -> int:
        """Return the number of demonstrations that maxent holds out; one at least is left to learn from."""
        return max(0, min(self.validation, count - 1))
