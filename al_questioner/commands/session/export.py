"""A session as JSON, and as tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from al_questioner.domain import NO_SYMBOL, Content, InputError, Query
from al_questioner.domain.names import joined
from al_questioner.event_log.summary import SessionSummary, StatedAnswer
from al_questioner.messages.documents import record_members, settings_members
from al_questioner.questioning import Receipt
from al_questioner.simulation import Evaluation, WorldSpec, load_task
from al_questioner.support.files import write_text

ANSWER_COLUMNS = (
    *('time', 'turn', 'query_id', 'kind', 'object_id', 'symbol', 'cost'),
    *('answer_id', 'teacher_id', 'outcome', 'content', 'replaces', 'status'),
)
TURN_COLUMNS = (
    *('turn', 'stamp', 'objects', 'kind', 'object_id', 'symbol', 'query_id'),
    *('cost', 'outcome', 'groups', 'answered_in', 'relevant'),
)


def session_document(summary: SessionSummary) -> dict[str, Any]:
    """Return the JSON of an episode (docs/reference/documents.md), with accuracy only if its world is simulated."""
    started, records = summary.started, summary.episode.records
    accuracy, reason = measured_accuracy(summary)
    settings = settings_members(started.settings)
    # The fingerprint tells what it was; `--concepts` writes all that is known.
    settings.pop('concepts', None)
    return {
        'task': None if started.world is None else started.world['task'],
        'strategy': settings.pop('strategy'),
        'seed': started.seed,
        'budget': settings.pop('budget'),
        'turns': settings.pop('turns'),
        'spent': sum(record.cost for record in records),
        'final_accuracy': accuracy[-1] if accuracy else None,
        'accuracy': accuracy,
        'queries': [record_members(record) for record in records],
        'no_accuracy_because': reason,
        'episode_id': started.episode_id,
        'sample': None if started.world is None else started.world['sample'],
        'dataset': None if started.world is None else started.world['dataset'],
        **settings,
        'view_tolerance': started.view_tolerance,
        'kernel': asdict(summary.episode.concepts.kernel) if summary.episode.turn else None,
        'teachers': {name: asdict(record) for name, record in summary.episode.teachers.items()},
        'turns_over': summary.turns_over,
        'damage': summary.fault,
        'version': started.version,
    }


def measured_accuracy(summary: SessionSummary) -> tuple[list[float], str | None]:
    """Accuracy on held-out observations after each turn that is over, with all corrections, or why it is not known."""
    world = summary.started.world
    if world is None:
        return [], 'the world was not simulated'
    try:
        dataset = None if world['dataset'] is None else Path(world['dataset'])
        world_spec = WorldSpec(load_task(world['task']), world['seed'], world['sample'], dataset)
        episode, settings = summary.episode, summary.started.settings
        beyond = [symbol for symbol in world_spec.task.symbols if symbol not in settings.symbols]
        if beyond:
            return [], f'the world has things of {", ".join(beyond)}, which nobody could say'
        evaluation = Evaluation(world_spec, settings, episode.strategy.selector, tuned_turns=episode.tuned_turns)
        by_turn = {record.turn: record for record in episode.records}
        for observed in summary.observed[: summary.turns_over]:
            if not evaluation.world.scene(observed.turn).equals(observed.scene):
                return [], f'the scene of turn {observed.turn} is not that of the simulated world'
            evaluation.next_turn(by_turn.get(observed.turn))
    except InputError as error:
        return [], str(error)
    return (list(evaluation.result().accuracy), None) if evaluation.turn else ([], 'no turn is over')


def write_tables(summary: SessionSummary, folder: Path) -> list[Path]:
    """Write `answers.csv`, all that was said, and `turns.csv`, what came of each turn.

    Raises:
        InputError: they cannot be written.
    """
    paths = [folder / 'answers.csv', folder / 'turns.csv']
    _write(paths[0], ANSWER_COLUMNS, _answer_rows(summary))
    _write(paths[1], TURN_COLUMNS, _turn_rows(summary))
    return paths


def spoken(content: Content) -> str:
    """Return a content as one cell; several parts are parted by commas, those that hold one in quotes.

    That nothing matters is `NO_SYMBOL`, as people say it.
    """
    if content is None:
        return ''
    return (joined(map(str, content)) or NO_SYMBOL) if isinstance(content, tuple) else str(content)


def status(statement: StatedAnswer) -> str:
    """Describe what became of an answer."""
    if statement.receipt is Receipt.LATE:
        return 'late'
    return 'taken' if statement.replaced_by is None else f'taken, then replaced by {statement.replaced_by}'


def time_of(stamp: int) -> str:
    """Nanoseconds since the epoch, in UTC to the millisecond."""
    return datetime.fromtimestamp(stamp / 1e9, timezone.utc).isoformat(timespec='milliseconds')


def _answer_rows(summary: SessionSummary) -> list[list[object]]:
    rows: list[tuple[int, list[object]]] = []
    for statement in summary.statements:
        answer = statement.answer
        told = [answer.answer_id, answer.teacher_id, answer.outcome.value, spoken(answer.content)]
        asked = _asked(statement.query) or [None, answer.query_id, None, None, None, None]
        became = status(statement)
        rows.append((statement.stamp, [time_of(statement.stamp), *asked, *told, answer.replaces, became]))
    for stamp, rejected in summary.rejected:
        unknown = [None] * 9
        rows.append((stamp, [time_of(stamp), *unknown, rejected.text, None, f'refused: {rejected.reason}']))
    return [row for _, row in sorted(rows, key=lambda row: row[0])]


def _asked(query: Query | None) -> list[object]:
    if query is None:
        return []
    action = query.action
    return [query.turn, query.query_id, action.kind.value, action.object_id, action.symbol, query.cost]


def _turn_rows(summary: SessionSummary) -> list[list[object]]:
    records = {record.turn: record for record in summary.episode.records}
    queries = {query.turn: query for query in summary.queries.values()}
    rows: list[list[object]] = []
    for observed in summary.observed:
        query, record = queries.get(observed.turn), records.get(observed.turn)
        kind = 'no_query' if query is None else query.action.kind.value
        object_id, symbol = (None, None) if query is None else (query.action.object_id, query.action.symbol)
        came: list[object] = [None, None, '', None, '']
        if record is not None:
            object_id, symbol = record.object_id, record.symbol
            came = [
                record.cost,
                record.outcome.value,
                joined(record.groups),
                record.answered_in,
                spoken(record.objects),
            ]
        asked = [kind, object_id, symbol, query and query.query_id]
        rows.append([observed.turn, observed.stamp, len(observed.scene), *asked, *came])
    return rows


def _write(path: Path, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(columns)
    writer.writerows(rows)
    write_text(path, text.getvalue())
