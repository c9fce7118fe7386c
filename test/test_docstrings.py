"""The rules of plain English, held against docstrings and all other texts."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import pytest

from shared.checkout import ROOT

PACKAGE = 'al_questioner'
OTHER_FOLDERS = ('benchmarks', 'launch', 'test', 'tools')

QUESTIONS = {'What', 'How', 'That', 'Which', 'Who', 'Whoever', 'Whose', 'When', 'Where', 'Whether', 'Why', 'If'}
ARTICLES = {'The', 'A', 'An'}
PREPOSITIONS = {
    *('Above', 'After', 'Among', 'As', 'At', 'Before', 'Below', 'Beside', 'Between', 'Beyond', 'By', 'During', 'For'),
    *('From', 'In', 'Of', 'On', 'Out', 'Since', 'To', 'Until', 'Up', 'With', 'Within', 'Without'),
}
FORBIDDEN_WORDS = {
    'function': {*QUESTIONS, *ARTICLES, *PREPOSITIONS, '('},
    'property': {*QUESTIONS, *PREPOSITIONS, 'Return', '('},
    'constant': {*QUESTIONS, *PREPOSITIONS},
    'class': QUESTIONS,
    'module': QUESTIONS,
}
"""First words that a docstring of the package may not have, by what it describes."""

QUAINT = re.compile(r'\b(amiss|anew|beforehand|heeds?|in vain|lest|nought|of before|unawares|whoever)\b', re.IGNORECASE)
"""Old-fashioned words that a reader may not know."""


class Docstring(NamedTuple):
    """The docstring of something, at a line of its module."""

    kind: str
    line: int
    text: str


def docstrings(source: str) -> Iterator[Docstring]:
    """Yield all docstrings of a module, those of its constants and of the fields of its classes included."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            if text := ast.get_docstring(node):
                yield Docstring(kind_of(node), node.body[0].lineno, text)
            for target, after in pairwise(node.body):
                if isinstance(target, (ast.Assign, ast.AnnAssign)) and (text := text_of(after)):
                    yield Docstring('constant', after.lineno, text)


def kind_of(node: ast.AST) -> str:
    """Return the kind of a definition; a fixture is like a property, a value with a name."""
    if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
        is_value = any(re.search('property|fixture', ast.unparse(one)) for one in node.decorator_list)
        return 'property' if is_value else 'function'
    return 'class' if isinstance(node, ast.ClassDef) else 'module'


def text_of(statement: ast.stmt) -> str | None:
    """Return the text that a statement consists of, if it is one."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    return value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else None


def is_unclear(docstring: Docstring, folder: str = PACKAGE) -> bool:
    """Return whether a docstring begins with a word that it may not have in a folder."""
    forbidden = FORBIDDEN_WORDS[docstring.kind] if folder == PACKAGE else {*QUESTIONS, 'By'}
    return re.match(r"\(|[\w']+|", docstring.text.strip())[0] in forbidden


@pytest.mark.parametrize('folder', [PACKAGE, *OTHER_FOLDERS])
def test_the_docstrings_are_plain_english(folder: str) -> None:
    for path in (ROOT / folder).rglob('*.py'):
        each = docstrings(path.read_text(encoding='utf-8'))
        assert not [(one.line, one.text) for one in each if is_unclear(one, folder)], path


def test_no_text_is_quaint() -> None:
    paths = [path for folder in (PACKAGE, *OTHER_FOLDERS, 'config', 'docs') for path in (ROOT / folder).rglob('*.*')]
    for path in (*paths, *ROOT.glob('*.md')):
        if path.suffix in ('.md', '.py', '.yaml') and path.name != 'test_docstrings.py':
            assert not QUAINT.search(path.read_text(encoding='utf-8')), path


@pytest.mark.parametrize(
    'source',
    [
        'def size():\n    """The number of bytes."""',
        'def size():\n    """(n,) the numbers of bytes."""',
        'class Reader:\n    def size(self):\n        """How many bytes."""',
        'def outer():\n    def inner():\n        """Whether it is empty."""',
        'class Reader:\n    @property\n    def size(self):\n        """Of the file, in bytes."""',
        'class Reader:\n    @cached_property\n    def size(self):\n        """Return the size."""',
        'class Reader:\n    """What reads."""',
        '"""How a file is read."""',
        'LIMIT = 3\n"""After which reading ends."""',
        'class Reader:\n    limit: int\n    """Up to which bytes are read."""',
    ],
)
def test_the_check_sees_a_fault(source: str) -> None:
    assert len([one for one in docstrings(source) if is_unclear(one)]) == 1


@pytest.mark.parametrize(
    'source',
    [
        '"""Reading of files."""',
        'def size():\n    """Return the number of bytes.\n\n    What is not a byte does not count.\n    """',
        'class Reader:\n    """A reader."""\n\n    @property\n    def size(self):\n        """Size in bytes."""',
        'LIMIT = 3\n"""Seconds until reading ends."""',
        'LIMIT = 3\nsize()\n"""What follows no assignment describes nothing."""',
    ],
)
def test_the_check_accepts_plain_english(source: str) -> None:
    assert [one for one in docstrings(source) if is_unclear(one)] == []
