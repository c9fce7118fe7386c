"""What the paper claims, as statements that the tables of an experiment confirm or not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from al_questioner.domain import QueryKind
from al_questioner.experiments.plan import PAPER_CONDITIONS, PAPER_STRATEGIES, Condition
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import Comparison, compare

OURS = 'dt_task_env'
BASELINES = tuple(name for name in PAPER_STRATEGIES if name != OURS)
SIGNIFICANT = 0.05
PAPER_COUNTS = {OURS: 134, 'dt_task': 22, 'dt_iros': 9}
"""Queries in C4 on prepare_lunch, of one sample."""
EARLY_TURN = 5
"""The paper's expert asked its feature subset query within so many turns; so early is early."""


@dataclass(frozen=True)
class Verdict:
    """One claim and what became of it.

    Attributes:
        claim: what the paper says.
        found: our figures.
        reproduced: whether they bear it out.
    """

    claim: str
    found: str
    reproduced: bool


def verdicts(results: Results) -> Iterator[Verdict]:
    """The claims that the experiment has the episodes for."""
    for task in results.tasks:
        for name, condition in PAPER_CONDITIONS.items():
            if all(results.group(task, condition, strategy) for strategy in PAPER_STRATEGIES):
                yield from _condition_verdicts(results, task, name, condition)


def _condition_verdicts(results: Results, task: str, name: str, condition: Condition) -> Iterator[Verdict]:
    if task not in ('prepare_lunch', 'pack_lunchbox') or (task == 'pack_lunchbox' and name != 'C1'):
        return
    where = f'{task}, {name}'
    comparisons = baseline_comparisons(results, task, condition)
    if name == 'C2':
        yield _all_but_dt_task(where, comparisons)
    else:
        yield _outperforms_all(where, comparisons)
    yield _most_accurate(results, task, condition, where)
    if task == 'prepare_lunch':
        yield _asks_at_every_turn(results, task, condition, where)
        yield _asks_for_the_subset_early(results, task, condition, where)
        if name == 'C4':
            yield from _query_counts(results, task, condition, where)


def baseline_comparisons(results: Results, task: str, condition: Condition) -> dict[str, Comparison]:
    """Comparisons of dt_task_env with each of the paper's baselines, corrected within the condition."""
    accuracies = results.final_accuracies(task, condition)
    others = {name: accuracies[name] for name in BASELINES if name in accuracies}
    return {comparison.other: comparison for comparison in compare(accuracies[OURS], others)}


def _p_values(comparisons: dict[str, Comparison]) -> str:
    parts = [f'{name} p = {c.p:.3f} (Holm {c.p_holm:.3f})' for name, c in comparisons.items()]
    return '; '.join(parts)


def _outperforms_all(where: str, comparisons: dict[str, Comparison]) -> Verdict:
    return Verdict(
        f'{where}: dt_task_env statistically outperforms all others',
        _p_values(comparisons),
        all(comparison.p_holm < SIGNIFICANT for comparison in comparisons.values()),
    )


def _all_but_dt_task(where: str, comparisons: dict[str, Comparison]) -> Verdict:
    equal = not comparisons['dt_task'].p_holm < SIGNIFICANT
    better = all(c.p_holm < SIGNIFICANT for name, c in comparisons.items() if name != 'dt_task')
    return Verdict(
        f'{where}: it outperforms all others but dt_task, to which it is equal',
        _p_values(comparisons),
        equal and better,
    )


def _most_accurate(results: Results, task: str, condition: Condition, where: str) -> Verdict:
    accuracies = results.final_accuracies(task, condition)
    means = {name: float(accuracies[name].mean()) for name in PAPER_STRATEGIES}
    order = sorted(means, key=lambda name: -means[name])
    return Verdict(
        f'{where}: dt_task_env is the most accurate of the four',
        ', '.join(f'{name} {means[name]:.3f}' for name in order),
        means[OURS] >= max(means.values()),
    )


def _asks_at_every_turn(results: Results, task: str, condition: Condition, where: str) -> Verdict:
    asked = []
    for row in results.group(task, condition, 'u_sampling'):
        turns = results.turns_of(row.cell)
        affordable = min(len(turns), int(condition.budget))
        asked.append(all(turn.kind == QueryKind.LABEL.value for turn in turns[:affordable]))
    return Verdict(
        f'{where}: u_sampling asks at every turn until its budget is gone',
        f'in {sum(asked)} of {len(asked)} samples',
        all(asked),
    )


def _asks_for_the_subset_early(results: Results, task: str, condition: Condition, where: str) -> Verdict:
    first: dict[str, list[str]] = {}
    early = True
    for name in ('dt_iros', 'dt_task', OURS):
        for row in results.group(task, condition, name):
            turn = next((t.turn for t in results.turns_of(row.cell) if t.kind == QueryKind.FEATURE_SUBSET.value), None)
            first.setdefault(name, []).append('never' if turn is None else str(turn))
            early = early and turn is not None and turn <= EARLY_TURN
    found = '; '.join(f'{name} in turn {" ".join(turns)}' for name, turns in first.items())
    return Verdict(
        f'{where}: the decision-theoretic strategies ask the FSQ early (first {EARLY_TURN} turns)', found, early
    )


def _query_counts(results: Results, task: str, condition: Condition, where: str) -> Iterator[Verdict]:
    counts = {
        name: float(np.mean([row.queries for row in results.group(task, condition, name)])) for name in PAPER_COUNTS
    }
    names = ' / '.join(PAPER_COUNTS)
    found = ' / '.join(f'{count:.0f}' for count in counts.values())
    yield Verdict(
        f'{where}: about {" / ".join(map(str, PAPER_COUNTS.values()))} queries of {names} (within a factor of 1.5)',
        found,
        all(paper / 1.5 <= counts[name] <= paper * 1.5 for name, paper in PAPER_COUNTS.items()),
    )
    yield Verdict(
        f'{where}: dt_task_env asks about an order of magnitude more than dt_task and dt_iros (at least five times)',
        found,
        counts[OURS] >= 5 * max(counts['dt_task'], counts['dt_iros']),
    )
