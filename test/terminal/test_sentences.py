"""Sentences for the person at the terminal."""

from __future__ import annotations

from typing import Any

from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.terminal.sentences import farewell


def test_the_last_words_fit_what_was_heard(person: Any, made: Any) -> None:
    """Otherwise the last words would say that a robot goes on that was never heard."""
    assert farewell(TeacherDialogue('anna', lambda *_: None).view_state()).startswith('No robot was heard')
    assert farewell(person.dialogue.view_state()).startswith('The robot goes on')
    person.progress(8, made.record(1), done=True)
    assert 'spent on 1 question. Thank you.' in farewell(person.dialogue.view_state())
