"""The examples that users copy."""

from __future__ import annotations

import os
import sys
from collections import deque
from pathlib import Path
from typing import Any

from std_msgs.msg import String

from al_questioner.domain import random_stream
from al_questioner.messages import documents
from al_questioner.messages.concepts_file import write_concepts
from al_questioner.questioning import Episode
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.recogniser import RecogniserNode
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task, turns
from shared.checkout import ROOT

EXAMPLES = ROOT / 'docs' / 'examples'
DEADLINE = 90.0


def test_a_robots_own_perception_teaches_the_learner(graph: Any, processes: Any, diagnostics: Any) -> None:
    """The example that users copy works, and is not asked about the same still things because of its noise."""
    states = graph.listen('learner_state')
    processes.namespace = graph.namespace
    for script in (EXAMPLES / 'own_perception.py', Path(__file__).with_name('person.py')):
        processes.node(script.stem, program=[sys.executable, str(script)])
    graph.start(LearnerNode, task=str(EXAMPLES / 'blobs.yaml'), strategy='random_fsq')
    state = graph.wait_for_end(states)
    assert state['spent'] == 6
    asked = [query['object_id'] for query in state['queries'] if query['kind'] == 'label']
    assert sorted(asked) == [1, 2, 3, 4]
    # They are told once a second, and the episode may be shorter.
    graph.wait_for(lambda: 'the noisiest is size_width' in diagnostics.values.get('view noise', ''), 'the noise')


def test_who_answers_by_hand_is_told_everything_once(graph: Any, processes: Any, tmp_path: Path) -> None:
    """The repetitions of the learner do not fill the screen, and an empty line is no refused answer."""
    answers = graph.listen('answer', profile=qos.EVENTS)
    asks, tells = (graph.ears.create_publisher(String, name, qos.LATCHED) for name in ('query', 'learner_state'))
    typed = tmp_path / 'typed'
    os.mkfifo(typed)
    keyboard = os.open(typed, os.O_RDWR)
    processes.namespace = graph.namespace
    process = processes.node('by_hand', typed, [sys.executable, '-u', str(EXAMPLES / 'answer_by_hand.py')])

    def ask(number: int) -> None:
        question = {'query_id': f'q{number}', 'kind': 'label', 'text': f'What is object {number}?'}
        asks.publish(String(data=documents.write('query', 'e', {**question, 'choices': ['snack', 'fruit']})))

    def heard(word: str) -> bool:
        os.write(keyboard, f'{word}\n'.encode())
        return any(answer.data == word for answer in answers)

    for spent in (5, 6):
        ask(1)
        tells.publish(String(data=documents.write('learner_state', 'e', {'done': True, 'spent': spent})))
        processes.wait_for_log('by_hand', 'the episode is over')
        processes.wait_for_log('by_hand', 'What is object 1?')
    ask(2)
    processes.wait_for_log('by_hand', 'What is object 2?')
    graph.wait_for(lambda: heard('snack'), 'an answer')
    os.write(keyboard, b'\n  \n')
    graph.wait_for(lambda: heard('fruit'), 'another answer')
    os.close(keyboard)
    assert process.wait(DEADLINE) == 0
    assert {answer.data for answer in answers} == {'snack', 'fruit'}
    shown = processes.log('by_hand')
    assert [shown.count(text) for text in ('What is object 1?', 'What is object 2?', 'is over')] == [1, 1, 1]


def test_a_new_table_is_shown_and_asked_for(graph: Any, processes: Any, tmp_path: Path) -> None:
    """Nobody without a robot could see what a concepts file is good for."""
    world = WorldSpec(load_task('prepare_lunch'), 4, 4)
    teacher = ScriptedTeacher(world.task.symbols, world.task.relevant_groups, 4)
    episode = Episode(episode_settings(world.task, 'farthest_fsq', 12.0, 12), random_stream(4, 'learner'))
    deque(turns(episode, PerceivedWorld(world.open()), teacher), maxlen=0)
    write_concepts(tmp_path / 'known.json', episode.knowledge('monday'))
    graph.start(RecogniserNode, concepts=str(tmp_path / 'known.json'))
    recognitions = graph.listen('recognition')
    typed = tmp_path / 'typed'
    os.mkfifo(typed)
    keyboard = os.open(typed, os.O_RDWR)
    processes.namespace = graph.namespace
    script = [sys.executable, '-u', str(EXAMPLES / 'new_table.py'), '--task', 'prepare_lunch', '--sample', '4']
    process = processes.node('new_table', typed, script)
    processes.wait_for_log('new_table', ' rightly.')
    truth = world.open().new_table(0).symbols
    things = recognitions[-1]['things']
    right = [each for each in things if each['known'] and each['best'] == truth[each['object_id']]]
    assert f'{len(truth)} things are on the table' in processes.log('new_table')
    assert f'is right about {len(right)};' in processes.log('new_table')
    os.write(keyboard, b'pliers\n\n')
    processes.wait_for_log('new_table', "'pliers' is nothing that was taught")
    os.close(keyboard)
    assert process.wait(DEADLINE) == 0, processes.log('new_table')
