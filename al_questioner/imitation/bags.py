"""Demonstrations from bags."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

from al_questioner.bags import BagError, LeftOut, RecordedEpisode, RecordedTurn, read_episodes
from al_questioner.bags.rerun import decisions_anew
from al_questioner.domain import DECISION_FEATURES, InputError
from al_questioner.imitation.demonstration import Demonstration, UnknownWorld, steps_of
from al_questioner.messages.documents import Document
from al_questioner.questioning import FEATURE_SETS, FeatureSet
from al_questioner.simulation import WorldSpec, load_task


def read_demonstrations(
    paths: Sequence[Path],
    feature_set: FeatureSet = FEATURE_SETS['dt_task_env'],
    left_out: list[str] | None = None,
) -> list[Demonstration]:
    """The demonstrations of several bags, in the order given; a bag may hold several episodes.

    Args:
        paths: of the bags.
        feature_set: whose weights are to be learnt.
        left_out: takes what of the bags cannot be used, beside what can; if not given, all must be.

    Raises:
        InputError: a bag that is none, broken, of something else, or whose decisions hold nothing to learn from; or an
            episode that is in them twice.
    """
    named: list[tuple[str, RecordedEpisode]] = []
    for path in paths:
        missing: list[LeftOut] = []
        sessions = read_episodes(path, None if left_out is None else missing)
        if left_out is not None:
            left_out += [f'{path}: {what} is left out: {reason}' for what, reason in missing]
        for number, session in enumerate(sessions, 1):
            named.append((path.name if len(sessions) == 1 else f'{path.name} ({number})', session))
    for (name, one), (other_name, other) in combinations(named, 2):
        if is_same_episode(one, other):
            raise InputError(f'{other_name} holds the same episode as {name}: leave one of them out')
    return [demonstration_of(session, name, feature_set) for name, session in named]


def is_same_episode(one: RecordedEpisode, other: RecordedEpisode) -> bool:
    """Whether two recordings show the same, turn for turn, whatever their files, topics and times are.

    Of the same `episode_id` one may have ended earlier than the other.
    """
    if one.settings != other.settings or (len(one.turns) != len(other.turns) and one.episode_id != other.episode_id):
        return False
    return all(_shown(ours) == _shown(theirs) for ours, theirs in zip(one.turns, other.turns, strict=False))


def _shown(turn: RecordedTurn) -> tuple[object, ...]:
    chosen = turn.decision.candidates[turn.decision.chosen]
    return turn.scene.object_ids, turn.scene.features.tobytes(), chosen, turn.record


def demonstration_of(
    session: RecordedEpisode, name: str, feature_set: FeatureSet = FEATURE_SETS['dt_task_env']
) -> Demonstration:
    """What a recorded episode shows of its questioner.

    Raises:
        BagError: its decisions hold no decision features, or chose what was not considered.
    """
    try:
        # A bag holds the decision features; all others are those of what the learner knew at the time.
        as_recorded = feature_set.names == DECISION_FEATURES
        decisions = [turn.decision for turn in session.turns] if as_recorded else decisions_anew(session, feature_set)
        steps = steps_of(decisions)
    except InputError as error:
        raise BagError(f'{session.source}: strategy {session.settings.strategy}: {error}') from error
    return Demonstration(
        name=name,
        settings=session.settings,
        world=None if session.world is None else _world(session.world, session.settings.symbols),
        turns=len(session.turns),
        steps=steps,
        feature_names=session.feature_names,
        queries=session.records,
        change_turns=session.change_turns,
        view_tolerance=session.view_tolerance,
        feature_set=feature_set,
    )


def _world(members: Document, symbols: tuple[str, ...]) -> WorldSpec | UnknownWorld:
    """The simulated world, or why it is none: the document holds the name of a task alone, not the user's own file."""
    name = members['task']
    try:
        dataset = Path(members['dataset']) if members['dataset'] else None
        choice = WorldSpec(load_task(name), members['seed'], members['sample'], dataset)
    except InputError as error:
        return UnknownWorld(name, str(error))
    if choice.task.symbols != symbols:
        return UnknownWorld(name, f'the task {name} that is known here has other symbols')
    return choice
