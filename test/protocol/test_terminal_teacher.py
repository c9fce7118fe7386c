"""The machine between the topics and a person."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from al_questioner.domain import Action, Query, QueryKind, Scene, SceneError
from al_questioner.messages import documents
from al_questioner.protocol.terminal_teacher import SAID, TerminalTeacherMachine
from al_questioner.protocol.topics import Look, PictureShown
from al_questioner.questioning.dialogue import Phase, TeacherDialogue
from shared.machine_driver import Driver

SCENE = Scene((7, 9), np.eye(2, 3, dtype=np.float32), np.ones((2, 1), np.float32), ('colour_hue',))


class Desk:
    """A person, and the machine that stands between them and the robot."""

    def __init__(self) -> None:
        self.dialogue = TeacherDialogue('anna', lambda *said: self.driver.enter(SAID, said))
        self.driver = Driver(TerminalTeacherMachine(self.dialogue))
        self.driver.start()

    def asks(self, number: int, episode_id: str = 'e') -> None:
        """Ask what object 7 is."""
        action = Action(QueryKind.LABEL, 7)
        query = Query(f'q{number}', number, action, ('snack', 'fruit'), 1, 4, 5, 1, 'What is object 7?')
        self.driver.hear_document('query', episode_id, documents.query_members(query))

    def tells(self, episode_id: str = 'e', done: bool = False) -> None:
        """Tell of the progress."""
        state = {'turn': 2, 'turns': 8, 'budget': 6, 'spent': 1, 'labels': {}, 'model_version': 1, 'beliefs': {}}
        self.driver.hear_document('learner_state', episode_id, {**state, 'queries': [], 'done': done})

    def acknowledges(self, accepted: bool = True, reason: str = '') -> None:
        """Acknowledge the last answer."""
        answer = self.answers[-1]
        ids = {'query_id': answer['query_id'], 'answer_id': answer['answer_id']}
        members = {**ids, 'accepted': accepted, 'reason': reason}
        self.driver.hear_document('answer_ack', answer['episode_id'], members)

    @property
    def answers(self) -> list[dict[str, Any]]:
        """All that was said to the robot."""
        return self.driver.published('answer')


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_what_the_person_says_is_said_until_the_learner_has_it(desk: Desk) -> None:
    """Otherwise one lost message would lose what a person said."""
    assert desk.driver.status == 'waiting for a query'
    desk.asks(1)
    assert desk.driver.status == 'q1: What is object 7?'
    desk.dialogue.say('fruit')
    desk.driver.pass_until(2.5)
    assert [answer['content'] for answer in desk.answers] == ['fruit'] * 3
    assert desk.dialogue.view_state().phase is Phase.SENDING
    desk.acknowledges()
    desk.driver.pass_until(100.0)
    assert len(desk.answers) == 3
    assert desk.dialogue.view_state().notice == 'Noted: object 7 is fruit.'
    assert desk.driver.status == 'waiting for a query'


def test_a_refusal_is_shown_to_the_person(desk: Desk) -> None:
    """Otherwise the robot would wait for ever."""
    desk.asks(1)
    desk.dialogue.say('fruit')
    desk.acknowledges(accepted=False, reason='it has gone')
    view_state = desk.dialogue.view_state()
    assert (view_state.phase, view_state.notice) == (Phase.ASKED, 'The robot did not take that: it has gone')
    assert [topic for topic, _ in desk.driver.refusals] == ['answer_ack']


def test_a_correction_names_the_answer_that_it_replaces(desk: Desk) -> None:
    """Otherwise the learner could not find what to take back."""
    desk.asks(1)
    desk.dialogue.say('fruit')
    (first,) = desk.answers
    assert (first['teacher_id'], first['outcome'], first['episode_id']) == ('anna', 'answered', 'e')
    assert 'replaces' not in first
    desk.acknowledges()
    desk.asks(2)
    desk.dialogue.undo()
    desk.dialogue.say('snack')
    correction = desk.answers[-1]
    assert (correction['query_id'], correction['content']) == ('q1', 'snack')
    assert correction['replaces'] == first['answer_id'] != correction['answer_id']
    desk.acknowledges()
    view_state = desk.dialogue.view_state()
    assert view_state.phase is Phase.ASKED
    assert view_state.prompt is not None
    assert (view_state.prompt.query.query_id, view_state.notice) == ('q2', 'Noted: object 7 is snack instead.')


def test_an_answer_is_not_carried_into_another_episode(desk: Desk) -> None:
    """The answer to a question of one episode is not learnt of a thing in another."""
    desk.asks(1)
    desk.dialogue.say('fruit')
    desk.asks(1, episode_id='another')
    desk.driver.pass_until(10.0)
    assert [answer['episode_id'] for answer in desk.answers] == ['e']
    assert desk.driver.machine.sender.unacknowledged is None


def test_what_was_said_as_another_episode_began_is_not_said_in_it() -> None:
    """The person's thread may be faster than the messages: their answer would be one to a question not yet seen."""
    said: list[Any] = []
    dialogue = TeacherDialogue('anna', lambda *one: said.append(one))
    desk = Desk()
    desk.driver = Driver(TerminalTeacherMachine(dialogue))
    desk.asks(1)
    dialogue.say('fruit')
    desk.asks(1, episode_id='another')
    desk.driver.enter(SAID, said[0])
    assert desk.answers == []


def test_the_end_of_an_episode_that_was_left_is_not_shown(desk: Desk) -> None:
    """Otherwise a learner that is over, and still runs, would take the open question of the next off the screen."""
    desk.tells('old', done=True)
    assert desk.dialogue.view_state().phase is Phase.OVER
    desk.asks(1, episode_id='new')
    desk.tells('old', done=True)
    assert desk.dialogue.view_state().phase is Phase.ASKED


def test_what_is_on_the_table_is_shown_with_the_question(desk: Desk) -> None:
    """Otherwise the person would not know which thing is meant."""
    known: list[tuple[str, ...]] = []

    def read(names: Any) -> Scene:
        known.append(tuple(names))
        return SCENE

    desk.asks(1)
    for stamp in (4, 5):
        desk.driver.hear('objects', Look(stamp, 'table', read))
    desk.driver.hear('scene_image', PictureShown(np.ones((4, 6, 3), np.uint8), 5))
    prompt = desk.dialogue.view_state().prompt
    assert prompt is not None
    assert prompt.picture is not None
    assert (prompt.scene, prompt.picture.shape) == (SCENE, (4, 6, 3))
    # An empty cloud need not name its fields.
    assert known == [(), SCENE.feature_names]


def test_a_table_that_was_cleared_is_shown_as_such(desk: Desk) -> None:
    """Otherwise the person would go on to see what is there no more."""
    desk.asks(1)
    nothing = Scene((), SCENE.positions[:0], SCENE.features[:0], SCENE.feature_names)
    for stamp, scene in ((4, SCENE), (5, nothing)):
        desk.driver.hear('objects', Look(stamp, 'table', lambda _, scene=scene: scene))
    prompt = desk.dialogue.view_state().prompt
    assert prompt is not None
    assert prompt.scene is nothing


def test_a_scene_that_cannot_be_read_is_refused(desk: Desk) -> None:
    """Otherwise any node on the network could end a person's session."""

    def read(_: Any) -> Scene:
        raise SceneError('no fields')

    desk.asks(1)
    desk.driver.hear('objects', Look(4, 'table', read))
    assert desk.driver.refusals == [('objects', 'no fields')]
    assert desk.dialogue.view_state().phase is Phase.ASKED
