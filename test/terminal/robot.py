"""A robot that asks three questions at this process's terminal; for the tests.

    python robot.py FILE [--deaf | --slow]

Every answer is written to FILE, a line each. With --deaf none is acknowledged, with --slow after a while.
SIGTERM ends it as it ends a node.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from pathlib import Path

import numpy as np

from al_questioner.domain import Action, Answer, Outcome, Query, QueryKind, QueryRecord, Scene
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import EpisodeProgress
from al_questioner.terminal.commands import WISHES
from al_questioner.terminal.run import run_terminal

IDS = (1, 7, 12)
ACTIONS = {
    'q1': (Action(QueryKind.LABEL, 7), ('snack', 'fruit'), 'What is object 7?'),
    'q2': (Action(QueryKind.DEMONSTRATION, symbol='snack'), tuple(map(str, IDS)), 'Can you show me a snack?'),
    'q3': (Action(QueryKind.FEATURE_SUBSET), ('colour', 'size'), 'Which properties matter?'),
}


class Robot:
    """Takes every answer, and corrections as well."""

    def __init__(self, file: Path, deaf: bool, slow: bool) -> None:
        self.file, self.deaf, self.slow = file, deaf, slow
        self.dialogue = TeacherDialogue('anna', self.hear, other_words=WISHES)
        self.records: list[QueryRecord] = []
        self.dialogue.enter('episode')
        self.dialogue.look(
            Scene(IDS, np.eye(3, dtype=np.float32) / 2, np.zeros((3, 1), np.float32), ('colour_hue',)), 1
        )
        self.dialogue.see(np.full((692, 1280, 3), 90, np.uint8), 1)
        self.ask()

    def ask(self) -> None:
        """Go on to the next turn."""
        turn = len(self.records) + 1
        self.dialogue.follow(EpisodeProgress(turn - 1, 3, 5.0, turn - 1.0, turn > 3, tuple(self.records)))
        if turn <= 3:
            action, choices, text = ACTIONS[f'q{turn}']
            self.dialogue.ask(Query(f'q{turn}', turn, action, choices, 1, 4, 3 - turn, 1, text))

    def hear(self, _: str, answer: Answer) -> None:
        """Write an answer down, and take it when it is time."""
        with self.file.open('a') as file:
            file.write(f'{answer.query_id} {answer.outcome.value} {answer.content} {answer.replaces is not None}\n')
        # As the logger of a node and the middleware do, past Python's stderr.
        os.write(2, b'[INFO] heard an answer\n[WARN] the disk is nearly full\n')
        if self.slow:
            threading.Timer(0.5, self.take, [answer]).start()
        elif not self.deaf:
            self.take(answer)

    def take(self, answer: Answer) -> None:
        """Acknowledge an answer, and go on."""
        self.dialogue.acknowledge(answer.answer_id, True, '')
        if answer.replaces is None:
            self.records.append(QueryRecord(len(self.records) + 1, QueryKind.LABEL, 7, 'fruit', 1.0, Outcome.ANSWERED))
            self.ask()


def main() -> None:
    """Attend in a thread, as the node does."""
    stopped = threading.Event()
    robot = Robot(Path(sys.argv[1]), '--deaf' in sys.argv, '--slow' in sys.argv)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopped.set())
    thread = threading.Thread(target=run_terminal, args=(robot.dialogue, stopped))
    thread.start()
    while thread.is_alive():
        thread.join(0.05)


if __name__ == '__main__':
    main()
