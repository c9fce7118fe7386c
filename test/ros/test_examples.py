"""The examples that users copy."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String

from al_questioner.messages import documents
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from shared.checkout import ROOT

EXAMPLES = ROOT / 'docs' / 'examples'
DEADLINE = 90.0


def test_a_robots_own_perception_teaches_the_learner(graph: Any, processes: Any) -> None:
    """The example that users copy would not work, or be asked about the same still things because of its noise."""
    states = graph.listen('learner_state')
    diagnostics = graph.listen('diagnostics', DiagnosticArray, qos.DIAGNOSTICS, '/diagnostics')
    remap = ['--ros-args', '-r', f'__ns:=/{graph.namespace}']
    processes.start('own_perception', [sys.executable, str(EXAMPLES / 'own_perception.py'), *remap])
    task = str(EXAMPLES / 'blobs.yaml')
    processes.start('person', [sys.executable, str(Path(__file__).with_name('person.py')), *remap])
    graph.start(LearnerNode, task=task, strategy='random_fsq')
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the episode')
    assert states[-1]['spent'] == 6
    asked = [query['object_id'] for query in states[-1]['queries'] if query['kind'] == 'label']
    assert sorted(asked) == [1, 2, 3, 4]

    def noise() -> str:
        latest = diagnostics[-1].status if diagnostics else []
        return {value.key: value.value for status in latest for value in status.values}.get('view noise', '')

    # They are told once a second, and the episode may be shorter.
    graph.wait_for(lambda: 'the noisiest is size_width' in noise(), 'the noise on /diagnostics')


def test_who_answers_by_hand_is_told_everything_once(graph: Any, processes: Any, tmp_path: Path) -> None:
    """What the learner repeats for others would fill the screen, and an empty line be refused as an answer."""
    answers = graph.listen('answer', profile=qos.EVENTS)
    asks, tells = (graph.ears.create_publisher(String, name, qos.LATCHED) for name in ('query', 'learner_state'))
    typed = tmp_path / 'typed'
    os.mkfifo(typed)
    keyboard = os.open(typed, os.O_RDWR)
    example = [sys.executable, '-u', str(EXAMPLES / 'answer_by_hand.py')]
    process = processes.start('by_hand', [*example, '--ros-args', '-r', f'__ns:=/{graph.namespace}'], typed)

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
