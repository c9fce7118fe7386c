"""Ways to the same table, timed in turns, with the error of each."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from look_ahead_parts import machine, refitting
from look_ahead_parts.states import State, clustered_state
from measuring import median_and_spread, print_table

from al_questioner.concepts import ConceptModels
from al_questioner.support.arrays import Array

THINGS, SYMBOLS, FEATURES = 12, 4, 60

AS_USERS = 'scikit-learn, as users write it'
DISTINCT = 'scikit-learn, distinct fits only'
ACTIVEML = 'scikit-activeml, error reduction'
COLD = 'ours: look_ahead, new scene'
SEEN = 'ours: look_ahead, scene seen'
WITH_FIT = 'ours: fit one label more + it'
OUR_WAYS = (COLD, SEEN, WITH_FIT)

OURS_A_ROUND = 5
"""Calls of ours after each call of a rival, which take so much longer."""

LEGEND = f"""\
{AS_USERS}: for each thing and symbol a multiclass GaussianProcessClassifier, fitted and asked.
{DISTINCT}: a binary one for each symbol, thing, and whether the one is the other: 2 |X| |Y|.
{ACTIVEML}: MonteCarloEER with that classifier. It fits as many as the first and returns, in the
  place of the table, one expected error of each label query (|X| numbers): no demonstration queries, no other utility.
{COLD}: the models are fitted to the n labels and have not seen the scene: its covariances included.
{SEEN}: predict_proba has been asked about the scene before, as in a turn of an episode.
{WITH_FIT}: fitted to n - 1 labels; fit with the n-th, then the look-ahead of a new scene.
error: largest difference from scikit-learn refitted to convergence. scikit-learn stops its Newton's method early; what
  users get is normalised over the symbols, and so is what it is compared to.
"""

Figures = dict[str, Any]
Call = Callable[[], float]


def compare(sizes: Sequence[int], repeats: int, peak: machine.Work) -> Figures:
    """Time all ways at each number of labels, print and return the figures; a rival is called `repeats` times."""
    if refitting.expected_error_reduction(clustered_state(np.random.default_rng(0), 8, 2, 4)) is None:
        print('scikit-activeml is not installed (pip install scikit-activeml): left out.\n')
    figures = {}
    for n in sizes:
        state = clustered_state(np.random.default_rng(n), n, THINGS, SYMBOLS, FEATURES)
        seconds = timed_in_turns(state, repeats)
        figures[str(n)] = report(state, seconds, errors_of(state), peak)
    print(LEGEND)
    print(machine.WORK)
    print('of peak: time of that work at the measured matrix products, by the median time.\n')
    return figures


def timed_in_turns(state: State, repeats: int) -> dict[str, list[float]]:
    """Seconds of each call of each way: ours after every call of a rival."""
    rivals = {AS_USERS: timed(refitting.as_users_write, state), DISTINCT: timed(refitting.distinct_fits, state)}
    weigh = refitting.expected_error_reduction(state)
    if weigh is not None:
        rivals[ACTIVEML] = timed(weigh)
    ours = own_calls(state)
    for call in ours.values():
        call()
    seconds: dict[str, list[float]] = {name: [] for name in (*rivals, *ours)}
    for _ in range(repeats):
        for name, call in rivals.items():
            seconds[name].append(call())
            for own, own_call in ours.items():
                seconds[own] += [own_call() for _ in range(OURS_A_ROUND)]
    return seconds


def own_calls(state: State) -> dict[str, Call]:
    """Return the timed calls of our ways; each prepares, unmeasured, what its name takes for granted."""
    models = ConceptModels(state.symbols, state.amplitude)

    def new_scene() -> float:
        models.fit(state.features, state.labels)
        return timed(models.look_ahead, state.scene)()

    def scene_seen() -> float:
        models.fit(state.features, state.labels).predict_proba(state.scene)
        return timed(models.look_ahead, state.scene)()

    def with_fit() -> float:
        models.fit(state.features[:-1], state.labels[:-1])
        return timed(lambda: models.fit(state.features, state.labels).look_ahead(state.scene))()

    return {COLD: new_scene, SEEN: scene_seen, WITH_FIT: with_fit}


def timed(function: Callable[..., Any], *arguments: Any) -> Call:
    """A call of a function that returns its seconds."""

    def call() -> float:
        start = time.perf_counter()
        function(*arguments)
        return time.perf_counter() - start

    return call


def errors_of(state: State) -> dict[str, float]:
    """Largest error of each way that makes the table, where scikit-learn converged."""
    truth = refitting.until_convergence(state)
    models = state.models()
    warm = ConceptModels(state.symbols, state.amplitude).fit(state.features[:-1], state.labels[:-1])
    warm.fit(state.features, state.labels)
    cold = largest(models.look_ahead(state.scene), truth)
    return {
        AS_USERS: largest(refitting.as_users_write(state), truth / truth.sum(axis=-1, keepdims=True)),
        DISTINCT: largest(refitting.distinct_fits(state), truth),
        COLD: cold,
        SEEN: largest(models.look_ahead(state.scene), truth),
        WITH_FIT: largest(warm.look_ahead(state.scene), truth),
    }


def largest(table: Array, truth: Array) -> float:
    """Largest difference where the truth is known."""
    return float(np.nanmax(np.abs(table - truth)))


def report(state: State, seconds: dict[str, list[float]], errors: dict[str, float], peak: machine.Work) -> Figures:
    """Print and return the figures of one number of labels."""
    n = len(state.labels)
    reference = median_and_spread(seconds[AS_USERS])[0]
    needed = machine.work(n, THINGS, SYMBOLS)
    least = needed.seconds(peak)
    rows, figures = [], {}
    for name, values in seconds.items():
        median, spread = median_and_spread(values)
        error = errors.get(name, float('nan'))
        cells = [f'{1e3 * median:.3f}', f'{1e3 * spread:.3f}', f'{len(values)}', f'{reference / median:.0f}x']
        cells += ['' if np.isnan(error) else f'{error:.0e}', f'{least / median:.0%}' if name in OUR_WAYS else '']
        rows.append([name, *cells])
        figures[name] = {'median': 1e3 * median, 'spread': 1e3 * spread, 'ratio': reference / median, 'error': error}
    print_table(
        f'n={n}, |X|={THINGS}, |Y|={SYMBOLS}, m={FEATURES}, amplitude {state.amplitude:g}',
        ('', 'median ms', 'spread', 'calls', 'ratio', 'error', 'of peak'),
        rows,
    )
    print(
        f'Work: {needed.double / 1e6:.1f} MFLOP double, {needed.single / 1e6:.1f} MFLOP single precision;'
        f' {1e3 * least:.3f} ms at the peak.\n'
    )
    return figures
