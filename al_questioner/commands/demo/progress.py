"""Questions and answers of an episode as they come, above a progress bar."""

from __future__ import annotations

from rich import progress as bars
from rich.console import Console
from rich.markup import escape

from al_questioner.domain import NO_SYMBOL, Action, EpisodeSettings, Outcome, QueryKind, QueryRecord
from al_questioner.questioning.question_wording import question_text
from al_questioner.simulation import Task
from al_questioner.support.text import number_of


class ProgressView:
    """A context manager; tell it of each turn."""

    def __init__(self, console: Console, task: Task, settings: EpisodeSettings) -> None:
        self._console = console
        self._settings = settings
        self._spent = 0.0
        console.print(
            f'[bold]{escape(task.name)}[/bold]: learning {escape(", ".join(settings.symbols))} by asking'
            f' ({settings.strategy}, budget {settings.budget:g}, {number_of(settings.turns, "turn")})',
            soft_wrap=True,
        )
        self._bar = bars.Progress(
            bars.TextColumn('turn {task.completed:.0f}/{task.total:.0f}'),
            bars.BarColumn(),
            bars.TextColumn('{task.description}'),
            console=console,
            transient=True,
        )
        self._task = self._bar.add_task('starting the nodes and looking at the first scene', total=settings.turns)

    def __enter__(self) -> ProgressView:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def after_turn(self, turn: int, record: QueryRecord | None, accuracy: float) -> None:
        """Show a turn that has ended."""
        if record is not None:
            self._spent += record.cost
            question = question_text(Action(record.kind, record.object_id, record.symbol), self._settings.symbols)
            self._console.print(
                f'turn {turn:>3}  {escape(question)}  [green]{escape(answer_text(record))}[/green]',
                highlight=False,
                soft_wrap=True,
            )
        self._bar.update(
            self._task,
            completed=turn,
            description=f'spent {self._spent:g}/{self._settings.budget:g} · accuracy {accuracy:.2f}',
        )


def answer_text(record: QueryRecord) -> str:
    """Return the teacher's answer in plain English."""
    if record.outcome is Outcome.UNKNOWN:
        return 'I do not know.'
    if record.outcome is Outcome.SKIP:
        return 'Skip that.'
    if record.outcome is Outcome.UNANSWERED:
        return 'Nobody answers.'
    if record.kind is QueryKind.FEATURE_SUBSET:
        return f'{", ".join(record.groups)}.'
    if record.kind is QueryKind.RELEVANCE:
        things = ', '.join(map(str, sorted(record.objects or ())))
        return f'Object{"s" if len(record.objects or ()) > 1 else ""} {things}.' if things else 'Nothing here.'
    if record.kind is QueryKind.DEMONSTRATION:
        return 'None is here.' if record.object_id is None else f'Object {record.object_id}.'
    return 'None of these.' if record.symbol == NO_SYMBOL else f'{record.symbol}.'
