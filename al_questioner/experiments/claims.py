"""Claims of the paper, as statements that the tables of an experiment confirm or not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.domain import QueryKind
from al_questioner.experiments.plan import PAPER_CONDITIONS, PAPER_METHOD, PAPER_STRATEGIES, PAPER_TASKS, Condition
from al_questioner.experiments.results import Results, TurnRow
from al_questioner.experiments.statistics import Comparison, compare, exceeds, p_text, paired_p

BASELINES = tuple(name for name in PAPER_STRATEGIES if name != PAPER_METHOD)
TASK_CENTRIC = ('dt_iros', 'dt_task')
DECISION_THEORETIC = (*TASK_CENTRIC, PAPER_METHOD)
EQUAL_IN_C2 = 'dt_task'
CONSERVATIVE = (EQUAL_IN_C2, PAPER_METHOD)
"""Strategies that the paper calls conservative, and very similar, with a small budget and much time."""
SIGNIFICANT = 0.05
PAPER_COUNTS = {PAPER_METHOD: 134, 'dt_task': 22, 'dt_iros': 9}
"""Numbers of queries of one sample in C4 on prepare_lunch, from the paper."""
COUNT_FACTOR = 1.5
EARLY_TURN = 5
"""Turn by which the paper's expert had asked its feature subset query."""
FRESH_TURNS = 3
"""Number of turns after a change of the scene in which a questioner that adapts to it asks more than its share."""
DEAREST = 2.0
"""Price of the most expensive query; with less than that left, a small budget begins to exclude queries."""


@dataclass(frozen=True)
class Verdict:
    """One claim and its result.

    Attributes:
        claim: the statement of the paper.
        found: our figures.
        reproduced: whether the figures confirm it; None if there are too few samples to show it.
        tests: p-values and effects, if the claim is about significance.
        by_construction: whether it follows from the strategies themselves, in any world.
    """

    claim: str
    found: str
    reproduced: bool | None
    tests: str = ''
    by_construction: bool = False


def verdicts(results: Results, change_intervals: Mapping[str, int]) -> Iterator[Verdict]:
    """Yield a verdict for each claim that the experiment has the episodes for; the intervals are turns, by task."""
    for task in PAPER_TASKS:
        played = [name for name in PAPER_CONDITIONS if _was_played(results, task, name)]
        for name in played:
            yield from _accuracy_verdicts(results, task, name)
        if len(played) == len(PAPER_CONDITIONS):
            yield _never_below_task_centric(results, task)
    lunch = PAPER_TASKS[0]
    played = [name for name in PAPER_CONDITIONS if _was_played(results, lunch, name)]
    if played:
        yield _asks_at_every_turn(results, lunch, played)
        yield _asks_for_the_subset_early(results, lunch, played)
    if 'C4' in played:
        yield from _query_counts(results, lunch)
    if 'C2' in played:
        yield _asks_as_much(results, lunch)
        yield _spends_early(results, lunch)
        yield _keeps_up_with_the_scene(results, lunch, change_intervals[lunch])
    if 'C2' in played and 'C4' in played:
        yield _task_centric_do_the_same(results, lunch)


def baseline_comparisons(results: Results, task: str, condition: Condition) -> list[Comparison]:
    """Return comparisons of dt_task_env with each of the paper's baselines, corrected within the condition."""
    accuracies = results.final_accuracies(task, condition)
    return compare(accuracies[PAPER_METHOD], {name: accuracies[name] for name in BASELINES if name in accuracies})


def _was_played(results: Results, task: str, name: str) -> bool:
    """Return whether all four strategies have a sample in common."""
    accuracies = results.final_accuracies(task, PAPER_CONDITIONS[name])
    return all(len(accuracies.get(strategy, ())) for strategy in PAPER_STRATEGIES)


def _means(results: Results, task: str, name: str) -> dict[str, float]:
    accuracies = results.final_accuracies(task, PAPER_CONDITIONS[name])
    return {strategy: float(accuracies[strategy].mean()) for strategy in PAPER_STRATEGIES}


def _accuracy_verdicts(results: Results, task: str, name: str) -> Iterator[Verdict]:
    where = f'{task}, {name}'
    means = _means(results, task, name)
    order = ' > '.join(f'{strategy} {means[strategy]:.3f}' for strategy in sorted(means, key=lambda s: -means[s]))
    if name == 'C2':
        ahead = min(means[strategy] for strategy in CONSERVATIVE)
        rest = max(means[strategy] for strategy in PAPER_STRATEGIES if strategy not in CONSERVATIVE)
        who, confirmed = f'{PAPER_METHOD} and {EQUAL_IN_C2} ahead of the others', exceeds(ahead, rest)
    else:
        who, confirmed = f'{PAPER_METHOD} first', not exceeds(max(means.values()), means[PAPER_METHOD])
    yield Verdict(f'{where}: accuracy order: {who}', order, confirmed)
    comparisons = {c.other: c for c in baseline_comparisons(results, task, PAPER_CONDITIONS[name])}
    tests = '; '.join(
        f'{other}: {p_text(c.p)} (Holm {p_text(c.p_holm)}), superiority {c.superiority:.2f}'
        for other, c in comparisons.items()
    )
    differences = ', '.join(f'{c.mean - c.other_mean:+.3f} to {other}' for other, c in comparisons.items())
    beaten = {other for other, c in comparisons.items() if c.p_holm < SIGNIFICANT}
    n = len(results.final_accuracies(task, PAPER_CONDITIONS[name])[PAPER_METHOD])
    # The smallest p-value of n samples each, perfectly separated.
    can_be_shown = len(comparisons) / math.comb(2 * n, n) < SIGNIFICANT
    if name != 'C2':
        claim = f'{where}: {PAPER_METHOD} statistically outperforms all others'
        yield Verdict(claim, differences, beaten == set(comparisons) if can_be_shown else None, tests)
        return
    behind = compare(*_pair(results, task, name, EQUAL_IN_C2, PAPER_METHOD))[0]
    equal = EQUAL_IN_C2 not in beaten and behind.p >= SIGNIFICANT
    yield Verdict(
        f'{where}: {PAPER_METHOD} statistically outperforms all others but {EQUAL_IN_C2}, to which it is equal'
        ' (no difference found in either direction)',
        differences,
        (beaten == set(comparisons) - {EQUAL_IN_C2} and equal) if can_be_shown else None,
        f'{tests}; {EQUAL_IN_C2} above it: {p_text(behind.p)}',
    )


def _pair(
    results: Results, task: str, name: str, first: str, other: str
) -> tuple[np.ndarray, Mapping[str, np.ndarray]]:
    accuracies = results.final_accuracies(task, PAPER_CONDITIONS[name])
    return accuracies[first], {other: accuracies[other]}


def _never_below_task_centric(results: Results, task: str) -> Verdict:
    gaps = {}
    for name in PAPER_CONDITIONS:
        means = _means(results, task, name)
        gaps[name] = means[PAPER_METHOD] - max(means[strategy] for strategy in TASK_CENTRIC)
    return Verdict(
        f'{task}, all conditions: {PAPER_METHOD} always performs at least as well as dt_iros and dt_task',
        ', '.join(f'{name} {gap:+.3f}' for name, gap in gaps.items()) + ' to the better of them',
        not exceeds(0.0, min(gaps.values())),
    )


def _asks_at_every_turn(results: Results, task: str, names: Sequence[str]) -> Verdict:
    found, always = [], True
    for name in names:
        condition = PAPER_CONDITIONS[name]
        asked = []
        for turns in _episodes(results, task, condition, 'u_sampling').values():
            affordable = min(len(turns), int(condition.budget))
            asked.append(all(turn.kind == QueryKind.LABEL.value for turn in turns[:affordable]))
        found.append(f'{name} in {sum(asked)} of {len(asked)} samples')
        always = always and all(asked)
    claim = f'{task}: u_sampling asks at every turn until its budget is gone'
    return Verdict(claim, ', '.join(found), always, by_construction=True)


def _asks_for_the_subset_early(results: Results, task: str, names: Sequence[str]) -> Verdict:
    """Judge the median turn of the subset query; an episode without one counts as if it were asked after the end."""
    found, early = [], True
    for strategy in DECISION_THEORETIC:
        turns = [
            next((turn.turn for turn in episode if turn.kind == QueryKind.FEATURE_SUBSET.value), math.inf)
            for name in names
            for episode in _episodes(results, task, PAPER_CONDITIONS[name], strategy).values()
        ]
        median = float(np.median(turns))
        early = early and median <= EARLY_TURN
        in_time = sum(turn <= EARLY_TURN for turn in turns)
        when = f'in turn {min(turns):g} to {max(turns):g}, median {median:g}'
        found.append(f'{strategy} {when}, in {in_time} of {len(turns)} episodes by turn {EARLY_TURN}')
    return Verdict(
        f'{task}: the decision-theoretic strategies ask the FSQ early (median by turn {EARLY_TURN}, the bound that the'
        ' paper gives for its expert)',
        '; '.join(found).replace('inf', 'never'),
        early,
    )


def _query_counts(results: Results, task: str) -> Iterator[Verdict]:
    counts = {name: _mean_queries(results, task, 'C4', name) for name in PAPER_COUNTS}
    found = ' / '.join(f'{count:.0f}' for count in counts.values())
    wanted = f'{" / ".join(map(str, PAPER_COUNTS.values()))} queries of {" / ".join(PAPER_COUNTS)}'
    yield Verdict(
        f'{task}, C4: about {wanted} (within a factor of {COUNT_FACTOR})',
        found,
        all(paper / COUNT_FACTOR <= counts[name] <= paper * COUNT_FACTOR for name, paper in PAPER_COUNTS.items()),
    )
    yield Verdict(
        f'{task}, C4: {PAPER_METHOD} asks about an order of magnitude more than dt_task and dt_iros'
        ' (at least five times)',
        found,
        counts[PAPER_METHOD] >= 5 * max(counts[name] for name in TASK_CENTRIC),
    )


def _asks_as_much(results: Results, task: str) -> Verdict:
    counts = [_mean_queries(results, task, 'C2', name) for name in CONSERVATIVE]
    return Verdict(
        f'{task}, C2: {" and ".join(CONSERVATIVE)} ask very similarly (numbers of queries within a factor of'
        f' {COUNT_FACTOR})',
        ' / '.join(f'{count:.0f}' for count in counts) + ' queries',
        max(counts) <= COUNT_FACTOR * min(counts),
    )


def _mean_queries(results: Results, task: str, name: str, strategy: str) -> float:
    return float(np.mean([row.queries for row in results.group(task, PAPER_CONDITIONS[name], strategy)]))


def _spends_early(results: Results, task: str) -> Verdict:
    condition = PAPER_CONDITIONS['C2']
    shares = {}
    for name in CONSERVATIVE:
        spent = [turns[condition.turns // 2 - 1].spent for turns in _episodes(results, task, condition, name).values()]
        shares[name] = float(np.mean(spent)) / condition.budget
    return Verdict(
        f'{task}, C2: {" and ".join(CONSERVATIVE)} use most of their budget closer to the beginning'
        ' (more than half of it in the first half of the time)',
        ', '.join(f'{name} {share:.0%}' for name, share in shares.items()),
        min(shares.values()) > 0.5,
    )


def _keeps_up_with_the_scene(results: Results, task: str, interval: int) -> Verdict:
    """Compare the queries after a change with queries that are spread evenly until the last one.

    The last one comes within a scene.
    """
    found, tests, does = [], [], True
    for name in (*CONSERVATIVE, 'u_sampling'):
        asked, evenly = [], []
        for turns in _episodes(results, task, PAPER_CONDITIONS['C2'], name).values():
            queries = [turn.turn for turn in turns[interval:] if turn.kind != QueryKind.NO_QUERY.value]
            if queries:
                asked.append(_fresh_share(queries, interval))
                evenly.append(_fresh_share(range(interval + 1, max(queries) + 1), interval))
        if not asked:
            does = does and name not in CONSERVATIVE
            found.append(f'{name} asks nothing')
            continue
        p = paired_p(np.array(asked), np.array(evenly))
        found.append(f'{name} {np.mean(asked):.0%} ({np.mean(evenly):.0%} were it spread evenly)')
        tests.append(f'{name}: {p_text(p)}')
        does = does and (name not in CONSERVATIVE or p < SIGNIFICANT)
    return Verdict(
        f'{task}, C2: {" and ".join(CONSERVATIVE)} modulate their consumption with the rate of change (after the first'
        f' scene, more of the queries in the {FRESH_TURNS} turns after a change than if spread evenly; signed-rank'
        ' test); u_sampling, beside them, does not',
        ', '.join(found),
        does,
        '; '.join(tests),
    )


def _fresh_share(turns: Sequence[int], interval: int) -> float:
    return float(np.mean([(turn - 1) % interval < FRESH_TURNS for turn in turns]))


def _task_centric_do_the_same(results: Results, task: str) -> Verdict:
    """Compare the queries as long as the smaller budget pays for everything."""
    poor, rich = PAPER_CONDITIONS['C2'], PAPER_CONDITIONS['C4']
    same = {}
    for name in TASK_CENTRIC:
        first, second = _episodes(results, task, poor, name), _episodes(results, task, rich, name)
        same[name] = [
            all(
                (a.kind, a.object_id, a.symbol) == (b.kind, b.object_id, b.symbol)
                for a, b in zip(first[sample], second[sample], strict=True)
                if b.spent <= poor.budget - DEAREST
            )
            for sample in sorted(first.keys() & second.keys())
        ]
    return Verdict(
        f'{task}: dt_task and dt_iros ask exactly the same in C2 as in C4, as long as the budget lasts',
        ', '.join(f'{name} in {sum(equal)} of {len(equal)} samples' for name, equal in same.items()),
        all(all(equal) for equal in same.values()),
        by_construction=True,
    )


def _episodes(results: Results, task: str, condition: Condition, strategy: str) -> Mapping[int, Sequence[TurnRow]]:
    """Return the turns of each episode, by sample."""
    return {row.cell.sample: results.turns_of(row.cell) for row in results.group(task, condition, strategy)}
