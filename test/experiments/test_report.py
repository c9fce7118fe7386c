"""The page: that it says what the tables do, on results made up so that the answer is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import mannwhitneyu

from al_questioner.experiments.plan import Cell, Plan, Variation
from al_questioner.experiments.report import Page, report
from al_questioner.experiments.results import EpisodeRow, Results, TurnRow
from al_questioner.experiments.studies import Study
from al_questioner.questioning import Weights

PAPER_METHOD = [0.70, 0.71, 0.72, 0.73, 0.74, 0.75]
BETTER = [0.80, 0.81, 0.82, 0.83, 0.84, 0.85]
WORSE = [0.50, 0.51, 0.52, 0.53, 0.54, 0.55]


def made(finals: Mapping[str, Sequence[float]], task: str = 'kitchen_table') -> Results:
    """Results of one condition, two turns long."""
    episodes, turns = [], []
    for strategy, values in finals.items():
        for sample, value in enumerate(values):
            cell = Cell(task, 25.0, 40, strategy, sample)
            episodes.append(EpisodeRow(cell, value, value, 3, 4.0))
            turns += [TurnRow(cell, turn, value, 'label', '1', 'snack', 'answered', turn) for turn in (1, 2)]
    return Results(episodes, turns)


def page_of(results: Results, **members: object) -> str:
    intervals = {'kitchen_table': 5, 'prepare_lunch': 10, 'pack_lunchbox': 10}
    return report(Page('the command', results, intervals, (), {}, **members), Path())


def test_the_first_paragraph_says_where_a_control_is_better() -> None:
    """It is the one thing that a reader must not miss."""
    controls = {'random_fsq': WORSE, 'farthest_fsq': BETTER, 'u_sampling_fsq': [value + 0.01 for value in PAPER_METHOD]}
    page = page_of(made({'dt_task_env': PAPER_METHOD, 'dt_iros': BETTER, 'dt_task': WORSE, **controls}))
    p = mannwhitneyu(BETTER, PAPER_METHOD, alternative='greater').pvalue
    assert 'in 1 of 1 cell' in page
    assert f'farthest_fsq 0.825, dt_task_env 0.725 (p = {3 * p:.3f})' in page
    assert 'Other strategies of the paper are more accurate' in page
    assert '- kitchen_table, C1: budget 25, 40 turns: dt_iros 0.825\n' in page


def test_the_first_paragraph_tells_the_other_side_too() -> None:
    """A page that tells only what simple rules do would be as one-sided as a paper that plays none."""
    others = {'dt_iros': WORSE, 'dt_task': [value + 0.001 for value in PAPER_METHOD], 'farthest_fsq': BETTER}
    finding = "**Of the paper's own strategies, dt_task_env is the most accurate, in the mean, in {} of 1 cell**"
    for strategies, first, sure in ((others, 0, 'none'), ({**others, 'dt_task': WORSE}, 1, 1)):
        page = page_of(made({'dt_task_env': PAPER_METHOD, **strategies}))
        paragraph = page.split('\n\n')[1]
        assert paragraph.startswith(f'{finding.format(first)}, significantly above each of the others in {sure}.')
    assert "Of the paper's own strategies" not in page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))


def test_ceilings_of_few_samples_take_none_from_the_strategies() -> None:
    """Otherwise all tests would be made on the few samples that a slow oracle was played on."""
    results = made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE, 'greedy_oracle': BETTER[:2]})
    p = mannwhitneyu(PAPER_METHOD, WORSE, alternative='greater').pvalue
    page = page_of(results)
    assert f'| `random_fsq` | +0.200 | {p:.4f} |' in page
    assert 'They were played on the first 2 samples alone.' in page
    assert f'| `greedy_oracle` | {np.mean(BETTER[:2]):.3f} ' in page
    everywhere = page_of(made({'dt_task_env': PAPER_METHOD, 'greedy_oracle': BETTER}))
    assert 'know the truth' in everywhere
    assert 'first 6 samples' not in everywhere


def test_the_first_paragraph_says_where_none_is() -> None:
    """Otherwise the paper's method would be said to lose where it wins."""
    page = page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))
    assert 'In the only cell no control is more accurate, in the mean, than dt_task_env.' in page
    assert 'Other strategies' not in page


def test_the_first_paragraph_says_what_was_not_compared() -> None:
    """Otherwise the page would say that no control was played although their accuracies stand below."""
    assert 'No other strategy was played beside dt_task_env' in page_of(made({'dt_task_env': PAPER_METHOD}))
    assert 'No control was played beside dt_task_env.' in page_of(made({'dt_task_env': BETTER, 'dt_task': WORSE}))
    controls = page_of(made({'random_fsq': WORSE, 'rarest_demo': BETTER}))
    assert 'No episode of dt_task_env was finished: nothing is tested.' in controls
    assert 'No control was played' not in controls
    ceilings = page_of(made({'all_labels': BETTER, 'greedy_oracle': BETTER}), compared=None)
    assert ceilings.startswith(
        '# Accuracy of all_labels, greedy_oracle\n\nOnly ceilings were played: nothing is tested.'
    )


def test_a_page_is_about_the_strategy_that_was_asked_about() -> None:
    """Otherwise who asks about a strategy would read whether another one is better than the others."""
    others = {'dt_iros': WORSE, 'random_fsq': WORSE, 'farthest_fsq': BETTER}
    page = page_of(made({'value_per_cost': PAPER_METHOD, **others}), compared='value_per_cost')
    assert page.startswith('# value_per_cost against 3 other strategies\n')
    assert (
        'Of the strategies that were played, value_per_cost is the most accurate, in the mean, in 0 of 1 cell' in page
    )
    assert 'A simple control is more accurate, in the mean, than value_per_cost in 1 of 1 cell' in page
    # Only the controls that were played.
    assert 'The controls, random_fsq, farthest_fsq, follow one rule each.' in page
    assert '- kitchen_table, C1: budget 25, 40 turns: farthest_fsq 0.825, value_per_cost 0.725 (' in page
    assert '## value_per_cost against each other strategy' in page
    p = mannwhitneyu(PAPER_METHOD, WORSE, alternative='greater').pvalue
    assert f'| `dt_iros` | +0.200 | {p:.4f} |' in page
    assert "one standard error, of the paper's strategies and value_per_cost." in page
    assert 'dt_task_env' not in page


def test_a_control_is_compared_with_the_others() -> None:
    """Otherwise it would be said to be better than itself."""
    finals = {'random_fsq': WORSE, 'farthest_fsq': BETTER, 'value_per_cost': PAPER_METHOD}
    beaten = page_of(made(finals), compared='random_fsq')
    assert 'Another simple control is more accurate, in the mean, than random_fsq in 1 of 1 cell' in beaten
    assert 'The other control, farthest_fsq, follows one rule.' in beaten
    others = 'Other strategies are more accurate than it in these cells:'
    assert f'{others}\n\n- kitchen_table, C1: budget 25, 40 turns: value_per_cost 0.725\n' in beaten
    best = page_of(made(finals), compared='farthest_fsq')
    assert 'In the only cell no other control is more accurate, in the mean, than farthest_fsq.' in best
    assert '## Where others are more accurate' not in best


def test_a_strategy_that_is_played_alone_claims_nothing() -> None:
    """Otherwise a page about a strategy of one's own would speak of claims that nobody made."""
    page = page_of(made({'mine': PAPER_METHOD}), compared='mine')
    assert page.startswith('# Accuracy of mine\n\nNo other strategy was played beside mine: nothing is tested.\n')
    assert 'claim' not in page
    assert "the paper's" not in page
    assert 'against' not in page


def test_the_claims_of_the_paper_stand_below_what_was_asked() -> None:
    """Otherwise who asks about another strategy would have to read first what the paper says of its own."""
    own = {'dt_task_env': BETTER, **dict.fromkeys(('u_sampling', 'dt_iros', 'dt_task'), WORSE)}
    results = made({**own, 'value_per_cost': PAPER_METHOD}, 'prepare_lunch')
    page = page_of(results, compared='value_per_cost')
    assert page.startswith('# value_per_cost against 4 other strategies\n')
    before, _, after = page.partition('## What the paper claims')
    assert 'hold:' not in before
    assert 'Of the paper' not in before
    assert "Of the paper's claims, " in after
    assert 'These claims of the paper hold:\n\n- prepare_lunch, C1: accuracy order: dt_task_env first\n' in after
    assert page_of(results).startswith('# Reproduction\n')


def test_means_deviations_and_tests_are_those_of_the_tables() -> None:
    """Otherwise the numbers that people quote would be wrong."""
    page = page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))
    assert f'| `random_fsq` | {np.mean(WORSE):.3f} ± {np.std(WORSE, ddof=1):.3f} (3) |' in page
    p = mannwhitneyu(PAPER_METHOD, WORSE, alternative='greater').pvalue
    assert f'| `random_fsq` | +0.200 | {p:.4f} | {p:.4f} | 1.00 [1.00, 1.00] |' in page


def test_only_a_page_that_tests_a_claim_is_called_a_reproduction() -> None:
    """Otherwise a comparison of other strategies, or on other tasks, would pass for a reproduction of the paper."""
    own = {'dt_task_env': PAPER_METHOD, **dict.fromkeys(('u_sampling', 'dt_iros', 'dt_task'), WORSE)}
    assert page_of(made(own, 'prepare_lunch')).startswith('# Reproduction\n')
    for elsewhere in (made(own), made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}, 'prepare_lunch')):
        page = page_of(elsewhere)
        assert page.startswith('# dt_task_env against ')
        assert 'Reproduction' not in page


def test_few_samples_give_no_interval() -> None:
    """Otherwise two samples would be printed as certainty."""
    page = page_of(made({'dt_task_env': PAPER_METHOD[:2], 'random_fsq': WORSE[:2]}))
    assert '| 1.00 |' in page
    assert '[1.00, 1.00]' not in page
    assert 'fewer than 5 samples cannot tell' in page
    assert 'cannot tell' not in page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))


def test_what_was_not_played_has_no_section() -> None:
    """Otherwise empty tables would look like results."""
    page = page_of(made({'random_fsq': WORSE}), compared='random_fsq')
    assert 'against each other strategy' not in page
    assert 'What the paper claims' not in page
    assert '## The weights' not in page
    assert 'greedy_oracle' not in page


def test_variations_and_weights_are_told() -> None:
    """Otherwise a page about erring teachers would pass for one about the paper."""
    weights = {'dt_iros': Weights({'discriminability': 0.9}, 'Set by somebody.')}
    results = made({'dt_task_env': PAPER_METHOD})
    page = report(Page('c', results, {'kitchen_table': 5}, (), weights, varied='share of wrong answers 0.1'), Path())
    assert '**Varied throughout: share of wrong answers 0.1.**' in page
    assert '| `dt_iros` | 0.900 |' in page
    assert '`dt_iros`: Set by somebody.' in page


@pytest.mark.parametrize('compared', ['dt_task_env', 'value_per_cost'])
@pytest.mark.parametrize('own', [True, False])
def test_a_study_shows_the_comparison_only_if_it_has_it(own: bool, compared: str) -> None:
    """Otherwise an empty row would stand for what was never played."""
    plan = Plan(
        ('kitchen_table',), (Cell('kitchen_table', 25.0, 40, 'x', 0).condition,), ('u_sampling',), (0, 1), Variation()
    )
    study = Study('s', 'A study', 'About it.', 'as it is', {'otherwise': plan})
    found = {'otherwise': made({'u_sampling': WORSE[:2]})}
    comparison = made({compared: PAPER_METHOD, **({'u_sampling': BETTER} if own else {})})
    page = page_of(comparison, studies=[(study, found)], compared=compared)
    assert '| otherwise | 0.505 ± 0.007 (3) |' in page
    assert ('| as it is | 0.805 ± 0.007 (3) |' in page) == own
    assert f'| beside it: `{compared}` | 0.705 ± 0.007 (3) |' in page
    better = f'More accurate than {compared}, in the mean:\n\n- kitchen_table, C1: budget 25, 40 turns: as it is'
    assert (better in page) == own


def test_the_page_begins_with_what_holds_and_what_does_not() -> None:
    """A reader would have to gather it from the tables."""
    order = ('u_sampling', 'dt_iros', 'dt_task')
    page = page_of(made({'dt_task_env': BETTER, **dict.fromkeys(order, WORSE)}, 'prepare_lunch'))
    conclusion = page.partition('## What the paper claims')[0]
    hold, _, fail = conclusion.partition('These claims of the paper do not hold:')
    assert 'hold:\n\n- prepare_lunch, C1: accuracy order: dt_task_env first\n' in hold
    assert '- prepare_lunch: the decision-theoretic strategies ask the FSQ early' in fail
