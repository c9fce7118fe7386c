"""Examples as a table."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from al_questioner.domain import Knowledge
from al_questioner.messages.knowledge_members import readable, time_text
from al_questioner.support.files import write_text

COLUMNS = ('view', 'label', 'kind', 'teacher', 'time', 'episode', 'turn', 'object')
CARRIED = 'carried'
"""Word in the place of the kind of question for a label that was carried from another view."""


def write_examples(path: Path, knowledge: Knowledge) -> None:
    """Write a row for each example, with a column for each feature behind `COLUMNS`.

    Raises:
        InputError: it cannot be written.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow((*COLUMNS, *knowledge.feature_names))
    for lesson, label in knowledge.examples:
        view = knowledge.views[label.view]
        writer.writerow(
            (
                label.view,
                label.label,
                CARRIED if label.is_carried else '' if lesson.kind is None else lesson.kind.value,
                knowledge.teacher_of(lesson, label),
                '' if lesson.stamp is None else time_text(lesson.stamp),
                lesson.episode,
                lesson.turn,
                view.object_id,
                *readable(view.features),
            )
        )
    write_text(path, text.getvalue())
