"""Running experiments: paired, resumable, and the same however the work is spread."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path

import pytest

from al_questioner.domain import InputError, SettingsError
from al_questioner.experiments import playing, running
from al_questioner.experiments.plan import Cell, Condition, Plan, Variation
from al_questioner.experiments.playing import play_cells, play_episode
from al_questioner.experiments.results import read_results
from al_questioner.experiments.running import Store, run

PLAN = Plan(('prepare_lunch',), (Condition(3, 4), Condition(2, 6)), ('random_fsq', 'dt_task_env'), (0, 1))


def tables(folder: Path) -> tuple[str, str]:
    return (folder / 'episodes.csv').read_text(), (folder / 'turns.csv').read_text()


def played(folder: Path, plan: Plan = PLAN, **options: object) -> tuple[str, str]:
    store = Store(folder, plan)
    assert run([store], **options) == []
    store.write_tables()
    return tables(folder)


@pytest.fixture(scope='module')
def reference(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[str, str]]:
    folder = tmp_path_factory.mktemp('experiment')
    return folder, played(folder)


def test_the_numbers_do_not_depend_on_the_processes(reference, tmp_path: Path) -> None:
    """Nobody could check a result on another machine."""
    assert played(tmp_path, jobs=2) == reference[1]


def test_a_cell_is_the_episode_that_demo_plays(reference) -> None:
    """The experiment would be about other episodes than those that users see."""
    for row in read_results(reference[0]).episodes:
        result = play_episode(row.cell, Variation())
        assert row.final_accuracy == result.final_accuracy
        assert row.queries == len(result.queries)
        assert row.spent == result.spent


def test_the_tables_have_a_row_per_episode_and_per_turn(reference) -> None:
    """Scripts that read the tables would not find what the contract names."""
    folder, _ = reference
    episodes = list(csv.DictReader((folder / 'episodes.csv').open()))
    assert list(episodes[0]) == [
        'task', 'budget', 'turns', 'strategy', 'sample', 'seed', 'final_accuracy', 'mean_accuracy', 'queries', 'spent',
    ]  # fmt: skip
    assert len(episodes) == 8
    turns = list(csv.DictReader((folder / 'turns.csv').open()))
    assert len(turns) == 4 * 4 + 4 * 6
    manifest = json.loads((folder / 'manifest.json').read_text())
    assert manifest['seeds'] == [0, 1]
    assert {'version', 'machine', 'variation', 'conditions'} <= set(manifest)
    results = read_results(folder)
    for row in results.episodes:
        steps = results.turns_of(row.cell)
        assert [step.turn for step in steps] == list(range(1, row.cell.turns + 1))
        assert steps[-1].accuracy == row.final_accuracy
        assert steps[-1].spent == row.spent <= row.cell.budget
        assert sum(step.kind != 'no_query' for step in steps) == row.queries


def test_what_is_finished_is_never_played_again(reference, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interruption after hours would cost hours."""
    half = dataclasses.replace(PLAN, samples=(0,))
    played(tmp_path, half)
    count = []

    def counting(cells, variation, dataset):
        count.extend(cells)
        return play_cells(cells, variation, dataset)

    monkeypatch.setattr(running, 'play_cells', counting)
    assert played(tmp_path) == reference[1]
    assert {cell.sample for cell in count} == {1}
    (tmp_path / 'cells' / 'prepare_lunch' / '3-4' / 'random_fsq' / '0.json').write_text('{"half')
    count.clear()
    assert played(tmp_path) == reference[1]
    assert count == [Cell('prepare_lunch', 3, 4, 'random_fsq', 0)]


def test_a_failed_cell_is_told_and_the_rest_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One bad episode of thousands would end the night's run."""
    original = playing.play_episode

    def failing(cell, variation, dataset):
        if cell.strategy == 'dt_task_env' and cell.sample == 1:
            raise RuntimeError('broken')
        return original(cell, variation, dataset)

    monkeypatch.setattr(playing, 'play_episode', failing)
    store = Store(tmp_path, PLAN)
    failed = run([store])
    assert {(p.cell.strategy, p.cell.sample, p.error) for p in failed} == {('dt_task_env', 1, 'RuntimeError: broken')}
    store.write_tables()
    assert len(read_results(tmp_path).episodes) == 6


def test_another_experiment_is_not_mixed_in(reference) -> None:
    """Half of the table would be with erring teachers."""
    other = dataclasses.replace(PLAN, variation=Variation(wrong_rate=0.1))
    with pytest.raises(SettingsError, match='choose another folder'):
        Store(reference[0], other)


def test_variations_change_what_is_played(tmp_path: Path) -> None:
    """A sensitivity that is none would be reported."""
    cell = Cell('prepare_lunch', 6, 12, 'random_fsq', 0)
    plain = play_episode(cell, Variation())
    for variation in (
        Variation(change_interval=3),
        Variation(synchrony=1.0, change_interval=3),
        Variation(wrong_rate=1.0),
    ):
        assert play_episode(cell, variation).accuracy != plain.accuracy
    env = Cell('prepare_lunch', 6, 12, 'dt_task_env', 0)
    silent = Variation(weights={'dt_task_env': {'budget_consumption': -1.0}})
    assert play_episode(env, silent).queries == ()


def test_plans_that_make_no_sense_are_refused() -> None:
    """A typing error would be found out after the run."""
    for changes, reason in (
        ({'strategies': ('clever',)}, 'unknown strategy'),
        ({'strategies': ('human',)}, 'by hand'),
        ({'tasks': ('lunch',)}, 'unknown task'),
        ({'samples': ()}, 'no sample'),
        ({'strategies': ('dt_task', 'dt_task')}, 'twice'),
    ):
        with pytest.raises(InputError, match=reason):
            dataclasses.replace(PLAN, **changes)
