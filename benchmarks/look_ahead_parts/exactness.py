"""The look-ahead against refitting, over states of all kinds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from look_ahead_parts import refitting
from look_ahead_parts.actions import choose, task_weights
from look_ahead_parts.states import (
    LARGEST_AMPLITUDE,
    SHIPPED,
    State,
    clustered_state,
    random_state,
    without_odds,
)
from measuring import print_table

from al_questioner.concepts.kernel import RBF
from al_questioner.support.arrays import Array

NEAR_TIE = 1e-9
"""Margin of expected utility below which two actions are equally good: rounding decides."""

EVERY = 10
"""Number of states of which one is also compared to scikit-learn, in two hypotheses for each symbol."""

SAMPLED = 2
"""Labels of each state that are refitted, where not all are."""

QUANTILES = (0.5, 0.9, 0.99, 0.999, 1.0)

LEGEND = f"""\
States: 0 to 150 examples, 10 to 70 features in groups of 1 to 12, 2 to 12 things, 2 to 5 symbols; amplitudes 1 to
{LARGEST_AMPLITUDE:g} by their logarithm; half with the RBF kernel, a quarter with the grouped one that ships, a quarter
with other saturations and exponents; half with class balance .5, half without; one in three repeats examples and shows
labelled views again, one in ten knows a single class.
Refitted are fresh models: for a sampled label (x, y) of all symbols at once, for all labels of each distinct
hypothesis. scikit-learn is refitted until it stands still, for one thing of every {EVERY}th state, as an example of
each symbol and as none."""

Figures = dict[str, Any]


@dataclass(frozen=True)
class Compared:
    """A look-ahead beside a better one of the same state.

    Attributes:
        error: largest difference of a probability.
        same: whether it leads to the same action.
        margin: by how much, in the better one, the chosen action exceeds the next.
    """

    error: float
    same: bool
    margin: float


def check(states: int, whole: int, seed: int = 0) -> Figures:
    """Compare with refitting, print and return the figures.

    Of one state in `whole` the whole table is refitted, which tells the chosen action.
    """
    weights, rng = task_weights(), np.random.default_rng(seed)
    compared, direct, outside, unanswered = [], [], [], 0
    by_kernel: dict[str, list[float]] = {}
    worst = (0.0, '')
    for number in range(states):
        state = random_state(rng)
        ahead = state.models().look_ahead(state.scene, exact=True)
        direct.append(sampled_error(state, ahead, rng))
        worst = max(worst, (direct[-1], described(state)))
        by_kernel.setdefault('rbf' if state.kind.shape == RBF else 'grouped', []).append(direct[-1])
        if number % whole == 0:
            compared.append(compare(state, ahead, refitting.own_refits(state), weights))
            worst = max(worst, (compared[-1].error, described(state)))
        if number % EVERY == 0:
            found, missing = against_scikit_learn(state, ahead, int(rng.integers(len(state.scene))))
            outside += found
            unanswered += missing
    errors = [result.error for result in compared]
    print_table(
        f'Exactness over {states} random states: largest error',
        ('', *(f'{quantile:.1%}' for quantile in QUANTILES), 'number'),
        [
            [f'of {SAMPLED} labels of a state, from ConceptModels refitted', *quantiles(direct), f'{len(direct)}'],
            *([f'  with the {name} kernel', *quantiles(of), f'{len(of)}'] for name, of in sorted(by_kernel.items())),
            ['of all labels of a state', *quantiles(errors), f'{len(errors)}'],
            ['of a hypothesis, from scikit-learn refitted', *quantiles(outside), f'{len(outside)}'],
        ],
    )
    print(LEGEND)
    refused = f'{unanswered} of {len(outside) + unanswered}'
    print(f'scikit-learn refuses (a single class) or does not settle in {refused} of those hypotheses.')
    print(f'The largest error, {worst[0]:.1e}, is at {worst[1]}.')
    print(f'Where all labels were refitted (one state in {whole}, see --whole), ', end='')
    return {
        'sampled': dict(zip(map(str, QUANTILES), np.quantile(direct, QUANTILES).tolist(), strict=True)),
        'errors': dict(zip(map(str, QUANTILES), np.quantile(errors, QUANTILES).tolist(), strict=True)),
        'largest_from_scikit_learn': max(outside, default=float('nan')),
        'actions': report_actions(compared, 'brute force'),
    }


def sampled_error(state: State, ahead: Array, rng: np.random.Generator) -> float:
    """Largest error of a few labels (x, y), each refitted for all symbols at once."""
    drawn = [tuple(int(rng.integers(size)) for size in ahead.shape[:2]) for _ in range(SAMPLED)]
    return max(float(np.abs(ahead[i, j] - refitting.own_refit(state, i, j)).max()) for i, j in drawn)


def check_approximation(states: int, seed: int = 1) -> Figures:
    """Compare the approximate mode with the exact one where the classifiers are those of the learner.

    So many states are of the kinds of `check`, and as many of the clusters that the other tables are about.
    """
    weights, rng = task_weights(), np.random.default_rng(seed)
    drawn = {
        'states of all kinds': [random_state(rng, SHIPPED) for _ in range(states)],
        'clusters, |X|=12, |Y|=4, m=60': [clustered_state(rng, int(rng.integers(151)), 12, 4) for _ in range(states)],
    }
    compared: dict[str, list[Compared]] = {kind: [] for kind in drawn}
    for kind, of_kind in drawn.items():
        for state in of_kind:
            models = state.models()
            exact, cheap = (models.look_ahead(state.scene, exact=exact) for exact in (True, False))
            compared[kind].append(compare(state, cheap, exact, weights))
    errors = {kind: [result.error for result in results] for kind, results in compared.items()}
    print_table(
        f'Approximate mode, exact=False against exact=True, n up to 150: {SHIPPED}',
        ('largest error of a state', *(f'{quantile:.1%}' for quantile in QUANTILES), 'number'),
        [[kind, *quantiles(of_kind), f'{len(of_kind)}'] for kind, of_kind in errors.items()],
    )
    figures = {}
    for kind, results in compared.items():
        print(f'{kind[0].upper()}{kind[1:]}: ', end='')
        figures[kind] = {
            'errors': dict(zip(map(str, QUANTILES), np.quantile(errors[kind], QUANTILES).tolist(), strict=True)),
            'actions': report_actions(results, 'exact'),
        }
    return figures


def compare(state: State, table: Array, truth: Array, weights: Array) -> Compared:
    """A look-ahead against a better one."""
    q = state.models().predict_proba(state.scene)
    chosen, best = (choose(state, q, ahead, weights) for ahead in (table, truth))
    return Compared(float(np.abs(table - truth).max()), chosen.action == best.action, best.margin)


def against_scikit_learn(state: State, ahead: Array, thing: int) -> tuple[list[float], int]:
    """Largest error of each hypothesis about one thing, and how many scikit-learn has no answer to."""
    errors = []
    for j, target in np.ndindex(len(state.symbols), 2):
        if len(np.unique([*state.targets(j), target])) == 2:
            label = j if target else (j + 1) % len(state.symbols)
            truth = without_odds(refitting.converged(state, thing, j, target), state.odds()[label, j])
            errors.append(np.abs(truth - ahead[thing, label, :, j]).max())
    found = [float(error) for error in errors if not np.isnan(error)]
    return found, 2 * len(state.symbols) - len(found)


def report_actions(compared: Sequence[Compared], truth: str) -> Figures:
    """Print and return how often the chosen action is another than the true one."""
    ties = [result for result in compared if result.margin < NEAR_TIE]
    clear = [result for result in compared if result.margin >= NEAR_TIE]
    differ = Counter(result.margin < NEAR_TIE for result in compared if not result.same)
    margins = [result.margin for result in clear if not result.same]
    least = f'; margins up to {max(margins):.0e}' if margins else ''
    print(
        f'chosen action other than by {truth}: {differ[False]} of {len(clear)} states{least}; '
        f'and {differ[True]} of {len(ties)} near ties (margin below {NEAR_TIE:g}).\n'
    )
    return {'clear': len(clear), 'differ': differ[False], 'near_ties': len(ties), 'near_ties_differ': differ[True]}


def quantiles(errors: Sequence[float]) -> list[str]:
    """The cells of a line."""
    if not errors:
        return [''] * len(QUANTILES)
    return [f'{value:.1e}' for value in np.quantile(errors, QUANTILES)]


def described(state: State) -> str:
    """A state in a few words."""
    return (
        f'n={len(state.labels)}, |X|={len(state.scene)}, |Y|={len(state.symbols)}, m={state.scene.shape[1]}, '
        f'amplitude {state.kind.amplitude:.3g}, saturation {state.kind.shape.saturation:.3g}, '
        f'class balance {state.kind.class_balance:g}'
    )
