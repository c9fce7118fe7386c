"""Dialogue with the person at the terminal of this process, from the first question to the farewell."""

from __future__ import annotations

import os
import sys
import threading

from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import Phase
from al_questioner.terminal.line_mode import LineMode, LineReader
from al_questioner.terminal.sentences import farewell

SECONDS_TO_SETTLE = 3.0
"""Seconds that quitting waits for an unacknowledged answer."""


def run_terminal(dialogue: TeacherDialogue, stopped: threading.Event) -> None:
    """Let the person at stdin and stdout answer: by keys if both are a terminal, else line by line.

    Returns when the episode is over, the person quits, the input ends, or `stopped` is set.
    """
    keys = _is_terminal()
    if keys:
        from al_questioner.terminal.fullscreen import FullScreen

        FullScreen(dialogue, stopped).run()
    else:
        LineMode(dialogue, LineReader(_stdin()), sys.stdout, sys.stderr, stopped).run()
    if not stopped.is_set():
        dialogue.wait_for(
            lambda view_state: stopped.is_set() or view_state.phase is not Phase.SENDING, SECONDS_TO_SETTLE
        )
    print(farewell(dialogue.view_state()), file=sys.stdout if keys else sys.stderr, flush=True)


def _is_terminal() -> bool:
    try:
        both = sys.stdin.isatty() and sys.stdout.isatty()
    except (AttributeError, ValueError):
        # There is no stdin or stdout, or it is closed.
        return False
    return both and os.environ.get('TERM', 'dumb') != 'dumb'


def _stdin() -> int | None:
    try:
        return sys.stdin.fileno()
    except (AttributeError, ValueError, OSError):
        return None
