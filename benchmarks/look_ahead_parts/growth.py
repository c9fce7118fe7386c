"""Growth of time, memory and the error of the approximate mode with labels, things and symbols."""

from __future__ import annotations

import logging
import time
import tracemalloc
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from look_ahead_parts.actions import task_weights, utilities
from look_ahead_parts.states import SHIPPED, State, clustered_state
from measuring import median_and_spread, print_table

from al_questioner.concepts import ConceptModels
from al_questioner.concepts.concept_models import EXACT_OPERATIONS, exact_operations
from al_questioner.questioning.strategies.decision_features import symbol_given_object
from al_questioner.support.arrays import Array

LONGEST = 12.0
"""Seconds above which an exact look-ahead is left out."""

CALLS = 5
ENOUGH = 0.5
"""Number of timed look-aheads, and of seconds that they may take together, which can make them fewer."""

MIB = 2**20

LEGEND = f"""\
A new scene each time: its covariances are included, fitting the models (cold fit: to all labels at once) is not.
MiB: largest memory that numpy holds during one call beyond what it held before, the result included; result: MiB of
that alone. error: largest difference of exact=False from exact=True. default: what exact=None does; above
{EXACT_OPERATIONS:.0e} operations, 8 |Y| (n |X|)^2, it approximates and logs a warning, once.
An exact look-ahead that would take more than {LONGEST:g} s, by the rate of the largest so far, is left out (-)."""

Figures = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Measured:
    """Calls of one look-ahead.

    Attributes:
        seconds: of each.
        peak: bytes that a call needed at most, its result included.
        table: the result.
    """

    seconds: list[float]
    peak: int
    table: Array


def grow(labels: Sequence[int], scenes: Sequence[int], symbols: Sequence[int], longest: float = LONGEST) -> Figures:
    """Measure look-aheads of all sizes, print and return the figures; exact ones that take longer are left out."""
    rows: list[list[str]] = []
    figures: Figures = {}
    largest = rate = 0.0
    for n, n_symbols in product(labels, symbols):
        whole = clustered_state(np.random.default_rng((n, n_symbols)), n, max(scenes), n_symbols)
        start = time.process_time()
        models = whole.models()
        fitting = time.process_time() - start
        for things in scenes:
            state = replace(whole, scene=whole.scene[:things])
            default = 'approximate' if approximates(models, state) else 'exact'
            cheap = measure(models, state, exact=False)
            operations = exact_operations(things, n_symbols, n)
            exact = measure(models, state, exact=True) if operations * rate <= longest else None
            if exact is not None and operations > largest:
                largest, rate = operations, min(exact.seconds) / operations
            error = None if exact is None else float(np.abs(exact.table - cheap.table).max())
            size = f'n={n}, |X|={things}, |Y|={n_symbols}'
            rows.append([size, f'{1e3 * fitting:.1f}', *cells(exact), *cells(cheap)])
            rows[-1] += [f'{cheap.table.nbytes / MIB:.1f}', '-' if error is None else f'{error:.0e}', default]
            figures[f'{n},{things},{n_symbols}'] = {
                'fit_ms': 1e3 * fitting,
                'exact': None if exact is None else summary(exact),
                'approximate': summary(cheap),
                'error': error,
                'default': default,
            }
    print_table(
        f'Growth: m=60, {SHIPPED}',
        ('', 'cold fit ms', 'exact ms', 'spread', 'MiB', 'approx. ms', 'spread', 'MiB', 'result', 'error', 'default'),
        rows,
    )
    print(LEGEND + '\n')
    return figures


def measure(models: ConceptModels, state: State, exact: bool) -> Measured:
    """Time look-aheads of a scene that the models have not seen; the first call only tells its memory, if short."""
    forget = forgetting(models, state)
    tracemalloc.start()
    try:
        start = time.process_time()
        table = models.look_ahead(state.scene, exact)
        seconds = [time.process_time() - start]
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    if seconds[0] < ENOUGH:
        seconds = []
        while len(seconds) < CALLS and sum(seconds) < ENOUGH:
            forget()
            start = time.process_time()
            models.look_ahead(state.scene, exact)
            seconds.append(time.process_time() - start)
    return Measured(seconds, peak, table)


def forgetting(models: ConceptModels, state: State) -> Callable[[], object]:
    """Make the models forget the last scene by showing them another thing."""
    other = state.scene[:1] + 1.0
    models.predict_proba(other)
    return lambda: models.predict_proba(other)


def approximates(models: ConceptModels, state: State) -> bool:
    """Return whether the models, left to themselves, approximate: they say so in a warning before the first chunk.

    No default look-ahead has been asked of them; they warn once, so it is a copy that is asked.
    """
    warnings: list[logging.LogRecord] = []

    class Listening(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            warnings.append(record)

    logger, listening = logging.getLogger('al_questioner'), Listening(logging.WARNING)
    propagates = logger.propagate
    logger.addHandler(listening)
    logger.propagate = False
    try:
        next(copy(models).look_ahead_chunks(state.scene))
    finally:
        logger.removeHandler(listening)
        logger.propagate = propagates
    return bool(warnings)


def cells(measured: Measured | None) -> list[str]:
    """Median, spread and memory of a line."""
    if measured is None:
        return ['-', '', '']
    median, spread = median_and_spread(measured.seconds)
    known = f'{1e3 * spread:.2f}' if len(measured.seconds) > 1 else ''
    return [f'{1e3 * median:.2f}', known, f'{measured.peak / MIB:.1f}']


def summary(measured: Measured) -> Figures:
    """The same in numbers."""
    median, spread = median_and_spread(measured.seconds)
    return {'median': 1e3 * median, 'spread': 1e3 * spread, 'calls': len(measured.seconds), 'peak': measured.peak}


def score_pool(things: int, n: int, symbols: int) -> Figures:
    """Weigh a label query about each thing of a pool, chunk by chunk; print and return the figures."""
    state = clustered_state(np.random.default_rng(things), n, things, symbols)
    weights, models = task_weights(), state.models()
    belief = symbol_given_object(models.predict_proba(state.scene))
    expected, chunks, looking = np.empty(things), 0, 0.0
    tracemalloc.start()
    try:
        start = begun = time.process_time()
        for rows, part in models.look_ahead_chunks(state.scene, exact=False):
            looking += time.process_time() - begun
            expected[rows] = (belief[rows] * utilities(state, part, weights)).sum(axis=1)
            chunks += 1
            begun = time.process_time()
        whole = time.process_time() - start
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    table = 8 * (things * symbols) ** 2
    print(
        f'A pool of {things} unlabelled things, n={n}, |Y|={symbols}, exact=False, {chunks} chunks: {looking:.1f} s,\n'
        f'{whole:.1f} s with the expected utility of asking about each; at most {peak / MIB:.0f} MiB, where the whole\n'
        f'table has {table / MIB:.0f}. The best is thing {int(np.argmax(expected))}.\n'
    )
    return {'things': things, 'chunks': chunks, 'look_ahead_s': looking, 'whole_s': whole, 'peak': peak}
