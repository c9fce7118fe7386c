"""An episode in numbers: as JSON, and as a table for people."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict
from typing import Any

from rich.markup import escape
from rich.table import Table

from al_questioner import __version__
from al_questioner.domain import QueryKind
from al_questioner.messages.documents import costs_members, record_members
from al_questioner.simulation import EpisodeResult, PerceivedWorld, ScriptedTeacher
from al_questioner.support.text import number_of


def episode_document(result: EpisodeResult, teacher: ScriptedTeacher, world: PerceivedWorld) -> dict[str, Any]:
    """Return the JSON of a learning episode (docs/reference/documents.md), from which it can be played again."""
    world_spec, settings = result.world_spec, result.settings
    return {
        'task': world_spec.task.name,
        'strategy': settings.strategy,
        'seed': world_spec.seed,
        'budget': settings.budget,
        'turns': settings.turns,
        'spent': result.spent,
        'final_accuracy': result.final_accuracy,
        'accuracy': list(result.accuracy),
        'queries': [record_members(record) for record in result.queries],
        'test_images': result.test_size,
        'mean_accuracy': sum(result.accuracy) / len(result.accuracy),
        'scene_changes': world.change_turns(settings.turns),
        'sample': world_spec.sample,
        'dataset': None if world_spec.dataset is None else str(world_spec.dataset),
        'dataset_report': world.report().splitlines(),
        'symbols': list(settings.symbols),
        'weights': dict(settings.weights),
        'costs': costs_members(settings.costs),
        'change_interval': settings.change_interval,
        **settings.classifiers._asdict(),
        'length_scale': settings.length_scale,
        'carry_labels': settings.carry_labels,
        'kernel': asdict(result.kernel),
        'wrong_rate': teacher.wrong_rate,
        'unknown_rate': teacher.unknown_rate,
        'relevance_omission': teacher.relevance_omission,
        'relevance_false_alarm': teacher.relevance_false_alarm,
        'repeat_shown': teacher.repeat_shown,
        'version': __version__,
    }


def labels_told(result: EpisodeResult) -> dict[str, int]:
    """Count how often the teacher named each symbol, and `none`; every symbol is there."""
    told = Counter(record.symbol for record in result.queries if record.object_id is not None and record.symbol)
    return {symbol: told.pop(symbol, 0) for symbol in result.settings.symbols} | dict(told)


def summary(result: EpisodeResult, views: str = 'images') -> Table:
    """Return the lines that a person reads at the end; `views` says what the test observations are."""
    settings = result.settings
    kinds = Counter(record.kind for record in result.queries)
    asked = ', '.join(f'{kinds[kind]} {kind.value.replace("_", " ")}' for kind in QueryKind if kinds[kind])
    table = Table(
        title=f'{escape(result.world_spec.task.name)} · {settings.strategy} · seed {result.world_spec.seed}',
        show_header=False,
        title_justify='left',
    )
    chance = 1 / len(settings.symbols)
    table.add_row(
        f'accuracy on held-out {views}',
        f'[bold]{result.final_accuracy:.2f}[/bold] on {result.test_size} {views} (chance {chance:.2f})',
    )
    table.add_row('mean accuracy over the turns', f'{sum(result.accuracy) / len(result.accuracy):.2f}')
    turns = number_of(settings.turns, 'turn')
    table.add_row('budget spent', f'{result.spent:g} of {settings.budget:g}, in {turns}')
    table.add_row('queries', f'{len(result.queries)}: {asked}' if asked else 'none')
    told = ', '.join(f'{count} {symbol}' for symbol, count in labels_told(result).items())
    table.add_row('named', escape(told))
    return table
