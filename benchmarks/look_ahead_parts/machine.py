"""Limits of this machine: its fastest matrix product, and the arithmetic that a look-ahead needs."""

from __future__ import annotations

import os
import time

import numpy as np

SIZE = 1024
PRODUCTS = 8

MODE_PRODUCTS = 5
VARIANCE_PRODUCTS = 3
"""Products with the covariance matrix that a hypothesis, and a point under it, typically take, see `work`."""

WORK = (
    f'Work counted: 2 n^2 |Y| (2|X| ({MODE_PRODUCTS} + {VARIANCE_PRODUCTS} |X|) + |X|), for modes, variances and '
    'marginals;\nkernels, exponentials, error functions and active sets, of lower order in n, are not counted.'
)


def work(n: int, things: int, symbols: int) -> float:
    """Multiplications and additions in the products of an exact look-ahead that takes the typical number of steps.

    A product of one vector with the covariance of the examples costs 2 n^2. For each symbol, each of the 2|X|
    hypotheses takes `MODE_PRODUCTS` in search of its mode, and `VARIANCE_PRODUCTS` for the variance of each point; each
    of the |X| points of the scene takes one for its marginal.
    """
    hypotheses = 2 * things
    return 2.0 * n**2 * symbols * (hypotheses * (MODE_PRODUCTS + VARIANCE_PRODUCTS * things) + things)


def peak() -> float:
    """Multiplications and additions a second in the best of a few large matrix products."""
    matrix = np.random.default_rng(0).normal(size=(SIZE, SIZE))
    result = np.empty_like(matrix)
    best = np.inf
    for _ in range(PRODUCTS):
        start = time.process_time()
        np.matmul(matrix, matrix, out=result)
        best = min(best, time.process_time() - start)
    return 2.0 * SIZE**3 / best


def conditions() -> str:
    """One line about what the figures depend on."""
    return (
        f'{os.cpu_count()} cores, load average {os.getloadavg()[0]:.1f}; '
        f'BLAS threads: {os.environ.get("OMP_NUM_THREADS", "as many as cores")} (OMP_NUM_THREADS)'
    )
