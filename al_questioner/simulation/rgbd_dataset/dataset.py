"""World of real objects: scenes drawn from a directory of RGB-D crops."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from al_questioner.domain import NO_SYMBOL, Camera, InputError, Observation, View, random_stream
from al_questioner.simulation.kitchen.layout import places
from al_questioner.simulation.kitchen.sensors import read_sensors
from al_questioner.simulation.rgbd_dataset.files import CropError, CropFiles, Skipped, index_crops, read_view
from al_questioner.simulation.rgbd_dataset.split import CropsByCategory, Draw, draw_sample, split_crops
from al_questioner.simulation.task import DatasetParameters, Task
from al_questioner.simulation.world import Table

FRAME_CENTRE = (319.5, 239.5)
"""Principal point of a 640 x 480 frame, in pixels."""

DEFAULT_WEIGHT_KG = 0.3
"""Weight of an object whose category has none in the task, in kg."""

REPORTED = 20
"""Number of skipped files that the report names; it counts the others."""


class _PlacedView(NamedTuple):
    """An object of a scene, and the crop that shows it."""

    crop: CropFiles
    observation: Observation


class DatasetWorld:
    """Scenes of real objects, from a directory in the layout of the University of Washington RGB-D Object Dataset.

    The directory is listed at once. Images are read when a scene or the test shows them, and an unusable one is
    replaced by another of its category and reported. A scene shows each physical object once: it holds fewer objects
    than the task says if the dataset has fewer. If objects change their state, the same ones come in other views.
    The places on the table and the other sensors are simulated: the original was filmed on a turntable.

    Args:
        task: task with a `dataset` section, which maps categories to symbols.
        root: the directory.
        seed: seed of the scenes.
        sample: seed of the held-out crops, training pool and test set; None for the seed.

    Attributes:
        symbols: the concepts to ground.
        split_report: the split of each category into training and test, and the absent ones; a line for each.

    Raises:
        InputError: a task without a dataset section, a negative seed, or a directory without a scene and a test.
    """

    def __init__(self, task: Task, root: Path, seed: int, sample: int | None = None) -> None:
        if task.dataset is None:
            raise InputError(f'task {task.name} has no dataset section: it cannot use the crops in {root}')
        self._task = task
        self._dataset: DatasetParameters = task.dataset
        self._seed = seed
        self._sample = seed if sample is None else sample
        self._camera = Camera(task.camera.focal_px, task.camera.focal_px, *FRAME_CENTRE)
        self.symbols = task.symbols

        index = index_crops(root, self._dataset.categories)
        self._root = index.root
        self._skipped = {skipped.path: skipped for skipped in index.skipped}
        split = split_crops(index.crops, self._dataset.test_share, random_stream(self._sample, 'dataset/split'))
        absent = [f'{category}: absent, no complete crop' for category in index.absent]
        found = {self._dataset.categories[category] for category in index.crops}
        unseen = [f'{symbol}: none of its categories is there' for symbol in task.symbols if symbol not in found]
        self.split_report = '\n'.join((*split.lines, *absent, *unseen))
        self._weights = self._draw_weights(index.crops)
        scenes = task.scenes
        frequencies = task.class_frequencies
        shares = {s: f * (1 - scenes.clutter_share) for s, f in frequencies.items()} | {NO_SYMBOL: scenes.clutter_share}
        self._shares, self._held_out = shares, split.test
        self._training = self._draw(split.training, scenes.training_size, shares, 'training')
        balanced = {symbol: 1 / len(task.symbols) for symbol in task.symbols}
        self._test = self._draw(
            split.test, scenes.test_size, balanced if scenes.test_balance == 'classes' else frequencies, 'test'
        )
        self._deck = _Deck(self._training, random_stream(seed, 'dataset/deck'))
        self._newest_id = 0
        self._scenes: list[tuple[_PlacedView, ...]] = [self._first_scene()]

    def scene(self, turn: int) -> tuple[Observation, ...]:
        """Return the observations of a turn, see `World.scene`."""
        return tuple(seen.observation for seen in self._seen(turn))

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return the symbols of a turn by object id, see `World.truth`."""
        return {seen.observation.object_id: self._symbol(seen.crop) for seen in self._seen(turn)}

    def names(self, turn: int) -> Mapping[int, str]:
        """Return the name of each object, in words: for pictures and logs that people read."""
        return {
            seen.observation.object_id: f'{seen.crop.category.replace("_", " ")} {seen.crop.instance}'
            for seen in self._seen(turn)
        }

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns that begin with a scene change, see `World.change_turns`."""
        interval = self._task.scenes.change_interval
        return list(range(1 + interval, turns + 1, interval))

    def training_pool(self, rows: Sequence[int] | None = None) -> tuple[Observation, ...]:
        """Return the training observations, see `World.training_pool`.

        This reads all images of the sample, which may take long.
        """
        chosen = range(len(self._training_pool)) if rows is None else rows
        return tuple(self._training_pool[row][1] for row in chosen)

    def training_labels(self) -> tuple[str, ...]:
        """Return the symbols of the training pool, see `World.training_labels`."""
        return tuple(self._symbol(crop) for crop, _ in self._training_pool)

    def test_observations(self) -> tuple[Observation, ...]:
        """Return the test observations, see `World.test_observations`.

        Raises:
            InputError: none of the held-out crops can be read.
        """
        return tuple(observation for _, observation in self._test_set)

    def test_labels(self) -> tuple[str, ...]:
        """Return the symbols of the test observations, see `World.test_labels`."""
        return tuple(self._symbol(crop) for crop, _ in self._test_set)

    def validation_observations(self) -> tuple[Observation, ...]:
        """Raise an error, since a directory of crops has no second draw, see `World.validation_observations`."""
        raise InputError('a directory of crops has no second draw of held-out observations')

    def validation_labels(self) -> tuple[str, ...]:
        """Raise an error, since a directory of crops has no second draw, see `World.validation_labels`."""
        raise InputError('a directory of crops has no second draw of held-out observations')

    def new_table(self, number: int = 0) -> Table:
        """Return a held-out table, see `World.new_table`; a thing stands on it once, the ids are 1 and up.

        Raises:
            InputError: a number below 0, or no held-out crop can be read.
        """
        if number < 0:
            raise InputError(f'the number of a table must be 0 or more, not {number}')
        draws = self._draw(self._held_out, self._task.scenes.objects, self._shares, f'table/{number}')
        shown = {crop.thing: (crop, view) for draw in draws.values() for crop, view in self._read_all(draw)}
        if not shown:
            raise InputError(f'dataset {self._root}: no held-out crop can be read; the last: {self.skipped[-1]}')
        placed = list(enumerate(shown.values()))
        return Table(
            tuple(self._observe(place + 1, crop, view, place) for place, (crop, view) in placed),
            {place + 1: self._symbol(crop) for place, (crop, _) in placed},
        )

    @property
    def skipped(self) -> tuple[Skipped, ...]:
        """Files that were skipped so far; more may follow when a scene or the test draws them."""
        return tuple(self._skipped.values())

    def report(self) -> str:
        """Return the split of the crops, the number of loaded ones, and the skipped files, see `World.report`."""
        return f'{self.split_report}\n{self.load_report()}'

    def load_report(self) -> str:
        """Return the number of loaded crops and the files skipped so far, with their number at the end."""
        training, test = (sum(len(draw.crops) for draw in part.values()) for part in (self._training, self._test))
        lines = [f'{self._root}: {training} training crops, {test} test crops']
        if len(self._scenes[0]) < self._task.scenes.objects:
            lines.append(f'{len(self._scenes[0])} objects in a scene: there are no more')
        lines += [f'skipped {skipped}' for skipped in self.skipped[:REPORTED]]
        if len(self.skipped) > REPORTED:
            lines.append(f'and {len(self.skipped) - REPORTED} more')
        return '\n'.join((*lines, f'skipped in all: {len(self.skipped)}'))

    def _symbol(self, crop: CropFiles) -> str:
        return self._dataset.categories[crop.category]

    def _draw_weights(self, crops: CropsByCategory) -> dict[tuple[str, int], float]:
        """Draw the weight in kg of each physical object, around the nominal weight of its category."""
        things = sorted({crop.thing for found in crops.values() for crop in found})
        nominal = [self._dataset.weights_kg.get(category, DEFAULT_WEIGHT_KG) for category, _ in things]
        rng = random_stream(self._sample, 'dataset/weights')
        factors = np.exp(rng.normal(0, self._task.appearance.weight_spread, len(things)))
        return dict(zip(things, (np.array(nominal) * factors).tolist(), strict=True))

    def _draw(self, pool: CropsByCategory, size: int, shares: Mapping[str, float], part: str) -> dict[str, Draw]:
        """Draw a sample whose symbols have these shares, each of their categories about equally often."""
        present = {category: symbol for category, symbol in self._dataset.categories.items() if pool.get(category)}
        kinds = list(present.values())
        by_category = {c: shares.get(symbol, 0.0) / kinds.count(symbol) for c, symbol in present.items()}
        drawn = draw_sample(pool, size, by_category, random_stream(self._sample, f'dataset/{part}'))
        if not drawn:
            raise InputError(f'dataset {self._root}: no crop of any symbol is left for the {part}')
        return drawn

    def _read(self, crop: CropFiles) -> View | None:
        try:
            return read_view(crop, self._camera)
        except CropError as error:
            self._skipped[error.skipped.path] = error.skipped
            return None

    def _observe(self, object_id: int, crop: CropFiles, view: View, place: int) -> Observation:
        """Return the observation of a crop; the same crop in the same place gives the same readings whatever its id."""
        rng = random_stream(self._sample, f'dataset/observation/{crop.stem.name}')
        spots = places(self._task.scenes.table_m, self._task.scenes.objects)
        spot = spots[place % len(spots)]
        jitter = rng.uniform(-1, 1, 2) * spot.slack
        position = (float(spot.x + jitter[0]), float(spot.y + jitter[1]), 0.0)
        sensors = read_sensors(rng, position, self._weights[crop.thing], self._task.sensors)
        return Observation(object_id, position, view, sensors)

    @cached_property
    def _training_pool(self) -> tuple[_PlacedView, ...]:
        return self._observe_all(self._training)

    @cached_property
    def _test_set(self) -> tuple[_PlacedView, ...]:
        found = self._observe_all(self._test)
        if not found:
            raise InputError(f'dataset {self._root}: no test crop can be read; the last: {self.skipped[-1]}')
        return found

    def _observe_all(self, drawn: Mapping[str, Draw]) -> tuple[_PlacedView, ...]:
        read = [pair for draw in drawn.values() for pair in self._read_all(draw)]
        return tuple(_PlacedView(crop, self._observe(i, crop, view, i)) for i, (crop, view) in enumerate(read))

    def _read_all(self, draw: Draw) -> Iterator[tuple[CropFiles, View]]:
        """Yield as many crops as were drawn, with spares in place of unreadable ones as long as there are any."""
        wanted = len(draw.crops)
        for crop in (*draw.crops, *draw.spares):
            if wanted > 0 and (view := self._read(crop)) is not None:
                wanted -= 1
                yield crop, view

    def _seen(self, turn: int) -> tuple[_PlacedView, ...]:
        if turn < 1:
            raise InputError(f'turn must be 1 or more, not {turn}')
        number = (turn - 1) // self._task.scenes.change_interval
        while len(self._scenes) <= number:
            rng = random_stream(self._seed, f'dataset/scene/{len(self._scenes)}')
            self._scenes.append(self._next_scene(self._scenes[-1], rng))
        return self._scenes[number]

    def _first_scene(self) -> tuple[_PlacedView, ...]:
        rng = random_stream(self._seed, 'dataset/scene/0')
        scene: list[_PlacedView] = []
        for place in range(self._task.scenes.objects):
            newcomer = self._newcomer(place, scene, rng)
            if newcomer is not None:
                scene.append(newcomer)
        if not scene:
            raise InputError(f'dataset {self._root}: no training crop can be read; the last: {self.skipped[-1]}')
        return tuple(scene)

    def _next_scene(self, before: tuple[_PlacedView, ...], rng: np.random.Generator) -> tuple[_PlacedView, ...]:
        """Return the scene after a change: exactly the persistent share of the objects stays the same."""
        staying = round(self._task.scenes.persistence * len(before))
        after = list(before)
        for place in sorted(rng.permutation(len(before))[staying:].tolist()):
            replacement = None
            if self._task.scenes.turnover == 'object':
                replacement = self._newcomer(place, (*before, *after), rng)
            after[place] = replacement or self._another_view(place, before[place], rng)
        return tuple(after)

    def _newcomer(self, place: int, present: Iterable[_PlacedView], rng: np.random.Generator) -> _PlacedView | None:
        """Return a physical object that is not present, or None if there is no other."""
        things = {seen.crop.thing for seen in present}
        drawn = self._deal(lambda crop: crop.thing not in things, rng)
        if drawn is None:
            return None
        self._newest_id += 1
        return _PlacedView(drawn[0], self._observe(self._newest_id, *drawn, place))

    def _another_view(self, place: int, old: _PlacedView, rng: np.random.Generator) -> _PlacedView:
        """Return another view of the same object, or the same one if there is no other."""
        drawn = self._deal(lambda crop: crop.thing == old.crop.thing and crop != old.crop, rng)
        return old if drawn is None else _PlacedView(drawn[0], self._observe(old.observation.object_id, *drawn, place))

    def _deal(self, fits: Callable[[CropFiles], bool], rng: np.random.Generator) -> tuple[CropFiles, View] | None:
        while (crop := self._deck.deal(fits, rng)) is not None:
            view = self._read(crop)
            if view is not None:
                return crop, view
            self._deck.replace(crop)
        return None


class _Deck:
    """Crops of a sample in random order. A dealt crop comes back only when nothing else fits."""

    def __init__(self, drawn: Mapping[str, Draw], rng: np.random.Generator) -> None:
        crops = [crop for draw in drawn.values() for crop in draw.crops]
        self._pile = [crops[i] for i in rng.permutation(len(crops))]
        self._dealt: list[CropFiles] = []
        self._spares = {category: list(draw.spares) for category, draw in drawn.items()}

    def deal(self, fits: Callable[[CropFiles], bool], rng: np.random.Generator) -> CropFiles | None:
        """Return the first crop that fits, or None if none does."""
        crop = next(filter(fits, self._pile), None)
        if crop is None:
            self._pile += [self._dealt[i] for i in rng.permutation(len(self._dealt))]
            self._dealt.clear()
            crop = next(filter(fits, self._pile), None)
        if crop is not None:
            self._pile.remove(crop)
            self._dealt.append(crop)
        return crop

    def replace(self, crop: CropFiles) -> None:
        """Remove a dealt crop, and put a spare of its category on the top of the pile, if there is one."""
        self._dealt.remove(crop)
        if self._spares[crop.category]:
            self._pile.insert(0, self._spares[crop.category].pop(0))
