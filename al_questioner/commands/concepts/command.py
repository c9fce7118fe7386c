"""The `concepts` executable."""

from __future__ import annotations

import argparse
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from al_questioner.commands.concepts.export import write_examples
from al_questioner.concepts.editing import (
    with_symbol,
    with_symbol_renamed,
    without_example,
    without_examples_of,
    without_symbol,
)
from al_questioner.concepts.merging import joined_knowledge, settled
from al_questioner.domain import NO_SYMBOL, InputError, Knowledge, ViewLabel
from al_questioner.domain.settlement import REFUSE
from al_questioner.messages.concepts_file import read_concepts, write_concepts
from al_questioner.messages.knowledge_members import time_text
from al_questioner.questioning.review import doubtful_labels, reviewed
from al_questioner.support.files import check_writable
from al_questioner.support.text import number_of


def main(given: argparse.Namespace) -> int:
    """Show what is known, and write it, merged and changed as asked."""
    parts = [(str(path), read_concepts(path)) for path in given.files]
    for path in filter(None, (given.out, given.csv)):
        check_writable(path)
    # What is there may be something else, by a mistake.
    if given.out is not None and given.out.exists() and not _is_concepts_file(given.out):
        raise InputError(f'--out would overwrite {given.out}, which is no concepts file')
    if given.csv is not None and given.csv.exists() and _is_concepts_file(given.csv):
        raise InputError(f'--csv would overwrite {given.csv}, a concepts file')
    console = Console()
    if not console.is_terminal:
        # Through a pipe rich would take 80 columns for the width.
        console = Console(width=200)
    knowledge = _merged(console, parts, given)
    for each in given.remove:
        remove = without_example if isinstance(each, int) else without_examples_of
        knowledge = remove(knowledge, each)
    for old, new in given.rename:
        knowledge = with_symbol_renamed(knowledge, old, new)
    for symbol in given.drop:
        knowledge = without_symbol(knowledge, symbol)
    for symbol in given.add:
        knowledge = with_symbol(knowledge, symbol)
    if knowledge.statistics is None:
        knowledge = reviewed(knowledge)
    _show(console, knowledge, given.examples)
    is_another = len(parts) > 1 or given.remove or given.rename or given.drop or given.add
    if is_another and given.out is None and given.csv is None:
        _say(console, 'nothing is written: --out FILE keeps this')
    if given.out is not None:
        write_concepts(given.out, knowledge)
        _say(console, f'  {given.out}')
    if given.csv is not None:
        write_examples(given.csv, knowledge)
        _say(console, f'  {given.csv}')
    return 0


def _is_concepts_file(path: Path) -> bool:
    try:
        read_concepts(path)
    except InputError:
        return False
    return True


def _merged(console: Console, parts: list[tuple[str, Knowledge]], given: argparse.Namespace) -> Knowledge:
    """Return what is known by all, with the contradictions named and settled as asked.

    Raises:
        InputError: the files do not fit, or their contradictions are not to be settled and would be written.
    """
    if len(parts) == 1 and given.settle == REFUSE:
        return parts[0][1]
    joined = joined_knowledge(parts)
    merged, contradictions = settled(joined, given.settle, reviewed(joined).reliabilities)
    for contradiction in contradictions:
        _say(console, str(contradiction))
    if contradictions and given.settle == REFUSE and (given.out is not None or given.csv is not None):
        count = number_of(len(contradictions), 'view was', 'views were')
        raise InputError(
            f'{count} called several things, first: {contradictions[0]}; --settle newest or --settle reliable decides'
        )
    for name, part in parts[1:]:
        if (part.classifiers, part.length_scale) != (merged.classifiers, merged.length_scale):
            _say(console, f'{name}: {part.classifiers}; taken are those of {parts[0][0]}: {merged.classifiers}')
    return merged


def _show(console: Console, knowledge: Knowledge, with_examples: bool) -> None:
    """Print what is known."""
    counts, relevant = knowledge.counts, knowledge.relevant_groups
    count = number_of(sum(counts.values()), 'example')
    _say(console, f'{count} among {number_of(len(knowledge.views), "view")}; {knowledge.classifiers}')
    told = f'a teacher called {", ".join(relevant)} relevant' if relevant else 'no teacher was asked which are relevant'
    features = number_of(len(knowledge.feature_names), 'feature')
    _say(console, f'{features} of the groups {", ".join(knowledge.groups)}; {told}')
    names = dict(zip(counts, (*knowledge.symbols, f'{NO_SYMBOL} of these'), strict=True))
    _print(console, ('symbol', 'examples'), [(names[name], str(number)) for name, number in counts.items()])
    _print(
        console,
        ('teacher', 'answered', 'unknown', 'skipped', 'corrected', 'late', 'labels right, estimated'),
        [
            (name, *(str(number) for number in vars(answers).values()), _share(knowledge.reliabilities.get(name)))
            for name, answers in knowledge.teachers.items()
        ],
    )
    _print(
        console,
        ('episode', 'task', 'asked by', 'examples'),
        [
            (
                origin.episode,
                '' if origin.world is None else str(origin.world['task']),
                origin.strategy,
                str(sum(lesson.episode == origin.episode for lesson, _ in knowledge.examples)),
            )
            for origin in knowledge.origins
        ],
    )
    if with_examples:
        _print(console, ('view', 'label', 'teacher', 'time', 'episode', 'turn', 'object'), _examples(knowledge))
    doubtful = doubtful_labels(knowledge)
    if doubtful:
        _say(console, 'doubtful labels, which the other labels contradict:')
        _print(
            console,
            ('view', 'label', 'teacher', 'time', 'probability', 'by the others', 'probability'),
            [
                (
                    str(doubt.label.view),
                    _label(doubt.label),
                    knowledge.teacher_of(doubt.lesson, doubt.label),
                    _time(doubt.lesson.stamp),
                    f'{doubt.belief:.2f}',
                    doubt.likely,
                    f'{doubt.likelihood:.2f}',
                )
                for doubt in doubtful
            ],
        )


def _examples(knowledge: Knowledge) -> list[tuple[str, ...]]:
    return [
        (
            str(label.view),
            _label(label),
            knowledge.teacher_of(lesson, label),
            _time(lesson.stamp),
            lesson.episode,
            str(lesson.turn),
            str(knowledge.views[label.view].object_id),
        )
        for lesson, label in knowledge.examples
    ]


def _label(label: ViewLabel) -> str:
    return label.label if label.carried_from is None else f'{label.label}, carried from {label.carried_from}'


def _print(console: Console, columns: tuple[str, ...], rows: list[tuple[str, ...]]) -> None:
    if not rows:
        return
    table = Table(show_header=True)
    for column in columns:
        table.add_column(column)
    for row in rows:
        table.add_row(*map(Text, row))
    console.print(table)


def _time(stamp: int | None) -> str:
    return '' if stamp is None else time_text(stamp)[:19]


def _share(share: float | None) -> str:
    return '' if share is None else f'{share:.0%}'


def _say(console: Console, line: str | Path) -> None:
    console.print(str(line), markup=False, highlight=False, soft_wrap=True)
