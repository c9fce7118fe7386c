"""Names in the documents, which must exist."""

from __future__ import annotations

import re
import runpy
import shlex
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

from shared.checkout import ROOT

DOCS = ROOT / 'docs'
DOCUMENTS = (
    *(ROOT / name for name in ('README.md', 'CONTRIBUTING.md', 'QUALITY_DECLARATION.md', 'bags/README.md')),
    *sorted(DOCS.rglob('*.md')),
)
SOURCES = {
    path.relative_to(ROOT).as_posix()
    for folder in ('al_questioner', 'benchmarks', 'docs', 'launch', 'test', 'tools')
    for path in (ROOT / folder).rglob('*.py')
}


def prose(document: Path) -> str:
    """The text of a page without its blocks of code."""
    return re.sub(r'^```.*?^```', '', document.read_text(encoding='utf-8'), flags=re.DOTALL | re.MULTILINE)


def named_sources(text: str) -> Iterator[str]:
    """The Python files in a text, by whatever end of their paths it gives."""
    return (found.lstrip('./') for found in re.findall(r'[\w./-]*\w\.py\b', text))


def links(document: Path) -> Iterator[tuple[Path, str]]:
    """Target and anchor of every relative link of a page."""
    for link in re.findall(r'\]\(([^)\s]+)\)', prose(document)):
        if '://' not in link:
            target, _, anchor = link.partition('#')
            yield (document.parent / target).resolve() if target else document, anchor


@cache
def anchors(document: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub and MkDocs make them."""
    headings = re.findall(r'^#+ (.*)', prose(document), flags=re.MULTILINE)
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-') for heading in headings}


def commands(document: Path) -> Iterator[list[str]]:
    """Executable and arguments of every line `python -m al_questioner ...` that a page gives to be copied."""
    text = document.read_text(encoding='utf-8').replace('\\\n', ' ')
    for block in re.findall(r'^```bash\n(.*?)^```', text, flags=re.DOTALL | re.MULTILINE):
        for line in re.findall(r'python -m al_questioner (\w+ [^#;&|\n]+)', block):
            yield shlex.split(re.sub(r'\$\w+', '0', line))


def name_of(document: Path) -> str:
    return document.relative_to(ROOT).as_posix()


@pytest.mark.parametrize('document', DOCUMENTS, ids=name_of)
def test_every_link_leads_to_a_file_and_a_heading(document: Path) -> None:
    """A link that leads nowhere is a fault."""
    assert [target for target, _ in links(document) if not target.exists()] == []
    assert [
        f'{target.name}#{anchor}' for target, anchor in links(document) if anchor and anchor not in anchors(target)
    ] == []


@pytest.mark.parametrize('document', DOCUMENTS, ids=name_of)
def test_every_source_that_a_document_names_is_there(document: Path) -> None:
    """A file that has moved must not stay in a document under its old name."""
    text = document.read_text(encoding='utf-8')
    lost = [name for name in named_sources(text) if not any(f'/{path}'.endswith(f'/{name}') for path in SOURCES)]
    assert lost == []


@pytest.mark.parametrize('document', DOCUMENTS, ids=name_of)
def test_every_command_that_needs_no_ros_is_taken_as_it_stands(document: Path) -> None:
    """No renamed option stays in the documentation; `test_documented_lines.py` tries the nodes."""
    for name, *arguments in commands(document):
        if name in ('demo', 'experiment', 'replay', 'session', 'train_weights'):
            import_module(f'al_questioner.commands.{name}.arguments').parser().parse_args(arguments)


def test_every_page_is_in_the_table_of_contents() -> None:
    """A page that nothing leads to is not read; the site's menu has them all because `make docs` is strict."""
    listed = {target for target, _ in links(DOCS / 'README.md')}
    assert [name_of(page) for page in sorted(DOCS.rglob('*.md')) if page not in listed] == ['docs/README.md']


def test_the_python_api_is_that_of_the_docstrings() -> None:
    """The reference holds no old names: `make generated` writes it again."""
    tool = runpy.run_path(str(ROOT / 'tools' / 'python_api.py'))
    assert tool['PAGE'].read_text(encoding='utf-8') == tool['page']()


def test_folders_that_contributors_are_told_of_are_there() -> None:
    text = (ROOT / 'CONTRIBUTING.md').read_text(encoding='utf-8')
    told = re.findall(r'^\| `([\w/]+)/` \|', text, flags=re.MULTILINE)
    assert [folder for folder in told if not (ROOT / 'al_questioner' / folder).is_dir()] == []
    rooms = {path.parent.name for path in (ROOT / 'al_questioner').glob('*/__init__.py')}
    assert rooms == {folder for folder in told if '/' not in folder}
