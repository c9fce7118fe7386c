"""Verdicts on the paper's claims, on results made up so that the answer is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest
from scipy.stats import mannwhitneyu

from al_questioner.experiments.claims import Verdict, verdicts
from al_questioner.experiments.plan import PAPER_CONDITIONS, Cell, Condition
from al_questioner.experiments.results import EpisodeRow, Results, TurnRow

LOW, HIGH = [0.5, 0.51, 0.52, 0.53, 0.54], [0.9, 0.91, 0.92, 0.93, 0.94]
FINALS = {'u_sampling': LOW, 'dt_iros': LOW, 'dt_task': LOW, 'dt_task_env': HIGH}
"""As the paper has it, but for C2."""
FRESH = [turn for first in range(1, 151, 10) for turn in (first, first + 1)]
"""The first two turns of every scene."""
EVERY = range(1, 151)
PAPER_TURNS = {'u_sampling': EVERY, 'dt_iros': FRESH[:9], 'dt_task': FRESH[:22], 'dt_task_env': range(1, 135)}
FRUGAL = {**PAPER_TURNS, 'dt_task_env': FRESH[:20]}
"""Times at which each kind of question is asked in C4 and in C2."""


def made(
    finals: Mapping[str, Sequence[float]],
    asks: Mapping[str, Sequence[int]],
    name: str = 'C4',
    task: str = 'prepare_lunch',
    subset_turn: int = 2,
) -> Results:
    """Results of a condition in which each strategy ends with these accuracies and asks in these turns.

    They are label queries of price 1, as long as the budget lasts, with one feature subset query but of u_sampling.
    """
    episodes, turns = [], []
    condition: Condition = PAPER_CONDITIONS[name]
    for strategy, values in finals.items():
        for sample, value in enumerate(values):
            cell = Cell(task, condition.budget, condition.turns, strategy, sample)
            spent = 0.0
            for turn in range(1, condition.turns + 1):
                asked = turn in asks[strategy] and spent < condition.budget
                spent += asked
                is_subset = asked and turn == subset_turn and strategy != 'u_sampling'
                kind = 'feature_subset' if is_subset else 'label' if asked else 'no_query'
                turns.append(TurnRow(cell, turn, value, kind, str(turn) if asked else '', '', 'answered', spent))
            episodes.append(EpisodeRow(cell, value, value, int(spent), spent))
    return Results(episodes, turns)


def both(first: Results, second: Results) -> Results:
    """Two results as one."""
    return Results([*first.episodes, *second.episodes], [*first.turns, *second.turns])


def verdict(results: Results, words: str) -> Verdict:
    (found,) = [each for each in verdicts(results, {'prepare_lunch': 10, 'pack_lunchbox': 10}) if words in each.claim]
    return found


def all_conditions(task: str, finals: Mapping[str, Sequence[float]] = FINALS) -> Results:
    """Results of a task in all four conditions, as the paper has them."""
    drawn = {**finals, 'dt_task': finals['dt_task_env']}
    poor = both(made(finals, FRUGAL, 'C1', task), made(drawn, FRUGAL, 'C2', task))
    return both(poor, both(made(finals, PAPER_TURNS, 'C3', task), made(finals, PAPER_TURNS, 'C4', task)))


def test_all_is_reproduced_where_all_is_as_in_the_paper() -> None:
    """Otherwise the page would say that claims fail that hold."""
    results = both(all_conditions('prepare_lunch'), all_conditions('pack_lunchbox'))
    found = list(verdicts(results, {'prepare_lunch': 10, 'pack_lunchbox': 10}))
    assert [each.claim for each in found if not each.reproduced] == []
    assert len(found) == 2 * (4 * 2 + 1) + 2 + 2 + 3 + 1
    assert sum(each.by_construction for each in found) == 2
    p = mannwhitneyu(HIGH, LOW, alternative='greater').pvalue
    tests = verdict(all_conditions('prepare_lunch'), 'C4: dt_task_env stat').tests
    assert f'dt_task: p = {p:.3f} (Holm p = {3 * p:.3f}), superiority 1.00' in tests


@pytest.mark.parametrize(
    ('words', 'changes'),
    [
        ('statistically outperforms', {'finals': {**FINALS, 'dt_task': HIGH}}),
        ('accuracy order', {'finals': {**FINALS, 'dt_iros': [0.95] * 5}}),
        ('asks at every turn', {'asks': {**PAPER_TURNS, 'u_sampling': range(2, 151)}}),
        ('FSQ early', {'subset_turn': 11}),
        ('FSQ early', {'subset_turn': 1000}),
        ('134 / 22 / 9', {'asks': {**PAPER_TURNS, 'dt_task': FRESH[:9]}}),
        ('order of magnitude', {'asks': {**PAPER_TURNS, 'dt_task_env': range(1, 100)}}),
    ],
)
def test_a_claim_about_c4_fails_when_its_figures_do(words: str, changes: Mapping[str, object]) -> None:
    """Otherwise the page would say that claims hold that fail."""
    arguments = {'finals': FINALS, 'asks': PAPER_TURNS, **changes}
    assert verdict(made(FINALS, PAPER_TURNS), words).reproduced
    assert not verdict(made(**arguments), words).reproduced


@pytest.mark.parametrize(
    ('words', 'asks'),
    [
        ('closer to the beginning', {**FRUGAL, 'dt_task': range(100, 122)}),
        ('closer to the beginning', {**FRUGAL, 'dt_task': FRESH[:12]}),
        ('very similarly', {**FRUGAL, 'dt_task': FRESH[:12]}),
        ('rate of change', {**FRUGAL, 'dt_task_env': [turn + 5 for turn in FRESH[:20]]}),
        ('rate of change', {**FRUGAL, 'dt_task_env': EVERY}),
        ('rate of change', {**FRUGAL, 'dt_task_env': ()}),
    ],
)
def test_a_claim_about_behaviour_in_c2_fails_when_its_figures_do(words: str, asks: Mapping[str, range]) -> None:
    """Otherwise the page would say that a questioner keeps up with the scene though it does not."""
    assert verdict(made(FINALS, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made(FINALS, asks, 'C2'), words).reproduced


def test_equality_in_c2_means_better_than_all_others_and_not_than_dt_task() -> None:
    """In C2 the paper claims a draw with dt_task, so that a win there is no reproduction."""
    words = 'to which it is equal'
    assert verdict(made({**FINALS, 'dt_task': HIGH}, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made(FINALS, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made({**FINALS, 'dt_task': HIGH, 'dt_iros': HIGH}, FRUGAL, 'C2'), words).reproduced
    # Beaten by it is not equal to it.
    assert not verdict(made({**FINALS, 'dt_task': [0.99] * 5}, FRUGAL, 'C2'), words).reproduced


def test_the_order_in_c2_is_of_two_before_two() -> None:
    """The paper has a draw there, so that either of them may come first."""
    words = 'ahead of the others'
    assert verdict(made({**FINALS, 'dt_task': [0.99] * 5}, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made(FINALS, FRUGAL, 'C2'), words).reproduced


def test_holm_decides_and_not_the_bare_p() -> None:
    """Otherwise three tests would be taken for one."""
    other = [0.5, 0.51, 0.905, 0.915, 0.53]
    p = mannwhitneyu(HIGH, other, alternative='greater').pvalue
    finals = dict.fromkeys(FINALS, other) | {'dt_task_env': HIGH}
    assert p < 0.05 < 3 * p
    assert not verdict(made(finals, PAPER_TURNS), 'statistically').reproduced


def test_too_few_samples_are_no_refutation() -> None:
    """Otherwise a quick try on three samples would say of every claim that it fails."""
    few = made({name: values[:3] for name, values in FINALS.items()}, PAPER_TURNS)
    assert verdict(few, 'statistically').reproduced is None
    assert verdict(few, 'accuracy order').reproduced


def test_the_lunchbox_must_bear_out_what_is_said_of_it() -> None:
    """One condition is not enough to say that the paper's results are replicated on a second task."""
    results = both(all_conditions('prepare_lunch'), all_conditions('pack_lunchbox', {**FINALS, 'dt_iros': [0.95] * 5}))
    assert verdict(results, 'prepare_lunch, all conditions').reproduced
    failed = verdict(results, 'pack_lunchbox, all conditions')
    assert not failed.reproduced
    assert 'C1 -0.030' in failed.found


def test_holes_in_the_tables_are_stepped_over() -> None:
    """Otherwise one failed episode would end the page, or pair one sample with another."""
    results = both(made(FINALS, FRUGAL, 'C2'), made(FINALS, {**PAPER_TURNS, 'dt_iros': FRESH[:9]}))
    lost = {Cell('prepare_lunch', 25, 150, 'dt_iros', 0), Cell('prepare_lunch', 500, 150, 'dt_iros', 3)}
    holed = Results(
        [row for row in results.episodes if row.cell not in lost],
        [row for row in results.turns if row.cell not in lost],
    )
    assert 'dt_iros in 3 of 3 samples, dt_task in 5 of 5' in verdict(holed, 'exactly the same').found
    other = Results(
        [row for row in holed.episodes if row.cell.sample != 4 or row.cell.strategy == 'dt_task'], holed.turns
    )
    assert verdict(other, 'C4: accuracy order').reproduced
    apart = [row for row in results.episodes if (row.cell.strategy == 'dt_task') == (row.cell.sample > 2)]
    assert list(verdicts(Results(apart, results.turns), {'prepare_lunch': 10})) == []


def test_task_centric_learners_must_ask_the_same_in_c2_and_c4() -> None:
    """Otherwise the page would say of a learner that looks at its budget that it does not."""
    words = 'exactly the same'
    rich = made(FINALS, PAPER_TURNS)
    assert verdict(both(made(FINALS, FRUGAL, 'C2'), rich), words).reproduced
    other = {**FRUGAL, 'dt_iros': FRESH[1:10]}
    assert not verdict(both(made(FINALS, other, 'C2'), rich), words).reproduced
    # What the smaller budget cannot pay for is no difference.
    more = made(FINALS, {**PAPER_TURNS, 'dt_iros': EVERY})
    poor = made(FINALS, {**FRUGAL, 'dt_iros': EVERY}, 'C2')
    assert verdict(both(poor, more), words).reproduced


def test_no_claim_without_its_episodes() -> None:
    """Otherwise a page about two strategies would claim something about four."""
    half = made({name: FINALS[name] for name in ('dt_task', 'dt_task_env')}, PAPER_TURNS)
    assert list(verdicts(half, {'prepare_lunch': 10})) == []
