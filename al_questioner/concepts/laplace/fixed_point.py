"""Anderson's acceleration of fixed point iterations, with a memory of one step (Anderson 1965)."""

from __future__ import annotations

from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.support.arrays import Array

Memory = tuple[Array, Array, Array, Array]
"""State of many problems: (H, n) guesses, last images and last residuals, and (H,) squared lengths of the residuals."""


@compiled
def extrapolate(memory: Memory, row: int, target_row: int, this: Array, length: float, common: float) -> None:
    """Make the next guess: the point of least residual on the line through the last two images.

    Args:
        memory: memory of all problems; before the first step it holds zeros, except for the guesses.
        row: row of the problem.
        target_row: new row of the problem, at most `row`.
        this: (n,) image of the guess.
        length: squared length of its residual, the image less the guess.
        common: inner product of the residual with the last one.
    """
    guess, image, residual, squared = memory
    share = 0.0
    if squared[row] > 0:
        share = (length - common) / max(length - 2 * common + squared[row], 1e-300)
    for i in range(len(this)):
        difference = this[i] - guess[row, i]
        guess[target_row, i] = this[i] - share * (this[i] - image[row, i])
        image[target_row, i] = this[i]
        residual[target_row, i] = difference
    squared[target_row] = length
