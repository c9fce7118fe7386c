"""What the documents name is there."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from checkout import ROOT

DOCUMENTS = (ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').rglob('*.md')))
SOURCES = {
    path.relative_to(ROOT).as_posix()
    for folder in ('al_questioner', 'benchmarks', 'docs', 'launch', 'test')
    for path in (ROOT / folder).rglob('*.py')
}


def named_sources(text: str) -> Iterator[str]:
    """The Python files in a text, by whatever end of their paths it gives."""
    return (found.lstrip('./') for found in re.findall(r'[\w./-]*\w\.py\b', text))


@pytest.mark.parametrize('document', DOCUMENTS, ids=lambda path: path.name)
def test_every_file_that_a_document_names_is_there(document: Path) -> None:
    """Whoever follows it would look for a file that has moved."""
    text = document.read_text(encoding='utf-8')
    linked = [link.split('#')[0] for link in re.findall(r'\]\(([^)\s]+)\)', text) if '://' not in link]
    assert [link for link in linked if not (document.parent / link).exists()] == []
    lost = [name for name in named_sources(text) if not any(f'/{path}'.endswith(f'/{name}') for path in SOURCES)]
    assert lost == []


def test_folders_that_contributors_are_told_of_are_there() -> None:
    text = (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')
    told = re.findall(r'^\| `([\w/]+)/` \|', text, flags=re.MULTILINE)
    assert [folder for folder in told if not (ROOT / 'al_questioner' / folder).is_dir()] == []
    rooms = {path.parent.name for path in (ROOT / 'al_questioner').glob('*/__init__.py')}
    assert rooms == {folder for folder in told if '/' not in folder}
