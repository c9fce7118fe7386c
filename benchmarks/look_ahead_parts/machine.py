"""Limits of this machine: its fastest matrix product, and the arithmetic that a look-ahead needs."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike

SIZE = 1024
PRODUCTS = 8

MODE_PRODUCTS = 3
TANGENT_PRODUCTS = 2
LANCZOS_PRODUCTS = 2
"""Products with the covariance matrix that a hypothesis typically takes, see `work`."""

WORK = (
    f'Work counted: 2 n^2 |Y| (2|X| ({MODE_PRODUCTS} + {TANGENT_PRODUCTS} + 1) + |X|) in double precision, for modes, '
    f'tangents,\nspectral bound and marginals, and {LANCZOS_PRODUCTS} x 2 n^2 |Y| 2|X| |X| in single, for variances; '
    'kernels, exponentials and\nerror functions, which are of lower order in n, are not counted.'
)


@dataclass(frozen=True)
class Work:
    """Multiplications and additions, in double and in single precision."""

    double: float
    single: float

    def seconds(self, peak: Work) -> float:
        """Return the least time that they take at this rate a second."""
        return self.double / peak.double + self.single / peak.single


def work(n: int, things: int, symbols: int) -> Work:
    """Matrix products of an exact look-ahead whose hypotheses take the typical number of steps.

    A product of one vector with the covariance of the examples costs 2 n^2. For each symbol, each of the 2|X|
    hypotheses takes `MODE_PRODUCTS` in search of its mode, `TANGENT_PRODUCTS` for the covariance of its example with
    the others and one for the bound of its spectrum; each of the |X| points of the scene takes one for its marginal.
    The variance of each point under each hypothesis takes `LANCZOS_PRODUCTS`, in single precision.
    """
    of_a_vector = 2.0 * n**2 * symbols
    hypotheses = 2 * things
    return Work(
        of_a_vector * (hypotheses * (MODE_PRODUCTS + TANGENT_PRODUCTS + 1) + things),
        of_a_vector * hypotheses * things * LANCZOS_PRODUCTS,
    )


def peak() -> Work:
    """Multiplications and additions a second in the best of a few large matrix products, in each precision."""
    return Work(_rate(np.float64), _rate(np.float32))


def _rate(precision: DTypeLike) -> float:
    matrix = np.random.default_rng(0).normal(size=(SIZE, SIZE)).astype(precision)
    result = np.empty_like(matrix)
    best = np.inf
    for _ in range(PRODUCTS):
        start = time.perf_counter()
        np.matmul(matrix, matrix, out=result)
        best = min(best, time.perf_counter() - start)
    return 2.0 * SIZE**3 / best


def conditions() -> str:
    """One line about what the figures depend on."""
    return (
        f'{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}; '
        f'BLAS threads: {os.environ.get("OMP_NUM_THREADS", "as many as cores")} (OMP_NUM_THREADS)'
    )
