"""Sentences for the person at the terminal, in plain English."""

from __future__ import annotations

from al_questioner.domain import NO_SYMBOL, Query, QueryKind
from al_questioner.domain.names import joined
from al_questioner.questioning.dialogue.view_state import EpisodeProgress, Phase, ViewState
from al_questioner.support.safe_text import counted, printable
from al_questioner.support.text import number_of

HELP = (
    'You teach a robot what things are. It asks; every question costs it something of its budget.',
    '"What is object 7?": the name of what it is, or none: it belongs to no name in the list.',
    '"Can you show me a snack?": the number of one on the table, or none: there is no such thing here.',
    '"Which properties matter ...?": the properties that distinguish the names, one or more.',
    '"Which of these things matter?": the numbers of all that have a name in the list, or none: nothing here has.',
    'unknown (?) says that you do not know, skip asks for another question.',
    'undo takes your last answer back: its question is asked again. A second undo keeps the answer.',
    'quit leaves the robot waiting: start this program again, and it goes on where you left.',
)
"""Paragraphs of the help."""


def present_turn(query: Query, progress: EpisodeProgress | None) -> int:
    """Return the turn in which a question waits: a later one than its own if turns have passed without an answer."""
    present = query.turn if progress is None else max(query.turn, progress.turn + 1)
    return min(present, query.turn + query.turns_left)


def price(query: Query, progress: EpisodeProgress | None) -> str:
    """Return the cost of a question, and the rest of the budget after it, as text."""
    of_all = '' if progress is None else f' of {progress.budget:g}'
    return f'costs {query.cost:g}, which leaves {query.budget_left:g}{of_all} of the budget'


def question_line(query: Query, corrects: bool, progress: EpisodeProgress | None = None) -> str:
    """Return a question with its possible answers on one line."""
    nothing = [] if query.action.kind is QueryKind.FEATURE_SUBSET else [NO_SYMBOL]
    parting = ', ' if any(' ' in choice for choice in query.choices) else ' '
    is_list = query.action.kind in (QueryKind.FEATURE_SUBSET, QueryKind.RELEVANCE)
    choices = [joined(query.choices)] if is_list else [*query.choices]
    words = parting.join([*choices, *nothing, '?', 'skip'])
    again = 'correction: ' if corrects else ''
    turns_left = query.turn + query.turns_left - present_turn(query, progress)
    left = f'{price(query, progress)}; turns left {counted(turns_left)}'
    # A scene of a thousand objects is still one line that can be read.
    return f'{printable(query.query_id, 40)}: {again}{printable(query.text)} [{printable(words, 2000)}] ({left})'


def farewell(view_state: ViewState) -> str:
    """Return the last words: how the episode ended, or what to do next."""
    progress = view_state.progress
    if view_state.phase is Phase.OVER and progress is not None:
        questions = number_of(len(progress.records), 'question')
        return f'The episode is over: {progress.spent:g} of {progress.budget:g} spent on {questions}. Thank you.'
    if view_state.phase is Phase.ALONE:
        return 'No robot was heard; start this program again when its learner runs.'
    if view_state.prompt is None:
        return 'The robot goes on; start this program again to answer what it asks next.'
    query = view_state.prompt.query
    question = f'{printable(query.text)} ({printable(query.query_id, 40)})'
    if view_state.phase is Phase.SENDING:
        return f'The robot has not confirmed your answer to: {question} If it did not get it, it will ask again.'
    if view_state.corrected is not None:
        return f'Your earlier answer stands: {question}'
    return f'Left open: {question} Start this program again to answer it.'
