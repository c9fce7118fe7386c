"""YAML that cannot be relied on must be refused with its line, and nothing else must be."""

from __future__ import annotations

from pathlib import Path

import pytest

from al_questioner.domain import InputError
from al_questioner.support.configuration import config_dir, read_yaml
from al_questioner.support.strict_yaml import parse, parse_for_ros, text_of

BOMB = 'a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n' + '\n'.join(
    f'{name}: &{name} [{", ".join([f"*{before}"] * 10)}]' for before, name in zip('abcdefgh', 'bcdefghi', strict=True)
)
CHAIN = 'a0: &a0 [1]\n' + '\n'.join(f'a{i}: &a{i} [*a{i - 1}]' for i in range(1, 40))


def refusal(tmp_path: Path, content: bytes) -> str:
    path = tmp_path / 'task.yaml'
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_yaml(path)
    text = str(caught.value)
    assert '\n' not in text
    return text.removeprefix(str(path))


@pytest.mark.parametrize(
    ('content', 'line'),
    [
        ('a: 1\nb: 2\na: 3', 3),
        ('w:\n  a: 1\n  "a": 1', 3),
        ('{a: 1, a: 1}', 1),
        ('l:\n- {b: 1,\n   b: 2}', 3),
        ('{1: a,\n 0x1: b}', 2),
        ('{true: 1,\n True: 2}', 2),
        ('Caf\u00e9: 1\nCafe\u0301: 2', 2),
    ],
)
def test_a_key_that_occurs_twice_is_refused(tmp_path: Path, content: str, line: int) -> None:
    """Otherwise the last would win in silence, however deep it lies and however it is written."""
    assert f', line {line}: key ' in refusal(tmp_path, content.encode())


@pytest.mark.parametrize(
    ('word', 'hint'),
    [
        ('010', "010 is the number 8 in YAML 1.1 and the number 10 in YAML 1.2; write 8, 10 or '010'"),
        ('08', "write 8 or '08'"),
        ('0o10', "write 8 or '0o10'"),
        ('0b11', "write 3 or '0b11'"),
        ('1:30', "1:30 is the number 90 in YAML 1.1 and a text in YAML 1.2; write 90 or '1:30'"),
        ('-1:30.5', "write -90.5 or '-1:30.5'"),
        ('1_000', "write 1000 or '1_000'"),
        ('1_0.5', "write 10.5 or '1_0.5'"),
        ('1e3', "write 1000.0 or '1e3'"),
        ('2E20', "write 2.0e+20 or '2E20'"),
        ('-.5', "write -0.5 or '-.5'"),
        ('no', "no is a truth value in YAML 1.1 and a text in YAML 1.2; write false or 'no'"),
        ('Yes', "write true or 'Yes'"),
        ('ON', "write true or 'ON'"),
        ('off', "write false or 'off'"),
        ('2024-01-31', "2024-01-31 is a date in YAML 1.1 and a text in YAML 1.2; write '2024-01-31'"),
        ('2024-13-31', '2024-13-31 is no value; put a text in quotes'),
        ('9' * 30, 'is too large a number'),
    ],
)
def test_a_word_that_the_versions_of_yaml_read_differently_is_refused(tmp_path: Path, word: str, hint: str) -> None:
    """Otherwise `budget: 010` would be 8, and the symbol `no` would be False; in quotes they are plain text."""
    for content in (f'a: 1\nb: {word}', f'a: 1\nsymbols: [x, {word}]', f'a: 1\n{word}: 1'):
        text = refusal(tmp_path, content.encode())
        assert text.startswith(', line 2: ')
        assert hint in text
    assert parse(f"b: '{word}'".encode()) == {'b': word}


@pytest.mark.parametrize(
    ('content', 'reason'),
    [
        (b'a: ' + b'[' * 5000 + b']' * 5000, ', line 1: deeper than 20 levels'),
        (b'a: ' + b'{b: ' * 5000 + b'}' * 5000, ', line 1: deeper than 20 levels'),
        (CHAIN.encode(), 'deeper than 20 levels'),
        (BOMB.encode(), ', line 5: more than 100000 values'),
        (b'b: 1\na: &a [*a]', ', line 2: an alias stands for what it lies in'),
        (b'a: ' + b'9' * 5000, f', line 1: {"9" * 40}... is no value'),
        (b'a: *nothing', ', line 1: not valid YAML (found undefined alias'),
        (b'a: 1\n\tb: 2', ', line 2: not valid YAML'),
        (b'a: 1\n---\nb: 2', ', line 2: not valid YAML'),
        (b'a: 1\nb: \0', ', line 2: not valid YAML'),
        (b'a: 1\nb: \xff', ', line 2: not valid YAML'),
        (b'a: [', 'not valid YAML'),
        (b'\xff\xfe\xff', 'not valid YAML'),
        (b'a: "\\0"', ', line 1: a text holds no NUL'),
        (b'a: "\\ud800"', ', line 1: a text holds no NUL, and no half of a character'),
        (b'[a]: 3', ', line 1: expected a name as key'),
        (b'a: !!int x', ', line 1: the tag tag:yaml.org,2002:int is not supported'),
        (b'a: !!python/object/apply:os.getcwd []', ', line 1: the tag '),
        (b'# a' + b'a' * 1_000_000, ': larger than 1000000 bytes'),
        (b'', ': expected a mapping of settings, found nothing'),
        (b'# nothing', ': expected a mapping of settings, found nothing'),
        (b'- 1', ': expected a mapping of settings, found list'),
        (b'word', ': expected a mapping of settings, found str'),
    ],
)
def test_unusable_yaml_is_one_line(tmp_path: Path, content: bytes, reason: str) -> None:
    """Otherwise a file would end in a traceback, fill the memory, or be read in part."""
    assert reason in refusal(tmp_path, content)


@pytest.mark.parametrize(
    ('content', 'values'),
    [
        (b'\xef\xbb\xbfa: 1\r\nb: [x]\r\n', {'a': 1, 'b': ['x']}),
        ('a: ö'.encode('utf-16'), {'a': 'ö'}),
        (b'a: &a [1, 2]\nb: *a', {'a': [1, 2], 'b': [1, 2]}),
        (b'a: &a {x: 1, y: 2}\nb: {<<: *a, x: 3}', {'a': {'x': 1, 'y': 2}, 'b': {'x': 3, 'y': 2}}),
        (b'a: 1.0e+6\nb: -1.5\nc: .5\nd: 0\ne: 0x10', {'a': 1e6, 'b': -1.5, 'c': 0.5, 'd': 0, 'e': 16}),
        (b'a: true\nb: False\nc: ~\nd:', {'a': True, 'b': False, 'c': None, 'd': None}),
        (
            b'a: y\nb: !!str 010\nc: "no"\nd: 12:75\ne: >\n  no',
            {'a': 'y', 'b': '010', 'c': 'no', 'd': '12:75', 'e': 'no'},
        ),
    ],
)
def test_other_yaml_is_read_as_ever(content: bytes, values: object) -> None:
    """Otherwise own tasks of users would be refused."""
    assert parse(content) == values


def test_all_that_ros_may_take_otherwise_is_told_with_its_line() -> None:
    """All faults are told at once, among them y, which would silently be a truth value."""
    lines = ('a: no', 'b: 010', 'a: 1', 'c: [x, y, "n", Y]', 'y: 1', 'd: n', 'e: !!str y', 'f: -.5')
    content, doubts = parse_for_ros('\n'.join(lines).encode())
    assert content == {'a': 1, 'b': 8, 'c': ['x', 'y', 'n', 'Y'], 'y': 1, 'd': 'n', 'e': 'y', 'f': '-.5'}
    told = [(doubt.problem_mark.line + 1, doubt.problem) for doubt in doubts if doubt.problem_mark]
    assert [line for line, _ in told] == [1, 2, 3, 4, 4, 6, 8]
    assert (4, "y is a truth value in YAML 1.1 and a text in YAML 1.2; write true or 'y'") in told
    assert (6, "n is a truth value in YAML 1.1 and a text in YAML 1.2; write false or 'n'") in told


@pytest.mark.parametrize(
    'text', ['1e3', '010', '08', 'no', '1:30', '-.5', '0o7', '2024-01-01', '', 'plain', 'a: b', '~']
)
def test_what_is_written_is_read_again(text: str) -> None:
    """Otherwise a bag with a name such as 1e3 would make a weights file that is refused."""
    assert parse(text_of({text: [text, 1e20, 3, None]}).encode()) == {text: [text, 1e20, 3, None]}


def test_all_that_ships_is_read() -> None:
    """Parameter files are read strictly, too: a key that occurs twice is not lost without a word."""
    for path in config_dir().rglob('*.yaml'):
        assert read_yaml(path), path
