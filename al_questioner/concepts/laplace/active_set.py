"""Linear systems I + E T that are the identity but for a few rows, up to a remainder that contracts.

T is a scaled posterior covariance, between 0 and I, and E a diagonal of relative changes of curvatures. Where
|E_i| T_ii is small, row i hardly differs from that of the identity. The others are the *active set*: solved exactly, in
a dense system of their small number, they leave an iteration on the rest that contracts quickly.
"""

from __future__ import annotations

from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.support.arrays import Array, Index

LARGEST_PASSIVE = 0.2
"""Largest |E_i| T_ii of a row outside of the active set: smaller takes larger systems, larger takes more iterations."""

SLOW = 0.6
"""Share of the error that may remain after an iteration.

Where more remains, many rows that change a little each change together, and the limit of the active set is lowered to
`LOWER` times what it was.
"""

LOWER = 0.25


@compiled
def select_active(covariance: Array, relative: Array, limit: float, rows: Index) -> int:
    """Write the numbers of the active rows, and return how many they are.

    Args:
        covariance: (n, n) T.
        relative: (n,) diagonal of E.
        limit: largest |E_i| T_ii of another row.
        rows: (n,) takes the numbers.
    """
    size = 0
    for i in range(len(relative)):
        if abs(relative[i]) * covariance[i, i] > limit:
            rows[size] = i
            size += 1
    return size


@compiled
def factorise(matrix: Array, pivots: Index, size: int) -> None:
    """Factorise the leading part of a matrix in place: Gaussian elimination with row exchanges.

    LAPACK's calls cost more than the systems of a few rows that it is for.

    Args:
        matrix: (n, n) whose first rows and columns, `size` of them, become L and U.
        pivots: (n,) takes the row that each row was exchanged with.
        size: of the system.
    """
    for k in range(size):
        pivot, largest = k, abs(matrix[k, k])
        for i in range(k + 1, size):
            if abs(matrix[i, k]) > largest:
                pivot, largest = i, abs(matrix[i, k])
        pivots[k] = pivot
        if pivot != k:
            for j in range(size):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
        for i in range(k + 1, size):
            factor = matrix[i, k] / matrix[k, k]
            matrix[i, k] = factor
            for j in range(k + 1, size):
                matrix[i, j] -= factor * matrix[k, j]


@compiled
def substitute(factors: Array, pivots: Index, size: int, vector: Array) -> None:
    """Solve the factorised system for a right hand side, in place.

    Args:
        factors: (n, n) as `factorise` left it.
        pivots: (n,) likewise.
        size: of the system.
        vector: (n,) whose first numbers, `size` of them, become the solution.
    """
    for k in range(size):
        pivot = pivots[k]
        vector[k], vector[pivot] = vector[pivot], vector[k]
    for i in range(size):
        total = vector[i]
        for j in range(i):
            total -= factors[i, j] * vector[j]
        vector[i] = total
    for i in range(size - 1, -1, -1):
        total = vector[i]
        for j in range(i + 1, size):
            total -= factors[i, j] * vector[j]
        vector[i] = total / factors[i, i]
