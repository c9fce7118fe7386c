"""A task: which symbols to ground in which world, as `config/tasks/NAME.yaml` states it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from al_questioner.domain import BUDGET, CHANGE_INTERVAL, NO_SYMBOL, TURNS, Costs, InputError, Setting
from al_questioner.domain.names import suggestion
from al_questioner.questioning.strategies.names import STRATEGY
from al_questioner.simulation.task_reading import (
    Interval,
    choice,
    costs,
    declared,
    defaults_of,
    interval,
    names_of,
    number,
    pair,
    read_section,
    section_of,
    setting,
    strategy,
    table_of,
    text,
    unless_empty,
    whole,
)
from al_questioner.simulation.variety import Variety
from al_questioner.support.configuration import named_file, read_yaml

SCENE_INTERVAL = replace(CHANGE_INTERVAL, description='turns between changes', unit='', upper=1_000_000)
SYNCHRONY = Setting('synchrony', 1.0, 'how synchronously objects change', '', 0, 1)

_EMPTY: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class EpisodeDefaults:
    """Settings of an episode of the task, unless the user chooses others.

    Attributes:
        budget: query budget, in units of a label query.
        turns: length of the episode.
        strategy: questioning strategy.
        costs: of each kind of query, and the shares of them that are charged for what is not answered.
    """

    budget: float = declared(BUDGET)
    turns: int = declared(TURNS)
    strategy: str = setting(strategy, STRATEGY.default)
    costs: Costs = setting(unless_empty(costs, Costs()), Costs())


@dataclass(frozen=True)
class SceneParameters:
    """Number of things on the table, and their changes over time.

    Attributes:
        objects: things on the table at once.
        change_interval: turns between scene changes.
        turnover: 'state', the same objects come in new states; or 'object', things leave and others come with new ids.
        persistence: share of the objects that a scene change leaves as they are.
        synchrony: probability that an object follows the common clock of states rather than a state of its own
            (turnover 'state' only).
        clutter_share: share of the things that belong to no symbol.
        class_frequencies: share of each symbol among the other things; empty for equal shares.
        training_size: observations that the scenes are drawn from.
        test_size: held-out observations, each of some symbol.
        test_balance: 'training', composed like the training observations but without clutter; or 'classes', equally
            many of each symbol.
        table_m: width and depth of the table in metres.
    """

    objects: int = setting(whole(1, 200), 10)
    change_interval: int = declared(SCENE_INTERVAL)
    turnover: str = setting(choice('state', 'object'), 'object')
    persistence: float = setting(number(0, 1), 0.0)
    synchrony: float = declared(SYNCHRONY)
    clutter_share: float = setting(number(0, 0.95), 0.0)
    class_frequencies: Mapping[str, float] = setting(table_of(number(0, 1)), _EMPTY)
    training_size: int = setting(whole(1, 100_000), 80)
    test_size: int = setting(whole(1, 100_000), 40)
    test_balance: str = setting(choice('training', 'classes'), 'training')
    table_m: Interval = setting(pair('width', 'depth', number(0.2, 5)), Interval(1.4, 0.8))


@dataclass(frozen=True)
class AppearanceParameters:
    """Differences between views of things of one kind.

    Attributes:
        catalogue: which kinds of things there are; empty for one that holds those of the symbols.
        kinds_per_symbol: kinds of things of each symbol, drawn for each sample; 0 for all of the catalogue.
        kinds_of_clutter: kinds of things of no symbol, likewise.
        size_spread: relative standard deviation of a thing's size.
        hue_spread: standard deviation of the shift of its colours around the colour wheel, in degrees.
        tone_spread: standard deviation of the log brightness of its colours.
        weight_spread: relative standard deviation of its weight.
        light_spread: standard deviation of the log brightness of the light, per view.
        tint_spread: standard deviation of the log gain of each colour channel, per view.
        light_elevation_deg: height of the light above the table.
        background_variety: 0 for one table top, 1 for all of them.
    """

    catalogue: str = setting(text, '')
    kinds_per_symbol: int = setting(whole(0, 1000), 0)
    kinds_of_clutter: int = setting(whole(0, 1000), 0)
    size_spread: float = setting(number(0, 0.3), 0.08)
    hue_spread: float = setting(number(0, 180), 4.0)
    tone_spread: float = setting(number(0, 1), 0.08)
    weight_spread: float = setting(number(0, 1), 0.2)
    light_spread: float = setting(number(0, 1), 0.12)
    tint_spread: float = setting(number(0, 0.5), 0.03)
    light_elevation_deg: Interval = setting(interval(20, 90), Interval(40.0, 70.0))
    background_variety: float = setting(number(0, 1), 0.0)


@dataclass(frozen=True)
class CameraParameters:
    """A Kinect-like RGB-D camera.

    Attributes:
        focal_px: focal length in pixels of the 640 x 480 frame.
        distance_m: from the camera to the thing.
        elevation_deg: of the camera above the table plane, seen from the thing.
        margin_px: rim of the crop around the thing.
        color_noise: standard deviation of a colour channel, in levels of 255.
        blur_px: standard deviation of the colour image's blur.
        depth_noise_m: standard deviation of a depth reading at 1 m; it grows with the square of the distance.
        disparity_step: quantisation of the depth in pixels of disparity (the Kinect's is 1/8); 0 for none.
        edge_holes: share of the pixels at the thing's outline without a depth reading.
        random_holes: share of all pixels without a reading.
        shiny_holes: share of the pixels with a highlight, or of a transparent surface, without a reading.
    """

    focal_px: float = setting(number(100, 800), 525.0)
    distance_m: Interval = setting(interval(0.6, 5), Interval(0.9, 1.2))
    elevation_deg: Interval = setting(interval(25, 80), Interval(38.0, 58.0))
    margin_px: int = setting(whole(2, 60), 8)
    color_noise: float = setting(number(0, 60), 3.0)
    blur_px: float = setting(number(0, 5), 0.4)
    depth_noise_m: float = setting(number(0, 0.05), 0.0015)
    disparity_step: float = setting(number(0, 2), 0.125)
    edge_holes: float = setting(number(0, 1), 0.4)
    random_holes: float = setting(number(0, 1), 0.01)
    shiny_holes: float = setting(number(0, 1), 0.6)


@dataclass(frozen=True)
class SensorParameters:
    """Standard deviations of the Gaussian noise of the robot's other sensors, and what they say about the class.

    Attributes:
        weight_kg: of the object's weight.
        location_m: of the object's location.
        base_m: of the base's position.
        base_rad: of the base's heading.
        arms_rad: of a joint of an arm.
        hands_m: of a hand's position.
        noise_db: of a volume of noise.
        cold_pull: how strongly things that are kept cold stand near the refrigerator: 0 not at all, 1 always.
    """

    weight_kg: float = setting(number(0, 10), 0.01)
    location_m: float = setting(number(0, 10), 0.02)
    base_m: float = setting(number(0, 10), 0.02)
    base_rad: float = setting(number(0, 3), 0.02)
    arms_rad: float = setting(number(0, 3), 0.01)
    hands_m: float = setting(number(0, 10), 0.01)
    noise_db: float = setting(number(0, 100), 2.0)
    cold_pull: float = setting(number(0, 1), 0.0)


@dataclass(frozen=True)
class DatasetParameters:
    """Parameters of a world of real RGB-D crops.

    Attributes:
        categories: symbol, or 'none' for clutter, by category; other categories are left out.
        weights_kg: nominal weight by category, for the simulated scales.
        test_share: share of the objects of a category (of the views, if there is but one) that is held out.
    """

    categories: Mapping[str, str] = setting(table_of(text))
    weights_kg: Mapping[str, float] = setting(table_of(number(0, 100)), _EMPTY)
    test_share: float = setting(number(0.01, 0.99), 1 / 3)


@dataclass(frozen=True)
class Task:
    """A concept grounding task.

    Attributes:
        name: the file's name without its suffix.
        description: one sentence; may be empty.
        source: 'simulated' or 'dataset'; 'arrays' for that of a `PoolWorld`.
        symbols: the concepts to ground.
        relevant_groups: what the scripted teacher answers to the feature subset query; if empty, that it does not know.
        episode: defaults of an episode.
        scenes: what lies on the table, and how it changes.
        appearance, camera: how things look (simulated worlds).
        sensors: the robot's other sensors.
        dataset: how a directory of crops is read (dataset worlds).
        variety: from where each sample draws scenes of its own (simulated worlds); None if all have those above.
    """

    name: str
    description: str
    source: str
    symbols: tuple[str, ...]
    relevant_groups: tuple[str, ...]
    episode: EpisodeDefaults
    scenes: SceneParameters
    appearance: AppearanceParameters
    camera: CameraParameters
    sensors: SensorParameters
    dataset: DatasetParameters | None
    variety: Variety | None = None

    def of_sample(self, sample: int) -> Task:
        """Return the task as the sample of this number has it: the same for every seed of the scenes."""
        if self.variety is None:
            return self
        scenes = replace(self.scenes, **self.variety.draw(self.symbols, sample))
        return replace(self, scenes=scenes, variety=None)

    @property
    def class_frequencies(self) -> Mapping[str, float]:
        """Share of each symbol among the things that belong to one; the shares sum to 1."""
        given = self.scenes.class_frequencies
        return {s: given[s] if given else 1 / len(self.symbols) for s in self.symbols}


def load_task(name_or_path: str) -> Task:
    """Load the task of a name that ships in `config/tasks`, or of a YAML file.

    Raises:
        InputError: no such task, or a file that is not a valid task; the text names the file and the key.
    """
    path = named_file('tasks', str(name_or_path), 'task')
    content = read_yaml(path)
    document = read_section(_Document, content, path.name)
    parts = {name: getattr(document, name) for name in _Document.__dataclass_fields__}
    beside = parts.pop('costs')
    if beside is not None:
        if (content.get('episode') or {}).get('costs') is not None:
            raise InputError(f'{path.name}: costs stand twice, in episode and beside it')
        # With the budget that they are paid from, wherever they stand in the file.
        parts['episode'] = replace(document.episode, costs=beside)
    task = Task(name=path.stem, **parts)
    _check(task, path.name)
    return task


@dataclass(frozen=True)
class _Document:
    symbols: tuple[str, ...] = setting(names_of('symbol'))
    relevant_groups: tuple[str, ...] = setting(unless_empty(names_of('feature group', has_key=False), ()), ())
    description: str = setting(unless_empty(text, ''), '')
    source: str = setting(choice('simulated', 'dataset'), 'simulated')
    episode: EpisodeDefaults = defaults_of(EpisodeDefaults)
    costs: Costs | None = setting(unless_empty(costs, None), None)
    scenes: SceneParameters = defaults_of(SceneParameters)
    appearance: AppearanceParameters = defaults_of(AppearanceParameters)
    camera: CameraParameters = defaults_of(CameraParameters)
    sensors: SensorParameters = defaults_of(SensorParameters)
    dataset: DatasetParameters | None = setting(unless_empty(section_of(DatasetParameters), None), None)
    variety: Variety | None = setting(unless_empty(section_of(Variety), None), None)


def _check(task: Task, where: str) -> None:
    """Hold what no single key can promise."""
    if len(task.symbols) < 2:
        raise InputError(f'{where}: symbols: at least two are needed, found {list(task.symbols)}')
    _check_shares(task, f'{where}: scenes: class_frequencies')
    if (task.source == 'dataset') != (task.dataset is not None):
        raise InputError(f'{where}: a dataset section belongs to source: dataset, and only there')
    if task.dataset is not None:
        _check_categories(task.dataset, task.symbols, f'{where}: dataset')
    elif task.scenes.training_size < max(task.scenes.objects, task.variety.objects.high if task.variety else 0):
        raise InputError(f'{where}: scenes: training_size is below the number of objects of a scene')
    if task.source == 'simulated' and task.scenes.turnover == 'state' and task.scenes.clutter_share > 0:
        raise InputError(f'{where}: scenes: clutter_share must be 0 where objects stay and change their state')
    if task.variety is not None and (task.source != 'simulated' or task.scenes.turnover == 'state'):
        raise InputError(f'{where}: variety: only simulated things that leave, and others that come, can vary')


def _check_shares(task: Task, where: str) -> None:
    shares = task.scenes.class_frequencies
    if not shares:
        return
    if sorted(shares) != sorted(task.symbols):
        raise InputError(
            f'{where}: expected one share for each of {", ".join(task.symbols)}, found {", ".join(shares)}'
        )
    if not math.isclose(sum(shares.values()), 1, abs_tol=1e-6):
        raise InputError(f'{where}: the shares sum to {sum(shares.values()):g}, expected 1')


def _check_categories(dataset: DatasetParameters, symbols: tuple[str, ...], where: str) -> None:
    for category, symbol in dataset.categories.items():
        if symbol not in (*symbols, NO_SYMBOL):
            known = ', '.join((*symbols, NO_SYMBOL))
            hint = suggestion(symbol, (*symbols, NO_SYMBOL))
            raise InputError(f'{where}: categories: {category}: unknown symbol {symbol!r}; known: {known}{hint}')
    for symbol in symbols:
        if symbol not in dataset.categories.values():
            raise InputError(f'{where}: categories: no category for the symbol {symbol!r}')
    for category in dataset.weights_kg:
        if category not in dataset.categories:
            raise InputError(f'{where}: weights_kg: {category!r} is not among the categories')
