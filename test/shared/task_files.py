"""Task files that ship, and those that a test writes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from shared.checkout import ROOT


def task_content(name: str) -> dict[str, Any]:
    """The content of a task file that ships."""
    content: dict[str, Any] = yaml.safe_load((ROOT / 'config' / 'tasks' / f'{name}.yaml').read_text(encoding='utf-8'))
    return content


def write_task(folder: Path, content: object) -> str:
    """Write a task file `mine`; its path."""
    path = folder / 'mine.yaml'
    path.write_text(yaml.safe_dump(content), encoding='utf-8')
    return str(path)
