"""World from arrays: things with known symbols, some of which lie on a table at a time.

There are no pictures, and there is no perception: the rows of a table are the features. So strategies can be compared
on any data that classifiers are compared on.
"""

from __future__ import annotations

import operator
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from al_questioner.domain import NO_SYMBOL, Costs, InputError, Scene, group_of, random_stream
from al_questioner.domain.names import listed
from al_questioner.simulation.task import (
    AppearanceParameters,
    CameraParameters,
    EpisodeDefaults,
    SceneParameters,
    SensorParameters,
    Task,
)
from al_questioner.simulation.world_spec import WorldSpec


@dataclass(frozen=True, eq=False)
class Pool:
    """Things with known symbols, as arrays.

    Lists are accepted in place of arrays and tuples.

    Attributes:
        features: (n, m) float32, one thing a row.
        labels: symbol of each thing, or 'none'; whole numbers are accepted, and read as names.
        feature_names: m names; the group of a feature is the part of its name before the first underscore. A name that
            occurs several times is numbered, so the groups alone will do: 'size', 'size' become 'size_0', 'size_1'.
            Without any, each feature is a group of its own.

    Raises:
        InputError: a shape that does not fit, a value that is not a finite number, a label that is neither text nor a
            whole number, a name that is the number of another one, or fewer than two symbols.
    """

    features: NDArray[np.float32]
    labels: tuple[str, ...]
    feature_names: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, 'features', _table(self.features))
        object.__setattr__(self, 'labels', _labels(self.labels))
        names = listed(self.feature_names)
        if names is None:
            raise InputError(f'feature_names must be a list of names, not {self.feature_names!r}')
        things, features = self.features.shape
        names = _numbered(names) or tuple(f'feature{column}' for column in range(features))
        object.__setattr__(self, 'feature_names', names)
        if len(self.labels) != things:
            raise InputError(f'there are {things} things, but {len(self.labels)} labels')
        if len(names) != features:
            raise InputError(f'the things have {features} features, but there are {len(names)} feature names')
        if len(set(names)) < len(names):
            raise InputError('a feature name occurs twice')
        if len(self.symbols) < 2:
            raise InputError(f'the things must be of at least two symbols, not of {list(self.symbols)}')
        finite = np.isfinite(self.features)
        if not finite.all():
            row, column = np.argwhere(~finite)[0]
            raise InputError(f'feature {names[column]} of thing {row} is not finite ({self.features[row, column]})')

    def __len__(self) -> int:
        return len(self.labels)

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """Symbols of the things, sorted."""
        return tuple(sorted(set(self.labels) - {NO_SYMBOL}))

    @cached_property
    def groups(self) -> tuple[str, ...]:
        """Groups of the features, in the order of the features."""
        return tuple(dict.fromkeys(map(group_of, self.feature_names)))


@dataclass(frozen=True, eq=False)
class PoolWorld:
    """World of a pool: part of its things are held out, the others lie on the table, so many at a time.

    At each change all things leave, and others come, with new ids. A thing comes back when all others have been there.
    The number of the split decides which things are held out, and which lie together. `spec` and `task` are what
    `run_episode` and `episode_settings` ask for.

    Attributes:
        pool: the things.
        split: number of the split, which is also the seed of an episode in this world.
        in_view: things on the table at a time.
        change_interval: turns from one change to the next.
        test_share: share of the things that is held out.
        relevant_groups: groups that the teacher calls relevant; all of the pool if none are given.
        name: name of the task.
        costs: of each kind of query.

    Raises:
        InputError: a number out of its range, an unknown group, too few things for a table, or nothing of a symbol
            held out.
    """

    pool: Pool
    split: int
    in_view: int = 20
    change_interval: int = 10
    test_share: float = 0.5
    relevant_groups: tuple[str, ...] = ()
    name: str = 'pool'
    costs: Costs = field(default_factory=Costs)
    _scenes: dict[int, Scene] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        groups = listed(self.relevant_groups)
        unknown = (
            [self.relevant_groups] if groups is None else [each for each in groups if each not in self.pool.groups]
        )
        if unknown:
            raise InputError(f'unknown feature group {unknown[0]!r}; known: {", ".join(self.pool.groups)}')
        object.__setattr__(self, 'relevant_groups', groups or self.pool.groups)
        for name, least in (('split', 0), ('in_view', 1), ('change_interval', 1)):
            number = getattr(self, name)
            if not isinstance(number, int | np.integer) or number < least:
                raise InputError(f'{name} must be a whole number of {least} or more, not {number!r}')
        if not (isinstance(self.test_share, int | float) and 0 < self.test_share < 1):
            raise InputError(f'test_share must be a number between 0 and 1, not {self.test_share!r}')
        if len(self._training) < self.in_view:
            raise InputError(f'{len(self._training)} things are not held out, too few for {self.in_view} on a table')
        if not self.test_set[1]:
            raise InputError('nothing of a symbol is held out')

    @cached_property
    def task(self) -> Task:
        """Task to learn the symbols of the pool."""
        return Task(
            name=self.name,
            description=f'{len(self.pool)} things from arrays',
            source='arrays',
            symbols=self.pool.symbols,
            relevant_groups=self.relevant_groups,
            episode=EpisodeDefaults(costs=self.costs),
            scenes=SceneParameters(objects=self.in_view, change_interval=self.change_interval),
            appearance=AppearanceParameters(),
            camera=CameraParameters(),
            sensors=SensorParameters(),
            dataset=None,
        )

    @property
    def spec(self) -> WorldSpec:
        """Specification for those who ask for one beside the world; it cannot be opened, since it holds no arrays."""
        return WorldSpec(self.task, self.split, self.split)

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn (1-based); the same object as long as nothing changes.

        Raises:
            InputError: a turn below 1.
        """
        number = self._number(turn)
        if number not in self._scenes:
            rows = self._rows(number)
            positions = np.zeros((len(rows), 3), dtype=np.float32)
            ids = tuple(self._ids(number))
            self._scenes[number] = Scene(ids, positions, self.pool.features[rows], self.pool.feature_names)
        return self._scenes[number]

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return symbol, or 'none', by object id: for the scripted teacher only.

        Raises:
            InputError: a turn below 1.
        """
        number = self._number(turn)
        labels = [self.pool.labels[row] for row in self._rows(number)]
        return dict(zip(self._ids(number), labels, strict=True))

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns up to `turns` that begin with a scene change; the first turn is not one."""
        return list(range(1 + self.change_interval, turns + 1, self.change_interval))

    @cached_property
    def test_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Features of the held-out things of a symbol, (k, m), and their k symbols."""
        rows = [int(row) for row in self._order[: self._held_out] if self.pool.labels[row] != NO_SYMBOL]
        return self.pool.features[rows], tuple(self.pool.labels[row] for row in rows)

    @property
    def validation_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Second draw of held-out things, which this world does not have.

        Raises:
            InputError: always.
        """
        raise InputError(f'task {self.name} has no second draw of held-out things')

    def report(self) -> str:
        """Return a text about the number of things."""
        return f'{len(self.pool)} things from arrays, {self._held_out} of them held out'

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        """Rows of the pool in the order of the split: first those that are held out."""
        return random_stream(self.split, 'pool/split').permutation(len(self.pool))

    @property
    def _held_out(self) -> int:
        return int(len(self.pool) * self.test_share)

    @property
    def _training(self) -> NDArray[np.intp]:
        return self._order[self._held_out :]

    def _number(self, turn: int) -> int:
        """Return the number of the scene of a turn, from 0."""
        if turn < 1:
            raise InputError(f'turn must be 1 or more, not {turn}')
        return (turn - 1) // self.change_interval

    def _ids(self, number: int) -> range:
        return range(number * self.in_view, (number + 1) * self.in_view)

    def _rows(self, number: int) -> NDArray[np.intp]:
        """Return the rows of the pool that lie on the table in the scene of a number."""
        round_number, place = divmod(number, len(self._training) // self.in_view)
        order = random_stream(self.split, f'pool/round {round_number}').permutation(self._training)
        return np.asarray(order[place * self.in_view : (place + 1) * self.in_view])


def _table(values: ArrayLike) -> NDArray[np.float32]:
    try:
        with np.errstate(over='ignore'):
            table = np.array(values, dtype=np.float32)
    except (TypeError, ValueError):
        raise InputError('features must be rows of numbers, all of the same length') from None
    if table.ndim != 2 or 0 in table.shape:
        raise InputError(f'features must be a table of things by features, not of shape {table.shape}')
    return table


def _labels(values: Iterable[object]) -> tuple[str, ...]:
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise InputError(f'labels must be a list of names, not {values!r}')
    return tuple(map(_label, values))


def _numbered(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names, of which those that occur several times have a number."""
    before: Counter[str] = Counter()
    found = []
    for name in names:
        found.append(f'{name}_{before[name]}' if names.count(name) > 1 else name)
        before[name] += 1
    return tuple(found)


def _label(value: object) -> str:
    if isinstance(value, str):
        return str(value)
    try:
        return str(operator.index(value))  # type: ignore[arg-type]
    except TypeError:
        raise InputError(f'a label must be a name or a whole number, not {value!r}') from None
