"""Capabilities of a terminal."""

from __future__ import annotations

import curses
import io
from dataclasses import dataclass

from rich.console import Console
from rich.text import Text

_PLAIN = str.maketrans({'…': '~', '·': '-', '▀': '#', '─': '-', '│': '|', '┌': '+', '┐': '+', '└': '+', '┘': '+'})
"""ASCII replacements for the few Unicode characters that are shown."""


@dataclass(frozen=True)
class Capabilities:
    """Size and abilities of a terminal.

    Attributes:
        width: columns.
        height: rows.
        colors: number of colours, as rich calls it; None for neither colours nor reverse video.
        monochrome: reverse video and bold, but no colours.
        unicode: whether more than ASCII can be shown.
    """

    width: int = 80
    height: int = 24
    colors: str | None = None
    monochrome: bool = False
    unicode: bool = True

    @property
    def in_color(self) -> bool:
        """True if colours are shown."""
        return self.colors is not None and not self.monochrome

    def console(self, file: io.StringIO | None = None) -> Console:
        """Return a console that writes for such a terminal."""
        return Console(
            file=file or io.StringIO(),
            width=self.width,
            height=self.height,
            force_terminal=True,
            color_system=self.colors,  # type: ignore[arg-type]
            no_color=self.monochrome,
            legacy_windows=False,
            highlight=False,
            markup=False,
            emoji=False,
        )

    def written(self, lines: list[Text]) -> str:
        """Return the characters that show these lines."""
        file = io.StringIO()
        self.console(file).print(Text('\n').join(lines), end='', soft_wrap=True)
        text = file.getvalue()
        return text if self.unicode else text.translate(_PLAIN).encode('ascii', 'replace').decode('ascii')


def detect_capabilities(console: Console) -> Capabilities:
    """Return the capabilities of the terminal that a console writes to."""
    return Capabilities(
        width=console.width,
        height=console.height,
        colors=console.color_system,
        monochrome=console.no_color or not _has_colors(),
        unicode=console.encoding.startswith('utf'),
    )


def _has_colors() -> bool:
    """Return whether the terminal has colours according to terminfo; rich assumes so for every unknown terminal."""
    try:
        curses.setupterm()
    except (curses.error, OSError, ValueError):
        return True
    return curses.tigetnum('colors') > 1
