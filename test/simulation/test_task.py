"""Task files: what is accepted, and the one line that says what is wrong."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from al_questioner.domain import Costs, InputError
from al_questioner.simulation import Task, episode_settings, load_task, make_world
from al_questioner.support.configuration import shipped_names
from shared.task_files import task_content, write_task

SYMBOLS = ('main_dish', 'snack', 'fruit', 'beverage')
SIMULATED = ('prepare_lunch', 'pack_lunchbox', 'kitchen_table')


def _own(folder: Path, **content: object) -> Task:
    """A task of fruit and snacks unless other symbols are told."""
    return load_task(write_task(folder, {'symbols': ['fruit', 'snack'], **content}))


@pytest.mark.parametrize('name', SIMULATED)
def test_shipped_tasks_state_every_parameter(name: str) -> None:
    """A parameter that only the code knows cannot be found by a user who wants to change it."""
    content, task = task_content(name), load_task(name)
    assert task.name == name
    for section in ('episode', 'scenes', 'appearance', 'camera', 'sensors'):
        assert set(content[section]) == set(getattr(task, section).__dataclass_fields__), section


def test_the_worlds_of_the_issue_are_as_specified() -> None:
    """Sizes, frequencies and changes that the issue and the paper fix."""
    lunch, lunchbox, kitchen = (load_task(name).scenes for name in SIMULATED)
    assert (lunch.objects, lunch.training_size, lunch.test_size, lunch.change_interval) == (10, 80, 40, 10)
    assert (lunchbox.training_size, lunchbox.test_size, lunchbox.turnover) == (3200, 800, 'object')
    assert (kitchen.objects, kitchen.clutter_share, kitchen.change_interval, kitchen.persistence) == (40, 0.75, 5, 0.5)
    assert sorted(kitchen.class_frequencies.values()) == [0.1, 0.15, 0.25, 0.5]
    assert kitchen.test_balance == 'classes'


@pytest.mark.parametrize('more', [{}, {'description': None, 'relevant_groups': []}, {'description': ''}], ids=str)
def test_a_task_of_ones_own_needs_symbols_alone(tmp_path: Path, more: dict[str, Any]) -> None:
    """Otherwise a person who teaches would have to write down what nobody reads."""
    task = _own(tmp_path, **more)
    assert (task.name, task.description, task.relevant_groups) == ('mine', '', ())
    assert task.class_frequencies == {'fruit': 0.5, 'snack': 0.5}
    assert task.episode.costs == Costs()
    assert make_world(task, 1).scene(1)


@pytest.mark.parametrize(
    'content',
    [
        {'costs': {'label': 0.5, 'skip': 0}},
        {'episode': {'costs': {'label': 0.5, 'skip': 0}}},
        {'episode': {'turns': 40}},
    ],
    ids=str,
)
def test_costs_of_a_task_are_those_of_its_episodes(tmp_path: Path, content: dict[str, Any]) -> None:
    """The learner asks at the prices that the task file states."""
    task = _own(tmp_path, **content)
    expected = Costs() if 'turns' in content.get('episode', {}) else Costs(label=0.5, skip=0)
    assert episode_settings(task).costs == task.episode.costs == expected
    assert episode_settings(task, costs=Costs(3, 3, 3)).costs == Costs(3, 3, 3)


def test_the_relevance_query_has_a_cost_or_none(tmp_path: Path) -> None:
    """Otherwise a table without clutter would have a question of no use, or one could not be without it."""
    for stated, expected in ((4, 4.0), (0, 0.0), ('never', None)):
        assert _own(tmp_path, costs={'relevance': stated}).episode.costs == Costs(relevance=expected)
    assert _own(tmp_path).episode.costs.relevance is None
    for wrong in (-1, 'off', True):
        with pytest.raises(InputError, match='costs: relevance'):
            _own(tmp_path, costs={'relevance': wrong})
    costs = {name: load_task(name).episode.costs.relevance for name in shipped_names('tasks')}
    assert {name for name, cost in costs.items() if cost == 4} == {'kitchen_table', 'mixed_kitchens'}
    assert {cost for cost in costs.values() if cost != 4} == {None}


@pytest.mark.parametrize('section', ['episode', 'costs', 'scenes', 'appearance', 'camera', 'sensors', 'variety'])
def test_a_section_that_is_left_empty_has_the_defaults(tmp_path: Path, section: str) -> None:
    """A key without lines below it has its defaults, and is not refused for being no mapping."""
    assert _own(tmp_path, description=None, **{section: None}) == _own(tmp_path, description=None)


def test_empty_costs_are_not_stated_twice(tmp_path: Path) -> None:
    """Otherwise the costs beside an empty key would be refused."""
    task = _own(tmp_path, episode={'costs': None, 'budget': 9}, costs={'label': 3})
    assert (task.episode.costs, task.episode.budget) == (Costs(label=3), 9)
    assert _own(tmp_path, episode={'costs': {'label': 3}}, costs=None).episode.costs == Costs(label=3)


def test_a_slip_in_a_task_has_a_suggestion(tmp_path: Path) -> None:
    """Otherwise people would compare their word with a list of ten."""
    for more, hint in (
        ({'episode': {'strategy': 'u_samplng'}}, 'human; did you mean u_sampling?'),
        ({'scens': {}}, 'variety; did you mean scenes?'),
        ({'costs': {'lable': 1}}, 'relevance; did you mean label?'),
        ({'scenes': {'turnover': 'objects'}}, "unknown 'objects'; known: state, object; did you mean object?"),
    ):
        with pytest.raises(InputError, match=re.escape(hint)):
            _own(tmp_path, **more)
    task = _own(tmp_path, appearance={'catalogue': 'pack_lunchbx'})
    with pytest.raises(InputError, match=r"unknown catalogue 'pack_lunchbx'; known: .*; did you mean pack_lunchbox\?"):
        make_world(task, 1)
    with pytest.raises(InputError, match=r"unknown task 'kitchen_tabel'; known: .*; did you mean kitchen_table\?"):
        load_task('kitchen_tabel')


def test_words_that_refer_to_a_symbol_may_be_decomposed(tmp_path: Path) -> None:
    """Otherwise an editor on a Mac would make a task that is refused with a text that shows the very same word."""
    content = {
        'symbols': ['Früchte', 'snack'],
        'source': 'dataset',
        'scenes': {'class_frequencies': {'Fru\u0308chte': 0.5, 'snack': 0.5}},
        'dataset': {'categories': {'a\u0308pfel': 'Fru\u0308chte', 'bar': 'snack'}},
    }
    task = _own(tmp_path, **content)
    assert task.class_frequencies == {'Früchte': 0.5, 'snack': 0.5}
    assert task.dataset is not None
    assert task.dataset.categories == {'äpfel': 'Früchte', 'bar': 'snack'}


@pytest.mark.parametrize(
    ('section', 'key', 'value', 'message'),
    [
        (None, 'colour', 1, r"mine.yaml: unknown key 'colour'; known: symbols, .*episode, costs, scenes"),
        ('scenes', 'objekts', 1, r"mine.yaml: scenes: unknown key 'objekts'; known: objects"),
        ('scenes', 'objects', 0, r'mine.yaml: scenes: objects: 0 is outside \[1, 200\]'),
        ('scenes', 'objects', 2.5, r'scenes: objects: expected a whole number, found 2.5'),
        ('scenes', 'objects', True, r'scenes: objects: expected a whole number, found True'),
        ('scenes', 'persistence', float('nan'), r'scenes: persistence: expected a finite number, found nan'),
        ('scenes', 'persistence', 1.5, r'scenes: persistence: 1.5 is outside \[0, 1\]'),
        ('scenes', 'turnover', 'wind', r"scenes: turnover: unknown 'wind'; known: state, object"),
        ('scenes', 'turnover', ['state'], r'scenes: turnover: unknown'),
        ('scenes', 'class_frequencies', {'fruit': 1}, r'class_frequencies: expected one share for each of main_dish'),
        ('scenes', 'class_frequencies', dict.fromkeys(SYMBOLS, 0.5), r'frequencies: the shares sum to 2, expected 1'),
        ('scenes', 'training_size', 20, r'training_size is below the number of objects'),
        ('scenes', 'table_m', [1.4], r'table_m: expected \[width, depth\], found \[1.4\]'),
        ('camera', 'distance_m', [1.2, 0.9], r'distance_m: the lowest value 1.2 is above the highest 0.9'),
        ('camera', 'distance_m', 'far', r"distance_m: expected \[lowest, highest\], found 'far'"),
        ('camera', 'depth_noise_m', float('inf'), r'depth_noise_m: expected a finite number, found inf'),
        ('episode', 'budget', -1, r'episode: budget: -1 is outside'),
        ('episode', 'turns', 0, r'episode: turns: 0 is outside'),
        (None, 'sensors', 3, r'mine.yaml: sensors: expected a mapping, found 3'),
        (None, 'symbols', ['fruit'], r'symbols: at least two'),
        (None, 'symbols', ['fruit', 'fruit'], r'symbols: a name occurs twice'),
        (None, 'symbols', ['fruit', 'none'], r"symbols: 'none' cannot be a symbol: .* belongs to no symbol"),
        (None, 'symbols', ['Cup', 'cup'], r"symbols: 'cup' cannot be a symbol beside 'Cup'"),
        (None, 'symbols', ['fruit', 'Skip'], r"symbols: 'Skip' cannot be a symbol: .* skips a question"),
        (None, 'symbols', ['fruit', '7'], r"symbols: '7' cannot be a symbol: a number means an object"),
        (None, 'symbols', ['fruit', 'a,b'], r"symbols: 'a,b' cannot be a symbol: a comma"),
        (None, 'symbols', ['fruit', ' cup '], r"symbols: ' cup ' cannot be a symbol: it begins or ends with a blank"),
        (None, 'symbols', ['fruit', 'Fru\u0308chte'], r'cannot be a symbol: its Unicode is decomposed'),
        (None, 'relevant_groups', ['size', 'Size'], r"relevant_groups: 'Size' cannot be a feature group beside 'size'"),
        (None, 'relevant_groups', ['size', 'bbox[0,1]'], r"'bbox\[0,1\]' cannot be a feature group: a comma"),
        (None, 'relevant_groups', ['size', 'unknown'], r"'unknown' cannot be a feature group"),
        ('episode', 'strategy', 'guess', r"episode: strategy: unknown strategy 'guess'; known: u_sampling, .*human"),
        ('episode', 'costs', {'labels': 1}, r"episode: costs: unknown key 'labels'; known: label, demonstration"),
        ('episode', 'costs', {'label': -1}, r'episode: costs: label: -1 is outside'),
        ('episode', 'costs', {'skip': 1.5}, r'episode: costs: skip: 1.5 is outside \[0, 1\]'),
        ('episode', 'costs', 2, r'episode: costs: expected a mapping, found 2'),
        ('episode', 'costs', {'label': 1e200}, r'episode: costs: label: 1e\+200 is outside \[0, 1e\+12\]'),
        (None, 'costs', {'label': 1e200}, r'mine.yaml: costs: label: 1e\+200 is outside'),
        (None, 'costs', 2, r'mine.yaml: costs: expected a mapping, found 2'),
        (None, 'costs', {'label': 1}, r'costs stand twice, in episode and beside it'),
        (None, 'source', 'dataset', r'a dataset section belongs to source: dataset'),
        (None, 'dataset', {'categories': {'apple': 'fruit'}}, r'a dataset section belongs to source: dataset'),
    ],
)
def test_bad_values_are_named_with_file_and_key(
    tmp_path: Path, section: str | None, key: str, value: Any, message: str
) -> None:
    content = task_content('kitchen_table')
    (content if section is None else content[section])[key] = value
    if key == 'symbols':
        content['scenes']['class_frequencies'] = {}
    with pytest.raises(InputError, match=message) as caught:
        load_task(write_task(tmp_path, content))
    assert '\n' not in str(caught.value)


def test_a_missing_key_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"mine.yaml: key 'symbols' is missing"):
        load_task(write_task(tmp_path, {'description': 'of nothing'}))


@pytest.mark.parametrize(
    ('dataset', 'message'),
    [
        ({'categories': {'apple': 'fruit', 'ball': 'toy'}}, r"ball: unknown symbol 'toy'; known: fruit, snack"),
        ({'categories': {'apple': 'fruit', 'ball': 'none'}}, r"no category for the symbol 'snack'"),
        (
            {'categories': {'apple': 'fruit', 'bar': 'snack'}, 'weights_kg': {'pear': 0.1}},
            r"weights_kg: 'pear' is not among the categories",
        ),
    ],
)
def test_a_dataset_section_must_fit_the_symbols(tmp_path: Path, dataset: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _own(tmp_path, description='d', relevant_groups=['colour'], source='dataset', dataset=dataset)


def test_source_and_dataset_directory_must_agree(kitchen: Task, tmp_path: Path) -> None:
    with pytest.raises(InputError, match='task kitchen_table is simulated: it takes no dataset'):
        make_world(kitchen, 1, dataset=tmp_path)
    with pytest.raises(InputError, match='task uw_lunchbox needs a dataset: give its directory'):
        make_world(load_task('uw_lunchbox'), 1)


def test_where_no_catalogue_is_named_the_error_says_what_to_do(tmp_path: Path) -> None:
    """Otherwise a roboticist would look for a catalogue that they never asked for."""
    task = _own(tmp_path, symbols=['fruit', 'screwdriver'], scenes={'clutter_share': 0.5})
    with pytest.raises(InputError, match=r"no simulated thing is a 'screwdriver'.*`objects`.*--dry-run") as caught:
        make_world(task, 1)
    assert 'pack_lunchbox' not in str(caught.value)


def test_where_no_catalogue_is_named_one_that_fits_is_taken(tmp_path: Path) -> None:
    """Otherwise a task with clutter would be refused although there is some."""
    world = make_world(_own(tmp_path, scenes={'clutter_share': 0.5}), 1)
    assert set(world.training_labels()) == {'fruit', 'snack', 'none'}


def test_unusable_catalogues_and_seeds_are_refused(kitchen: Task) -> None:
    with pytest.raises(InputError, match="unknown catalogue 'attic'; known: prepare_lunch"):
        make_world(replace(kitchen, appearance=replace(kitchen.appearance, catalogue='attic')), 1)
    with pytest.raises(InputError, match="holds nothing of the symbol 'toy'"):
        make_world(
            replace(kitchen, symbols=(*kitchen.symbols, 'toy'), scenes=replace(kitchen.scenes, class_frequencies={})), 1
        )
    with pytest.raises(InputError, match='holds no clutter'):
        make_world(replace(kitchen, appearance=replace(kitchen.appearance, catalogue='pack_lunchbox')), 1)
    with pytest.raises(InputError, match='seed must be 0 or more'):
        make_world(kitchen, -1)
