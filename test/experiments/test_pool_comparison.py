"""Comparisons of strategies on a user's own data."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from al_questioner import Costs, Pool, compare
from al_questioner.domain import InputError
from al_questioner.experiments.playing import Played
from al_questioner.experiments.pool_comparison import PoolComparison
from al_questioner.experiments.statistics import compare as compare_accuracies
from al_questioner.simulation import PoolWorld, ScriptedTeacher, episode_settings, run_episode

SMALL = {'repeats': 2, 'turns': 8, 'in_view': 8, 'change_interval': 4}


def pool_of(things: int = 60) -> Pool:
    """Things of three symbols, which the first two features tell apart."""
    rng = np.random.default_rng(0)
    labels = ['cup', 'plate', 'fork'] * (things // 3)
    features = rng.normal(size=(things, 3)) + np.array([[4, 0, 0], [0, 4, 0], [0, 0, 0]] * (things // 3))
    return Pool(features, labels, ['shape', 'shape', 'noise'])


POOL = pool_of()


@pytest.fixture(scope='module')
def found() -> PoolComparison:
    """Comparison of two strategies under two budgets."""
    return compare(['random_fsq', 'farthest_fsq', 'all_labels'], POOL, [4, 8], name='things', **SMALL)


def test_an_episode_is_the_one_that_anybody_plays(found: PoolComparison) -> None:
    """Otherwise the comparison would be about other episodes than those of `run_episode`."""
    for row in found.results.episodes:
        cell = row.cell
        if cell.strategy == 'all_labels':
            continue
        world = PoolWorld(POOL, cell.sample, in_view=8, change_interval=4, name='things')
        teacher = ScriptedTeacher(world.task.symbols, world.task.relevant_groups, cell.sample)
        settings = episode_settings(world.task, cell.strategy, cell.budget, cell.turns)
        result = run_episode(world.spec, settings, teacher, world=world)
        assert (row.final_accuracy, row.spent) == (result.final_accuracy, result.spent)
        assert [turn.accuracy for turn in found.results.turns_of(cell)] == list(result.accuracy)


def test_strategies_share_the_splits(found: PoolComparison) -> None:
    """The tests are paired, so the accuracies of all strategies must be in the order of the same splits."""
    assert found.results.samples == (0, 1)
    assert list(found.accuracies(8)) == ['random_fsq', 'farthest_fsq', 'all_labels']
    by_split = {
        row.cell.sample: row.final_accuracy
        for row in found.results.episodes
        if (row.cell.strategy, row.cell.budget) == ('farthest_fsq', 8)
    }
    assert found.accuracies(8)['farthest_fsq'].tolist() == [by_split[0], by_split[1]]


def test_the_tests_are_those_of_an_experiment(found: PoolComparison) -> None:
    """A second kind of statistics would give a second kind of truth. A ceiling is no rival."""
    accuracies = found.accuracies(4)
    assert found.against(budget=4) == compare_accuracies(
        accuracies['random_fsq'], {'farthest_fsq': accuracies['farthest_fsq']}
    )
    assert [each.other for each in found.against('farthest_fsq', 4)] == ['random_fsq']


def test_a_ceiling_is_not_tested(tmp_path: Path) -> None:
    """The one that knows the truth is more accurate than all who ask, which says nothing of them."""
    found = compare(['all_labels', 'random_fsq', 'farthest_fsq'], POOL, 4, **SMALL)
    assert found.compared == 'random_fsq'
    assert [each.other for each in found.against()] == ['farthest_fsq']
    assert 'Is random_fsq more accurate?' in str(found)
    with pytest.raises(InputError, match='all_labels knows the truth'):
        found.against('all_labels')
    alone = compare(['all_labels'], POOL, 4, **SMALL)
    assert alone.compared is None
    assert 'more accurate?' not in str(alone)
    assert alone.draw(tmp_path)
    with pytest.raises(InputError, match='knows the truth'):
        alone.against()


def test_it_is_read_in_a_terminal_and_in_a_notebook(found: PoolComparison) -> None:
    """The object itself is what people print."""
    text = str(found)
    assert repr(found) == text
    lines = [line.split() for line in text.splitlines()]
    mean = found.accuracies(4)['farthest_fsq'].mean()
    assert ['farthest_fsq', f'{mean:.3f}'] in [line[:2] for line in lines]
    assert 'Is random_fsq more accurate?' in text
    assert [line[4] for line in lines if line[:2] == ['budget', '4,']] == ['farthest_fsq']
    html = found._repr_html_()
    assert html.startswith('<pre>')
    assert 'src="data:image/png;base64,' in html


def test_it_is_drawn_as_an_experiment_is(found: PoolComparison, tmp_path: Path) -> None:
    """The curves tell who is ahead when, which the end does not."""
    assert {path.name for path in found.draw(tmp_path / 'new')} == {
        f'{name}_things.png' for name in ('learning_curves', 'behaviour', 'queries', 'budget', 'accuracy_by_cost')
    }
    titles = [panel.get_title(loc='left') for panel in found.figure().axes]
    assert titles == ['budget 8, 8 turns', 'budget 4, 8 turns']


def test_the_conditions_of_the_paper_are_not_those_of_a_pool() -> None:
    """Otherwise who knows nothing of the paper would ask what C1 is."""
    found = compare(['random_fsq'], POOL, 25, **{**SMALL, 'repeats': 1, 'turns': 40})
    assert 'budget 25, 40 turns' in str(found)
    assert 'C1' not in str(found)
    (panel,) = found.figure().axes
    assert panel.get_title(loc='left') == 'budget 25, 40 turns'


def test_a_single_strategy_is_tested_against_nobody() -> None:
    """A first look at a pool needs one strategy only, and one budget need not be named."""
    found = compare(['random_fsq'], POOL, 4, **SMALL)
    assert 'more accurate' not in str(found)
    assert found.against() == []
    assert len(found.accuracies()['random_fsq']) == 2


def test_prices_teacher_and_relevant_groups_are_those_that_are_given() -> None:
    """Otherwise it would be a comparison under other conditions than the user's."""
    watched: list[Played] = []
    given = {**SMALL, 'repeats': 1, 'relevant_groups': ['shape'], 'first_split': 3}
    compare(['random_fsq'], POOL, 8, Costs(label=2.0, feature_subset=1.0), watch=watched.append, **given)
    (played,) = watched
    assert played.cell.sample == 3
    assert played.seconds > 0
    spent = np.diff([turn['spent'] for turn in played.turns], prepend=0)
    assert {turn['kind']: cost for turn, cost in zip(played.turns, spent, strict=True) if cost} == {
        'feature_subset': 1, 'label': 2,
    }  # fmt: skip
    unknowing = compare(['random_fsq'], POOL, 8, unknown_rate=1.0, **given)
    assert {turn.outcome for turn in unknowing.results.turns} <= {'', 'unknown'}
    wrong = compare(['random_fsq'], POOL, 8, wrong_rate=1.0, **given)
    assert wrong.accuracies()['random_fsq'].mean() < 0.5


def test_the_numbers_do_not_depend_on_the_processes(found: PoolComparison) -> None:
    """Otherwise nobody could check a result on another machine."""
    spread = compare(['random_fsq', 'farthest_fsq', 'all_labels'], POOL, [4, 8], name='things', jobs=2, **SMALL)
    assert list(map(dataclasses.astuple, spread.results.turns)) == list(map(dataclasses.astuple, found.results.turns))


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'strategies': 'random_fsq'}, "strategies must be a list of names, not 'random_fsq'"),
        ({'strategies': ['nonsense']}, 'unknown strategy'),
        ({'strategies': []}, 'the experiment has no strategy'),
        ({'strategies': ['random_fsq', 'random_fsq']}, 'the experiment names a strategy twice'),
        ({'strategies': ['human']}, 'nobody can play an experiment by hand'),
        ({'strategies': ['greedy_oracle']}, 'no second draw of held-out things'),
        ({'budgets': [4, -1]}, 'budget must be'),
        ({'turns': 0}, 'turns must lie in'),
        ({'repeats': 0}, 'repeats must be a whole number of 1 or more'),
        ({'jobs': 0}, 'jobs must be a whole number of 1 or more'),
        ({'in_view': 100}, 'too few for 100 on a table'),
        ({'relevant_groups': ['taste']}, "unknown feature group 'taste'"),
    ],
)
def test_what_cannot_be_played_is_refused(changes: dict[str, object], reason: str) -> None:
    """One line says what is wrong, and not after an hour."""
    given = {'strategies': ['random_fsq'], 'pool': POOL, 'budgets': 4, **SMALL, **changes}
    with pytest.raises(InputError, match=reason):
        compare(**given)


def test_what_was_not_played_is_refused(found: PoolComparison) -> None:
    """A budget that is not named must not be taken for one of several."""
    with pytest.raises(InputError, match='budget 5 was not played; played were: 4, 8'):
        found.accuracies(5)
    with pytest.raises(InputError, match='name a budget; played were: 4, 8'):
        found.against()
    with pytest.raises(InputError, match="strategy 'dt_task' was not played; played were: random_fsq, farthest_fsq"):
        found.against('dt_task', 4)
