"""Thread in which a person at the terminal of this process takes part in a dialogue."""

from __future__ import annotations

import getpass
import threading
from collections.abc import Callable
from typing import Any

from al_questioner.questioning.dialogue import TeacherDialogue

SECONDS_TO_CLOSE = 5.0
"""Seconds within which the screen is closed."""

RunTerminal = Callable[[TeacherDialogue, threading.Event], Any]
"""Shows a dialogue to a person and has them answer, until they have done or the event is set."""


def login_name() -> str:
    """Return the name of the person who is logged in, the teacher if nobody says otherwise."""
    try:
        return getpass.getuser() or 'human'
    except (KeyError, OSError, ImportError):
        # A user without an entry in the password database, as in containers.
        return 'human'


class TerminalThread:
    """Thread that attends to a person.

    Args:
        dialogue: what is asked and said.
        run_terminal: attends to the person.
        end: ends the process once the person has done.

    Attributes:
        failure: why the thread ended before its time.
    """

    def __init__(self, dialogue: TeacherDialogue, run_terminal: RunTerminal, end: Callable[[], Any]) -> None:
        self.failure: Exception | None = None
        self._dialogue = dialogue
        self._attend = run_terminal
        self._end = end
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name='terminal', daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Give the terminal back."""
        self._stopped.set()
        self._dialogue.wake()
        if self._thread is not threading.current_thread():
            self._thread.join(SECONDS_TO_CLOSE)

    def _run(self) -> None:
        try:
            self._attend(self._dialogue, self._stopped)
        except Exception as error:  # noqa: BLE001 - whatever it is, the process must end and say so
            self.failure = error
        finally:
            if not self._stopped.is_set():
                self._end()
