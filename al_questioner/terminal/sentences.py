"""Sentences for the person at the terminal, in plain English."""

from __future__ import annotations

from collections.abc import Sequence

from al_questioner.domain import NO_SYMBOL, Action, Answer, Outcome, Query, QueryKind, QueryRecord
from al_questioner.domain.names import joined
from al_questioner.support.text import number_of
from al_questioner.terminal.safe_text import counted, printable
from al_questioner.terminal.view_state import EpisodeProgress, Phase, ViewState

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


def said_in_words(action: Action, answer: Answer) -> str:
    """Return an answer to a question as a sentence."""
    if answer.outcome is not Outcome.ANSWERED:
        return _unanswered(action, answer.outcome)
    content = answer.content
    if action.kind is QueryKind.RELEVANCE:
        return _mattering(tuple(content) if isinstance(content, tuple) else ())
    if isinstance(content, tuple):
        return f'what matters is {_listed(content)}'
    if action.kind is QueryKind.LABEL:
        return _is(action.object_id, str(content))
    return _shown(action.symbol, None if content == NO_SYMBOL else int(str(content)))


def recorded_in_words(record: QueryRecord) -> str:
    """Return the result of an earlier question, from the learner's records, as a sentence."""
    if record.outcome is not Outcome.ANSWERED:
        return _unanswered(Action(record.kind, record.object_id, record.symbol), record.outcome)
    if record.kind is QueryKind.FEATURE_SUBSET:
        return f'what matters is {_listed(record.groups)}'
    if record.kind is QueryKind.RELEVANCE:
        return _mattering(record.objects or ())
    if record.kind is QueryKind.LABEL:
        return _is(record.object_id, str(record.symbol))
    return _shown(record.symbol, record.object_id)


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


def _unanswered(action: Action, outcome: Outcome) -> str:
    about = {
        QueryKind.LABEL: f'object {action.object_id}',
        QueryKind.DEMONSTRATION: _name(action.symbol),
        QueryKind.FEATURE_SUBSET: 'what matters',
        QueryKind.RELEVANCE: 'which things matter',
    }.get(action.kind, '')
    said = {Outcome.UNKNOWN: 'you do not know', Outcome.SKIP: 'skipped'}
    return f'{about}: {said.get(outcome, "nobody answered")}'


def _is(object_id: int | None, symbol: str) -> str:
    return f'object {object_id} is ' + ('none of these' if symbol == NO_SYMBOL else _name(symbol))


def _shown(symbol: str | None, object_id: int | None) -> str:
    return f'{_name(symbol)}: ' + ('none is here' if object_id is None else f'object {object_id}')


def _mattering(objects: Sequence[object]) -> str:
    return 'of these things ' + (
        f'{_listed(objects)} {"matters" if len(objects) == 1 else "matter"}' if objects else 'none matters'
    )


def _listed(names: Sequence[object]) -> str:
    return printable(', '.join(map(str, names)), 200)


def _name(symbol: str | None) -> str:
    return printable(str(symbol), 60)
