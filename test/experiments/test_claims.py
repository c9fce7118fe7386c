"""What is said of the paper's claims, on results made up so that the answer is known."""

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
"""When what is asked in C4 and in C2."""


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


def test_all_is_reproduced_where_all_is_as_in_the_paper() -> None:
    """The page would damn the paper for nothing."""
    in_c2 = {**FINALS, 'dt_task': HIGH}
    by_name = {
        'C1': made(FINALS, FRUGAL, 'C1'),
        'C2': made(in_c2, FRUGAL, 'C2'),
        'C3': made(FINALS, PAPER_TURNS, 'C3'),
        'C4': made(FINALS, PAPER_TURNS),
    }
    results = both(both(by_name['C1'], by_name['C2']), both(by_name['C3'], by_name['C4']))
    results = both(results, made(FINALS, FRUGAL, 'C1', 'pack_lunchbox'))
    found = list(verdicts(results, {'prepare_lunch': 10, 'pack_lunchbox': 10}))
    assert [each.claim for each in found if not each.reproduced] == []
    assert len(found) == 5 * 2 + 1 + 2 + 2 + 2 + 1
    p = mannwhitneyu(HIGH, LOW, alternative='greater').pvalue
    assert (
        f'dt_task: p = {p:.3f} (Holm p = {3 * p:.3f}), superiority 1.00'
        in verdict(results, 'C4: dt_task_env stat').tests
    )


@pytest.mark.parametrize(
    ('words', 'changes'),
    [
        ('statistically outperforms', {'finals': {**FINALS, 'dt_task': HIGH}}),
        ('accuracy order', {'finals': {**FINALS, 'dt_iros': [0.95] * 5}}),
        ('asks at every turn', {'asks': {**PAPER_TURNS, 'u_sampling': range(2, 151)}}),
        ('FSQ early', {'subset_turn': 11}),
        ('134 / 22 / 9', {'asks': {**PAPER_TURNS, 'dt_task': FRESH[:9]}}),
        ('order of magnitude', {'asks': {**PAPER_TURNS, 'dt_task_env': range(1, 100)}}),
    ],
)
def test_a_claim_about_c4_fails_when_its_figures_do(words: str, changes: Mapping[str, object]) -> None:
    """The page would praise the paper for nothing."""
    arguments = {'finals': FINALS, 'asks': PAPER_TURNS, **changes}
    assert verdict(made(FINALS, PAPER_TURNS), words).reproduced
    assert not verdict(made(**arguments), words).reproduced


@pytest.mark.parametrize(
    ('words', 'asks'),
    [
        ('closer to the beginning', {**FRUGAL, 'dt_task': range(100, 122)}),
        ('rate of change', {**FRUGAL, 'dt_task_env': [turn + 5 for turn in FRESH[:20]]}),
    ],
)
def test_a_claim_about_behaviour_in_c2_fails_when_its_figures_do(words: str, asks: Mapping[str, range]) -> None:
    """A questioner that does not keep up with the scene would be said to."""
    assert verdict(made(FINALS, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made(FINALS, asks, 'C2'), words).reproduced


def test_equality_in_c2_means_better_than_all_others_and_not_than_dt_task() -> None:
    """In C2 the paper claims a draw with dt_task, so that a win there is no reproduction."""
    words = 'to which it is equal'
    assert verdict(made({**FINALS, 'dt_task': HIGH}, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made(FINALS, FRUGAL, 'C2'), words).reproduced
    assert not verdict(made({**FINALS, 'dt_task': HIGH, 'dt_iros': HIGH}, FRUGAL, 'C2'), words).reproduced


def test_task_centric_learners_must_ask_the_same_in_c2_and_c4() -> None:
    """A learner that looks at its budget would be said not to."""
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
    """A page about two strategies would claim something about four."""
    half = made({name: FINALS[name] for name in ('dt_task', 'dt_task_env')}, PAPER_TURNS)
    assert list(verdicts(half, {'prepare_lunch': 10})) == []
