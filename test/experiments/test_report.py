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
    assert 'No control was played beside dt_task_env.' in page_of(made({'dt_task_env': PAPER_METHOD}))
    controls = page_of(made({'random_fsq': WORSE, 'rarest_demo': BETTER}))
    assert 'Controls were played, but dt_task_env, the method of the paper, was not.' in controls
    assert 'No control was played' not in controls
    assert 'No control was played, and dt_task_env' in page_of(made({'value_per_cost': PAPER_METHOD}))


def test_means_deviations_and_tests_are_those_of_the_tables() -> None:
    """Otherwise the numbers that people quote would be wrong."""
    page = page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))
    assert f'| `random_fsq` | {np.mean(WORSE):.3f} ± {np.std(WORSE, ddof=1):.3f} (3) |' in page
    p = mannwhitneyu(PAPER_METHOD, WORSE, alternative='greater').pvalue
    assert f'| `random_fsq` | +0.200 | {p:.4f} | {p:.4f} | 1.00 [1.00, 1.00] |' in page


def test_only_a_page_with_the_papers_method_is_called_a_reproduction() -> None:
    """Otherwise a comparison of other strategies would pass for a reproduction of the paper."""
    assert page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE})).startswith('# Reproduction\n')
    others = page_of(made({'value_per_cost': PAPER_METHOD, 'dt_iros': WORSE}))
    assert others.startswith('# Comparison of questioning strategies\n')
    assert 'Reproduction' not in others


def test_few_samples_give_no_interval() -> None:
    """Otherwise two samples would be printed as certainty."""
    page = page_of(made({'dt_task_env': PAPER_METHOD[:2], 'random_fsq': WORSE[:2]}))
    assert '| 1.00 |' in page
    assert '[1.00, 1.00]' not in page
    assert 'fewer than 5 samples cannot tell' in page
    assert 'cannot tell' not in page_of(made({'dt_task_env': PAPER_METHOD, 'random_fsq': WORSE}))


def test_what_was_not_played_has_no_section() -> None:
    """Otherwise empty tables would look like results."""
    page = page_of(made({'random_fsq': WORSE}))
    assert 'against each other strategy' not in page
    assert 'no claim is tested' in page
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


@pytest.mark.parametrize('own', [True, False])
def test_a_study_shows_the_comparison_only_if_it_has_it(own: bool) -> None:
    """Otherwise an empty row would stand for what was never played."""
    plan = Plan(
        ('kitchen_table',), (Cell('kitchen_table', 25.0, 40, 'x', 0).condition,), ('u_sampling',), (0, 1), Variation()
    )
    study = Study('s', 'A study', 'About it.', 'as it is', {'otherwise': plan})
    found = {'otherwise': made({'u_sampling': WORSE[:2]})}
    comparison = made({'dt_task_env': PAPER_METHOD, **({'u_sampling': BETTER} if own else {})})
    page = page_of(comparison, studies=[(study, found)])
    assert '| otherwise | 0.505 ± 0.007 (3) |' in page
    assert ('| as it is | 0.805 ± 0.007 (3) |' in page) == own
    assert '| beside it: `dt_task_env` | 0.705 ± 0.007 (3) |' in page
    better = 'More accurate than dt_task_env, in the mean:\n\n- kitchen_table, C1: budget 25, 40 turns: as it is'
    assert (better in page) == own


def test_the_page_begins_with_what_holds_and_what_does_not() -> None:
    """A reader would have to gather it from the tables."""
    order = ('u_sampling', 'dt_iros', 'dt_task')
    page = page_of(made({'dt_task_env': BETTER, **dict.fromkeys(order, WORSE)}, 'prepare_lunch'))
    conclusion = page.partition('## What the paper claims')[0]
    hold, _, fail = conclusion.partition('These claims of the paper do not hold:')
    assert 'hold:\n\n- prepare_lunch, C1: accuracy order: dt_task_env first\n' in hold
    assert '- prepare_lunch: the decision-theoretic strategies ask the FSQ early' in fail
