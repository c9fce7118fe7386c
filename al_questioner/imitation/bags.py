"""Demonstrations from bags."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain import DECISION_FEATURES, InputError
from al_questioner.imitation.demonstration import Demonstration, steps_of
from al_questioner.messages.documents import Document
from al_questioner.questioning import FEATURE_SETS, FeatureSet
from al_questioner.recording import BagError, Session, read_sessions
from al_questioner.rerun import decisions_anew
from al_questioner.simulation import WorldChoice
from al_questioner.world import load_task


def read_demonstrations(
    paths: Sequence[Path], feature_set: FeatureSet = FEATURE_SETS['dt_task_env']
) -> list[Demonstration]:
    """The demonstrations of several bags, in the order given; a bag may hold several episodes.

    Args:
        paths: of the bags.
        feature_set: whose weights are to be learnt.

    Raises:
        InputError: a bag that is none, broken, of something else, or whose decisions hold nothing to learn from.
    """
    found: list[Demonstration] = []
    for path in paths:
        sessions = read_sessions(path)
        for number, session in enumerate(sessions, 1):
            name = path.name if len(sessions) == 1 else f'{path.name} ({number})'
            found.append(demonstration_of(session, name, feature_set))
    return found


def demonstration_of(
    session: Session, name: str, feature_set: FeatureSet = FEATURE_SETS['dt_task_env']
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
        world=None if session.world is None else _world(session.source, session.world),
        turns=len(session.turns),
        steps=steps,
        feature_names=session.feature_names,
        queries=session.records,
        change_turns=session.change_turns,
        view_tolerance=session.view_tolerance,
        feature_set=feature_set,
    )


def _world(source: Path, members: Document) -> WorldChoice:
    try:
        task = load_task(members['task'])
    except InputError as error:
        raise BagError(f'{source}: {error}') from error
    dataset = Path(members['dataset']) if members['dataset'] else None
    return WorldChoice(task, members['seed'], members['sample'], dataset)
