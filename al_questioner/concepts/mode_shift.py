"""Where the modes go when one more example is added, starting from the present posterior.

In scaled coordinates: for a function g on the n examples, the arrays hold W^1/2 g. In these the posterior covariance of
the examples is T = I - B^-1, see `Posterior`. Derived in docs/method.md, "Look-ahead".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from al_questioner.concepts.gaussian_process import Array
from al_questioner.concepts.posterior import Posterior

MODE_TOLERANCE = 2e-7
"""The search for the modes ends when none is farther from the true one, in posterior standard deviations."""

MAX_MODE_STEPS = 10
FIRST_SITE_STEPS = 6
"""Newton steps to the first guess at the new example's own mode; each later guess takes one from the last."""


@dataclass(frozen=True, eq=False)
class Shift:
    """How the modes move when one example is added.

    Attributes:
        change: (|Y|, h, n) W^1/2 g, the change of the modes at the old examples, scaled.
        latent: (|Y|, h) the new example's own mode.
        pull: (|Y|, h) rho, the gradient of the new example there.
        bend: (|Y|, h, n) W^-1/2 h, by how much the old examples' gradients change beyond the linear.
        relative: (|Y|, h, n) E = W' / W - 1, the relative change of the old examples' curvatures.
        error: (|Y|, h) bound on the distance from the true mode, in posterior standard deviations.
    """

    change: Array
    latent: Array
    pull: Array
    bend: Array
    relative: Array
    error: Array


def find_shift(
    posterior: Posterior,
    solved: Array,
    variance: Array,
    mean: Array,
    targets: Array,
    steps: int = MAX_MODE_STEPS,
    tolerance: float = MODE_TOLERANCE,
) -> Shift:
    """Modes of the posteriors with one more example, as a change of the present ones.

    Solves g = c rho - T h(g) for the change g of the modes at the old examples, where c is their covariance with the
    new one: a fixed point iteration that contracts by the relative change of W, accelerated by Anderson's method with
    a memory of one step.

    Args:
        posterior: without the example.
        solved: (|Y|, h, n) covariance of each new example with the old ones, scaled.
        variance: (|Y|, h) posterior variance of each new example.
        mean: (|Y|, h) posterior mean of each new example.
        targets: (h,) or (|Y|, h) 1 for a positive, 0 for a negative example.
        steps: most evaluations of h.
        tolerance: `error` at which the search ends.
    """
    inverse_root = 1 / posterior.root[:, None]
    modes, p = posterior.modes[:, None], expit(posterior.modes)[:, None] * inverse_root
    linear_mean, latent = mean, np.zeros_like(mean)
    for _ in range(FIRST_SITE_STEPS):
        latent = _site_step(latent, linear_mean, variance, targets)
    bend, previous = np.zeros(()), None
    for step in range(1, steps + 1):
        pull = targets - expit(latent)
        change = solved * pull[:, :, None]
        if step > 1:
            change -= np.matmul(bend, posterior.covariance)
        shifted = expit(modes + change * inverse_root)
        image = shifted * inverse_root
        image -= p
        image -= change
        iterate = Iterate.of(image, bend)
        if step == steps or iterate.squared.max(initial=0.0) <= tolerance**2:
            break
        bend = iterate.following(previous)
        previous = iterate
        linear_mean = mean - dot(solved, bend)
        latent = _site_step(latent, linear_mean, variance, targets)
    relative = shifted * (1 - shifted) * inverse_root**2 - 1
    # The new example's own equation is part of the mode's: what its Newton steps left open counts as well.
    error = np.sqrt(iterate.squared) + np.abs(latent - linear_mean - variance * pull)
    # A step in the old posterior's metric is one in the new one's up to the change of the curvatures.
    error /= 1 + np.minimum(relative.min(axis=2, initial=0.0), 0)
    return Shift(change, latent, pull, image, relative, error)


def _site_step(latent: Array, mean: Array, variance: Array, targets: Array) -> Array:
    """Newton's step to the solution x of x = mean + variance (target - logistic(x)).

    Steps that begin at 0, where the logistic function has its point of inflection, approach it from one side.
    """
    p = expit(latent)
    step: Array = (latent - mean - variance * (targets - p)) / (1 + variance * p * (1 - p))
    return latent - step


@dataclass(frozen=True, eq=False)
class Iterate:
    """A step of a fixed point iteration for many problems at once, accelerated with a memory of one (Anderson 1965).

    Attributes:
        image: (..., n) what the iterated function makes of the guess.
        residual: (..., n) its difference from the guess.
        squared: (...) length of the residual, squared.
    """

    image: Array
    residual: Array
    squared: Array

    @classmethod
    def of(cls, image: Array, guess: Array) -> Iterate:
        """The step from a guess to its image."""
        residual = image - guess
        return cls(image, residual, dot(residual, residual))

    def following(self, previous: Iterate | None) -> Array:
        """(..., n) the next guess: of all on the line through the last two images, that of least residual."""
        if previous is None:
            return self.image
        common = dot(self.residual, previous.residual)
        change = self.squared - 2 * common + previous.squared
        share = (self.squared - common) / np.maximum(change, np.finfo(np.float64).tiny)
        step = self.image - previous.image
        step *= share[..., None]
        return np.subtract(self.image, step, out=step)


def dot(first: Array, second: Array) -> Array:
    """Inner product along the last axis."""
    product: Array = np.einsum('...n,...n->...', first, second)
    return product
