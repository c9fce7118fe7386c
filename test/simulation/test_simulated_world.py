"""Scenes: what is on the table, how it changes, and that all of it follows from the seed."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.stats import binomtest

from al_questioner.domain import NO_SYMBOL, InputError, Observation
from al_questioner.simulation import SimulatedWorld, Task
from al_questioner.simulation.kitchen import pool


def digest(observations: Iterable[Observation]) -> str:
    """Everything an observation holds, in one hash."""
    sha = hashlib.sha256()
    for o in observations:
        sha.update(repr((o.object_id, o.position, o.view.camera, o.view.origin, dict(o.sensors))).encode())
        for array in (o.view.color, o.view.depth, o.view.mask):
            sha.update(array.tobytes())
    return sha.hexdigest()


def plausible(successes: int, trials: int, share: float) -> bool:
    """Return whether the count is compatible with the share: exact binomial test, one false alarm in a million."""
    return bool(binomtest(successes, trials, share).pvalue > 1e-6)


def test_same_seed_same_bytes_other_seed_others(small: Task) -> None:
    world, again, other = SimulatedWorld(small, 5), SimulatedWorld(small, 5), SimulatedWorld(small, 6)
    assert digest(world.scene(1)) == digest(again.scene(1)) != digest(other.scene(1))
    assert digest(world.test_observations()[:2]) == digest(again.test_observations()[:2])


def test_another_process_sees_the_same_world(small: Task) -> None:
    """A node and an offline run are two processes, which hash() and the order of sets do not set apart."""
    program = (
        'import sys; from dataclasses import replace; sys.path.insert(0, sys.argv[1])\n'
        'from test_simulated_world import digest\n'
        'from al_questioner.simulation import SimulatedWorld, load_task\n'
        "task = load_task('kitchen_table')\n"
        'scenes = replace(task.scenes, objects=6, training_size=24, test_size=8, clutter_share=0.5)\n'
        'print(digest(SimulatedWorld(replace(task, scenes=scenes), 5).scene(11)))\n'
    )
    done = subprocess.run(
        [sys.executable, '-c', program, str(Path(__file__).parent)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == digest(SimulatedWorld(small, 5).scene(11))


@pytest.mark.parametrize('name', ['lunch', 'kitchen', 'lunchbox'])
def test_random_access_equals_sequential(name: str, request: pytest.FixtureRequest) -> None:
    """Late subscribers and replays ask for turns out of order."""
    task = request.getfixturevalue(name)
    forward, direct = SimulatedWorld(task, 3), SimulatedWorld(task, 3)
    truths = [forward.truth(turn) for turn in range(1, 60)]
    for turn in (58, 7, 31, 1):
        assert direct.truth(turn) == truths[turn - 1]


def test_an_unchanged_scene_is_the_identical_objects(small: Task) -> None:
    world = SimulatedWorld(small, 1)
    interval = small.scenes.change_interval
    first = world.scene(1)
    assert all(a is b for a, b in zip(first, world.scene(interval), strict=True))
    assert any(a is not b for a, b in zip(first, world.scene(interval + 1), strict=True))
    assert all(a is b for a, b in zip(first, world.scene(1), strict=True))


def test_truth_renders_nothing(kitchen: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    """The teacher runs in a process of its own; it must not pay for images it never shows."""
    monkeypatch.setattr(pool, 'render', Mock(side_effect=RuntimeError('rendered')))
    world = SimulatedWorld(kitchen, 1)
    assert len(world.truth(200)) == kitchen.scenes.objects
    assert len(world.test_labels()) == kitchen.scenes.test_size
    with pytest.raises(RuntimeError, match='rendered'):
        world.scene(1)


@pytest.mark.parametrize('turn', [0, -3])
def test_turns_start_at_one(small: Task, turn: int) -> None:
    with pytest.raises(InputError, match=f'turn must be 1 or more, not {turn}'):
        SimulatedWorld(small, 1).scene(turn)


def test_change_turns_are_those_in_which_the_truth_changes(kitchen: Task) -> None:
    world = SimulatedWorld(kitchen, 4)
    changed = [turn for turn in range(2, 41) if world.truth(turn) != world.truth(turn - 1)]
    assert world.change_turns(40) == changed == [6, 11, 16, 21, 26, 31, 36]


def test_the_sample_fixes_the_observations_and_the_seed_the_scenes(small: Task) -> None:
    """An experiment runs many seeds on each of five samples."""
    one, two = SimulatedWorld(small, 1, sample=9), SimulatedWorld(small, 2, sample=9)
    assert digest(one.training_pool()) == digest(two.training_pool())
    assert digest(one.test_observations()) == digest(two.test_observations())
    assert [one.truth(t) for t in range(1, 40)] != [two.truth(t) for t in range(1, 40)]
    assert digest(SimulatedWorld(small, 9).test_observations()) == digest(one.test_observations())


def test_scenes_show_observations_of_the_training_pool_and_never_of_the_test_set(small: Task) -> None:
    """Otherwise every accuracy would be too high."""
    world = SimulatedWorld(small, 2)
    known = {o.view.color.tobytes() for o in world.training_pool()}
    held_out = {o.view.color.tobytes() for o in world.test_observations()}
    shown = {o.view.color.tobytes() for turn in range(1, 60) for o in world.scene(turn)}
    assert shown <= known
    assert not held_out & known
    assert len(known) == small.scenes.training_size
    assert len(held_out) == small.scenes.test_size


def test_things_leave_and_others_come_with_new_ids(kitchen: Task) -> None:
    world = SimulatedWorld(kitchen, 8)
    seen: set[int] = set()
    before: dict[int, str] = {}
    for turn in [1, *world.change_turns(150)]:
        now = dict(world.truth(turn))
        staying = now.keys() & before.keys()
        assert len(now) == 40
        assert all(now[i] == before[i] for i in staying)
        if before:
            assert len(staying) == 20
        assert not (now.keys() - before.keys()) & seen
        seen |= now.keys()
        before = now
    assert max(seen) == len(seen)


def test_objects_that_change_their_state_keep_their_id_and_symbol(lunch: Task) -> None:
    world = SimulatedWorld(lunch, 8)
    first = world.truth(1)
    assert sorted(first) == list(range(1, 11))
    assert all(world.truth(turn) == first for turn in range(1, 100))
    assert Counter(first.values()) == {'main_dish': 3, 'snack': 3, 'fruit': 2, 'beverage': 2}


@pytest.mark.parametrize('synchrony', [0.0, 0.4, 1.0])
def test_synchrony_is_the_share_of_states_that_follow_the_clock(lunch: Task, synchrony: float) -> None:
    world = SimulatedWorld(replace(lunch, scenes=replace(lunch.scenes, synchrony=synchrony, change_interval=1)), 1)
    on_clock = total = 0
    for turn in range(1, 200):
        for name in world.names(turn).values():
            kind, state = name.split(', ')
            states = next(t.thing.kind.states for t in world._sample.training if t.thing.kind.name == kind)
            on_clock += states[(turn - 1) % len(states)].name == state
            total += 1
    assert plausible(on_clock, total, synchrony + (1 - synchrony) / 3)


def test_a_state_change_shows_another_view(lunch: Task) -> None:
    world = SimulatedWorld(lunch, 3)
    before, after = world._seen(1), world._seen(11)
    assert all(a.pool_row != b.pool_row for a, b in zip(before, after, strict=True))


@pytest.mark.parametrize(('persistence', 'staying'), [(0.0, 0), (0.3, 12), (1.0, 40)])
def test_persistence_is_the_share_that_stays(kitchen: Task, persistence: float, staying: int) -> None:
    world = SimulatedWorld(replace(kitchen, scenes=replace(kitchen.scenes, persistence=persistence)), 2)
    assert len(world.truth(5).keys() & world.truth(6).keys()) == staying


def test_class_frequencies_and_clutter_are_as_configured(kitchen: Task) -> None:
    """Statistical: what the scenes show, over many seeds."""
    counts: Counter[str] = Counter()
    for seed in range(20):
        counts.update(SimulatedWorld(kitchen, seed).truth(1).values())
    total = sum(counts.values())
    assert plausible(counts[NO_SYMBOL], total, 0.75)
    for symbol, share in kitchen.class_frequencies.items():
        assert plausible(counts[symbol], total - counts[NO_SYMBOL], share), symbol


def test_test_observations_are_balanced_as_configured(kitchen: Task, lunch: Task, lunchbox: Task) -> None:
    assert Counter(SimulatedWorld(kitchen, 1).test_labels()) == dict.fromkeys(kitchen.symbols, 20)
    assert Counter(SimulatedWorld(lunch, 1).test_labels()) == {'main_dish': 12, 'snack': 12, 'fruit': 8, 'beverage': 8}
    assert Counter(SimulatedWorld(lunchbox, 1).test_labels()) == dict.fromkeys(lunchbox.symbols, 200)


def test_every_object_and_state_of_prepare_lunch_is_in_training_and_test(lunch: Task) -> None:
    sample = pool.make_sample(lunch, 3)
    for specs, each in ((sample.training, 8), (sample.test, 4)):
        assert set(Counter(spec.thing.slot for spec in specs).values()) == {each}
        assert all(
            {s.state for s in specs if s.thing.slot == slot} == {0, 1, 2} for slot in range(lunch.scenes.objects)
        )


def test_fewer_kinds_make_an_easier_world(kitchen: Task) -> None:
    looks = replace(kitchen.appearance, kinds_per_symbol=3, kinds_of_clutter=5)
    sample = pool.make_sample(replace(kitchen, appearance=looks), 2)
    kinds = {(spec.symbol, spec.thing.kind.name) for spec in sample.training}
    assert Counter(symbol for symbol, _ in kinds) == {**dict.fromkeys(kitchen.symbols, 3), NO_SYMBOL: 5}
    assert {(spec.symbol, spec.thing.kind.name) for spec in sample.test} == {k for k in kinds if k[0] != NO_SYMBOL}


def test_nothing_overlaps_and_everything_stands_on_the_table(kitchen: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, 'render', lambda *_: None)
    spots = np.array([o.position for o in SimulatedWorld(kitchen, 6).scene(21)])
    gaps = np.linalg.norm(spots[:, None, :2] - spots[None, :, :2], axis=2) + np.eye(len(spots))
    width, depth = kitchen.scenes.table_m
    assert gaps.min() > 0.09
    assert (spots[:, :2] > 0).all()
    assert (spots[:, 0] < width).all()
    assert (spots[:, 1] < depth).all()


def test_objects_that_stay_are_moved_about(lunch: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    """The location of an object does not tell what it is."""
    monkeypatch.setattr(pool, 'render', lambda *_: None)
    world = SimulatedWorld(lunch, 2)
    spots = [np.array([o.position[:2] for o in world.scene(turn)]) for turn in range(1, 200, 10)]
    assert all(np.ptp(spots, axis=0).max(axis=1) > 0.15)
    for spot in spots:
        gaps = np.linalg.norm(spot[:, None] - spot[None, :], axis=2) + np.eye(len(spot))
        assert gaps.min() > 0.12


def test_cold_things_stand_near_the_refrigerator_if_asked_to(lunchbox: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, 'render', lambda *_: None)
    scenes = replace(lunchbox.scenes, training_size=200)

    def mean_x(pull: float) -> tuple[float, float]:
        task = replace(lunchbox, scenes=scenes, sensors=replace(lunchbox.sensors, cold_pull=pull))
        specs = pool.make_sample(task, 1).training
        x = np.array([pool.observe(s, task, 1, 0).position[0] for s in specs])
        cold = np.array([s.thing.kind.cold for s in specs])
        return float(x[cold].mean()), float(x[~cold].mean())

    cold, warm = mean_x(1.0)
    assert cold > warm + 0.4
    cold, warm = mean_x(0.0)
    assert abs(cold - warm) < 0.15


@pytest.mark.parametrize('name', ['kitchen', 'lunch'])
def test_the_second_draw_is_like_the_test_set_and_none_of_it(name: str, request: pytest.FixtureRequest) -> None:
    """Otherwise the oracle would look at what results are measured on, or at another world."""
    task: Task = request.getfixturevalue(name)
    world = SimulatedWorld(task, 1, 2)
    assert Counter(world.validation_labels()) == Counter(world.test_labels())
    drawn = [pool.make_sample(task, 2).test, pool.make_validation(task, 2)]
    assert {spec.thing.kind.name for spec in drawn[0]} == {spec.thing.kind.name for spec in drawn[1]}
    if task.scenes.turnover == 'state':
        assert {spec.thing for spec in drawn[0]} == {spec.thing for spec in drawn[1]}
    seen = [digest([pool.observe(spec, task, 2, 0)]) for specs in drawn for spec in specs[:6]]
    assert len(set(seen)) == 12
    again = SimulatedWorld(task, 5, 2)
    assert again.validation_labels() == world.validation_labels()


@pytest.mark.parametrize('name', ['lunch', 'kitchen', 'lunchbox'])
def test_a_new_table_is_like_a_scene_and_none_of_it_was_seen(name: str, request: pytest.FixtureRequest) -> None:
    """Otherwise recognition would be measured on what was taught, or on a table that the task never has."""
    task = request.getfixturevalue(name)
    world = SimulatedWorld(task, 3)
    scenes = task.scenes
    tables = [pool.make_table(task, 3, number) for number in (0, 1, 0)]
    assert tables[0] == tables[2] != tables[1]
    known = {view.key for view in (*pool.make_sample(task, 3).training, *pool.make_sample(task, 3).test)}
    for table in tables[:2]:
        counts = Counter(view.symbol for view in table)
        assert len(table) == scenes.objects
        assert counts[NO_SYMBOL] == round(scenes.clutter_share * scenes.objects)
        assert {symbol: counts[symbol] for symbol in task.symbols} == pool.apportion(
            task.class_frequencies, scenes.objects - counts[NO_SYMBOL]
        )
        assert not known & {view.key for view in table}
        assert len({view.place for view in table}) == len(table)
    if scenes.turnover == 'state':
        assert {view.thing for view in tables[0]} == {view.thing for view in pool.make_sample(task, 3).training}
    drawn = world.new_table()
    assert drawn.symbols == {i: view.symbol for i, view in enumerate(tables[0], start=1)}
    assert [o.object_id for o in drawn.observations] == list(drawn.symbols)


def test_a_table_has_a_number(small: Task) -> None:
    with pytest.raises(InputError, match='0 or more'):
        SimulatedWorld(small, 3).new_table(-1)
