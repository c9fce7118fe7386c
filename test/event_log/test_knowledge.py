"""Sessions that begin with what an earlier one taught, and what they leave."""

from __future__ import annotations

import contextlib
import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from al_questioner.bags import read_episodes
from al_questioner.cli import main
from al_questioner.domain import NO_SYMBOL, Action, InputError, Knowledge, QueryKind, Scene
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import SessionLogError, read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.summary import summarise_session
from al_questioner.imitation.bags import decisions_anew, read_demonstrations
from al_questioner.messages.concepts_file import concepts_of_text, read_concepts
from al_questioner.messages.concepts_text import concepts_text, fingerprint
from al_questioner.messages.knowledge_members import knowledge_members
from al_questioner.questioning import FEATURE_SETS, TurnContext
from al_questioner.questioning.review import taught_learner
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings
from shared.durable_sessions import (
    TASK,
    WITH_RELEVANCE,
    WORLD,
    ask_what_matters,
    durable_of,
    episode_started,
    play_turns,
    start_durable,
)


@pytest.fixture(scope='module')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


@pytest.fixture(scope='module')
def other_world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 5, 5).open())


def going_on(known, budget=3.0, episode_id='e2', strategy='farthest_fsq'):
    settings = dataclasses.replace(episode_settings(TASK, strategy, budget, 6), concepts=known)
    return {'settings': settings, 'episode_id': episode_id, 'world': {**WORLD, 'seed': 5, 'sample': 5}}


def test_a_session_leaves_what_it_taught(tmp_path: Path, world: PerceivedWorld) -> None:
    """The file of the command is another one than that of the learner."""
    durable = start_durable(tmp_path / 's')
    play_turns(durable, world, 4)
    durable.close()
    assert main(['session', str(tmp_path / 's'), '--concepts', str(tmp_path / 'c.json')]) == 0
    assert (tmp_path / 'c.json').read_text() == concepts_text(durable.knowledge())
    found = read_concepts(tmp_path / 'c.json')
    assert found == durable.knowledge()
    assert found.lessons[0].stamp == 1000
    assert (found.origins[0].episode, found.origins[0].world) == ('e1', {**(episode_started().world or {})})


def test_a_session_goes_on_tomorrow_and_is_resumed(
    tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld
) -> None:
    """A learner that was killed on the second day forgets the first."""
    first = start_durable(None)
    play_turns(first, world, 6)
    known = first.knowledge()
    second = start_durable(tmp_path / 's', **going_on(known))
    play_turns(second, other_world, 3)
    second.close()

    # The file is gone by now.
    resumed = start_durable(tmp_path / 's', **going_on(None))
    assert resumed.started.settings.concepts == known
    play_turns(resumed, other_world, 3)
    resumed.close()
    events, fault = decoded(read_log(tmp_path / 's'))
    assert fault is None
    begun = events[0]
    assert isinstance(begun, EpisodeStarted)
    assert first_divergence(begun, events[1:]) is None
    summary = summarise_session(tmp_path / 's', read_log(tmp_path / 's'))
    assert summary.knowledge == resumed.knowledge()
    assert summary.knowledge.lessons[: len(known.lessons)] == known.lessons


class Elsewhere:
    """A world whose things have ids that those of another one have not."""

    def __init__(self, world: PerceivedWorld, later_by: int) -> None:
        self.world, self.later_by = world, later_by

    def scene(self, turn: int) -> Scene:
        scene = self.world.scene(turn - self.later_by)
        return dataclasses.replace(scene, object_ids=tuple(1000 + each for each in scene.object_ids))

    def truth(self, turn: int) -> dict[int, str]:
        return {1000 + each: symbol for each, symbol in self.world.truth(turn - self.later_by).items()}


def kept(folder: Path) -> Knowledge:
    """Read what the command writes of a session."""
    assert main(['session', str(folder), '--concepts', str(folder / 'kept.json')]) == 0
    return read_concepts(folder / 'kept.json')


def test_two_session_logs_are_as_one(tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld) -> None:
    """A robot that is switched off overnight believes other last digits than one that is not."""
    human = {'settings': dataclasses.replace(WITH_RELEVANCE, budget=40.0)}
    with contextlib.closing(start_durable(tmp_path / '1', ask_what_matters, **human)) as first:
        play_turns(first, world, 6)
    monday = kept(tmp_path / '1')
    later = {'settings': dataclasses.replace(human['settings'], concepts=monday), 'episode_id': 'e2'}
    with contextlib.closing(start_durable(tmp_path / '2', ask_what_matters, **later)) as second:
        play_turns(second, Elsewhere(other_world, 0), 6)
    tuesday = kept(tmp_path / '2')

    records = [record for each in (first, second) for record in each.episode.records]
    actions = [Action(record.kind, record.object_id) for record in records]
    assert {action.kind for action in actions} == {QueryKind.RELEVANCE, QueryKind.LABEL}

    def ask_as_before(context: TurnContext) -> int:
        return context.candidates.index(actions[context.turn - 1])

    both = {'settings': dataclasses.replace(human['settings'], budget=80.0, turns=12)}
    # Between the days the learner ends, and goes on with its log.
    for world_of_day in (world, Elsewhere(other_world, 6)):
        with contextlib.closing(start_durable(tmp_path / '3', ask_as_before, **both)) as whole:
            play_turns(whole, world_of_day, 6)
    as_one = kept(tmp_path / '3')

    assert [lesson.seen for lesson in tuesday.lessons] == [lesson.seen for lesson in as_one.lessons]
    assert [label for _, label in tuesday.examples] == [label for _, label in as_one.examples]
    assert tuesday.statistics == as_one.statistics
    assert tuesday.reliabilities == as_one.reliabilities
    looks = np.array([view.features for view in as_one.views.values()], dtype=np.float32)
    expected = whole.episode.concepts.predict_proba(looks)
    for learner in (second.episode.concepts, taught_learner(tuesday), taught_learner(as_one)):
        assert np.array_equal(learner.predict_proba(looks), expected)


def test_another_file_is_not_taken_for_the_one_that_was_known(
    tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld
) -> None:
    """A session goes on with other beliefs than it asked with; a file that has grown is the same one."""
    first, other = start_durable(None), start_durable(None, episode_id='e0')
    play_turns(first, world, 6)
    play_turns(other, world, 5)
    second = start_durable(tmp_path / 's', **going_on(first.knowledge()))
    play_turns(second, other_world, 2)
    second.close()
    grown = second.knowledge()
    start_durable(tmp_path / 's', **going_on(grown)).close()
    named_otherwise = tuple(
        dataclasses.replace(lesson, labels=tuple(dataclasses.replace(each, label=NO_SYMBOL) for each in lesson.labels))
        for lesson in grown.lessons
    )
    changed = dataclasses.replace(grown, lessons=named_otherwise)
    for file in (other.knowledge(), changed):
        with pytest.raises(SessionLogError, match='began with other concepts'):
            start_durable(tmp_path / 's', **going_on(file))


def test_the_selection_of_features_is_kept(world: PerceivedWorld) -> None:
    """The beliefs of one who learns from the file would follow from features that the learner had ruled out."""
    durable = start_durable(None, **going_on(None, strategy='u_sampling'))
    play_turns(durable, world, 6)
    concepts, again = durable.episode.concepts, taught_learner(concepts_of_text(concepts_text(durable.knowledge())))
    assert len(concepts.features_in_use) < len(concepts.feature_names)
    assert again.features_in_use == concepts.features_in_use
    looks = world.scene(1).features
    assert np.array_equal(again.predict_proba(looks), concepts.predict_proba(looks))


def test_old_logs_have_no_concepts(tmp_path: Path, world: PerceivedWorld) -> None:
    """Nothing is to change for those who keep nothing."""
    started = episode_started()
    assert not {'concepts', 'concepts_sha256'} & started.members().keys()
    durable = durable_of(started, None)
    durable.start()
    play_turns(durable, world, 1)
    assert knowledge_members(durable.knowledge())['lessons']


def test_a_bag_holds_what_was_known(tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld) -> None:
    """A recorded episode of the second day cannot be checked, or be learnt from, without the first one's file."""
    first = start_durable(None)
    play_turns(first, world, 6)
    second = start_durable(tmp_path / 's', **going_on(first.knowledge(), strategy='expert'))
    play_turns(second, other_world, 6)
    second.close()
    assert main(['session', str(tmp_path / 's'), '--bag', str(tmp_path / 'bag'), '--json', str(tmp_path / 'j')]) == 0
    (episode,) = read_episodes(tmp_path / 'bag')
    assert episode.started.settings.concepts == first.knowledge()
    assert first_divergence(episode.started, episode.events) is None
    exported = json.loads((tmp_path / 'j').read_text())
    assert exported['concepts_sha256'] == fingerprint(first.knowledge())
    assert exported['accuracy']
    (demonstration,) = read_demonstrations([tmp_path / 'bag'])
    assert demonstration.settings.concepts == first.knowledge()
    again = list(decisions_anew(episode, FEATURE_SETS['dt_task_env']))
    recorded = [turn.decision.features for turn in episode.turns]
    assert len(again) == len(recorded)
    for decision, features in zip(again, recorded, strict=True):
        np.testing.assert_allclose(decision.features, features, rtol=1e-5, atol=1e-5)


def test_an_episode_has_an_id_of_its_own(world: PerceivedWorld) -> None:
    """Lessons of the second day could not be told from those of the first."""
    first = start_durable(None)
    play_turns(first, world, 2)
    with pytest.raises(InputError, match="an episode 'e1' already"):
        start_durable(None, **going_on(first.knowledge(), episode_id='e1'))
