"""Observations of a sample: its objects, their states and viewpoints. They are rendered at the first access."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from al_questioner.domain import NO_SYMBOL, Observation, View, random_stream
from al_questioner.simulation.kitchen.drawing.rendering import draw_lighting, draw_pose, render
from al_questioner.simulation.kitchen.layout import Place, places
from al_questioner.simulation.kitchen.sensors import REFRIGERATOR, read_sensors
from al_questioner.simulation.kitchen.things.catalogue import kinds_by_symbol
from al_questioner.simulation.kitchen.things.kinds import Kind
from al_questioner.simulation.kitchen.things.vessels import Look
from al_questioner.simulation.task import Task

_PLACES_PER_OBJECT = 3
"""Number of places among which an object that stays is moved, so that its location does not reveal its symbol."""


@dataclass(frozen=True)
class ObjectInstance:
    """One physical object.

    Attributes:
        kind: its kind.
        look: its individual look.
        weight_factor: factor of its weight.
        slot: index of the object in a scene, or, if objects are replaced, the index that it may take.
        places: its possible places on the table, as indices of `places`; no two slots share a place.
    """

    kind: Kind
    look: Look
    weight_factor: float
    slot: int
    places: tuple[int, ...]


@dataclass(frozen=True)
class ViewSpec:
    """One observation before it is made: an object in a state.

    Attributes:
        key: names the random stream of the observation, unique within the sample.
        thing: the object.
        state: index of its state.
        place: index of its place on the table.
    """

    key: str
    thing: ObjectInstance
    state: int
    place: int

    @property
    def symbol(self) -> str:
        """True symbol, or 'none'."""
        return self.thing.kind.symbol


@dataclass(frozen=True)
class Sample:
    """Training and test views of a task; no view is in both.

    Attributes:
        training: T views, the pool that scenes are drawn from.
        test: held-out views, each of some symbol.
    """

    training: tuple[ViewSpec, ...]
    test: tuple[ViewSpec, ...]


KindsBySymbol = Mapping[str, Sequence[Kind]]


def make_sample(task: Task, sample: int, there_are: KindsBySymbol | None = None) -> Sample:
    """Return the sample of this number: the same for every seed of the scenes.

    If objects change their state, training and test show the same objects in the same states, in new views. If
    objects are replaced, every view is of an object of its own. The kinds `there_are` are by symbol and 'none', or
    those of the task's catalogue if not given.
    """
    rng = random_stream(sample, 'world/sample')
    scenes = task.scenes
    kinds = _some_kinds(task, there_are, rng)
    shares = task.class_frequencies
    if scenes.turnover == 'state':
        kinds_of_objects = _kinds(kinds, apportion(shares, scenes.objects), rng)
        things = _things(kinds_of_objects, task, rng)
        return Sample(_view_specs(things, scenes.training_size, 'training'), _elsewhere(things, task, rng, 'test'))
    clutter = round(scenes.clutter_share * scenes.training_size)
    wanted = {**apportion(shares, scenes.training_size - clutter), NO_SYMBOL: clutter}
    training = _things(_kinds(kinds, wanted, rng), task, rng)
    return Sample(_view_specs(training, len(training), 'training'), _held_out(kinds, task, rng, 'test'))


def make_validation(task: Task, sample: int, there_are: KindsBySymbol | None = None) -> tuple[ViewSpec, ...]:
    """Return a second draw of test views, like those of `make_sample` but disjoint and drawn independently."""
    of_sample, rng = random_stream(sample, 'world/sample'), random_stream(sample, 'world/validation')
    kinds = _some_kinds(task, there_are, of_sample)
    if task.scenes.turnover != 'state':
        return _held_out(kinds, task, rng, 'validation')
    counts = apportion(task.class_frequencies, task.scenes.objects)
    return _elsewhere(_things(_kinds(kinds, counts, of_sample), task, of_sample), task, rng, 'validation')


def make_table(task: Task, sample: int, number: int, there_are: KindsBySymbol | None = None) -> tuple[ViewSpec, ...]:
    """Return held-out views of the things of one scene, clutter included, in the order of their slots.

    As in `make_sample`: the sample's own objects in random states if objects change their state, else other objects of
    the same kinds. Where an object stands is drawn as in the scenes.
    """
    of_sample, rng = random_stream(sample, 'world/sample'), random_stream(sample, f'world/table/{number}')
    scenes, kinds = task.scenes, _some_kinds(task, there_are, of_sample)
    if scenes.turnover == 'state':
        counts = apportion(task.class_frequencies, scenes.objects)
        things = _things(_kinds(kinds, counts, of_sample), task, of_sample)
    else:
        clutter = round(scenes.clutter_share * scenes.objects)
        counts = {**apportion(task.class_frequencies, scenes.objects - clutter), NO_SYMBOL: clutter}
        things = _things(_kinds(kinds, counts, rng), task, rng)
    return tuple(
        ViewSpec(
            f'table/{number}/{i}',
            thing,
            int(rng.integers(len(thing.kind.states))),
            int(rng.choice(thing.places)),
        )
        for i, thing in enumerate(things)
    )


def observe(view_spec: ViewSpec, task: Task, sample: int, object_id: int) -> Observation:
    """Make the observation: render the view and read the sensors. The same view looks the same whatever its id."""
    rng = random_stream(sample, f'world/observation/{view_spec.key}')
    position = position_of(view_spec, task, rng)
    state = view_spec.thing.kind.states[view_spec.state]
    sensors = read_sensors(rng, position, view_spec.thing.weight_factor * state.weight_kg, task.sensors)
    return Observation(object_id, position, _view(view_spec, task, rng), sensors)


def apportion(shares: Mapping[str, float], total: int) -> dict[str, int]:
    """Return whole numbers in proportion to the shares that sum to the total, by the method of largest remainders."""
    exact = {name: share * total for name, share in shares.items()}
    counts = {name: int(value + 1e-9) for name, value in exact.items()}
    by_remainder = sorted(exact, key=lambda name: counts[name] - exact[name])
    for name in by_remainder[: total - sum(counts.values())]:
        counts[name] += 1
    return counts


def _some_kinds(task: Task, there_are: KindsBySymbol | None, rng: np.random.Generator) -> dict[str, list[Kind]]:
    """Return as many kinds of each symbol, and of clutter, as the task asks for."""
    chosen = {}
    for symbol, kinds in (kinds_by_symbol(task) if there_are is None else there_are).items():
        looks = task.appearance
        wanted = looks.kinds_of_clutter if symbol == NO_SYMBOL else looks.kinds_per_symbol
        chosen[symbol] = [kinds[i] for i in rng.permutation(len(kinds))[: wanted or None]]
    return chosen


def _kinds(kinds: Mapping[str, Sequence[Kind]], counts: Mapping[str, int], rng: np.random.Generator) -> list[Kind]:
    """Return the given number of kinds of each symbol, every kind of a symbol about equally often, in random order."""
    chosen: list[Kind] = []
    for symbol, count in counts.items():
        while count > 0:
            order = rng.permutation(len(kinds[symbol]))[:count]
            chosen += [kinds[symbol][i] for i in order]
            count -= len(order)
    return [chosen[i] for i in rng.permutation(len(chosen))]


def _things(kinds: Sequence[Kind], task: Task, rng: np.random.Generator) -> list[ObjectInstance]:
    """Return objects of these kinds, spread evenly over the places of the table."""
    looks = task.appearance
    things = []
    for index, owned in enumerate(_deal_places(kinds, task, rng)):
        look = Look(
            size=float(np.exp(rng.normal(0, looks.size_spread))),
            hue_deg=float(rng.normal(0, looks.hue_spread)),
            tone=float(np.exp(rng.normal(0, looks.tone_spread))),
            variant=float(rng.random()),
        )
        weight_factor = float(np.exp(rng.normal(0, looks.weight_spread)))
        slot = index if task.scenes.turnover == 'state' else owned[0]
        things.append(ObjectInstance(kinds[index], look, weight_factor, slot, owned))
    return things


def _deal_places(kinds: Sequence[Kind], task: Task, rng: np.random.Generator) -> list[tuple[int, ...]]:
    """Return the places of each object: random, but cold ones are nearer the refrigerator by `cold_pull`."""
    spots = _grid(task)
    nearest = sorted(
        range(len(spots)), key=lambda i: np.hypot(spots[i].x - REFRIGERATOR[0], spots[i].y - REFRIGERATOR[1])
    )
    owners = [i for i in range(len(kinds)) for _ in range(len(spots) // task.scenes.objects)]
    pull = task.sensors.cold_pull
    warmth = [(1 - pull) * rng.random() + pull * (not kinds[i].cold) for i in owners]
    dealt: list[list[int]] = [[] for _ in kinds]
    for rank, claim in enumerate(sorted(range(len(owners)), key=warmth.__getitem__)):
        dealt[owners[claim]].append(nearest[rank * len(spots) // len(owners)])
    return [tuple(owned) for owned in dealt]


def _view_specs(things: Sequence[ObjectInstance], count: int, split: str) -> tuple[ViewSpec, ...]:
    """Return `count` views, evenly over the objects and, of each object, over its states and places."""
    view_specs = []
    for i in range(count):
        view, thing = i // len(things), things[i % len(things)]
        states = len(thing.kind.states)
        place = thing.places[(view + view // states) % len(thing.places)]
        view_specs.append(ViewSpec(f'{split}/{i}', thing, view % states, place))
    return tuple(view_specs)


def _held_out(
    kinds: Mapping[str, Sequence[Kind]], task: Task, rng: np.random.Generator, split: str
) -> tuple[ViewSpec, ...]:
    """Return held-out views, each of an object of its own."""
    scenes = task.scenes
    equal = {symbol: 1 / len(task.symbols) for symbol in task.symbols}
    counts = apportion(equal if scenes.test_balance == 'classes' else task.class_frequencies, scenes.test_size)
    return _elsewhere(_things(_kinds(kinds, counts, rng), task, rng), task, rng, split)


def _elsewhere(
    things: Sequence[ObjectInstance], task: Task, rng: np.random.Generator, split: str
) -> tuple[ViewSpec, ...]:
    """Return held-out views, anywhere on the table, so that the places in training do not predict those in the test."""
    view_specs = _view_specs(things, task.scenes.test_size, split)
    if task.sensors.cold_pull > 0:
        return view_specs
    return tuple(replace(view_spec, place=int(rng.integers(len(_grid(task))))) for view_spec in view_specs)


def _grid(task: Task) -> tuple[Place, ...]:
    """Return the places on the table: one for each object of a scene, or several if the objects stay but are moved."""
    copies = _PLACES_PER_OBJECT if task.scenes.turnover == 'state' else 1
    return places(task.scenes.table_m, copies * task.scenes.objects)


def position_of(view_spec: ViewSpec, task: Task, rng: np.random.Generator) -> tuple[float, float, float]:
    """Return the position of an object on the table, in metres."""
    place = _grid(task)[view_spec.place]
    jitter = rng.uniform(-1, 1, 2) * place.slack
    return float(place.x + jitter[0]), float(place.y + jitter[1]), 0.0


def _view(view_spec: ViewSpec, task: Task, rng: np.random.Generator) -> View:
    look = view_spec.thing.look
    solid = view_spec.thing.kind.states[view_spec.state].draw(look, rng)
    pose = draw_pose(rng, solid, look.size, task.camera)
    return render(solid, pose, draw_lighting(rng, task.appearance), task.camera, rng)
