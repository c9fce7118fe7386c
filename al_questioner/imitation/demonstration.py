"""Demonstrations of an expert questioner: the candidates of each turn, and the one that was chosen."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from al_questioner.domain import (
    AUTO,
    Action,
    Decision,
    EpisodeSettings,
    InputError,
    QueryKind,
    QueryRecord,
    ViewTolerance,
)
from al_questioner.questioning import FEATURE_SETS, FeatureSet
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec
from al_questioner.support.arrays import Array


@dataclass(frozen=True, eq=False)
class Step:
    """One decision.

    Attributes:
        actions: the C candidates that were considered.
        features: (C, F) their features, in the order of the demonstration's feature set.
        chosen: index of the one that was chosen.
    """

    turn: int
    actions: tuple[Action, ...]
    features: Array
    chosen: int

    @property
    def kind(self) -> QueryKind:
        """Kind of what was chosen."""
        return self.actions[self.chosen].kind

    @property
    def contrasts(self) -> Array:
        """Features of each candidate less those of the chosen one, (C, F)."""
        difference: Array = self.features - self.features[self.chosen]
        return difference


@dataclass(frozen=True)
class UnknownWorld:
    """A world that cannot be played in here: its task as the demonstration names it, and why not, in one line."""

    task_name: str
    reason: str


@dataclass(frozen=True, eq=False)
class Demonstration:
    """One episode of an expert questioner, or as much of it as there is.

    Attributes:
        name: where it comes from, for people.
        settings: of the episode; the classifiers need not be those that the expert had, see `bags`.
        world: the simulated world it took place in; what is known of it if it cannot be played in; None if it was
            another one.
        turns: number of turns that were recorded.
        steps: one per turn in which there was something to choose.
        feature_names: of the objects.
        change_turns: turns that began with a scene change.
        view_tolerance: of the learner, see `questioning.Episode`.
        feature_set: whose weights are to be learnt.
    """

    name: str
    settings: EpisodeSettings
    world: WorldSpec | UnknownWorld | None
    turns: int
    steps: tuple[Step, ...]
    feature_names: tuple[str, ...] = ()
    queries: tuple[QueryRecord, ...] = ()
    change_turns: tuple[int, ...] = ()
    view_tolerance: ViewTolerance = AUTO
    feature_set: FeatureSet = FEATURE_SETS['dt_task_env']

    @property
    def task_name(self) -> str:
        """Name of the world's task; 'another world' if it has none."""
        if self.world is None:
            return 'another world'
        return self.world.task_name if isinstance(self.world, UnknownWorld) else self.world.task.name

    @property
    def world_spec(self) -> WorldSpec:
        """Specification of the simulated world that it took place in.

        Raises:
            InputError: it cannot be played in.
        """
        if isinstance(self.world, WorldSpec):
            return self.world
        raise self._unplayable('' if self.world is None else self.world.reason)

    def open_world(self) -> PerceivedWorld:
        """Open the simulated world, to play in.

        Raises:
            InputError: there is none, it cannot be opened, or things look otherwise in it than they were recorded.
        """
        world = PerceivedWorld(self.world_spec.open())
        if self.feature_names and world.scene(1).feature_names != self.feature_names:
            raise self._unplayable(f'its objects have other features than those of {self.task_name}')
        return world

    def _unplayable(self, reason: str) -> InputError:
        why = f' ({reason})' if reason else ''
        return InputError(f'{self.name}: no simulated world to roll out in{why}')

    @cached_property
    def feature_counts(self) -> Array:
        """Features of the chosen candidates, (F,), mean over the turns: phi_E of equation 6."""
        return np.asarray(np.mean([step.features[step.chosen] for step in self.steps], axis=0))


def steps_of(decisions: Iterable[Decision], passed_over: Collection[QueryKind] = ()) -> tuple[Step, ...]:
    """Return the steps of a questioner from its decisions, without the turns in which nothing could be chosen.

    A strategy that passes over a kind of query can learn nothing from a choice of one, nor from its being there.

    Raises:
        InputError: see `step_of`; or there was nothing to choose in any turn.
    """
    chosen = (decision for decision in decisions if decision.candidates[decision.chosen].kind not in passed_over)
    found = tuple(step_of(decision, passed_over) for decision in chosen if not _is_forced(decision))
    if not found:
        raise InputError('in no turn was there anything to choose')
    return found


def _is_forced(decision: Decision) -> bool:
    """Return whether only asking nothing was considered, and nothing weighed."""
    considered = np.flatnonzero(~np.isnan(decision.utilities))
    return considered.tolist() == [len(decision.candidates) - 1] and bool(np.isnan(decision.features).all())


def step_of(decision: Decision, passed_over: Collection[QueryKind] = ()) -> Step:
    """Return the step of a questioner from its decision, without the kinds of queries that are passed over.

    Raises:
        InputError: it carries no decision features, or chose what it did not consider.
    """
    is_known = np.array([action.kind not in passed_over for action in decision.candidates])
    considered = np.flatnonzero(~np.isnan(decision.utilities) & is_known)
    chosen = np.flatnonzero(considered == decision.chosen)
    if len(chosen) != 1:
        raise InputError(f'turn {decision.turn}: the chosen candidate is marked as not considered')
    features = decision.features[considered]
    if not np.isfinite(features).all():
        raise InputError(
            f'turn {decision.turn}: the decision carries no decision features to learn from;'
            ' record a learner with strategy:=human or strategy:=expert, or train with --strategy value_per_cost'
        )
    actions = tuple(decision.candidates[row] for row in considered)
    return Step(decision.turn, actions, features, int(chosen[0]))


def teacher_of(world_spec: WorldSpec) -> ScriptedTeacher:
    """Make the teacher of rollouts: as in the demonstrations that ship, it shows things that are known already."""
    return ScriptedTeacher(world_spec.task.symbols, world_spec.task.relevant_groups, world_spec.seed, repeat_shown=True)


def all_steps(demonstrations: Sequence[Demonstration]) -> Iterator[Step]:
    """Return the steps of several demonstrations."""
    for demonstration in demonstrations:
        yield from demonstration.steps


def feature_scale(demonstrations: Sequence[Demonstration]) -> Array:
    """Return the (F,) standard deviations of the features around their mean over the candidates of a step.

    A feature that is the same for all candidates of every step has scale 0: no choice depends on it.
    """
    deviations = [step.features - step.features.mean(axis=0) for step in all_steps(demonstrations)]
    scale = np.sqrt(np.mean(np.concatenate(deviations) ** 2, axis=0))
    return np.where(scale > 1e-9, scale, 0.0)
