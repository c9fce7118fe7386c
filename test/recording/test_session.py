"""Episodes in bags: whole ones as they were lived, and each way of not being one."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from al_questioner.imitation.bags import read_demonstrations
from al_questioner.recording import BagError, BagWriter, read_bag, read_sessions, repair
from al_questioner.recording.bags import typestore
from al_questioner.rerun import first_divergence


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_session_is_what_was_lived(bags, tmp_path, storage):
    """The expert's scenes, choices and answers would be others than those learnt from."""
    lived = bags.write_episode(tmp_path / 'b', storage)
    (session,) = read_sessions(tmp_path / 'b')
    assert session.settings == lived.settings
    assert session.world['task'] == 'prepare_lunch'
    assert session.change_turns == (5,) or session.change_turns == ()
    assert [turn.record for turn in session.turns if turn.record] == list(lived.episode.records)
    for turn in session.turns:
        np.testing.assert_array_equal(turn.scene.features, lived.world.scene(turn.turn).features)
    assert first_divergence(session) is None


def test_another_learner_diverges_and_the_turn_is_named(bags, tmp_path):
    """A check that finds nothing would be worth nothing."""
    bags.write_episode(tmp_path / 'b', strategy='random_fsq')
    (session,) = read_sessions(tmp_path / 'b')
    assert first_divergence(session) is None
    other = first_divergence(dataclasses.replace(session, seed=session.seed + 1))
    assert other is not None
    assert other.turn >= 2
    assert 'was recorded' in other.what
    changed = dataclasses.replace(session, settings=dataclasses.replace(session.settings, strategy='farthest_fsq'))
    assert first_divergence(changed) is not None


@pytest.mark.parametrize(('change', 'found'), [(1e-6, 'the features differ by up to 1e-06'), (1e-11, None)])
def test_features_of_another_look_are_a_divergence_and_rounding_is_none(bags, tmp_path, change, found):
    """The same choice for other reasons is not the same decision; but processors differ in their last digits."""
    bags.write_episode(tmp_path / 'b')
    (session,) = read_sessions(tmp_path / 'b')
    first = session.turns[0]
    decision = dataclasses.replace(first.decision, features=first.decision.features + change)
    turns = (dataclasses.replace(first, decision=decision), *session.turns[1:])
    divergence = first_divergence(dataclasses.replace(session, turns=turns))
    assert (divergence and divergence.turn) == (found and 1)
    assert (divergence and divergence.what) == found


@pytest.mark.parametrize('accepted', [True, False])
def test_without_a_turns_state_nobody_knows_since_when_an_answer_is_corrected(bags, tmp_path, accepted):
    """A decision would be replayed with what was not known then."""

    def then(writing, _):
        stamp = bags.START + 2 * 10**9
        answer = {'query_id': 'q1', 'answer_id': 'a2', 'teacher_id': 'anna', 'outcome': 'answered', 'content': 'snack'}
        writing.send('answer', typestore().types[bags.STRING]('{"no": "answer"'), stamp + 1)
        writing.say('answer', answer | {'replaces': 'a1'}, stamp + 2)
        ack = {'query_id': 'q1', 'answer_id': 'a2', 'accepted': accepted, 'reason': ''}
        writing.say('answer_ack', ack, stamp + 3)

    bags.write_episode(tmp_path / 'b', missing=[('learner_state', 4)], then=then)
    if accepted:
        with pytest.raises(BagError, match='b: turn 4 was recorded without its learner_state'):
            read_sessions(tmp_path / 'b')
    else:
        assert len(read_sessions(tmp_path / 'b')) == 1


def test_an_episode_without_a_whole_turn_is_told_of_beside_others(bags, tmp_path):
    """What was recorded before it would be as good as lost; or its loss go unnoticed."""

    def then(writing, episode):
        stamp = bags.START + 2 * 10**9
        told = {'sec': stamp // 10**9, 'nanosec': 0}
        writing.say('turn', {'turn': 1, 'stamp': told, 'world': episode['world']}, stamp, 'e2')
        writing.say('episode', episode, stamp + 1, 'e2')

    bags.write_episode(tmp_path / 'b', then=then)
    with pytest.raises(BagError, match='ended before the first turn of episode e2'):
        read_sessions(tmp_path / 'b')
    too_short: list[str] = []
    (session,) = read_sessions(tmp_path / 'b', too_short)
    assert (session.episode_id, too_short) == ('e1', ['e2'])


def test_an_unfinished_recording_counts_as_far_as_it_goes(bags, tmp_path):
    """A killed recording of a person's half hour would be lost; repaired, it trains."""
    bags.write_episode(tmp_path / 'b', close=False)
    with pytest.raises(BagError, match='record --repair'):
        read_sessions(tmp_path / 'b')
    repair(tmp_path / 'b')
    (demonstration,) = read_demonstrations([tmp_path / 'b'])
    assert len(demonstration.steps) == 8


@pytest.mark.parametrize(
    ('missing', 'reason'),
    [
        ([('turn', 3)], 'turn 3 of 8 was not recorded'),
        (
            [('decision', 4)],
            'turn 4 of 8 was recorded without its decision; if the learner kept a session, `session DIR',
        ),
        ([('objects', 8)], 'turn 8 of 8 was recorded without its objects'),
        ([('objects', 4)], 'turn 4 of 8 was recorded without its objects'),
        ([('episode', 1)], 'no episode was recorded'),
        ([('learner_state', turn) for turn in range(1, 9)], 'ended before the first turn'),
    ],
)
def test_what_is_missing_is_named(bags, tmp_path, missing, reason):
    """An episode with holes would be learnt from as if the expert had done nothing."""
    bags.write_episode(tmp_path / 'b', missing=missing)
    with pytest.raises(BagError, match=reason):
        read_sessions(tmp_path / 'b')


def test_other_message_types_are_named(bags, tmp_path):
    """A bag of another program with topics of the same name."""
    writing = bags.Writing(tmp_path / 'b', types={**bags.TYPES, 'turn': 'sensor_msgs/msg/PointCloud2'})
    writing.say('episode', {}, bags.START)
    writing.bag.close()
    with pytest.raises(BagError, match=r'topic /robot/turn holds sensor_msgs/msg/PointCloud2, expected std_msgs'):
        read_sessions(tmp_path / 'b')


def test_documents_that_are_none_are_named(bags, tmp_path):
    """A bag of another version, or of nobody's."""
    writing = bags.Writing(tmp_path / 'b')
    writing.say('episode', {'symbols': ['a', 'b']}, bags.START)
    writing.bag.close()
    with pytest.raises(BagError, match=r'/robot/episode: .*is a required property'):
        read_sessions(tmp_path / 'b')


def test_objects_with_other_features_than_announced_are_named(bags, tmp_path, monkeypatch):
    """The decision would belong to another scene."""
    original = bags.Writing.say

    def renamed(self, name, members, stamp, episode_id='e1'):
        if name == 'episode':
            members = {**members, 'feature_names': members['feature_names'][:-1]}
        original(self, name, members, stamp, episode_id)

    monkeypatch.setattr(bags.Writing, 'say', renamed)
    bags.write_episode(tmp_path / 'b')
    with pytest.raises(BagError, match='the objects of turn 1 have other features than the episode announces'):
        read_sessions(tmp_path / 'b')


def test_decisions_without_features_cannot_be_learnt_from(bags, tmp_path):
    """A control weighs nothing: its bag is no demonstration for the decision features."""
    bags.write_episode(tmp_path / 'b', strategy='random_fsq')
    with pytest.raises(BagError, match='strategy random_fsq: turn 1: the decision carries no decision features'):
        read_demonstrations([tmp_path / 'b'])


def test_what_latched_topics_tell_of_an_earlier_episode_is_left_out(tmp_path):
    """A learner that is done and still up would make the bag of the next episode unreadable."""
    shipped = Path(__file__).resolve().parents[2] / 'bags'
    old, new = (read_bag(shipped / name) for name in ('expert_0', 'expert_1'))
    topics = [dataclasses.replace(topic, name=f'/r/{last_part(topic.name)}') for topic in new.topics]
    left_over = [
        next(m for m in reversed(old.messages) if last_part(m.topic) == name)
        for name in ('turn', 'episode', 'learner_state')
    ]
    with BagWriter(tmp_path / 'b', topics) as bag:
        for message in (*left_over, *new.messages):
            bag.write(f'/r/{last_part(message.topic)}', message.data, message.stamp)
    (session,) = read_sessions(tmp_path / 'b')
    assert session.seed == 1
    assert len(session.turns) == 30


def last_part(topic):
    return topic.rsplit('/', 1)[-1]
