"""Full screen mode of the terminal, redrawn at every change and controlled by single keys."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator

from prompt_toolkit.application import Application, run_in_terminal
from prompt_toolkit.data_structures import Size
from prompt_toolkit.formatted_text import ANSI
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent
from prompt_toolkit.keys import Keys
from prompt_toolkit.layout import FormattedTextControl, Layout, Window
from prompt_toolkit.output import ColorDepth
from rich.console import Console

from al_questioner.domain import AnswerError
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import Phase
from al_questioner.support.safe_text import printable
from al_questioner.terminal.capabilities import Capabilities, detect_capabilities
from al_questioner.terminal.commands import Command, Explain, Say, Wish
from al_questioner.terminal.keypad import Pad, about, press
from al_questioner.terminal.screen import screen

NAMES = {
    Keys.Enter: 'enter',
    Keys.ControlJ: 'enter',
    Keys.Backspace: 'backspace',
    Keys.Delete: 'backspace',
    Keys.Escape: 'escape',
    Keys.Up: 'up',
    Keys.Down: 'down',
    Keys.Left: 'left',
    Keys.Right: 'right',
    Keys.Tab: 'tab',
}
DEPTHS = {
    'truecolor': ColorDepth.DEPTH_24_BIT,
    '256': ColorDepth.DEPTH_8_BIT,
    'standard': ColorDepth.DEPTH_4_BIT,
    None: ColorDepth.DEPTH_1_BIT,
}
LOOK_PERIOD = 0.1
"""Seconds between two checks whether to end, and of the size of the terminal."""
SUSPENSION_PERIOD = 0.01
"""Seconds between two checks whether the stop signal has been delivered."""
MOST_HELD_BACK = 20_000
"""Largest size, in bytes, of the messages that are shown after the screen has closed."""


class FullScreen:
    """A screen with keys; `run` it in a thread of its own."""

    def __init__(self, dialogue: TeacherDialogue, stopped: threading.Event) -> None:
        self._dialogue = dialogue
        self._stopped = stopped
        self._look = detect_capabilities(Console())
        self._pad = Pad()
        self._in_help = False
        self._size = Size(rows=0, columns=0)

    def run(self) -> None:
        """Take keys until the episode is over, the person quits, or it is stopped; then restore the terminal."""
        control = FormattedTextControl(lambda: ANSI(self._drawn()), focusable=True, show_cursor=False)
        application: Application[None] = Application(
            layout=Layout(Window(control, always_hide_cursor=True)),
            key_bindings=self._bindings(),
            full_screen=True,
            color_depth=ColorDepth.DEPTH_1_BIT if self._look.monochrome else DEPTHS[self._look.colors],
            min_redraw_interval=0.05,
            # The polling of prompt_toolkit misses a change right after the start.
            terminal_size_polling_interval=None,
        )

        async def end_in_time() -> None:
            while not self._stopped.is_set() and not self._nothing_left():
                await asyncio.sleep(LOOK_PERIOD)
                # No event tells that no reply has come.
                waits = self._dialogue.view_state().phase is Phase.SENDING
                if waits or application.output.get_size() != self._size:
                    application.invalidate()
            if not application.is_done:
                application.exit()

        def watch() -> None:
            application.create_background_task(end_in_time())

        self._application = application
        self._dialogue.on_change = application.invalidate
        try:
            with _held_back_errors():
                application.run(pre_run=watch, set_exception_handler=False)
        finally:
            self._dialogue.on_change = lambda: None

    def _nothing_left(self) -> bool:
        view_state = self._dialogue.view_state()
        return view_state.phase is Phase.OVER and not view_state.can_undo

    def _drawn(self) -> str:
        size = self._size = self._application.output.get_size()
        capabilities = Capabilities(
            size.columns, size.rows, self._look.colors, self._look.monochrome, self._look.unicode
        )
        view_state = self._dialogue.view_state()
        pad = self._pad if self._pad.about == about(view_state) else Pad()
        try:
            return capabilities.written(screen(view_state, pad, capabilities, self._in_help))
        except Exception as error:  # noqa: BLE001 - the person can go on after any message
            return printable(f'This cannot be shown ({type(error).__name__}: {error}); q quits.')

    def _bindings(self) -> KeyBindings:
        bindings = KeyBindings()

        @bindings.add('c-c')
        @bindings.add('c-d')
        def _(event: KeyPressEvent) -> None:
            event.app.exit()

        @bindings.add('c-z')
        def _(event: KeyPressEvent) -> None:
            run_in_terminal(_suspend)

        @bindings.add('c-l')
        def _(event: KeyPressEvent) -> None:
            event.app.renderer.clear()

        @bindings.add(Keys.BracketedPaste)
        def _(event: KeyPressEvent) -> None:
            # Text that is pasted outside of a word is hardly meant as keys.
            if self._pad.in_words:
                for character in event.data.strip():
                    self._press(character)

        @bindings.add(Keys.Any)
        def _(event: KeyPressEvent) -> None:
            key = event.key_sequence[0].key
            name = NAMES.get(key, key.value) if isinstance(key, Keys) else key
            if not name.startswith('<'):
                self._press(name)

        return bindings

    def _press(self, key: str) -> None:
        if self._in_help:
            self._in_help = False
            return
        self._pad, command = press(key, self._pad, self._dialogue.view_state())
        if command is not None:
            self._follow(command)

    def _follow(self, command: Command) -> None:
        if command is Wish.QUIT:
            self._application.exit()
        elif command is Wish.HELP:
            self._in_help = True
        elif isinstance(command, Explain):
            self._explain(command.text)
        else:
            try:
                if isinstance(command, Say):
                    self._dialogue.say(command.text)
                else:
                    self._dialogue.undo()
            except AnswerError as error:
                self._explain(str(error))

    def _explain(self, text: str) -> None:
        self._pad = self._pad.explained(text)


def _suspend() -> None:
    """Stop this process and its group, as Ctrl-Z does in a shell, until they are continued.

    Another thread may receive the signal. Until then nothing may be drawn, and the terminal may not be changed.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTSTP})
    try:
        os.kill(0, signal.SIGTSTP)
        while signal.SIGTSTP in signal.sigpending():
            time.sleep(SUSPENSION_PERIOD)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _held_back_errors() -> Iterator[None]:
    """Keep stderr of the process off the screen, and print it afterwards, except for lines that only inform."""
    if not os.isatty(2):
        yield
        return
    with tempfile.TemporaryFile() as file:
        sys.stderr.flush()
        before = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            sys.stderr.flush()
            os.dup2(before, 2)
            os.close(before)
            file.seek(max(0, file.seek(0, os.SEEK_END) - MOST_HELD_BACK))
            for line in file.read().decode(errors='replace').splitlines():
                if not line.startswith('[INFO]'):
                    sys.stderr.write(f'{line}\n')
