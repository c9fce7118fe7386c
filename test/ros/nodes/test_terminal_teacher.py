"""The teacher node before a person, and a stub in the learner's place."""

from __future__ import annotations

import threading
from functools import partial
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String

from al_questioner.domain import Action, InputError, Outcome, Query, QueryKind, QueryRecord, Scene
from al_questioner.messages import documents
from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.messages.pictures import image
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import Phase
from al_questioner.ros import qos
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.types import CLOUD_TYPES, header, octets

SCENE = Scene((7, 9), np.eye(2, 3, dtype=np.float32), np.ones((2, 1), np.float32), ('colour_hue',))


class Robot:
    """The teacher under test, with what it hears and says."""

    def __init__(self, graph: Any) -> None:
        self.graph = graph
        self.answers = graph.listen('answer', profile=qos.EVENTS)
        self.topics = {
            name: graph.ears.create_publisher(kind, name, profile)
            for name, kind, profile in (
                ('query', String, qos.LATCHED),
                ('learner_state', String, qos.LATCHED),
                ('objects', PointCloud2, qos.LATCHED),
                ('scene_image', Image, qos.LATCHED),
                ('answer_ack', String, qos.EVENTS),
            )
        }
        self.dialogue: TeacherDialogue | None = None
        self.node: Any = None

    def start(self, **parameters: Any) -> None:
        """The teacher."""

        def run_terminal(dialogue: TeacherDialogue, stopped: threading.Event) -> None:
            self.dialogue = dialogue
            stopped.wait()

        self.node = self.graph.start(partial(TeacherNode, run_terminal), mode='terminal', **parameters)
        self.graph.wait_for(lambda: self.dialogue is not None, 'the person')

    def says(self, topic: str, episode_id: str = 'e', **members: Any) -> None:
        """Publish a document."""
        self.topics[topic].publish(String(data=documents.write(topic, episode_id, members)))

    def asks(self, number: int, episode_id: str = 'e') -> None:
        """Ask what object 7 is, and wait until the person is asked."""
        action = Action(QueryKind.LABEL, 7)
        query = Query(f'q{number}', number, action, ('snack', 'fruit'), 1, 4, 5, 1, 'What is object 7?')
        self.says('query', episode_id=episode_id, **documents.query_members(query))
        self.until(lambda now: now.prompt is not None and now.prompt.query.query_id == query.query_id, 'a question')

    def is_told_fruit(self, **parameters: Any) -> None:
        """The teacher, who says that object 7 is fruit."""
        self.start(**parameters)
        self.asks(1)
        self.dialogue.say('fruit')

    def takes(self, answer: dict[str, Any], accepted: bool = True, reason: str = '') -> None:
        """Acknowledge an answer."""
        self.graph.wait_for(self.topics['answer_ack'].get_subscription_count, 'a teacher that listens')
        ids = {'query_id': answer['query_id'], 'answer_id': answer['answer_id']}
        self.says('answer_ack', **ids, accepted=accepted, reason=reason)

    def hears(self, count: int) -> dict[str, Any]:
        """Wait for at least `count` messages, and return the last."""
        self.graph.wait_for(lambda: len(self.answers) >= count, f'{count} answers')
        return self.answers[-1]

    def until(self, is_true: Any, what: str) -> Any:
        """Wait until a condition on the view state is true, and return the view state."""

        def view_state_if_true() -> Any:
            view_state = self.dialogue.view_state()
            return view_state if is_true(view_state) else None

        return self.graph.wait_for(view_state_if_true, what)


@pytest.fixture
def robot(graph: Any) -> Robot:
    return Robot(graph)


def test_who_comes_late_or_back_sees_the_question_the_table_and_what_was_answered(robot: Robot) -> None:
    """Otherwise a person who quits could not go on."""
    stamp = header(5, 'table')
    robot.topics['objects'].publish(cloud_of_scene(SCENE, stamp, CLOUD_TYPES))
    robot.topics['scene_image'].publish(image(np.ones((4, 6, 3), np.uint8), stamp, Image, octets))
    record = QueryRecord(1, QueryKind.LABEL, 9, 'snack', 1.0, Outcome.ANSWERED)
    state = {'turn': 2, 'turns': 8, 'budget': 6, 'spent': 1, 'done': False, 'labels': {}, 'model_version': 1}
    robot.says('learner_state', **state, queries=[documents.record_members(record)], beliefs={})
    query = Query('q2', 3, Action(QueryKind.LABEL, 7), ('snack', 'fruit'), 1, 4, 5, 1, 'What is object 7?')
    robot.says('query', **documents.query_members(query))
    robot.start()

    def complete(view_state: Any) -> bool:
        prompt = view_state.prompt
        return bool(prompt and prompt.scene and prompt.picture is not None and view_state.progress)

    view_state = robot.until(complete, 'all that is latched')
    assert view_state.prompt.scene.object_ids == (7, 9)
    assert view_state.prompt.picture.shape == (4, 6, 3)
    assert [one.symbol for one in view_state.progress.records] == ['snack']


def test_messages_that_cannot_be_used_are_refused_and_counted(robot: Robot, diagnostics: Any) -> None:
    """Otherwise any node on the network could end a person's session."""
    robot.start()
    robot.asks(1)
    robot.topics['query'].publish(String(data='{"query_id"'))
    robot.topics['learner_state'].publish(String(data='[]'))
    robot.topics['objects'].publish(PointCloud2(width=3, height=1))
    robot.topics['scene_image'].publish(Image(width=1000, height=1000, step=3000, encoding='rgb8'))
    refused = {f'refused on {name}' for name in ('query', 'learner_state', 'objects', 'scene_image')}
    robot.graph.wait_for(lambda: refused <= diagnostics.values.keys(), 'four refusals on /diagnostics')
    assert robot.dialogue.view_state().phase is Phase.ASKED


@pytest.mark.parametrize(
    ('parameters', 'reason'),
    [({'mode': 'telepathy'}, 'unknown mode .*; known: scripted, terminal'), ({'teacher_id': 'x' * 101}, 'at most 100')],
)
def test_parameters_of_the_teacher_that_cannot_be_used_are_named(graph: Any, parameters: Any, reason: str) -> None:
    """Otherwise a person would wait at a terminal where nobody asks."""
    with pytest.raises(InputError, match=reason):
        graph.start(TeacherNode, **parameters)


def test_a_person_needs_no_world(robot: Robot) -> None:
    """A person can teach a real robot, without drawings or crops of its things."""
    robot.start(task='uw_lunchbox', dataset='/no/such/place')
    robot.asks(1)
    assert robot.dialogue.view_state().teacher_id
