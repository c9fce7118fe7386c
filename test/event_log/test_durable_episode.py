"""A session that goes on after whatever happened: nothing is lost, nothing counts twice, and the same is asked."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from al_questioner.domain import Answer, AnswerError, Outcome, QueryKind
from al_questioner.event_log.encoding import Encoder
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    InputRejected,
    LateAnswerKept,
    SceneObserved,
)
from al_questioner.event_log.log import LogWriteError, SessionLog, SessionLogError
from al_questioner.event_log.replay import replay_of
from al_questioner.questioning import Receipt, TurnContext
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.checkout import ROOT
from shared.durable_sessions import (
    TASK,
    WITH_RELEVANCE,
    WORLD,
    Start,
    answer,
    ask,
    ask_what_matters,
    durable_of,
    episode_started,
    events,
    play_turns,
    start_durable,
)


def drive(*arguments: object) -> dict[str, object]:
    command = [sys.executable, '-m', 'shared.session_driver', *map(str, arguments)]
    environment = {**os.environ, 'PYTHONPATH': str(ROOT / 'test')}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=280, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow
def test_killed_at_every_write_point(tmp_path: Path) -> None:
    """An acknowledged answer is not lost or counted twice, and the next question stays the same."""
    result = drive('points', tmp_path)
    assert result['problems'] == []
    assert result['kills'] > 70
    kinds = {'answer', 'correction', 'late', 'passed', 'decision', 'scene', 'episode'}
    assert kinds == set(result['kinds'])


@pytest.mark.slow
def test_killed_while_it_is_asked_what_matters(tmp_path: Path) -> None:
    """The same with answers about many things, and one that was taken back."""
    result = drive('relevance', tmp_path)
    assert result['problems'] == []
    assert result['kills'] > 60


def test_what_matters_is_known_after_resuming(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise the robot would pay for the same question again, and believe other things than before."""
    settings, durable = WITH_RELEVANCE, None
    oracle = start_durable(None, ask_what_matters, settings=settings)
    for turn in range(1, settings.turns + 1):
        # Another learner for each turn, and for its answer, which the first one hears twice.
        durable = start(ask_what_matters, settings=settings)
        ask(durable, world)
        durable = start(ask_what_matters, settings=settings)
        if durable.episode.pending is not None:
            said = answer(durable, world)
            durable.take(said)
            assert durable.take(said).receipt is Receipt.DUPLICATE
        play_turns(oracle, world, 1)
        if turn == 3:
            for each in (durable, oracle):
                query = next(iter(each.episode._queries.by_id.values()))
                first = next(iter(each.episode.answers.standing())).answer_id
                undo = Answer(query.query_id, 'c1', 'anna', Outcome.ANSWERED, (4, 2), replaces=first)
                assert each.take(undo).receipt is Receipt.ACCEPTED
    assert durable is not None
    kinds = [record.kind for record in durable.episode.records]
    assert kinds.count(QueryKind.RELEVANCE) == 1
    assert durable.episode.records[0].objects == (4, 2)
    ours, theirs = (start(ask_what_matters, settings=settings).episode, oracle.episode)
    for name in ('turn', 'spent', 'pending', 'records', 'positives'):
        assert getattr(ours, name) == getattr(theirs, name), name
    scene = world.scene(1)
    for name in ('matters', 'distances_to_mattering', 'labels_of'):
        mine, other = (getattr(each.concepts, name)(scene) for each in (ours, theirs))
        np.testing.assert_array_equal(mine, other)
    np.testing.assert_array_equal(
        ours.concepts.predict_proba(scene.features), theirs.concepts.predict_proba(scene.features)
    )
    assert ours._rng.bit_generator.state == theirs._rng.bit_generator.state
    oracle.close()


@pytest.mark.slow
def test_killed_at_random_moments(tmp_path: Path) -> None:
    """No answer is lost at a moment that no list of write points foresees."""
    result = drive('random', tmp_path, 200, 1)
    assert result['problems'] == []
    assert result['kills'] >= 200


def test_a_log_that_does_not_tell_what_was_known_is_gone_on_with(
    start: Start, tmp_path: Path, world: PerceivedWorld
) -> None:
    """Otherwise sessions of earlier versions would be lost."""
    durable = start(settings=episode_settings(TASK, 'rarest_demo', 20.0, 8))
    play_turns(durable, world, 5)
    replay, asked = replay_of(durable.started), []
    for event in events(tmp_path)[1:]:
        earlier = event
        if isinstance(event, ActionChosen) and event.query is not None:
            asked.append(event.query)
            earlier = dataclasses.replace(event, query=dataclasses.replace(event.query, known=None))
        replay.play(earlier)
    assert any(query.known for query in asked)
    assert replay.episode.records == durable.episode.records


def test_the_same_state_after_resuming(start: Start, world: PerceivedWorld) -> None:
    """Otherwise the robot would believe other things than before, and so ask others."""
    durable = start()
    play_turns(durable, world, 3)
    ask(durable, world)
    resumed = start()
    ours, theirs = durable.episode, resumed.episode
    for name in ('turn', 'spent', 'pending', 'records'):
        assert getattr(ours, name) == getattr(theirs, name), name
    scene = world.scene(1).features
    np.testing.assert_array_equal(ours.concepts.predict_proba(scene), theirs.concepts.predict_proba(scene))
    assert ours._rng.bit_generator.state == theirs._rng.bit_generator.state
    assert (resumed.observed.turn, resumed.observed.stamp, resumed.observed.frame_id) == (4, 4000, 'table')
    np.testing.assert_array_equal(durable.decision.utilities, resumed.decision.utilities)


def test_an_answer_counts_once(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """A resent answer counts once and is acknowledged again, before and after a crash."""
    durable = start()
    (said, _, _) = play_turns(durable, world, 3)
    for _ in range(2):
        assert durable.take(said).receipt is Receipt.DUPLICATE
        with pytest.raises(AnswerError, match='was taken already'):
            durable.take(dataclasses.replace(said, outcome=Outcome.SKIP, content=None))
        durable = start()
    assert len(durable.episode.records) == 3
    assert sum(isinstance(event, AnswerAccepted) for event in events(tmp_path)) == 3


def test_a_late_answer_is_kept_with_its_own_question(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """The answer is learnt of the thing that the second teacher was asked about."""
    durable = start()
    (first, *_) = play_turns(durable, world, 2)
    pending = ask(durable, world).query
    with pytest.raises(AnswerError, match='a feature subset is some of'):
        durable.take(Answer(first.query_id, 'b0', 'bert', Outcome.ANSWERED, 'snack'))
    late = Answer(first.query_id, 'b1', 'bert', Outcome.ANSWERED, ('size',))
    for _ in range(2):
        assert durable.take(late).receipt is Receipt.LATE
        assert durable.episode.pending is pending
        durable = start()
        pending = durable.episode.pending
    kept = [event for event in events(tmp_path) if isinstance(event, LateAnswerKept)]
    assert kept == [LateAnswerKept(late, f"query 'q1' was answered already, by '{first.answer_id}'")]


def test_a_correction_is_kept_beside_what_it_corrects(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise undo would rewrite the past, or not survive."""
    durable = start()
    said = play_turns(durable, world, 3)
    label = next(a for a in said if isinstance(a.content, str))
    undo = Answer(label.query_id, 'c1', 'scripted', Outcome.UNKNOWN, replaces=label.answer_id)
    assert durable.take(undo).receipt is Receipt.ACCEPTED
    assert durable.take(undo).receipt is Receipt.DUPLICATE
    with pytest.raises(AnswerError, match="no answer 'c9' to query"):
        durable.take(dataclasses.replace(undo, answer_id='c2', replaces='c9'))
    told = [event.answer for event in events(tmp_path) if isinstance(event, AnswerAccepted)]
    assert told == [*said, undo]
    resumed = start()
    assert resumed.episode.records == durable.episode.records
    assert Outcome.UNKNOWN in {record.outcome for record in resumed.episode.records}


def test_refused_texts_are_kept_once(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise nobody could tell why a person's answer had not been taken; or a stuck sender would fill the disk."""
    durable = start()
    for _ in range(3):
        durable.note_rejected('x' * 5000, 'nonsense', 0.0)
    durable.close()
    assert events(tmp_path)[1:] == [InputRejected('x' * 1000, 'nonsense')]
    start()


def test_a_flood_of_refused_texts_is_counted(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """A sender of garbage cannot fill the disk, so that there is room for the answers."""
    durable = start()
    for number in range(1000):
        durable.note_rejected(str(number), 'nonsense', 0.0)
    for number in range(1012):
        durable.note_rejected(f'{number} again', 'nonsense', 61.0)
    durable.close()
    refused = [event for event in events(tmp_path) if isinstance(event, InputRejected)]
    assert [event.text for event in refused[:10]] == list(map(str, range(10)))
    assert refused[10] == InputRejected('', '990 more, too many to keep', 990)
    assert len(refused) == 22
    assert sum(event.count for event in refused) == 2012


def test_of_late_answers_to_one_query_so_many_are_kept(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """The same with answers that come too late."""
    durable = start()
    (first,) = play_turns(durable, world, 1)
    for number in range(120):
        assert durable.take(dataclasses.replace(first, answer_id=f'late {number}')).receipt is Receipt.LATE
    assert sum(isinstance(event, LateAnswerKept) for event in events(tmp_path)) == 100


@pytest.mark.parametrize(
    ('changes', 'difference'),
    [
        ({'seed': 5}, 'seed 4, not 5'),
        ({'view_tolerance': 0.5}, 'view_tolerance 0.001, not 0.5'),
        ({'world': {**WORLD, 'sample': 9}}, 'world.sample 4, not 9'),
        ({'episode_id': 'e2'}, "episode_id 'e1', not 'e2'"),
        ({'settings': dataclasses.replace(episode_started().settings, budget=9.0)}, 'budget 8.0, not 9.0'),
        ({'world': None}, "world.task 'prepare_lunch', not None"),
    ],
)
def test_a_session_of_other_settings_is_refused(tmp_path: Path, changes: dict[str, object], difference: str) -> None:
    """Otherwise two episodes would be mixed."""
    start_durable(tmp_path).close()
    with SessionLog(tmp_path) as log, pytest.raises(SessionLogError, match=difference):
        durable_of(episode_started(**changes), log)
    resumed = start_durable(tmp_path, episode_id='', version='2')
    assert resumed.started == episode_started()
    resumed.close()


def test_a_log_with_a_fixed_view_tolerance_goes_on_with_it_where_none_is_asked_for(tmp_path: Path) -> None:
    """Otherwise sessions that were begun before the tolerance was estimated could not be continued."""
    start_durable(tmp_path, view_tolerance=0.25).close()
    resumed = start_durable(tmp_path, view_tolerance='auto')
    assert resumed.started.view_tolerance == 0.25
    resumed.close()


def test_what_cannot_be_written_is_not_taken(start: Start, world: PerceivedWorld) -> None:
    """Otherwise an answer would be learnt, and acknowledged, that is gone after the next start."""
    durable = start()
    play_turns(durable, world, 2)
    ask(durable, world)
    said = answer(durable, world)
    durable._log._storage._database.execute('PRAGMA query_only=1')
    for _ in range(2):
        with pytest.raises(LogWriteError, match='cannot be written'):
            durable.take(said)
    assert len(durable.episode.records) == 2
    resumed = start()
    assert resumed.take(said).receipt is Receipt.ACCEPTED


def test_without_a_log_answers_count_once_too(world: PerceivedWorld) -> None:
    """Otherwise a learner without a session would have other rules."""
    durable = start_durable(None)
    (said, *_) = play_turns(durable, world, 2)
    assert durable.take(said).receipt is Receipt.DUPLICATE
    assert durable.take(dataclasses.replace(said, answer_id='other')).receipt is Receipt.LATE
    durable.close()


def test_a_scene_without_its_decision_is_passed_over(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise a log that was cut off within a turn could not be continued."""
    durable = start()
    play_turns(durable, world, 1)
    durable.close()
    with SessionLog(tmp_path) as log:
        log.append(Encoder().encode(SceneObserved(2, 2000, 'table', world.scene(2))))
    resumed = start()
    assert resumed.episode.turn == 1
    play_turns(resumed, world, 2)
    again = start()
    assert again.episode.turn == 3


def test_a_persons_choices_are_not_asked_for_again(start: Start, world: PerceivedWorld) -> None:
    """The demonstration of a person who shows how to ask survives a crash."""
    asked = []

    def person(context: TurnContext) -> int:
        asked.append(context.turn)
        return context.turn % len(context.candidates)

    settings = dataclasses.replace(episode_started().settings, strategy='human')
    durable = start(settings=settings, pick=person)
    play_turns(durable, world, 3)
    queries = durable.episode.records
    again = start(settings=settings, pick=person)
    assert asked == [1, 2, 3]
    assert again.episode.records == queries
    play_turns(again, world, 1)
    assert asked == [1, 2, 3, 4]
