"""Episodes in bags: whole ones as they were lived, and each way of not being one."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import yaml

from al_questioner.bags import (
    BagError,
    BagMessage,
    BagWriter,
    LeftOut,
    Topic,
    deserialize,
    read_bag,
    read_episodes,
    repair,
)
from al_questioner.bags.reading import typestore
from al_questioner.bags.topics import CLOUD, STRING
from al_questioner.cli import main
from al_questioner.event_log.events import ActionChosen
from al_questioner.event_log.replay import first_divergence
from al_questioner.imitation.bags import read_demonstrations
from shared.bags import SHIPPED, text


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_an_episode_is_what_was_lived(bags, tmp_path, storage):
    """Otherwise the expert's scenes, choices and answers would be others than those learnt from."""
    lived = bags.write_episode(tmp_path / 'b', storage)
    (episode,) = read_episodes(tmp_path / 'b')
    assert episode.started.settings == lived.settings
    assert episode.started.world['task'] == 'prepare_lunch'
    assert episode.change_turns == (5,) or episode.change_turns == ()
    assert [turn.record for turn in episode.turns if turn.record] == list(lived.episode.records)
    for turn in episode.turns:
        np.testing.assert_array_equal(turn.scene.features, lived.world.scene(turn.turn).features)
    assert first_divergence(episode.started, episode.events) is None


def test_another_learner_diverges_and_the_turn_is_named(bags, tmp_path):
    """The check finds what differs, and does not pass for every learner."""
    bags.write_episode(tmp_path / 'b', strategy='random_fsq')
    (episode,) = read_episodes(tmp_path / 'b')
    assert first_divergence(episode.started, episode.events) is None
    started = episode.started
    other = first_divergence(dataclasses.replace(started, seed=started.seed + 1), episode.events)
    assert other is not None
    assert int(other.split()[1].rstrip(':')) >= 2
    assert 'was recorded' in other
    changed = dataclasses.replace(started, settings=dataclasses.replace(started.settings, strategy='farthest_fsq'))
    assert first_divergence(changed, episode.events) is not None


def with_other_features(episode, turn, change):
    """The events of an episode, but that other features were recorded in a turn."""
    return [
        dataclasses.replace(event, weighed=dataclasses.replace(event.weighed, features=event.weighed.features + change))
        if isinstance(event, ActionChosen) and event.turn == turn
        else event
        for event in episode.events
    ]


@pytest.mark.parametrize(('change', 'found'), [(1e-3, 'turn 1: the features differ by up to 0.001'), (1e-6, None)])
def test_features_of_another_look_are_a_divergence_and_rounding_is_none(bags, tmp_path, change, found):
    """The same choice for other reasons is not the same decision; but a look-ahead is exact to 1e-6 only."""
    bags.write_episode(tmp_path / 'b')
    (episode,) = read_episodes(tmp_path / 'b')
    assert first_divergence(episode.started, with_other_features(episode, 1, change)) == found


@pytest.mark.parametrize('accepted', [True, False])
def test_without_a_turns_state_nobody_knows_since_when_an_answer_is_corrected(bags, tmp_path, accepted):
    """Otherwise a decision would be replayed with what was not known then."""

    def then(writing, _):
        stamp = bags.START + 2 * 10**9
        answer = {'query_id': 'q1', 'answer_id': 'a2', 'teacher_id': 'anna', 'outcome': 'answered', 'content': 'snack'}
        writing.send('answer', typestore().types[STRING]('{"no": "answer"'), stamp + 1)
        writing.say('answer', answer | {'replaces': 'a1'}, stamp + 2)
        ack = {'query_id': 'q1', 'answer_id': 'a2', 'accepted': accepted, 'reason': ''}
        writing.say('answer_ack', ack, stamp + 3)

    bags.write_episode(tmp_path / 'b', missing=[('learner_state', 4)], then=then)
    if accepted:
        with pytest.raises(BagError, match='b: turn 4 was recorded without its learner_state'):
            read_episodes(tmp_path / 'b')
    else:
        assert len(read_episodes(tmp_path / 'b')) == 1


def test_an_episode_without_a_whole_turn_is_told_of_beside_others(bags, tmp_path):
    """The user is told of the part, and what was recorded before it is not hidden."""

    def then(writing, episode):
        stamp = bags.START + 2 * 10**9
        writing.begin_turn(1, stamp, episode['world'], 'e2')
        writing.say('episode', episode, stamp + 1, 'e2')

    bags.write_episode(tmp_path / 'b', then=then)
    with pytest.raises(BagError, match='ended before the first turn of episode e2'):
        read_episodes(tmp_path / 'b')
    left_out: list[LeftOut] = []
    (episode,) = read_episodes(tmp_path / 'b', left_out)
    assert (episode.started.episode_id, [what for what, _ in left_out]) == ('e1', ['e2'])


def test_an_unfinished_recording_counts_as_far_as_it_goes(bags, tmp_path):
    """Otherwise a killed recording of a person's half hour would be lost; repaired, it trains."""
    bags.write_episode(tmp_path / 'b', close=False)
    with pytest.raises(BagError, match='record --repair'):
        read_episodes(tmp_path / 'b')
    repair(tmp_path / 'b')
    (demonstration,) = read_demonstrations([tmp_path / 'b'])
    assert len(demonstration.steps) == 8


@pytest.mark.parametrize(
    ('missing', 'reason'),
    [
        ([('turn', 3)], 'turn 3 of 8 was not recorded'),
        ([('decision', 4)], '4 of 8 was recorded without its decision; if the learner kept a session, `session DIR'),
        ([('objects', 8)], 'turn 8 of 8 was recorded without its objects'),
        ([('objects', 4)], 'turn 4 of 8 was recorded without its objects'),
        ([('episode', 1)], 'no episode was recorded'),
        ([('learner_state', turn) for turn in range(1, 9)], 'ended before the first turn'),
    ],
)
def test_what_is_missing_is_named(bags, tmp_path, missing, reason):
    """Otherwise an episode with holes would be learnt from as if the expert had done nothing."""
    bags.write_episode(tmp_path / 'b', missing=missing)
    with pytest.raises(BagError, match=reason):
        read_episodes(tmp_path / 'b')


@pytest.mark.parametrize(
    ('types', 'reason'),
    [
        ({'turn': CLOUD}, r'topic /robot/turn holds sensor_msgs/msg/PointCloud2, expected std_msgs'),
        ({}, r'/robot/episode: .*is a required property'),
    ],
)
def test_other_types_and_documents_that_are_none_are_named(bags, tmp_path, types, reason):
    """A bag of another program with topics of the same name, of another version, or of nobody's."""
    writing = bags.Writing(tmp_path / 'b', types={**bags.TYPES, **types})
    writing.say('episode', {'symbols': ['a', 'b']}, bags.START)
    writing.bag.close()
    with pytest.raises(BagError, match=reason):
        read_episodes(tmp_path / 'b')


def test_objects_with_other_features_than_announced_are_named(bags, tmp_path, monkeypatch):
    """Otherwise the decision would belong to another scene."""
    original = bags.Writing.say

    def renamed(self, name, members, stamp, episode_id='e1'):
        if name == 'episode':
            members = {**members, 'feature_names': members['feature_names'][:-1]}
        original(self, name, members, stamp, episode_id)

    monkeypatch.setattr(bags.Writing, 'say', renamed)
    bags.write_episode(tmp_path / 'b')
    with pytest.raises(BagError, match='the objects of turn 1 have other features than the episode announces'):
        read_episodes(tmp_path / 'b')


def test_decisions_without_features_cannot_be_learnt_from(bags, tmp_path):
    """A control weighs nothing: its bag is no demonstration for the decision features."""
    bags.write_episode(tmp_path / 'b', strategy='random_fsq')
    reason = 'strategy random_fsq: turn 1: the decision carries no decision features to learn from; record .*'
    with pytest.raises(BagError, match=f'{reason}strategy:=human .* or train with --strategy value_per_cost'):
        read_demonstrations([tmp_path / 'b'])


def test_what_latched_topics_tell_of_an_earlier_episode_is_left_out(tmp_path):
    """Otherwise a learner that is done and still up would make the bag of the next episode unreadable."""
    old, new = (read_bag(SHIPPED.with_name(name)) for name in ('expert_0', 'expert_1'))
    topics = [dataclasses.replace(topic, name=f'/r/{last_part(topic.name)}') for topic in new.topics]
    left_over = [
        next(m for m in reversed(old.messages) if last_part(m.topic) == name)
        for name in ('turn', 'episode', 'learner_state')
    ]
    with BagWriter(tmp_path / 'b', topics) as bag:
        for message in (*left_over, *new.messages):
            bag.write(f'/r/{last_part(message.topic)}', message.data, message.stamp)
    (episode,) = read_episodes(tmp_path / 'b')
    assert episode.started.seed == 1
    assert len(episode.turns) == 30


def last_part(topic):
    return topic.rsplit('/', 1)[-1]


HOUR = 3600 * 10**9


def written(path, messages, storage='mcap'):
    """A bag of these messages, in this order."""
    known = {message.topic: Topic(message.topic, message.type, True) for message in messages}
    with BagWriter(path, list(known.values()), storage) as bag:
        for message in messages:
            bag.write(message.topic, message.data, message.stamp)
    return path


def stepped(messages, at, by):
    """The messages as a recorder would have stamped them whose clock was put forward or back before one of them."""
    return [
        dataclasses.replace(message, stamp=message.stamp + (by if place >= at else 0))
        for place, message in enumerate(messages)
    ]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize(('at', 'by'), [(54, -HOUR), (54, HOUR), (100, -5 * 10**8), (160, -HOUR)])
@pytest.mark.parametrize('is_sorted', [False, True], ids=['as recorded', 'sorted since'])
def test_a_clock_that_was_put_back_hides_nothing(tmp_path, storage, at, by, is_sorted):
    """Otherwise only ten of thirty decisions would be checked and learnt from, without a word."""
    messages = stepped(read_bag(SHIPPED).messages, at, by)
    if is_sorted:
        messages.sort(key=lambda message: message.stamp)
    (episode,) = read_episodes(written(tmp_path / 'b', messages, storage=storage))
    (before,) = read_episodes(SHIPPED)
    assert len(episode.turns) == 30
    assert episode.records == before.records
    assert first_divergence(episode.started, episode.events) is None


@pytest.mark.parametrize(
    'arranged',
    [
        lambda messages: [dataclasses.replace(message, stamp=0) for message in messages],
        lambda messages: sorted(messages, key=lambda message: message.topic),
        lambda messages: list(reversed(messages)),
        lambda messages: [*messages, *messages],
        lambda messages: [*messages, *stepped(messages, 0, HOUR)],
    ],
    ids=['without stamps', 'topic after topic', 'backwards', 'looped on a looping clock', 'looped'],
)
def test_the_order_of_a_file_is_not_that_of_the_episode(tmp_path, arranged):
    """Whatever rewrites a bag has an order of its own."""
    (episode,) = read_episodes(written(tmp_path / 'b', arranged(read_bag(SHIPPED).messages)))
    assert len(episode.turns) == 30
    assert first_divergence(episode.started, episode.events) is None


@pytest.mark.parametrize('later', [HOUR, -HOUR, 0], ids=['later', 'on a clock that began again', 'at the same times'])
def test_two_learners_stay_apart(bags, tmp_path, later):
    """Otherwise turns of one would be taken for those of the next, which has the same parameters, or times."""
    bags.write_episode(tmp_path / 'long', n_turns=8)
    bags.write_episode(tmp_path / 'short', n_turns=4, strategy='random_fsq', start=bags.START + later)
    first, second = (read_bag(tmp_path / name).messages for name in ('long', 'short'))
    if later == 0:
        ids = (b'"episode_id":"e1"', b'"episode_id":"e2"')
        second = [dataclasses.replace(message, data=message.data.replace(*ids)) for message in second]
    episodes = read_episodes(written(tmp_path / 'b', [*first, *second]))
    assert [episode.started.settings.strategy for episode in episodes] == ['expert', 'random_fsq']
    assert [len(episode.turns) for episode in episodes] == [8, 4]
    assert [first_divergence(episode.started, episode.events) for episode in episodes] == [None, None]


@pytest.mark.parametrize(
    ('name', 'type_', 'data'),
    [
        ('/zed/objects', 'vision_msgs/msg/Detection2DArray', None),
        ('/zed/objects', CLOUD, 'cloud of others'),
        ('/chat/turn', STRING, 'your turn'),
        ('/chat/episode', STRING, '{"episode": 4}'),
        ('/shop/query', 'sensor_msgs/msg/PointCloud2', None),
        ('/robot/turn', STRING, 'your turn'),
        ('/robot/episode', STRING, '[1, 2]'),
        ('/robot/learner_state', STRING, '{"turn": 99, "episode_id": "e1"}'),
        ('/robot/objects', CLOUD, 'cloud of others'),
        ('/robot/decision', CLOUD, 'cloud of others'),
    ],
)
def test_what_other_nodes_say_on_such_names_is_passed_over(bags, tmp_path, name, type_, data):
    """In the recording of a whole robot the topics of other nodes are neither an error nor learnt from."""
    bags.write_episode(tmp_path / 'ours')
    messages = list(read_bag(tmp_path / 'ours').messages)
    if data == 'cloud of others':
        content = cloud_of_others(bags, messages)
    elif data is not None:
        content = text(data)
    if data is not None:
        others = [BagMessage(name, type_, message.stamp - 1, content) for message in messages[::3]]
        messages = sorted([*messages, *others], key=lambda message: message.stamp)
    path = written(tmp_path / 'b', messages)
    if data is None:
        add_topic(path, name, type_)
    left_out: list[LeftOut] = []
    (episode,) = read_episodes(path, left_out)
    assert (len(episode.turns), left_out) == (8, [])
    assert first_divergence(episode.started, episode.events) is None


def cloud_of_others(bags, messages):
    """Return a cloud as a camera publishes it: points without the ids of objects, stamped like the first turn."""
    store = typestore()
    field, header = store.types['sensor_msgs/msg/PointField'], store.types['std_msgs/msg/Header']
    begin = next(message.stamp for message in messages if last_part(message.topic) == 'turn')
    stamp = store.types['builtin_interfaces/msg/Time'](begin // 10**9, begin % 10**9)
    fields = [field(name, 4 * place, 7, 1) for place, name in enumerate('xyz')]
    points = np.zeros(24, np.uint8)
    cloud = store.types[CLOUD](header(stamp, 'camera'), 1, 2, fields, False, 12, 24, points, True)
    return bytes(store.serialize_cdr(cloud, CLOUD))


def add_topic(path, name, type_):
    """Announce another topic in a bag's metadata, of any type at all, without a message."""
    metadata = yaml.safe_load((path / 'metadata.yaml').read_text())
    topics = metadata['rosbag2_bagfile_information']['topics_with_message_count']
    described = {**topics[0]['topic_metadata'], 'name': name, 'type': type_}
    topics.append({'message_count': 0, 'topic_metadata': described})
    (path / 'metadata.yaml').write_text(yaml.safe_dump(metadata))


def test_what_could_not_be_used_beside_others_is_told(bags, tmp_path):
    """Otherwise the decisions that were not checked would be taken for checked ones."""
    missing_from = {
        'a': (),
        'b': [('objects', 3)],
        'c': [('turn', 1)],
        'd': [('learner_state', turn) for turn in range(3, 9)],
        'e': [('episode', 1)],
    }
    messages: list[BagMessage] = []
    for name, missing in missing_from.items():
        bags.write_episode(tmp_path / name, missing=missing)
        recorded = read_bag(tmp_path / name).messages
        messages += [dataclasses.replace(m, topic=f'/{name}/{last_part(m.topic)}') for m in recorded]
    path = written(tmp_path / 'all', messages)
    left_out: list[LeftOut] = []
    episodes = read_episodes(path, left_out)
    assert [len(episode.turns) for episode in episodes] == [8, 2]
    told = sorted(reason for _, reason in left_out)
    beginnings = [
        'no episode was recorded for its turns (/e/episode)',
        'turn 1 of 8 was not recorded: did the recording begin too late',
        'turn 3 of 8 was recorded without its objects',
        'turns 4 to 8: what was answered before was not recorded',
    ]
    assert [text[: len(beginning)] for text, beginning in zip(told, beginnings, strict=True)] == beginnings
    with pytest.raises(BagError, match='all: turn 3 of 8 was recorded without its objects'):
        read_episodes(path)


def test_the_last_decision_of_a_recording_that_ended_early_is_checked_and_counted(bags, tmp_path, capsys):
    """Otherwise it would be left out without a word, or seem not to have been checked."""
    bags.write_episode(tmp_path / 'b', missing=[('learner_state', 8)])
    (episode,) = read_episodes(tmp_path / 'b')
    assert (len(episode.turns), episode.decisions) == (7, 8)
    assert first_divergence(episode.started, episode.events) is None
    other = with_other_features(episode, 8, 1)
    assert first_divergence(episode.started, other) == 'turn 8: the features differ by up to 1'
    assert main(['replay', str(tmp_path / 'b'), '--check']) == 0
    assert '8 decisions, all as recorded' in capsys.readouterr().out.replace('\n', ' ')


def test_the_scenes_of_a_camera_whose_clock_went_back_are_found(bags, tmp_path):
    """The recording of a simulation that loops holds scenes all the same."""

    def earlier(message):
        cloud = deserialize(message)
        if last_part(message.topic) != 'objects' or cloud.header.stamp.nanosec < 500_000_000:
            return message
        cloud.header.stamp.sec -= 100
        cloud.header.stamp.nanosec += 1
        return dataclasses.replace(message, data=bytes(typestore().serialize_cdr(cloud, CLOUD)))

    bags.write_episode(tmp_path / 'whole')
    messages = [
        earlier(message) if message.type == CLOUD else message for message in read_bag(tmp_path / 'whole').messages
    ]
    (episode,) = read_episodes(written(tmp_path / 'b', messages))
    assert len(episode.turns) == 8
    assert first_divergence(episode.started, episode.events) is None


def test_what_a_camera_with_a_fast_clock_showed_before_the_turn_is_not_its_scene(bags, tmp_path):
    """The learner waited for none yet: it is the scene before a change, and not the one after it."""
    lived = bags.write_episode(tmp_path / 'whole', n_turns=12)
    messages, before = [], None
    for message in read_bag(tmp_path / 'whole').messages:
        if last_part(message.topic) == 'turn' and before is not None:
            cloud = deserialize(before)
            seconds, nanoseconds = divmod(message.stamp + 5, 10**9)
            cloud.header.stamp.sec, cloud.header.stamp.nanosec = seconds, nanoseconds
            data = bytes(typestore().serialize_cdr(cloud, CLOUD))
            messages.append(dataclasses.replace(before, data=data, stamp=message.stamp))
        before = message if last_part(message.topic) == 'objects' else before
        messages.append(message)
    (episode,) = read_episodes(written(tmp_path / 'b', messages))
    assert episode.change_turns == (11,)
    for turn in episode.turns:
        np.testing.assert_array_equal(turn.scene.features, lived.world.scene(turn.turn).features)


def test_the_scene_of_the_next_learner_is_not_taken_for_one_that_is_missing(bags, tmp_path):
    """Otherwise the end of an episode would be learnt from with things in view that were not there."""
    bags.write_episode(tmp_path / 'first', missing=[('objects', 8)])
    bags.write_episode(tmp_path / 'second', start=bags.START + HOUR)
    first, second = (read_bag(tmp_path / name).messages for name in ('first', 'second'))
    left_out: list[LeftOut] = []
    (episode,) = read_episodes(written(tmp_path / 'b', [*first, *second]), left_out)
    assert len(episode.turns) == 8
    assert [reason[:47] for _, reason in left_out] == ['turn 8 of 8 was recorded without its objects; i']
