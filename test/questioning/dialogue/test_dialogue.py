"""Questions, answers, refusals and corrections of a dialogue."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from al_questioner.domain import Answer, AnswerError, Outcome
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import Phase


def test_an_answer_is_on_its_way_until_it_is_taken(person: Any, made: Any) -> None:
    """Otherwise a person would see the next question while the last answer can still get lost."""
    view_state = person.asked(made.label(1))
    assert (view_state.phase, view_state.prompt.query.query_id) == (Phase.ASKED, 'q1')
    person.dialogue.say('Fruit')
    assert person.dialogue.view_state().phase is Phase.SENDING
    view_state = person.taken()
    assert (view_state.phase, view_state.prompt) == (Phase.THINKING, None)
    assert view_state.notice == 'Noted: object 7 is fruit.'
    ((episode_id, answer),) = person.sent
    assert episode_id == 'episode'
    assert (answer.query_id, answer.answer_id, answer.teacher_id) == ('q1', 'q1/anna/a1', 'anna')
    assert (answer.outcome, answer.content, answer.replaces) == (Outcome.ANSWERED, 'fruit', None)


def test_what_is_no_answer_is_explained_and_nothing_is_sent(person: Any, made: Any) -> None:
    """Otherwise a slip of the finger would be learnt."""
    person.asked(made.label(1))
    with pytest.raises(AnswerError, match=r"'pudding' does not answer .* expected one of: main_dish, snack"):
        person.dialogue.say('pudding')
    assert not person.sent
    assert person.dialogue.view_state().phase is Phase.ASKED


def test_a_refused_answer_is_asked_for_again_with_the_reason(person: Any, made: Any) -> None:
    """Otherwise the robot would wait for ever for an answer that the person believes to have given."""
    person.asked(made.label(1))
    person.dialogue.say('fruit')
    view_state = person.taken(accepted=False, reason='object 7 has gone')
    assert (view_state.phase, view_state.prompt.query.query_id) == (Phase.ASKED, 'q1')
    assert view_state.notice == 'The robot did not take that: object 7 has gone'
    person.dialogue.say('fruit')
    assert len({answer.answer_id for _, answer in person.sent}) == 2


def test_the_last_answer_is_taken_back_by_one_that_names_it(person: Any, made: Any) -> None:
    """Otherwise a wrong answer would stay in what the robot knows."""
    person.answered(made.label(1))
    person.asked(made.label(2, object_id=12))
    person.dialogue.undo()
    view_state = person.dialogue.view_state()
    assert (view_state.phase, view_state.prompt.query.query_id) == (Phase.CORRECTING, 'q1')
    assert view_state.corrected.answer.content == 'fruit'
    person.dialogue.say('snack')
    view_state = person.taken()
    correction = person.sent[-1][1]
    assert (correction.query_id, correction.content, correction.replaces) == ('q1', 'snack', 'q1/anna/a1')
    assert correction.answer_id == 'q1/anna/a2'
    assert view_state.notice == 'Noted: object 7 is snack instead.'
    assert (view_state.phase, view_state.prompt.query.query_id) == (Phase.ASKED, 'q2')
    person.dialogue.undo()
    person.dialogue.say('?')
    assert person.sent[-1][1].replaces == 'q1/anna/a2'


def test_a_correction_that_is_refused_leaves_the_question_that_is_open(person: Any, made: Any) -> None:
    """Otherwise a learner that takes no corrections would hold the person in one for ever."""
    person.answered(made.label(1))
    person.asked(made.label(2))
    person.dialogue.undo()
    person.dialogue.say('snack')
    view_state = person.taken(accepted=False, reason='too late')
    assert (view_state.phase, view_state.prompt.query.query_id) == (Phase.ASKED, 'q2')
    assert 'the earlier answer stands: too late' in view_state.notice


def test_to_take_back_twice_leaves_the_answer_as_it_was(person: Any, made: Any) -> None:
    """A person who presses undo by mistake need not answer again."""
    person.answered(made.label(1))
    person.dialogue.undo()
    person.dialogue.undo()
    assert person.dialogue.view_state().phase is Phase.THINKING
    assert len(person.sent) == 1


def test_nothing_can_be_taken_back_before_the_first_answer_or_while_one_is_on_its_way(person: Any, made: Any) -> None:
    """Otherwise undo would ask nothing at all, or two answers would overtake each other."""
    person.asked(made.label(1))
    with pytest.raises(AnswerError, match='nothing to take back'):
        person.dialogue.undo()
    person.dialogue.say('fruit')
    person.taken()
    person.asked(made.label(2))
    person.dialogue.say('fruit')
    with pytest.raises(AnswerError, match='on its way'):
        person.dialogue.undo()
    with pytest.raises(AnswerError, match='nothing is asked'):
        person.dialogue.say('fruit')


def test_a_question_that_others_answered_is_open_no_more(person: Any, made: Any) -> None:
    """Otherwise two teachers, or one who comes back, would be asked what is settled."""
    person.asked(made.label(3))
    person.progress(3, made.record(2))
    assert person.dialogue.view_state().phase is Phase.ASKED
    person.progress(3, made.record(2), made.record(3))
    assert person.dialogue.view_state().phase is Phase.THINKING


def test_the_episode_is_over_when_the_learner_says_so(person: Any, made: Any) -> None:
    """Otherwise the person would wait for a question that never comes."""
    person.progress(8, made.record(2), done=True)
    assert person.dialogue.view_state().phase is Phase.OVER


def test_another_episode_forgets_what_was_asked_in_the_last(person: Any, made: Any) -> None:
    """Otherwise an answer to the first question of one episode would be given to that of the next."""
    person.answered(made.label(1))
    person.dialogue.enter('another')
    assert person.dialogue.view_state().phase is Phase.THINKING
    with pytest.raises(AnswerError, match='nothing to take back'):
        person.dialogue.undo()
    assert person.asked(made.label(1)).phase is Phase.ASKED


def test_acknowledgements_of_others_answers_are_passed_over(person: Any, made: Any) -> None:
    """Otherwise an answer that got lost would be taken for given."""
    person.asked(made.label(1))
    person.dialogue.say('fruit')
    for other in (None, 'q1/plain'):
        person.dialogue.acknowledge(other, True, '')
    assert person.dialogue.view_state().phase is Phase.SENDING


def test_a_picture_of_what_lay_there_before_is_not_shown(person: Any, made: Any) -> None:
    """Otherwise the person would name the thing that has just been taken away."""
    assert person.asked(made.label(1)).prompt.picture is not None
    person.dialogue.look(made.scene_of({1: (0.1, 0.1), 7: (1.2, 0.41), 12: (0.6, 0.7)}), 2)
    assert person.dialogue.view_state().prompt.picture is not None
    person.dialogue.look(made.scene_of({1: (0.1, 0.1), 8: (1.2, 0.4), 12: (0.6, 0.7)}), 3)
    assert person.dialogue.view_state().prompt.picture is None
    person.dialogue.see(made.picture_of(), 3)
    assert person.dialogue.view_state().prompt.picture is not None


def test_a_correction_shows_what_was_there_when_it_was_asked(person: Any, made: Any) -> None:
    """Otherwise the person would correct an answer by looking at another thing."""
    person.answered(made.label(1))
    person.dialogue.look(made.scene_of({20: (0.5, 0.5)}), 2)
    person.dialogue.undo()
    assert person.dialogue.view_state().prompt.scene.object_ids == (1, 7, 12)


def test_what_was_said_before_the_program_began_can_be_taken_back(person: Any, made: Any) -> None:
    """A person who quits and comes back can correct the answer that made them quit, and nobody else can."""
    theirs, query = Answer('q4', 'a7', 'bert', Outcome.ANSWERED, 'snack'), made.label(4)
    person.progress(4, made.record(4), last=(query, theirs))
    with pytest.raises(AnswerError, match='nothing to take back'):
        person.dialogue.undo()
    mine = dataclasses.replace(theirs, teacher_id='anna')
    person.progress(4, made.record(4), last=(query, mine), done=True)
    assert person.dialogue.view_state().can_undo
    person.dialogue.undo()
    view_state = person.dialogue.view_state()
    assert (view_state.phase, view_state.prompt.query, view_state.corrected.answer) == (Phase.CORRECTING, query, mine)
    person.dialogue.say('fruit')
    _, correction = person.sent[-1]
    assert (correction.query_id, correction.replaces, correction.content) == ('q4', 'a7', 'fruit')
    person.taken()
    assert person.dialogue.view_state().phase is Phase.OVER


def test_what_was_said_of_an_earlier_turn_comes_too_late(person: Any, made: Any) -> None:
    """Otherwise a message that took another way would hide the question that is open, or bring an old one back."""
    person.asked(made.label(4))
    person.progress(4, made.record(2))
    assert person.asked(made.label(3)).prompt.query.query_id == 'q4'
    person.progress(2, done=False)
    assert person.dialogue.view_state().progress.turn == 4


def test_a_key_pressed_for_one_question_does_not_answer_the_next(made: Any) -> None:
    """An answer for one thing is not learnt of another when the question changes under the person's hands."""
    now, sent = [10.0], []
    dialogue = TeacherDialogue('anna', lambda *one: sent.append(one), clock=lambda: now[0])
    dialogue.enter('episode')
    dialogue.ask(made.label(1))
    dialogue.ask(made.label(2, object_id=8))
    now[0] += 0.2
    with pytest.raises(AnswerError, match='just asked something else'):
        dialogue.say('fruit')
    now[0] += 0.4
    dialogue.say('fruit')
    assert [answer.query_id for _, answer in sent] == ['q2']


def test_an_answer_that_nobody_replies_to_is_said_to_be_so(made: Any) -> None:
    """Otherwise the person would wait for ever before a learner that has died."""
    now = [100.0]
    dialogue = TeacherDialogue('anna', lambda *_: None, clock=lambda: now[0])
    dialogue.enter('episode')
    dialogue.ask(made.label(1))
    dialogue.say('fruit')
    now[0] += 4.0
    assert dialogue.view_state().notice == ''
    now[0] += 2.0
    assert dialogue.view_state().notice == 'No reply so far; is the learner running, and can it write to its disk?'
    dialogue.enter('another')
    assert dialogue.view_state().notice == ''


def test_who_slips_at_a_word_for_the_program_is_told_which_it_was(person: Any, made: Any) -> None:
    """Otherwise a person who wants to take an answer back would be told to choose among the names."""
    person.asked(made.label(1))
    with pytest.raises(AnswerError, match='did you mean undo'):
        person.dialogue.say('undoo')
