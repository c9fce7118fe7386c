"""The command line of `concepts`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain.names import parted
from al_questioner.domain.settlement import REFUSE, SETTLEMENTS
from al_questioner.support.arguments import Parser


def parser() -> Parser:
    """Make the parser of `concepts`."""
    result = Parser(
        prog='concepts',
        description='Show what learners know; several files are merged, in the order in which they are given.',
        epilog='exit status: 0, or 2 if a file or a change cannot be used: then nothing is written',
    )
    result.add_argument('files', type=Path, nargs='+', metavar='FILE', help='concepts file')
    result.add_argument('--examples', action='store_true', help='show every example, with the number of its view')
    settle = 'label that counts of a view with several: the newest one, or that of the most reliable teacher'
    result.add_argument('--settle', choices=SETTLEMENTS, default=REFUSE, help=settle)
    remove = 'forget what the view of this number was called, or all examples of a symbol or of none; can be repeated,'
    result.add_argument(
        '--remove',
        type=_view_or_label,
        action='append',
        default=[],
        metavar='VIEW|LABEL',
        help=f'{remove} as all below',
    )
    result.add_argument(
        '--rename', type=_renaming, action='append', default=[], metavar='OLD=NEW', help='rename a symbol'
    )
    drop = 'drop a symbol: its examples are of none from now on'
    result.add_argument('--drop', action='append', default=[], metavar='SYMBOL', help=drop)
    result.add_argument('--add', action='append', default=[], metavar='SYMBOL', help='add a symbol without examples')
    result.add_argument('--out', type=Path, metavar='FILE', help='write the result as a concepts file')
    result.add_argument('--csv', type=Path, metavar='FILE', help='write the examples as a table')
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments."""
    return parser().parse_args(arguments)


def _view_or_label(text: str) -> int | str:
    return int(text) if text.isdecimal() else text


def _renaming(text: str) -> tuple[str, str]:
    old, is_given, new = text.partition('=')
    names = [*parted(old), *parted(new)]
    if not is_given or len(names) != 2:
        raise argparse.ArgumentTypeError(f'must be OLD=NEW, not {text!r}')
    return names[0], names[1]
