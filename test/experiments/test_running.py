"""Running experiments: paired, resumable, and the same however the work is spread."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path

import pytest

from al_questioner.domain import NEVER, Classifiers, EpisodeError, InputError, SettingsError
from al_questioner.experiments import forecast, playing, running, storing
from al_questioner.experiments.plan import Cell, Condition, Plan, Variation
from al_questioner.experiments.playing import Played, play_cells, play_episode
from al_questioner.experiments.results import read_results
from al_questioner.experiments.running import run
from al_questioner.experiments.storing import Store
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.simulation import WorldSpec, episode_settings, run_episode
from shared.lunches import TASK, teacher_of
from shared.task_files import task_content, write_task

PLAN = Plan(('prepare_lunch',), (Condition(3, 4), Condition(2, 6)), ('random_fsq', 'dt_task_env'), (0, 1))


def tables(folder: Path) -> tuple[str, str]:
    return (folder / 'episodes.csv').read_text(), (folder / 'turns.csv').read_text()


def played(folder: Path, plan: Plan = PLAN, **options: object) -> tuple[str, str]:
    store = Store(folder, plan)
    assert run([store], **options) == []
    store.write_tables()
    return tables(folder)


def a_cell_is_finished(store: Store) -> None:
    store.save(Played(store.plan.cells()[0], {}, ()))


@pytest.fixture(scope='module')
def reference(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[str, str]]:
    folder = tmp_path_factory.mktemp('experiment')
    return folder, played(folder)


def test_the_numbers_do_not_depend_on_the_processes(reference, tmp_path: Path) -> None:
    """Otherwise nobody could check a result on another machine."""
    assert played(tmp_path, jobs=2) == reference[1]


def test_a_cell_is_the_episode_that_anybody_plays(reference) -> None:
    """Otherwise the experiment would be about other episodes than those that users see."""
    for row in read_results(reference[0]).episodes:
        cell, sample = row.cell, row.cell.sample
        settings = episode_settings(TASK, cell.strategy, cell.budget, cell.turns)
        result = run_episode(WorldSpec(TASK, sample, sample), settings, teacher_of(TASK, sample))
        assert (row.final_accuracy, row.spent) == (result.final_accuracy, result.spent)
        assert row.queries == len(result.queries)


def test_strategies_share_sample_scenes_and_teacher(monkeypatch: pytest.MonkeyPatch) -> None:
    """The design is paired: what differs between strategies must not be chance."""
    seen = []

    def watched(world_spec, settings, teacher, **others):
        seen.append((world_spec, teacher))
        return run_episode(world_spec, settings, teacher, **others)

    monkeypatch.setattr(playing, 'run_episode', watched)
    for strategy in ('random_fsq', 'dt_task_env'):
        cell = Cell('prepare_lunch', 3, 3, strategy, 1)
        assert cell.seed == 1
        play_episode(cell, Variation(wrong_rate=0.2))
    assert seen[0] == seen[1]
    assert (seen[0][0].seed, seen[0][0].sample, seen[0][1].seed) == (1, 1, 1)


def test_the_tables_have_a_row_per_episode_and_per_turn(reference) -> None:
    """Otherwise scripts that read the tables would not find what the contract names."""
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
    assert {'version', 'semantics', 'variation', 'conditions', 'worlds', 'runs'} <= set(manifest)
    results = read_results(folder)
    for row in results.episodes:
        steps = results.turns_of(row.cell)
        assert [step.turn for step in steps] == list(range(1, row.cell.turns + 1))
        assert steps[-1].accuracy == row.final_accuracy
        assert steps[-1].spent == row.spent <= row.cell.budget
        assert sum(step.kind != 'no_query' for step in steps) == row.queries


def test_what_is_finished_is_never_played_again(reference, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise an interruption after hours would cost hours."""
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
    """Otherwise one bad episode of thousands would end the night's run."""
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
    """Otherwise half of the table would be with erring teachers."""
    other = dataclasses.replace(PLAN, variation=Variation(wrong_rate=0.1))
    with pytest.raises(SettingsError, match=r'with wrong_rate 0.0, not 0.1: choose another folder$'):
        Store(reference[0], other)
    other = dataclasses.replace(PLAN, variation=Variation(weights={'dt_task': {'class_uniformity': 0.5}}))
    with pytest.raises(SettingsError, match=r'with weights.dt_task.class_uniformity None, not 0.5: choose'):
        Store(reference[0], other)


def test_a_folder_in_which_nothing_was_played_is_free(tmp_path: Path) -> None:
    """Otherwise a command that was mistyped would bar the folder from the right one."""
    Store(tmp_path, PLAN, '/some/crops')
    store = Store(tmp_path, PLAN)
    a_cell_is_finished(store)
    with pytest.raises(SettingsError, match="dataset '', not '/some/crops'"):
        Store(tmp_path, PLAN, '/some/crops')


def test_another_method_or_world_is_not_mixed_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise half of the table would be from before a change that decides what an episode is."""
    a_cell_is_finished(Store(tmp_path, PLAN))
    Store(tmp_path, dataclasses.replace(PLAN, tasks=('pack_lunchbox',)))
    monkeypatch.setattr(storing, 'SEMANTICS', SEMANTICS + 1)
    with pytest.raises(SettingsError, match=rf'with semantics {SEMANTICS}, not {SEMANTICS + 1}: choose'):
        Store(tmp_path, PLAN)
    monkeypatch.undo()
    monkeypatch.setattr(Plan, 'task_document', lambda plan, name: {'objects': 4})
    with pytest.raises(SettingsError, match=r'with prepare_lunch\.'):
        Store(tmp_path, PLAN)


def test_ceilings_can_be_played_on_the_first_samples_alone() -> None:
    """A greedy oracle takes longer than all strategies together, and a few samples tell where the ceiling is."""
    ceilings = ('all_labels', 'greedy_oracle')
    plan = dataclasses.replace(PLAN, strategies=('random_fsq', *ceilings), samples=(3, 4, 5), ceiling_samples=2)
    assert {cell.sample for cell in plan.cells() if cell.strategy in ceilings} == {3, 4}
    assert {cell.sample for cell in plan.cells() if cell.strategy not in ceilings} == {3, 4, 5}
    everywhere = dataclasses.replace(plan, ceiling_samples=None)
    assert len(everywhere.cells()) == len(plan.cells()) + 2 * len(ceilings)


def test_what_has_the_same_world_is_played_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To open a world takes longer than to play a short episode in it; a study has the world of the comparison."""
    opened = []
    monkeypatch.setattr(WorldSpec, 'open', lambda spec: opened.append((spec.sample, spec.task.scenes.synchrony)))
    playing._open_world.cache_clear()

    def play(cell: Cell, variation: Variation, dataset: str) -> None:
        playing._open_world(cell.task, cell.sample, variation.change_interval, variation.synchrony, dataset)
        raise EpisodeError('that is enough')

    monkeypatch.setattr(playing, 'play_episode', play)
    synchronous, amplitude = Variation(synchrony=1.0), Variation(classifiers=Classifiers(4.0))
    variations = (Variation(), synchronous, amplitude)
    stores = [
        Store(tmp_path / str(n), dataclasses.replace(PLAN, samples=(0, 1, 2, 3), variation=each))
        for n, each in enumerate(variations)
    ]
    assert len(run(stores)) == 3 * 4 * 4
    assert len(opened) == len(set(opened)) == 2 * 4
    assert [sample for sample, _ in opened] == sorted(sample for sample, _ in opened)


def test_every_run_is_told(reference, tmp_path: Path) -> None:
    """Otherwise nobody could say on which machine the first half was played."""
    a_cell_is_finished(Store(tmp_path, PLAN))
    Store(tmp_path, PLAN)
    manifest = json.loads((tmp_path / 'manifest.json').read_text())
    assert len(manifest['runs']) == 2
    assert {'python', 'numpy', 'scipy', 'begun'} <= set(manifest['runs'][0])


def test_an_experiment_from_before_labels_could_be_carried_goes_on(reference, tmp_path: Path) -> None:
    """Hours of playing are lost because a manifest does not tell of an option that was not there."""
    a_cell_is_finished(Store(tmp_path, PLAN))
    manifest = json.loads((tmp_path / 'manifest.json').read_text())
    del manifest['variation']['carry_labels']
    (tmp_path / 'manifest.json').write_text(json.dumps(manifest))
    assert Store(tmp_path, PLAN).finished() == 1
    carrying = dataclasses.replace(PLAN, variation=Variation(carry_labels=True))
    with pytest.raises(InputError, match='carry_labels False, not True'):
        Store(tmp_path, carrying)


def test_a_task_file_is_stored_inside_the_folder(tmp_path: Path) -> None:
    """Otherwise cells of a task of one's own would be written all over the disk."""
    mine, out = write_task(tmp_path, task_content('prepare_lunch')), tmp_path / 'out'
    plan = dataclasses.replace(PLAN, tasks=(mine,), samples=(0,), conditions=(Condition(2, 2),))
    played(out, plan)
    assert {path.relative_to(out).parts[1] for path in out.glob('cells/**/*.json')} == {'mine'}
    with pytest.raises(SettingsError, match='same name'):
        dataclasses.replace(PLAN, tasks=(mine, str(tmp_path / 'other' / 'mine.yaml')))


def test_the_forecast_is_that_of_episodes_like_those_that_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise an hour would be announced as a minute because the cheap episodes came first."""
    now = [0.0]
    monkeypatch.setattr(forecast.time, 'monotonic', lambda: now[0])
    cheap = [Cell('prepare_lunch', 3, 4, 'random_fsq', sample) for sample in range(10)]
    dear = [Cell('prepare_lunch', 3, 4, 'dt_task_env', sample) for sample in range(10)]
    found = forecast.Forecast([*cheap, *dear])
    assert found.seconds_left() is None
    found.played(dear[0], 100.0)
    found.played(cheap[0], 1.0)
    # Two at once: 101 seconds of work in half of the time.
    now[0] = 50.5
    assert found.seconds_left() == pytest.approx((9 * 100 + 9 * 1) / 2)
    for cell in cheap[1:]:
        found.played(cell, 1.0)
    now[0] += 4.5
    assert found.seconds_left() == pytest.approx(900 / 2)


def test_variations_change_what_is_played(tmp_path: Path) -> None:
    """Otherwise the page would report a sensitivity that does not exist."""
    cell = Cell('prepare_lunch', 6, 12, 'random_fsq', 0)
    plain = play_episode(cell, Variation())
    for variation in (
        Variation(change_interval=3),
        Variation(synchrony=1.0, change_interval=3),
        Variation(wrong_rate=1.0),
        Variation(classifiers=Classifiers(4.0, 'rbf', 0.0)),
    ):
        assert play_episode(cell, variation).accuracy != plain.accuracy
    demonstrations = Cell('prepare_lunch', 40, 20, 'rarest_demo', 0)
    shown = [play_episode(demonstrations, Variation(repeat_shown=repeats)).queries for repeats in (False, True)]
    assert shown[0] != shown[1]
    named = Cell('prepare_lunch', 40, 22, 'random_fsq', 0)
    asked = [play_episode(named, Variation(carry_labels=carries)).queries for carries in (False, True)]
    assert len(asked[0]) > len(asked[1])
    env = Cell('prepare_lunch', 6, 12, 'dt_task_env', 0)
    silent = Variation(weights={'dt_task_env': {'budget_consumption': -1.0}})
    assert play_episode(env, silent).queries == ()


def test_the_cost_of_the_relevance_query_is_the_tasks_unless_given() -> None:
    """The paper's comparison has no such question, although the cluttered tables' files have."""

    def costs(variation: Variation, name: str) -> float | None:
        return variation.task(name).episode.costs.relevance

    for name, stated in (('kitchen_table', 4.0), ('mixed_kitchens', 4.0), ('prepare_lunch', None)):
        assert costs(Variation(), name) == stated
        assert costs(Variation(cost_relevance=NEVER), name) is None
        assert costs(Variation(cost_relevance=2.0, change_interval=3), name) == 2.0


def test_plans_that_make_no_sense_are_refused() -> None:
    """Otherwise a typing error would be found out after the run."""
    for changes, reason in (
        ({'strategies': ('clever',)}, 'unknown strategy'),
        ({'strategies': ('human',)}, 'by hand'),
        ({'tasks': ('lunch',)}, 'unknown task'),
        ({'samples': ()}, 'no sample'),
        ({'strategies': ('dt_task', 'dt_task')}, 'twice'),
    ):
        with pytest.raises(InputError, match=reason):
            dataclasses.replace(PLAN, **changes)
