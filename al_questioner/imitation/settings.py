"""Settings of a training."""

from __future__ import annotations

from dataclasses import dataclass, field

from al_questioner.domain import Setting
from al_questioner.simulation.world_spec import SEED
from al_questioner.support.arguments import JOBS

METHOD = Setting(
    'method',
    'maxent',
    'maxent: match the feature counts in rollouts, for simulated worlds (default);'
    ' choice: likelihood of the choices, without a simulator',
    choices=('maxent', 'choice'),
)
_MOST = 10_000
ITERATIONS = Setting('iterations', 100, 'of maxent, at most', '', 2, _MOST)
ROLLOUTS = Setting('rollouts', 4, 'of each demonstration at each iteration of maxent', '', 2, _MOST)
"""A single one tells nothing of its neighbours."""
_OF_PATIENCE = 'iterations of maxent without a new smallest gap, training or validation, until it stops'
PATIENCE = Setting('patience', 12, _OF_PATIENCE, '', 1, _MOST)
_OF_VALIDATION = 'number of demonstrations, the last ones, that choose among the iterations'
VALIDATION = Setting('validation', 1, _OF_VALIDATION, '', 0, _MOST)
RIDGE = Setting('ridge', 0.01, 'strength of the prior of choice', '', 0, 1e6)
"""Strength of the normal prior on the weights, a step, in units of the features' scale; it bounds them where the
choices are separable."""


@dataclass(frozen=True)
class MatchingSettings:
    """Settings of the matching of feature counts.

    Attributes:
        patience: iterations without a new smallest gap, mean of the window, until it stops.
        seed: of the rollouts.
        jobs: number of processes.
    """

    iterations: int = ITERATIONS.default
    rollouts: int = ROLLOUTS.default
    patience: int = PATIENCE.default
    seed: int = SEED.default
    jobs: int = JOBS.default


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of a training.

    Attributes:
        method: 'maxent', see `max_entropy_irl`, or 'choice', see `choice_likelihood`.
        matching: settings of maxent.
    """

    method: str = METHOD.default
    validation: int = VALIDATION.default
    ridge: float = RIDGE.default
    matching: MatchingSettings = field(default_factory=MatchingSettings)

    def held_out_of(self, count: int) -> int:
        """Return the number of demonstrations that maxent holds out; one at least is left to learn from."""
        return max(0, min(self.validation, count - 1))
