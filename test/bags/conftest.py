"""Small bags, made from an episode that is played offline with the same encoders as the nodes use."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from al_questioner.bags import BagWriter, Topic
from al_questioner.bags.reading import typestore
from al_questioner.bags.topics import CLOUD, STRING, TYPES
from al_questioner.domain import random_stream
from al_questioner.messages import documents
from al_questioner.messages.clouds import CloudTypes, cloud_of_decision, cloud_of_scene
from al_questioner.messages.stamps import stamp_members
from al_questioner.questioning import Episode
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task, turns

START = 1_700_000_000_000_000_000
PERIOD = 100_000_000
LATCHED = ('episode', 'turn', 'objects', 'query', 'learner_state')


class Writing:
    """Writes messages under names without namespace, one after the other."""

    def __init__(self, path, storage='mcap', types=TYPES, namespace='/robot'):
        self._types, self._namespace = types, namespace
        self.topics = [Topic(f'{namespace}/{name}', type_, name in LATCHED) for name, type_ in types.items()]
        self.bag = BagWriter(path, self.topics, storage)
        store = typestore()
        self._header, self._time = (store.types[f'{n}'] for n in ('std_msgs/msg/Header', 'builtin_interfaces/msg/Time'))
        self.cloud_types = CloudTypes(
            store.types[CLOUD],
            store.types['sensor_msgs/msg/PointField'],
            lambda content: np.frombuffer(content, dtype=np.uint8),
        )

    def header(self, stamp):
        return self._header(self._time(stamp // 10**9, stamp % 10**9), 'table')

    def send(self, name, message, stamp):
        type_ = self._types[name]
        self.bag.write(f'{self._namespace}/{name}', bytes(typestore().serialize_cdr(message, type_)), stamp)

    def begin_turn(self, turn, stamp, world, episode_id='e1', received=None):
        members = {'turn': turn, 'stamp': stamp_members(stamp), 'world': world}
        self.say('turn', members, stamp if received is None else received, episode_id)

    def say(self, name, members, stamp, episode_id='e1'):
        self.send(name, typestore().types[STRING](documents.write(name, episode_id, members)), stamp)


def write_episode(path, storage='mcap', n_turns=8, missing=(), close=True, strategy='expert', then=None, start=START):
    """A bag, finished if it is closed, of an episode of the scripted expert from a time in nanoseconds on.

    `missing` are pairs of a topic's name and the turn in which nothing is recorded on it; `then`, given the writing and
    the members of the episode's document, writes what comes after it.
    """
    loaded = load_task('prepare_lunch')
    settings = episode_settings(loaded, strategy, 6.0, n_turns, change_interval=4)
    world, episode = PerceivedWorld(WorldSpec(loaded, 3, 3).open()), Episode(settings, random_stream(3, 'learner'))
    teacher = ScriptedTeacher(loaded.symbols, loaded.relevant_groups, 3)
    members = {'task': 'prepare_lunch', 'seed': 3, 'sample': 3, 'dataset': None}
    writing = Writing(path, storage)
    for decision, _ in turns(episode, world, teacher):
        turn, stamp = decision.turn, start + decision.turn * PERIOD
        scene = world.scene(turn)
        kept = {name for name in TYPES if (name, turn) not in missing}
        if 'turn' in kept:
            writing.begin_turn(turn, stamp, members)
        if 'objects' in kept:
            writing.send('objects', cloud_of_scene(scene, writing.header(stamp), writing.cloud_types), stamp + 1)
        if turn == 1 and 'episode' in kept:
            writing.say('episode', episode_members(settings, scene, members), stamp + 2)
        if 'decision' in kept:
            cloud = cloud_of_decision(decision, settings.symbols, writing.header(stamp), writing.cloud_types, scene)
            writing.send('decision', cloud, stamp + 3)
        if 'learner_state' in kept:
            writing.say('learner_state', state_members(episode), stamp + 4)
    if then is not None:
        then(writing, episode_members(settings, world.scene(1), members))
    if close:
        writing.bag.close()
    else:
        writing.bag.sync()
    return SimpleNamespace(settings=settings, world=world, episode=episode)


def episode_members(settings, scene, members):
    return {
        **documents.settings_members(settings),
        'feature_names': list(scene.feature_names),
        'seed': 3,
        'world': members,
        'semantics': SEMANTICS,
    }


def state_members(episode):
    return {
        'turn': episode.turn,
        'turns': episode.settings.turns,
        'budget': episode.settings.budget,
        'spent': episode.spent,
        'done': episode.done,
        'queries': [documents.record_members(record) for record in episode.records],
        'labels': dict(episode.positives),
        'model_version': episode.concepts.model_version,
        'beliefs': {},
    }


@pytest.fixture(scope='session')
def bags():
    """The helpers above; test modules cannot import from each other in pytest's importlib mode."""
    return SimpleNamespace(write_episode=write_episode, Writing=Writing, TYPES=TYPES, START=START, PERIOD=PERIOD)
