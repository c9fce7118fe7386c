"""Scenes and tests of real crops: disjoint, repeatable, true, and undisturbed by damaged files."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, InputError, Observation
from al_questioner.perception import VIEW_FEATURE_NAMES, perceive
from al_questioner.simulation import World, load_task, make_world
from al_questioner.simulation.rgbd_dataset.dataset import DatasetWorld
from al_questioner.simulation.task import Task
from shared.checkout import ROOT

if TYPE_CHECKING:
    from conftest import Tree

TABLETOP = ROOT.parent / 'shared/data/tabletop_rgbd/crops'
SYMBOL_OF = {'apple': 'fruit', 'pear': 'fruit', 'soda_can': 'beverage', 'stapler': NO_SYMBOL}

needs_tabletop = pytest.mark.skipif(not TABLETOP.is_dir(), reason=f'the real crops are not there: {TABLETOP}')


def make_task(test_share: float = 0.34, **scenes: Any) -> Task:
    """A task on some categories, two of which share a symbol."""
    task = load_task('uw_lunchbox')
    return dataclasses.replace(
        task,
        symbols=('fruit', 'beverage'),
        scenes=dataclasses.replace(task.scenes, **{'objects': 4, 'change_interval': 2, **scenes}),
        dataset=dataclasses.replace(task.dataset, categories=SYMBOL_OF, weights_kg={}, test_share=test_share),
    )


@pytest.fixture
def filled(tree: Tree) -> Tree:
    """Apples, pears and cans: four objects each, three views of each object."""
    for category in ('apple', 'pear', 'soda_can'):
        tree.add_category(category, objects=4, views=3)
    return tree


def contents(observations: tuple[Observation, ...]) -> list[tuple[object, ...]]:
    return [(o.object_id, o.position, o.view.origin, o.view.color.tobytes(), dict(o.sensors)) for o in observations]


def pixels(observations: tuple[Observation, ...]) -> set[tuple[tuple[int, int], bytes]]:
    """Return what identifies a crop of a `Tree`: its place in the frame and its colour."""
    return {(o.view.origin, o.view.color.tobytes()) for o in observations}


def test_world_satisfies_the_protocol_and_is_what_make_world_returns(filled: Tree) -> None:
    world: World = make_world(make_task(), seed=1, dataset=filled.root)
    assert isinstance(world, DatasetWorld)
    assert world.symbols == ('fruit', 'beverage')


def test_scene_stays_until_it_changes_whatever_is_asked_for_first(filled: Tree) -> None:
    world, other = (DatasetWorld(make_task(), filled.root, seed=1) for _ in range(2))
    late = contents(world.scene(9))
    assert world.scene(1)[0] is world.scene(2)[0]
    assert world.change_turns(9) == [3, 5, 7, 9]
    assert [contents(other.scene(turn)) for turn in range(1, 10)][-1] == late
    assert contents(world.scene(2)) != contents(world.scene(3))


def test_same_seed_gives_the_same_world_and_another_seed_another(filled: Tree) -> None:
    first, again, other = (DatasetWorld(make_task(), filled.root, seed) for seed in (5, 5, 6))
    for turn in (1, 3, 5):
        assert contents(first.scene(turn)) == contents(again.scene(turn))
    assert contents(first.test_observations()) == contents(again.test_observations())
    assert first.split_report == again.split_report
    assert contents(first.scene(1)) != contents(other.scene(1))


def test_seed_changes_the_scenes_of_a_sample_but_not_its_split(filled: Tree) -> None:
    first, other = (DatasetWorld(make_task(), filled.root, seed, sample=2) for seed in (5, 6))
    assert first.split_report == other.split_report
    assert contents(first.test_observations()) == contents(other.test_observations())
    assert contents(first.training_pool()) == contents(other.training_pool())
    assert contents(first.scene(1)) != contents(other.scene(1))


@pytest.mark.parametrize('turnover', ['state', 'object'])
def test_scene_shows_each_physical_object_once_and_apart(filled: Tree, turnover: str) -> None:
    world = DatasetWorld(make_task(turnover=turnover), filled.root, seed=2)
    for turn in range(1, 40, 2):
        scene = world.scene(turn)
        assert len({observation.object_id for observation in scene}) == len(scene) == 4
        assert len(set(world.names(turn).values())) == 4
        ground = np.array([observation.position for observation in scene])[:, :2]
        apart = np.linalg.norm(ground[:, None] - ground, axis=2) + np.eye(4)
        assert apart.min() > 0.2


def test_objects_that_change_their_state_stay_and_come_in_other_views(filled: Tree) -> None:
    world = DatasetWorld(make_task(turnover='state'), filled.root, seed=2)
    for turn in range(3, 20, 2):
        assert world.names(turn) == world.names(1)
        assert not pixels(world.scene(turn)) & pixels(world.scene(turn - 1))


def test_objects_that_are_replaced_come_with_new_ids(filled: Tree) -> None:
    world = DatasetWorld(make_task(turnover='object', persistence=0.5), filled.root, seed=2)
    seen: set[int] = set(world.names(1))
    for turn in range(3, 20, 2):
        before, after = world.names(turn - 2), world.names(turn)
        staying = before.keys() & after.keys()
        assert len(staying) == 2
        assert not (after.keys() - staying) & seen
        assert not {after[i] for i in after.keys() - staying} & set(before.values())
        seen |= after.keys()


def test_truth_is_the_symbol_of_the_category(filled: Tree) -> None:
    filled.add_category('stapler', objects=4, views=1)
    world = DatasetWorld(make_task(clutter_share=0.4), filled.root, seed=3)
    symbols = set()
    for turn in range(1, 30, 2):
        names = world.names(turn)
        categories = {i: name.rsplit(' ', 1)[0].replace(' ', '_') for i, name in names.items()}
        assert {i: SYMBOL_OF[category] for i, category in categories.items()} == world.truth(turn)
        symbols |= set(world.truth(turn).values())
    assert symbols == {'fruit', 'beverage', NO_SYMBOL}


def test_test_objects_are_never_in_a_scene_and_all_of_some_symbol(filled: Tree) -> None:
    filled.add_category('stapler', objects=3, views=2)
    world = DatasetWorld(make_task(clutter_share=0.3), filled.root, seed=4)
    held_out = pixels(world.test_observations())
    assert len(held_out) == 3 * 3
    assert sorted(world.test_labels()) == ['beverage'] * 3 + ['fruit'] * 6
    assert not held_out & pixels(world.training_pool())
    for turn in range(1, 60, 2):
        assert pixels(world.scene(turn)) <= pixels(world.training_pool())


def test_a_new_table_holds_each_held_out_thing_once_with_clutter(filled: Tree) -> None:
    """Otherwise recognition would be measured on things that were taught, or without things of no symbol."""
    filled.add_category('stapler', objects=6, views=2)
    world = DatasetWorld(make_task(clutter_share=0.5), filled.root, seed=4)
    tables = [world.new_table(number) for number in range(8)]
    for table in tables:
        assert not pixels(table.observations) & pixels(world.training_pool())
        assert list(table.symbols) == [o.object_id for o in table.observations]
        assert len({o.position for o in table.observations}) == len(table.observations) <= 4
    assert {symbol for table in tables for symbol in table.symbols.values()} == {'fruit', 'beverage', NO_SYMBOL}
    assert contents(world.new_table(3).observations) == contents(tables[3].observations)
    with pytest.raises(InputError, match='0 or more'):
        world.new_table(-1)


def test_sample_has_the_size_and_the_shares_of_the_task(filled: Tree) -> None:
    """Two categories of fruit share the half of the symbol."""
    world = DatasetWorld(make_task(training_size=8, test_size=4), filled.root, seed=4)
    assert sorted(world.training_labels()) == ['beverage'] * 4 + ['fruit'] * 4
    assert sorted(world.test_labels()) == ['beverage'] * 2 + ['fruit'] * 2
    assert len(world.training_pool()) == 8


def test_only_crops_that_are_shown_are_read(filled: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []
    original = Path.read_bytes
    monkeypatch.setattr(Path, 'read_bytes', lambda path: (read.append(path), original(path))[1])
    world = DatasetWorld(make_task(), filled.root, seed=1)
    world.scene(2)
    assert len(read) == 4 * 4
    world.test_observations()
    world.test_observations()
    assert len(read) == 4 * (4 + 9)


def test_scene_is_smaller_where_there_are_fewer_objects_and_the_report_says_so(tree: Tree) -> None:
    tree.add('apple', 1, 1)
    tree.add('apple', 1, 2)
    tree.add('soda_can', 1, 1)
    world = DatasetWorld(make_task(), tree.root, seed=1)
    assert [len(world.scene(turn)) for turn in (1, 3, 5)] == [2, 2, 2]
    assert '2 objects in a scene: there are no more' in world.load_report()


def test_split_report_has_a_line_for_each_category(tree: Tree) -> None:
    tree.add_category('apple', objects=2, views=2)
    tree.add_category('soda_can', objects=1, views=4)
    world = DatasetWorld(make_task(), tree.root, seed=1)
    by_object, by_view, pear, stapler = world.split_report.splitlines()
    assert by_object.startswith('apple: split by object, 2 training views, 2 test views (of object ')
    assert by_view == 'soda_can: split by view (one object only), 3 training views, 1 test views'
    assert (pear, stapler) == ('pear: absent, no complete crop', 'stapler: absent, no complete crop')


def test_symbol_without_any_category_is_named(tree: Tree) -> None:
    tree.add_category('apple', objects=3, views=2)
    world = DatasetWorld(make_task(), tree.root, seed=1)
    assert world.split_report.splitlines()[-1] == 'beverage: none of its categories is there'
    assert set(world.truth(1).values()) == {'fruit'}


def damage(tree: Tree, categories: tuple[str, ...], frame: int) -> list[str]:
    """Cut the depth image of one view of each object short."""
    broken = sorted(path for category in categories for path in tree.root.glob(f'{category}/*/*_{frame}_depthcrop.png'))
    for path in broken:
        path.write_bytes(path.read_bytes()[:-9])
    return [path.name for path in broken]


def test_unreadable_crops_are_replaced_named_and_counted(filled: Tree) -> None:
    filled.part(filled.add('apple', 1, 9), 'loc.txt').unlink()
    broken = damage(filled, ('apple', 'pear', 'soda_can'), frame=2)
    world = DatasetWorld(make_task(training_size=12, test_size=3), filled.root, seed=1)
    for turn in range(1, 80, 2):
        assert len(world.scene(turn)) == 4
        perceive(world.scene(turn))
    assert len(world.test_observations()) == 3
    assert len(world.training_pool()) == 12
    names = [skipped.path.name for skipped in world.skipped]
    assert names[0] == 'apple_1_1_9'
    assert len(set(names)) == len(names) > 3
    assert set(names[1:]) <= set(broken)
    lines = world.load_report().splitlines()
    assert lines[-1] == f'skipped in all: {len(names)}'
    assert lines[1] == f'skipped {filled.root}/apple/apple_1/apple_1_1_9: incomplete: no _loc.txt'


def test_scene_does_not_depend_on_what_else_was_asked_for(filled: Tree) -> None:
    """Reading pool and test finds damaged files; the scenes must not differ from those of a graph that never asks."""
    damage(filled, ('apple', 'soda_can'), frame=2)
    world, other = (DatasetWorld(make_task(training_size=10), filled.root, seed=1) for _ in range(2))
    world.training_pool()
    world.test_observations()
    for turn in (1, 5, 21):
        assert contents(world.scene(turn)) == contents(other.scene(turn))


def test_long_list_of_skipped_files_is_cut_but_counted(filled: Tree) -> None:
    for i in range(50):
        (filled.root / 'apple' / f'stray_{i}').write_text('')
    lines = DatasetWorld(make_task(), filled.root, seed=1).load_report().splitlines()
    assert lines[-2:] == ['and 30 more', 'skipped in all: 50']


def test_dataset_whose_crops_are_all_unreadable_is_refused(filled: Tree) -> None:
    world = DatasetWorld(make_task(), filled.root, seed=1)
    for frame in (1, 2, 3):
        damage(filled, ('apple', 'pear', 'soda_can'), frame)
    with pytest.raises(InputError, match='no test crop can be read'):
        world.test_observations()
    with pytest.raises(InputError, match=r'no training crop can be read; the last: .*not a complete PNG image$'):
        DatasetWorld(make_task(), filled.root, seed=1)


def test_dataset_without_anything_to_test_with_is_refused(tree: Tree) -> None:
    tree.add('apple')
    tree.add('soda_can')
    with pytest.raises(InputError, match=r'no crop of any symbol is left for the test$'):
        DatasetWorld(make_task(), tree.root, seed=1)


def test_task_without_a_dataset_section_is_refused(tree: Tree) -> None:
    with pytest.raises(InputError, match='has no dataset section'):
        DatasetWorld(load_task('pack_lunchbox'), tree.root, seed=1)


def test_turns_are_counted_from_one(filled: Tree) -> None:
    with pytest.raises(InputError, match='turn must be 1 or more, not 0'):
        DatasetWorld(make_task(), filled.root, seed=1).scene(0)


def tabletop(seed: int = 3) -> DatasetWorld:
    return DatasetWorld(load_task('tabletop'), TABLETOP, seed)


@needs_tabletop
def test_real_crops_make_scenes_of_the_five_things() -> None:
    world = tabletop()
    for turn in (1, 6, 11, 16):
        assert sorted(world.truth(turn).values()) == ['cereal', 'chips', 'cookies', 'mug', 'tea']
        assert np.isfinite(perceive(world.scene(turn)).features).all()
    assert world.change_turns(20) == [6, 11, 16]
    assert not world.skipped


@needs_tabletop
def test_real_crops_are_split_by_view_with_every_kind_on_both_sides() -> None:
    world = tabletop()
    assert world.split_report.count('split by view (one object only)') == 5
    assert (len(world.training_pool()), len(world.test_observations())) == (17, 8)
    for labels in (world.training_labels(), world.test_labels()):
        assert set(labels) == set(world.symbols)
    assert not pixels(world.training_pool()) & pixels(world.test_observations())


@needs_tabletop
@pytest.mark.parametrize(
    ('symbol', 'length', 'width'),
    [
        ('chips', (0.15, 0.30), (0.06, 0.10)),
        ('mug', (0.08, 0.15), (0.06, 0.11)),
        ('cereal', (0.15, 0.35), (0.08, 0.25)),
    ],
)
def test_real_things_have_plausible_sizes(symbol: str, length: tuple[float, float], width: tuple[float, float]) -> None:
    """A crisps tube is 23 cm by 8 cm, a mug about 10 cm by 8 cm; the camera looks down on them obliquely."""
    world = tabletop()
    features = perceive(world.training_pool()).features
    of_symbol = features[[label == symbol for label in world.training_labels()]]
    for name, (low, high) in (('size_length', length), ('size_width', width)):
        column = of_symbol[:, VIEW_FEATURE_NAMES.index(name)]
        assert low < column.min() <= column.max() < high, name
