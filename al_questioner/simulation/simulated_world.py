"""Kitchen table as a world: scenes that change over time, and held-out test observations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from al_questioner.domain import InputError, Observation, random_stream
from al_questioner.simulation.kitchen.pool import (
    KindsBySymbol,
    ViewSpec,
    make_sample,
    make_table,
    make_validation,
    observe,
)
from al_questioner.simulation.task import Task
from al_questioner.simulation.world import Table


class _PlacedView(NamedTuple):
    """An object of a scene: its id, and the row of the training pool whose view shows it."""

    object_id: int
    pool_row: int


class SimulatedWorld:
    """A table of rendered objects.

    Args:
        task: objects on the table and their changes.
        seed: seed of the scenes.
        sample: seed of training pool and test set; None for the seed.
        kinds: kinds of the objects, by symbol; those of the task's catalogue if not given.

    Raises:
        InputError: a negative seed, or a task whose catalogue lacks one of its symbols.
    """

    def __init__(self, task: Task, seed: int, sample: int | None = None, kinds: KindsBySymbol | None = None) -> None:
        self._task = task
        self._seed = seed
        self._sample_number = seed if sample is None else sample
        self._kinds = kinds
        self._sample = make_sample(task, self._sample_number, kinds)
        self._scenes: list[tuple[_PlacedView, ...]] = [self._first_scene()]
        self._observed: dict[_PlacedView, Observation] = {}

    @property
    def symbols(self) -> tuple[str, ...]:
        """Concepts to ground."""
        return self._task.symbols

    def scene(self, turn: int) -> tuple[Observation, ...]:
        """Return the observations of a turn, see `World.scene`."""
        return tuple(self._observation(seen) for seen in self._seen(turn))

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return the symbols of a turn by object id, see `World.truth`."""
        return {seen.object_id: self._sample.training[seen.pool_row].symbol for seen in self._seen(turn)}

    def names(self, turn: int) -> Mapping[int, str]:
        """Return the name of each object with its state, in words: for pictures and logs that people read."""
        return {seen.object_id: describe(self._sample.training[seen.pool_row]) for seen in self._seen(turn)}

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns that begin with a scene change, see `World.change_turns`."""
        interval = self._task.scenes.change_interval
        return list(range(1 + interval, turns + 1, interval))

    def training_pool(self, rows: Sequence[int] | None = None) -> tuple[Observation, ...]:
        """Return the training observations, see `World.training_pool`; the ids number the observations."""
        chosen = range(len(self._sample.training)) if rows is None else rows
        return tuple(self._observe(self._sample.training[row], row) for row in chosen)

    def training_labels(self) -> tuple[str, ...]:
        """Return the symbols of the training pool, see `World.training_labels`."""
        return tuple(view_spec.symbol for view_spec in self._sample.training)

    def test_observations(self) -> tuple[Observation, ...]:
        """Return the test observations, see `World.test_observations`; the ids number the observations."""
        return self._test_observations

    def test_labels(self) -> tuple[str, ...]:
        """Return the symbols of the test observations, see `World.test_labels`."""
        return tuple(view_spec.symbol for view_spec in self._sample.test)

    def validation_observations(self) -> tuple[Observation, ...]:
        """Return the second draw, see `World.validation_observations`; the ids number the observations."""
        return tuple(self._observe(view_spec, i) for i, view_spec in enumerate(self._validation))

    def validation_labels(self) -> tuple[str, ...]:
        """Return the symbols of the second draw, see `World.validation_labels`."""
        return tuple(view_spec.symbol for view_spec in self._validation)

    def new_table(self, number: int = 0) -> Table:
        """Return a held-out table, see `World.new_table`; the ids are 1 and up."""
        if number < 0:
            raise InputError(f'the number of a table must be 0 or more, not {number}')
        view_specs = make_table(self._task, self._sample_number, number, self._kinds)
        return Table(
            tuple(self._observe(view_spec, i) for i, view_spec in enumerate(view_specs, start=1)),
            {i: view_spec.symbol for i, view_spec in enumerate(view_specs, start=1)},
        )

    def report(self) -> str:
        """Return an empty text, see `World.report`: there is nothing to say about a simulated world."""
        return ''

    @cached_property
    def _test_observations(self) -> tuple[Observation, ...]:
        return tuple(self._observe(view_spec, i) for i, view_spec in enumerate(self._sample.test))

    @cached_property
    def _validation(self) -> tuple[ViewSpec, ...]:
        return make_validation(self._task, self._sample_number, self._kinds)

    @cached_property
    def _rows_of(self) -> list[list[int]]:
        """Rows of the training pool by the slot of a scene that they may fill."""
        of: list[list[int]] = [[] for _ in range(self._task.scenes.objects)]
        for index, view_spec in enumerate(self._sample.training):
            of[view_spec.thing.slot].append(index)
        return of

    def _observe(self, view_spec: ViewSpec, object_id: int) -> Observation:
        return observe(view_spec, self._task, self._sample_number, object_id)

    def _observation(self, seen: _PlacedView) -> Observation:
        if seen not in self._observed:
            self._observed[seen] = self._observe(self._sample.training[seen.pool_row], seen.object_id)
        return self._observed[seen]

    def _seen(self, turn: int) -> tuple[_PlacedView, ...]:
        if turn < 1:
            raise InputError(f'turn must be 1 or more, not {turn}')
        number = (turn - 1) // self._task.scenes.change_interval
        while len(self._scenes) <= number:
            self._scenes.append(self._next_scene(self._scenes[-1], len(self._scenes)))
        return self._scenes[number]

    def _first_scene(self) -> tuple[_PlacedView, ...]:
        rng = random_stream(self._seed, 'world/scene/0')
        if self._task.scenes.turnover == 'state':
            slots = range(len(self._rows_of))
            return tuple(_PlacedView(slot + 1, self._draw_state(slot, 0, None, rng)) for slot in slots)
        return tuple(_PlacedView(slot + 1, int(rng.choice(rows))) for slot, rows in enumerate(self._rows_of))

    def _next_scene(self, before: tuple[_PlacedView, ...], number: int) -> tuple[_PlacedView, ...]:
        """Return the scene after a change: exactly the persistent share of the objects stays the same."""
        rng = random_stream(self._seed, f'world/scene/{number}')
        count = len(before)
        leaving = sorted(rng.permutation(count)[round(self._task.scenes.persistence * count) :].tolist())
        after = list(before)
        newest = max(seen.object_id for scene in self._scenes for seen in scene)
        for slot in leaving:
            old = before[slot]
            if self._task.scenes.turnover == 'state':
                after[slot] = _PlacedView(old.object_id, self._draw_state(slot, number, old.pool_row, rng))
            else:
                newest += 1
                others = [row for row in self._rows_of[slot] if row != old.pool_row]
                after[slot] = _PlacedView(newest, int(rng.choice(others or [old.pool_row])))
        return tuple(after)

    def _draw_state(self, slot: int, clock: int, last: int | None, rng: np.random.Generator) -> int:
        """Return the row of a view of the object of a slot: in the state of the common clock, or in a random one."""
        rows = self._rows_of[slot]
        states = self._sample.training[rows[0]].thing.kind.states
        synchronous = rng.random() < self._task.scenes.synchrony
        state = clock % len(states) if synchronous else int(rng.integers(len(states)))
        fitting = [i for i in rows if self._sample.training[i].state == state]
        fresh = [i for i in fitting if i != last]
        return int(rng.choice(fresh or fitting or rows))


def describe(view_spec: ViewSpec) -> str:
    """Return a view in words: 'pasta, in pot'."""
    kind = view_spec.thing.kind
    return kind.name if len(kind.states) == 1 else f'{kind.name}, {kind.states[view_spec.state].name}'
