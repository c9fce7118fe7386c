"""The folder of an experiment: what was played, with what, and the tables made from it."""

from __future__ import annotations

import csv
import io
import json
import os
import platform
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from al_questioner import __version__
from al_questioner.domain import CARRY_LABELS, InputError, SettingsError
from al_questioner.experiments.plan import Cell, Plan, task_label
from al_questioner.experiments.playing import EPISODE_COLUMNS, TURN_COLUMNS, Played, Row
from al_questioner.experiments.semantics import semantics_of
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.support.differences import differences
from al_questioner.support.files import make_folder, write_text


class Store:
    """The folder of an experiment: a manifest, a file for each finished cell, and the tables made from them.

    Raises:
        InputError: the folder cannot be written to, or holds an experiment that cannot be continued: of another
            version of the method, or with other variations or worlds.
    """

    def __init__(self, folder: Path, plan: Plan, dataset: str = '') -> None:
        self.folder, self.plan, self.dataset = folder, plan, dataset
        self._cells = folder / 'cells'
        make_folder(self._cells)
        manifest = folder / 'manifest.json'
        # Where nothing was played yet, nothing can be mixed up.
        is_begun = manifest.is_file() and any(self._cells.rglob('*.json'))
        before = _read_manifest(manifest) if is_begun else {}
        members = {'version': __version__, 'semantics': SEMANTICS, 'dataset': dataset, **plan.document()}
        worlds = {name: plan.task_document(name) for name in plan.tasks}
        document = json.loads(json.dumps({**members, 'seeds': list(plan.samples), 'worlds': worlds}))
        if before:
            _check_same(folder, before, document)
        document['worlds'] = {**before.get('worlds', {}), **document['worlds']}
        document['runs'] = [*before.get('runs', []), _machine()]
        write_text(manifest, json.dumps(document, indent=1) + '\n')

    def load(self, cell: Cell) -> Played | None:
        """Load what was stored of a cell; return None if nothing usable was."""
        try:
            document = json.loads(self._path(cell).read_text(encoding='utf-8'))
            return Played(cell, document['episode'], tuple(document['turns']))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def finished(self) -> int:
        """Count the stored cells of the plan."""
        return sum(self.load(cell) is not None for cell in self.plan.cells())

    def missing(self) -> list[tuple[Cell, ...]]:
        """Return the cells that nothing is stored of, together those that share a world."""
        groups = (tuple(cell for cell in group if self.load(cell) is None) for group in self.plan.groups())
        return [group for group in groups if group]

    def save(self, played: Played) -> None:
        """Store a cell; a crash meanwhile leaves no half of it."""
        write_text(self._path(played.cell), json.dumps({'episode': played.episode, 'turns': played.turns}))

    def write_tables(self) -> list[Path]:
        """Write `episodes.csv` and `turns.csv` from what is stored of the plan, sorted."""
        stored = [played for cell in sorted(self.plan.cells()) if (played := self.load(cell)) is not None]
        episodes, turns = self.folder / 'episodes.csv', self.folder / 'turns.csv'
        _write_csv(episodes, EPISODE_COLUMNS, (played.episode for played in stored))
        _write_csv(turns, TURN_COLUMNS, (row for played in stored for row in played.turns))
        return [episodes, turns]

    def _path(self, cell: Cell) -> Path:
        condition = f'{cell.condition}'.replace('/', '-')
        return self._cells / task_label(cell.task) / condition / cell.strategy / f'{cell.sample}.json'


def _read_manifest(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError) as error:
        raise InputError(f'{path} cannot be read ({error})') from error
    if not isinstance(found, dict):
        raise InputError(f'{path} is no manifest of an experiment')
    return found


def _check_same(folder: Path, before: Mapping[str, Any], now: Mapping[str, Any]) -> None:
    """Hold two manifests against each other; an experiment may grow by tasks, conditions, strategies and samples."""
    tasks = before.get('worlds', {}).keys() & now['worlds'].keys()
    theirs, ours = (
        {
            'semantics': semantics_of(document),
            'dataset': document.get('dataset'),
            # Experiments of earlier versions do not tell of it.
            CARRY_LABELS.name: False,
            **document.get('variation', {}),
            **{name: document['worlds'][name] for name in sorted(tasks)},
        }
        for document in (before, now)
    )
    if differing := differences(theirs, ours):
        raise SettingsError(f'{folder} holds an experiment with {"; ".join(differing)}: choose another folder')


def _machine() -> dict[str, Any]:
    """Describe where and when it was run, for people."""
    return {
        'python': platform.python_version(),
        'numpy': np.__version__,
        'scipy': scipy.__version__,
        'platform': platform.platform(),
        'processor': platform.machine(),
        'cores': os.cpu_count(),
        'begun': time.strftime('%Y-%m-%dT%H:%M:%S%z'),
    }


def _write_csv(path: Path, columns: Sequence[str], rows: Iterator[Row]) -> None:
    table = io.StringIO()
    writer = csv.DictWriter(table, columns)
    writer.writeheader()
    writer.writerows(rows)
    write_text(path, table.getvalue())
