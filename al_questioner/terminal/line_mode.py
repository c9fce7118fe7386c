"""Questions and answers line by line, for scripts and for simple terminals."""

from __future__ import annotations

import codecs
import os
import select
import threading
import time
from collections import deque
from typing import TextIO

from al_questioner.domain import AnswerError
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import Phase
from al_questioner.support.safe_text import printable
from al_questioner.terminal.commands import Command, Explain, Wish, read_line
from al_questioner.terminal.keypad import about, choices_of
from al_questioner.terminal.sentences import HELP, question_line

LOOK_PERIOD = 0.1
"""Seconds between two checks of the input and the view state."""
PATIENCE_AT_THE_END = 10.0
"""Seconds after the end of the input in which the robot may still end the episode or ask a question."""
LONGEST_LINE = 10_000
"""Largest length of a line, in characters; a longer one is split into several lines."""


class LineReader:
    """Reader of lines from a file descriptor that never blocks for longer than requested."""

    def __init__(self, descriptor: int | None) -> None:
        self._descriptor = descriptor
        self._decode = codecs.getincrementaldecoder('utf-8')('replace').decode
        self._lines: deque[str] = deque()
        self._rest = ''
        self._closed = descriptor is None

    @property
    def ended(self) -> bool:
        """True if there are no more lines to come."""
        return self._closed and not self._lines

    def peek(self, seconds: float) -> str | None:
        """Return the next line without taking it; None if there is none so far."""
        if not self._lines and not self._closed:
            self._read(seconds)
        return self._lines[0] if self._lines else None

    def take(self) -> None:
        """Remove the line that `peek` returned."""
        self._lines.popleft()

    def _read(self, seconds: float) -> None:
        if self._descriptor is None or not select.select([self._descriptor], [], [], seconds)[0]:
            return
        try:
            content = os.read(self._descriptor, 4096)
        except OSError:
            # The terminal was closed.
            content = b''
        *lines, self._rest = (self._rest + self._decode(content, not content)).split('\n')
        self._lines.extend(lines)
        self._closed = not content
        if self._rest and (self._closed or len(self._rest) > LONGEST_LINE):
            self._lines.append(self._rest)
            self._rest = ''


class LineMode:
    """A conversation in lines: one question a line on `out`, all other text on `err`."""

    def __init__(
        self, dialogue: TeacherDialogue, lines: LineReader, out: TextIO, err: TextIO, stopped: threading.Event
    ) -> None:
        self._dialogue = dialogue
        self._lines = lines
        self._out = out
        self._err = err
        self._stopped = stopped
        self._asked = ''
        self._noticed = ''

    def run(self) -> None:
        """Ask and answer until the episode is over, the person quits, the input ends, or it is stopped."""
        ended_at = None
        while not self._stopped.is_set():
            view_state = self._dialogue.view_state()
            if view_state.notice != self._noticed:
                self._noticed = view_state.notice
                self._tell(view_state.notice)
            if view_state.phase is Phase.OVER and not (view_state.can_undo and self._takes_back()):
                return
            here = about(view_state)
            if here and view_state.prompt is not None and here != self._asked:
                self._asked = here
                self._write(
                    self._out,
                    question_line(view_state.prompt.query, view_state.phase is Phase.CORRECTING, view_state.progress),
                )
            line = self._lines.peek(LOOK_PERIOD)
            command = None if line is None else read_line(line, choices_of(view_state))
            if command is not None and self._is_due(command, here, view_state.phase):
                self._lines.take()
                if not self._follow(command):
                    return
            elif self._lines.ended:
                if here or view_state.phase is Phase.ALONE:
                    return
                ended_at = ended_at or time.monotonic()
                if time.monotonic() > ended_at + PATIENCE_AT_THE_END:
                    return
                self._stopped.wait(LOOK_PERIOD)
            elif line is not None:
                self._stopped.wait(LOOK_PERIOD)

    @staticmethod
    def _is_due(command: Command, here: str, phase: Phase) -> bool:
        """Return whether a line can be handled now: an answer waits for its question, `undo` for its answer."""
        # If `undo` were rejected instead, the replacing answer would go to the next question.
        return bool(here) or command in (Wish.HELP, Wish.QUIT) or (command is Wish.UNDO and phase is not Phase.SENDING)

    def _takes_back(self) -> bool:
        """Return whether the next line, if there is one already, takes back the last answer of the episode."""
        line = self._lines.peek(LOOK_PERIOD)
        return line is not None and read_line(line) is Wish.UNDO

    def _follow(self, command: Command) -> bool:
        """Execute the command of a line; return whether to go on."""
        if command is Wish.QUIT:
            return False
        # In any case, the question that is shown next is printed on a line of its own.
        self._asked = ''
        if command is Wish.HELP:
            for paragraph in HELP:
                self._tell(paragraph)
        elif isinstance(command, Explain):
            self._tell(command.text)
        else:
            try:
                if command is Wish.UNDO:
                    self._dialogue.undo()
                else:
                    self._dialogue.say(command.text)
                self._noticed = ''
            except AnswerError as error:
                self._tell(str(error))
        return True

    def _tell(self, text: str) -> None:
        if text:
            self._write(self._err, printable(text, 2000))

    @staticmethod
    def _write(file: TextIO, line: str) -> None:
        print(line, file=file, flush=True)
