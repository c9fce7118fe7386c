"""YAML that all versions read alike; a text that YAML 1.1 and 1.2 read differently is rejected."""

from __future__ import annotations

import re
import unicodedata
from typing import Any

import yaml
from yaml.error import Mark, MarkedYAMLError
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from yaml.reader import ReaderError

_STRING, _MERGE = 'tag:yaml.org,2002:str', 'tag:yaml.org,2002:merge'
"""Tags of a text, and of the key <<, which stands for the members of another mapping."""
MOST_BYTES = 1_000_000
"""Largest file that is read, in bytes; people write files a thousand times smaller."""
DEEPEST = 20
"""Largest number of nested levels of lists and mappings."""
MOST_VALUES = 100_000
"""Largest number of values with aliases expanded; each of a few lines could stand for ten of the next."""
LARGEST_WHOLE = 2**63 - 1

_ROS_WORDS = {'y': True, 'Y': True, 'n': False, 'N': False}
_WORDS = {'true': True, 'false': False, 'null': None, '~': None, '': None, '.nan': float('nan')}


class RefusedYAMLError(MarkedYAMLError):
    """Valid YAML that is rejected all the same."""


def parse(content: bytes) -> Any:
    """Return the content of a single YAML document; None if it is empty.

    Raises:
        yaml.MarkedYAMLError: the text is not YAML.
        RefusedYAMLError: the text is ambiguous or too large: a key that occurs twice, or a plain word that YAML 1.1 and
            1.2 read differently, such as 010, 1:30, no, 1_000 or 1e3; a tag; too much.
    """
    return _read(content, None)


def parse_for_ros(content: bytes) -> tuple[Any, list[MarkedYAMLError]]:
    """Return the content of a document that ROS also reads, and everything in it that ROS may read in another way.

    ROS reads a plain y or n as a truth value, except in a key.

    Raises:
        yaml.MarkedYAMLError: the text is not YAML, or too large, see `parse`.
    """
    doubts: list[MarkedYAMLError] = []
    found = _read(content, doubts)
    return found, sorted(doubts, key=lambda doubt: doubt.problem_mark.line if doubt.problem_mark else 0)


def _read(content: bytes, doubts: list[MarkedYAMLError] | None) -> Any:
    if len(content) > MOST_BYTES:
        raise RefusedYAMLError(problem=f'larger than {MOST_BYTES} bytes')
    try:
        return _Loader(content, doubts).get_single_data()
    except ReaderError as error:
        before = content.decode(errors='replace')[: error.position]
        mark = Mark('', error.position, before.count('\n'), 0, None, 0)
        raise MarkedYAMLError(problem=error.reason, problem_mark=mark) from error


def text_of(document: Any) -> str:
    """Return a document as YAML that `parse` reads as the same document."""
    return yaml.dump(document, Dumper=_Dumper, sort_keys=False, width=100)


class _Loader(yaml.SafeLoader):
    """A safe loader that checks each node as soon as it is complete, when its line is known.

    Ambiguous values are collected in the list of doubts; if there is none, such a value is an error.
    """

    def __init__(self, content: bytes, doubts: list[MarkedYAMLError] | None = None) -> None:
        super().__init__(content)
        self._doubts = doubts
        self._level = 0
        self._extents: dict[Node, tuple[int, int]] = {}

    def compose_node(self, parent: Node | None, index: Any) -> Node | None:
        """Compose a node, or take the node that an alias names."""
        event = self.peek_event()  # type: ignore[no-untyped-call]
        is_alias, mark = self.check_event(yaml.AliasEvent), event.start_mark
        if not is_alias and event.tag not in (None, '!', _STRING):
            raise _fault(f'the tag {event.tag} is not supported', mark)
        self._level += 1
        _check_depth(self._level, mark)
        node = super().compose_node(parent, index)
        self._level -= 1
        if node is None:
            return None
        if not is_alias:
            self._extents[node] = self._extent(node)
            is_key = isinstance(parent, MappingNode) and index is None
            is_plain = isinstance(node, ScalarNode) and event.implicit[0]
            if self._doubts is not None and is_plain and not is_key and node.value in _ROS_WORDS:
                self._doubt(_two_meanings(node.value, _ROS_WORDS[node.value], node.value), mark)
        elif node not in self._extents:
            raise _fault('an alias stands for what it lies in', mark)
        count, height = self._extents[node]
        _check_depth(self._level + height, mark)
        if count > MOST_VALUES:
            raise _fault(f'more than {MOST_VALUES} values, with what the aliases stand for', mark)
        return node

    def compose_scalar_node(self, anchor: Any) -> ScalarNode:
        """Compose a value; reject one that is plain and ambiguous."""
        event = self.peek_event()  # type: ignore[no-untyped-call]
        node = super().compose_scalar_node(anchor)
        if re.search('[\0\ud800-\udfff]', node.value):
            raise _fault('a text holds no NUL, and no half of a character', node.start_mark)
        if event.implicit[0] and node.tag != _MERGE:
            self._check_meaning(node)
        return node

    def compose_mapping_node(self, anchor: Any) -> MappingNode:
        """Compose a mapping; reject a key that is a list or occurs twice."""
        node = super().compose_mapping_node(anchor)
        lines: dict[object, int] = {}
        for key, _ in node.value:
            if not isinstance(key, ScalarNode):
                raise _fault('expected a name as key, found a list or a mapping', key.start_mark)
            # Compare keys by meaning: 1 and 0x1 are the same key, and so are both Unicode forms of an accent.
            meant = key.value if key.tag == _MERGE else self.construct_object(key)
            meant = unicodedata.normalize('NFC', meant) if isinstance(meant, str) else meant
            if meant in lines:
                self._doubt(f'key {key.value!r} occurs twice, first in line {lines[meant]}', key.start_mark)
            lines.setdefault(meant, key.start_mark.line + 1)
        return node

    def _extent(self, node: Node) -> tuple[int, int]:
        """Return how many values a new node stands for, and in how many levels."""
        inner: list[Node] = []
        if isinstance(node, SequenceNode):
            inner = node.value
        elif isinstance(node, MappingNode):
            inner = [part for pair in node.value for part in pair]
        extents = [self._extents[part] for part in inner]
        return 1 + sum(count for count, _ in extents), 1 + max((height for _, height in extents), default=-1)

    def _check_meaning(self, node: ScalarNode) -> None:
        shown = node.value if len(node.value) <= 40 else f'{node.value[:40]}...'
        try:
            here, there = self.construct_object(node), meaning(node.value)
        except (ValueError, yaml.YAMLError) as error:
            raise _fault(f'{shown} is no value; put a text in quotes', node.start_mark) from error
        if repr(here) != repr(there):
            self._doubt(_two_meanings(shown, here, there), node.start_mark)
        if isinstance(here, int) and abs(here) > LARGEST_WHOLE:
            raise _fault(f'{shown} is too large a number', node.start_mark)

    def _doubt(self, problem: str, mark: Mark) -> None:
        fault = _fault(problem, mark)
        if self._doubts is None:
            raise fault
        self._doubts.append(fault)


class _Dumper(yaml.SafeDumper):
    """A dumper that puts texts in quotes if the versions of YAML would read them differently."""

    def resolve(self, kind: Any, value: Any, implicit: Any) -> str:
        """Return the tag that a value would get without one of its own."""
        tag: str = super().resolve(kind, value, implicit)  # type: ignore[no-untyped-call]
        is_ambiguous = kind is ScalarNode and implicit[0] and tag == _STRING and meaning(value) != value
        return 'ambiguous' if is_ambiguous else tag


def meaning(text: str) -> str | int | float | bool | None:
    """Return the value of a plain word in YAML 1.2 (its core schema).

    Raises:
        ValueError: a number with thousands of digits.
    """
    if re.fullmatch(r'[-+]?[0-9]+', text):
        return int(text)
    if re.fullmatch(r'0o[0-7]+|0x[0-9a-fA-F]+', text):
        return int(text, 0)
    if re.fullmatch(r'[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?', text):
        return float(text)
    if re.fullmatch(r'[-+]?\.(inf|Inf|INF)', text):
        return float(text.replace('.', ''))
    if re.fullmatch(r'\.(nan|NaN|NAN)|~|(null|true|false)|(Null|True|False)|(NULL|TRUE|FALSE)|', text):
        return _WORDS[text.lower()]
    return text


def _two_meanings(shown: str, here: Any, there: Any) -> str:
    meanings = f'{shown} is {_in_words(here)} in YAML 1.1 and {_in_words(there)} in YAML 1.2'
    plain = [text_of(value).splitlines()[0] for value in (here, there) if isinstance(value, (int, float))]
    return f"{meanings}; write {', '.join(plain)}{' or ' if plain else ''}'{shown}'"


def _in_words(value: Any) -> str:
    if isinstance(value, bool):
        return 'a truth value'
    if isinstance(value, (int, float)):
        return f'the number {value}'
    return 'a text' if isinstance(value, str) else 'a date'


def _check_depth(level: int, mark: Mark) -> None:
    if level > DEEPEST:
        raise _fault(f'deeper than {DEEPEST} levels', mark)


def _fault(problem: str, mark: Mark) -> RefusedYAMLError:
    return RefusedYAMLError(problem=problem, problem_mark=mark)
