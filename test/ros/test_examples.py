"""The examples that users copy."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from std_msgs.msg import String

from al_questioner.messages import documents
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
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
