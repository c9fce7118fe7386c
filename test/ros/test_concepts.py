"""A learner that keeps what it was taught, and another one that goes on with it."""

from __future__ import annotations

import json
from collections import deque
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from al_questioner.cli import main
from al_questioner.domain import Classifiers, InputError, Knowledge, random_stream
from al_questioner.event_log.log import read_log
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages import documents
from al_questioner.messages.concepts_file import concepts_of_text, read_concepts, write_concepts
from al_questioner.messages.documents import record_members
from al_questioner.questioning import Episode
from al_questioner.questioning.review import taught_learner
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.settings import learner_settings
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task, turns
from shared.durable_sessions import play_turns, start_durable
from shared.lunches import TASK, WORLD_SPEC, taught


def test_two_days_of_nodes(graph: Any, tmp_path: Path) -> None:
    """A robot that is switched off has learnt nothing."""
    known = graph.listen('concepts')
    graph.play(session=str(tmp_path / 'monday'))
    monday = tmp_path / 'monday' / 'concepts.json'
    graph.wait_for(monday.exists, 'the file')
    summary = summarise_session(tmp_path / 'monday', read_log(tmp_path / 'monday'))
    graph.wait_for(lambda: read_concepts(monday) == summary.knowledge, 'the last answer in the file')
    graph.wait_for(lambda: known[-1] == json.loads(monday.read_text()), 'the same on the topic')
    # The whole day was told as it went on.
    sizes = [len(document['lessons']) for document in known]
    assert sizes == sorted(sizes)
    assert len(set(sizes)) > 2
    documents.read('concepts', json.dumps(known[0]))
    assert main(['session', str(tmp_path / 'monday'), '--concepts', str(tmp_path / 'again.json')]) == 0
    assert (tmp_path / 'again.json').read_bytes() == monday.read_bytes()

    for node in list(graph.nodes):
        graph.stop(node)
    for heard in graph.heard.values():
        heard.clear()
    tuesday = tmp_path / 'tuesday.json'
    parameters = {'strategy': 'farthest_fsq', 'session': str(tmp_path / 'tuesday')}
    state = graph.play(concepts=str(monday), save_concepts=str(tuesday), **parameters)
    graph.wait_for(lambda: tuesday.exists() and len(read_concepts(tuesday).origins) == 2, 'the second file')
    # The same as offline, and nothing of what was told before is asked again.
    task = load_task('prepare_lunch')
    settings = episode_settings(task, 'farthest_fsq', 6.0, 8, concepts=read_concepts(monday))
    episode = Episode(settings, random_stream(4, 'learner'))
    world, teacher = (
        PerceivedWorld(WorldSpec(task, 4, 4).open()),
        ScriptedTeacher(task.symbols, task.relevant_groups, 4),
    )
    deque(turns(episode, world, teacher), maxlen=0)
    assert state['queries'] == [record_members(record) for record in episode.records]
    assert 'feature_subset' not in [query['kind'] for query in state['queries']]
    assert state['labels'] == dict(episode.positives)
    assert state['teachers']['scripted']['answered'] == episode.teachers['scripted'].answered > len(state['queries'])

    whole = summarise_session(tmp_path / 'tuesday', read_log(tmp_path / 'tuesday'))
    graph.wait_for(lambda: read_concepts(tuesday) == whole.knowledge, 'all of the second day')
    looks = np.array([view.features for view in whole.knowledge.views.values()], dtype=np.float32)
    believed = taught_learner(concepts_of_text(tuesday.read_text())).predict_proba(looks)
    assert np.array_equal(believed, episode.concepts.predict_proba(looks))


def test_a_file_that_cannot_be_used_is_refused_at_once(graph: Any, tmp_path: Path) -> None:
    """A learner begins with nothing, although it was told what is known."""
    (tmp_path / 'damaged.json').write_text('{')
    for parameters, said in (
        ({'concepts': str(tmp_path / 'damaged.json')}, 'damaged.json: concepts: not valid JSON'),
        ({'concepts': str(tmp_path / 'missing.json')}, 'missing.json cannot be read'),
        ({'save_concepts': str(tmp_path)}, 'cannot be written'),
    ):
        with pytest.raises(InputError, match=said):
            graph.start(LearnerNode, **{**graph.episode, **parameters})


def test_what_is_known_decides_how_the_learner_learns() -> None:
    """A learner would otherwise believe otherwise than the one that was taught, unless told to."""
    known = Knowledge(('snack', 'fruit'), ('colour_red',), Classifiers(2.5, 'rbf', 0.25), length_scale=3.0)
    defaults = {each.name: each.default for each in learner_settings(load_task('prepare_lunch'), known)}
    assert [defaults[name] for name in ('amplitude', 'kernel_shape', 'class_balance')] == [2.5, 'rbf', 0.25]
    assert defaults['length_scale'] == 3.0


def test_what_was_taught_yesterday_is_not_replaced(graph: Any, tmp_path: Path) -> None:
    """The same command once more, on the second day, destroys what the first one has brought."""
    kept = tmp_path / 'kept.json'
    write_concepts(kept, taught().knowledge)
    text = kept.read_text()
    with pytest.raises(InputError, match=r'kept.json holds .* does not begin with .*: add concepts:='):
        graph.start(LearnerNode, **graph.episode, save_concepts=str(kept))
    (tmp_path / 'letter').write_text('Dear robot')
    with pytest.raises(InputError, match='letter: concepts: not valid JSON'):
        graph.start(LearnerNode, **graph.episode, save_concepts=str(tmp_path / 'letter'))
    assert (kept.read_text(), (tmp_path / 'letter').read_text()) == (text, 'Dear robot')
    graph.start(LearnerNode, **graph.episode, concepts=str(kept), save_concepts=str(kept))


def test_a_resumed_session_goes_on_with_its_file(graph: Any, tmp_path: Path) -> None:
    """A learner that is started again after a crash is told that its own file is somebody else's."""
    kept, session = tmp_path / 'kept.json', tmp_path / 'session'
    durable = start_durable(session, settings=episode_settings(TASK, 'random_fsq', 6.0, 8))
    play_turns(durable, PerceivedWorld(WORLD_SPEC.open()), 3)
    write_concepts(kept, durable.knowledge())
    durable.close()
    assert read_concepts(kept).examples
    learner = graph.start(LearnerNode, **graph.episode, save_concepts=str(kept), session=str(session))
    graph.wait_for(lambda: learner.machine.is_ready, 'a learner that goes on')
