"""Ways to the same table, timed in turns, with the error of each."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from itertools import product
from typing import Any

import numpy as np
from look_ahead_parts import machine, refitting
from look_ahead_parts.states import SHIPPED, SHIPPED_RBF, SMALL_RBF, State, clustered_state
from measuring import median_and_spread, print_table

from al_questioner.support.arrays import Array

THINGS, SYMBOLS, FEATURES = 12, 4, 60

KINDS = (SHIPPED, SHIPPED_RBF, SMALL_RBF)
"""Classifiers that are measured: those that ship, the same amplitude without groups, and a small one."""

AS_USERS = 'scikit-learn, as users write it'
OWN_RBF = 'scikit-learn, its own RBF kernel'
DISTINCT = 'scikit-learn, distinct fits only'
ACTIVEML = 'scikit-activeml, error reduction'
COLD = 'ours: look_ahead, new scene'
SEEN = 'ours: look_ahead, scene seen'
WITH_FIT = 'ours: fit one label more + it'
OUR_WAYS = (COLD, SEEN, WITH_FIT)

OURS_A_ROUND = 5
"""Calls of ours after each call of a rival, which take so much longer."""

LEGEND = f"""\
Times are those of the CPU, so that other processes of the machine count little.
{AS_USERS}: for each thing and symbol a multiclass GaussianProcessClassifier with the kernel
  of the table, fitted and asked. The grouped kernel is our own code, the RBF kernel is scikit-learn's.
{OWN_RBF}: the same with scikit-learn's RBF kernel of the same amplitude: other classifiers.
{DISTINCT}: a binary one for each symbol, thing, and whether the one is the other: 2 |X| |Y|.
{ACTIVEML}: MonteCarloEER with that classifier. It fits as many as the first and returns, in the
  place of the table, one expected error of each label query (|X| numbers): no demonstration queries, no other utility.
{COLD}: the models are fitted to the n labels and have not seen the scene: its covariances included.
{SEEN}: predict_proba has been asked about the scene before, as in a turn of an episode.
{WITH_FIT}: fitted to n - 1 labels; fit with the n-th, then the look-ahead of a new scene.
ratio: of the first to this, the median of the rounds, in each of which all are timed.
error: largest difference from scikit-learn refitted to convergence and, where the classes are balanced, balanced. The
  rivals are compared as they are, without balance. scikit-learn stops its Newton's method early; what users get is
  normalised over the symbols, and so is what it is compared to.
"""

Figures = dict[str, Any]
Call = Callable[[], float]


def compare(sizes: Sequence[int], repeats: int, peak: float) -> Figures:
    """Time all ways at each number of labels, print and return the figures; a rival is called `repeats` times."""
    if refitting.expected_error_reduction(clustered_state(np.random.default_rng(0), 8, 2, 4)) is None:
        print('scikit-activeml is not installed (pip install scikit-activeml): left out.\n')
    figures: Figures = {}
    for kind, n in product(KINDS, sizes):
        state = clustered_state(np.random.default_rng(n), n, THINGS, SYMBOLS, FEATURES, kind)
        rounds = timed_in_turns(state, repeats)
        figures.setdefault(str(kind), {})[str(n)] = report(state, rounds, errors_of(state), peak)
    print(LEGEND)
    print(machine.WORK)
    print('of peak: time of that work at the measured matrix products, by the median time.\n')
    summarise(figures)
    return figures


def summarise(figures: Figures) -> None:
    """Print the ratios of all classifiers side by side."""
    sizes = list(next(iter(figures.values())))
    rows = []
    for kind, of_kind in figures.items():
        for rival in (AS_USERS, OWN_RBF):
            if rival in of_kind[sizes[0]]:
                cells = (f'{of_kind[n][COLD]["median"]:.2f}, {of_kind[n][COLD]["ratios"][rival]:.0f}x' for n in sizes)
                rows.append([kind, rival, *cells])
    print_table(
        f'In short: ms of a look-ahead of a new scene, and how many times as fast as refitting, |X|={THINGS}',
        ('classifiers', 'refitted', *(f'n={n}' for n in sizes)),
        rows,
    )
    print()


def timed_in_turns(state: State, repeats: int) -> list[dict[str, list[float]]]:
    """Seconds of the calls of each way in each round: ours after every call of a rival."""
    rivals = {AS_USERS: timed(refitting.as_users_write, state), DISTINCT: timed(refitting.distinct_fits, state)}
    if state.kind == SHIPPED:
        rivals[OWN_RBF] = timed(refitting.as_users_write, state, refitting.own_rbf_of(state))
        weigh = refitting.expected_error_reduction(state)
        if weigh is not None:
            rivals[ACTIVEML] = timed(weigh)
    ours = own_calls(state)
    for call in ours.values():
        call()
    rounds = []
    for _ in range(repeats):
        seconds: dict[str, list[float]] = {name: [] for name in (*rivals, *ours)}
        for name, call in rivals.items():
            seconds[name].append(call())
            for own, own_call in ours.items():
                seconds[own] += [own_call() for _ in range(OURS_A_ROUND)]
        rounds.append(seconds)
    return rounds


def own_calls(state: State) -> dict[str, Call]:
    """Return the timed calls of our ways; each prepares, unmeasured, what its name takes for granted."""
    models = state.empty_models()

    def new_scene() -> float:
        models.fit(state.features, state.labels, state.groups)
        return timed(models.look_ahead, state.scene)()

    def scene_seen() -> float:
        models.fit(state.features, state.labels, state.groups).predict_proba(state.scene)
        return timed(models.look_ahead, state.scene)()

    def with_fit() -> float:
        models.fit(state.features[:-1], state.labels[:-1], state.groups)
        return timed(lambda: models.fit(state.features, state.labels, state.groups).look_ahead(state.scene))()

    return {COLD: new_scene, SEEN: scene_seen, WITH_FIT: with_fit}


def timed(function: Callable[..., Any], *arguments: Any) -> Call:
    """A call of a function that returns its seconds, those of the CPU."""

    def call() -> float:
        start = time.process_time()
        function(*arguments)
        return time.process_time() - start

    return call


def errors_of(state: State) -> dict[str, float]:
    """Largest error of each way that makes the table of the state's classifiers, where scikit-learn converged."""
    truth = refitting.until_convergence(state)
    balanced = state.balanced(truth)
    models = state.models()
    warm = state.empty_models().fit(state.features[:-1], state.labels[:-1], state.groups)
    warm.fit(state.features, state.labels, state.groups)
    cold = largest(models.look_ahead(state.scene), balanced)
    return {
        AS_USERS: largest(refitting.as_users_write(state), truth / truth.sum(axis=-1, keepdims=True)),
        DISTINCT: largest(refitting.distinct_fits(state), truth),
        COLD: cold,
        SEEN: largest(models.look_ahead(state.scene), balanced),
        WITH_FIT: largest(warm.look_ahead(state.scene), balanced),
    }


def largest(table: Array, truth: Array) -> float:
    """Largest difference where the truth is known."""
    return float(np.nanmax(np.abs(table - truth)))


def report(state: State, rounds: Sequence[dict[str, list[float]]], errors: dict[str, float], peak: float) -> Figures:
    """Print and return the figures of one number of labels."""
    n = len(state.labels)
    needed = machine.work(n, THINGS, SYMBOLS)
    least = needed / peak
    rows, figures = [], {}
    for name in rounds[0]:
        values = [seconds for each in rounds for seconds in each[name]]
        median, spread = median_and_spread(values)
        ratios = {rival: ratio(rounds, rival, name) for rival in (AS_USERS, OWN_RBF) if rival in rounds[0]}
        error = errors.get(name, float('nan'))
        cells = [f'{1e3 * median:.3f}', f'{1e3 * spread:.3f}', f'{len(values)}', f'{ratios[AS_USERS]:.0f}x']
        cells += ['' if np.isnan(error) else f'{error:.0e}', f'{least / median:.0%}' if name in OUR_WAYS else '']
        rows.append([name, *cells])
        figures[name] = {'median': 1e3 * median, 'spread': 1e3 * spread, 'ratios': ratios, 'error': error}
    print_table(
        f'n={n}, |X|={THINGS}, |Y|={SYMBOLS}, m={FEATURES}: {state.kind}',
        ('', 'median ms', 'spread', 'calls', 'ratio', 'error', 'of peak'),
        rows,
    )
    print(f'Work: {needed / 1e6:.1f} MFLOP; {1e3 * least:.3f} ms at the peak.\n')
    return figures


def ratio(rounds: Sequence[dict[str, list[float]]], rival: str, name: str) -> float:
    """Time of a rival as a multiple of that of a way, the median over the rounds."""
    return float(np.median([np.median(each[rival]) / np.median(each[name]) for each in rounds]))
