"""The `session` executable."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from al_questioner.commands.session.export import session_document, spoken, status, write_tables
from al_questioner.domain import Answer, Outcome
from al_questioner.domain.names import quoted
from al_questioner.event_log.log import read_log, repair_log
from al_questioner.event_log.summary import SessionSummary, StatedAnswer, summarise_session
from al_questioner.messages.concepts_file import write_concepts
from al_questioner.questioning import Receipt
from al_questioner.support.files import check_writable, write_text
from al_questioner.support.text import number_of


def main(given: argparse.Namespace) -> int:
    """Show a session, and return 0 if its log is whole, 1 if it is damaged."""
    for path in filter(None, (given.json, given.concepts)):
        check_writable(path)
    summary = summarise_session(given.folder, read_log(given.folder))
    console = Console()
    if not console.is_terminal:
        # Through a pipe rich would take 80 columns for the width.
        console = Console(width=200)
    _show(console, summary)
    if given.repair:
        was_damaged = repair_log(given.folder).damage is not None
        _say(console, f'{given.folder}: repaired' if was_damaged else f'{given.folder}: nothing to repair')
    written: list[Path] = []
    if given.json is not None:
        write_text(given.json, json.dumps(session_document(summary), indent=1) + '\n')
        written.append(given.json)
    if given.csv is not None:
        written += write_tables(summary, given.csv)
    if given.concepts is not None:
        write_concepts(given.concepts, summary.knowledge)
        written.append(given.concepts)
    if given.bag is not None:
        # Only now, as a robot may lack what bags need.
        from al_questioner.bags.from_session import write_bag

        write_bag(summary, given.bag)
        written.append(given.bag)
    for path in written:
        _say(console, f'  {path}')
    return 0 if summary.fault is None else 1


def _show(console: Console, summary: SessionSummary) -> None:
    """Print what was asked and said, and whether the log is whole."""
    started, episode = summary.started, summary.episode
    world = '' if started.world is None else f'{started.world["task"]} · '
    _say(console, f'{world}{started.settings.strategy} · seed {started.seed} · episode {started.episode_id}')
    spent = f'{episode.spent:g} of {started.settings.budget:g} spent'
    _say(console, f'turn {episode.turn} of {started.settings.turns}, {spent}{", over" if episode.done else ""}')
    table = Table(show_header=True)
    for column in ('turn', 'query', 'asked', 'said', 'by', 'answer', 'what became of it'):
        table.add_column(column)
    statements = summary.statements
    for statement in statements:
        table.add_row(*map(Text, _row(statement)))
    heard = {statement.answer.query_id for statement in statements}
    for query in (query for query in summary.queries.values() if query.query_id not in heard):
        status = 'pending' if query == episode.pending else 'unanswered, withdrawn'
        table.add_row(*map(Text, (str(query.turn), query.query_id, query.text, '', '', '', status)))
    if table.rows:
        console.print(table)
    accepted = [statement.answer for statement in statements if statement.receipt is Receipt.ACCEPTED]
    corrections = sum(answer.replaces is not None for answer in accepted)
    late, rejected = len(statements) - len(accepted), sum(event.count for _, event in summary.rejected)
    taken = f'{len(accepted) - corrections} taken, {number_of(corrections, "correction")}'
    counts = f'{taken}, {late} late, {rejected} refused'
    _say(console, f'answers: {counts}')
    for name, record in episode.teachers.items():
        told = f'{record.answered} answered, {record.unknown} unknown, {record.skipped} skipped'
        others = f'{record.corrected} corrected, {record.late} late'
        estimate = f'; labels right with an estimated {record.reliability:.0%}' if record.answered else ''
        _say(console, f'{name}: {told}, {others}{estimate}')
    if summary.fault is None:
        _say(console, f'{summary.folder}: whole, {len(summary.events)} events; playing them gives the same decisions')
    else:
        recovered = f'recovered: {len(summary.events)} events, {summary.turns_over} whole turns'
        _say(console, f'{summary.folder}: DAMAGED: {summary.fault}; {recovered}')


def _row(statement: StatedAnswer) -> tuple[str, ...]:
    answer, query, became = statement.answer, statement.query, status(statement)
    return (
        '' if query is None else str(query.turn),
        answer.query_id,
        '' if query is None else query.text,
        _said(answer),
        answer.teacher_id,
        answer.answer_id,
        became if answer.replaces is None else f'replaces {answer.replaces}; {became}',
    )


def _said(answer: Answer) -> str:
    """Return a content, or the outcome in its place; a symbol of the same name is put in quotes."""
    content = spoken(answer.content)
    return quoted(content) if content in [outcome.value for outcome in Outcome] else content or answer.outcome.value


def _say(console: Console, line: str) -> None:
    console.print(line, markup=False, highlight=False, soft_wrap=True)
