"""Knowledge of a learner, published and written to files whenever it has changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from al_questioner.domain import InputError, Knowledge
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.support.files import write_text


class ConceptsKeeper:
    """Publisher and writer of the `concepts` document; each change is told once.

    Args:
        paths: files to write, each as a whole or not at all.
        publish: publishes a text.
        complain: takes the reason if a file cannot be written; the topic, and what was written before, stay.
    """

    def __init__(self, paths: Sequence[Path], publish: Callable[[str], None], complain: Callable[[str], None]) -> None:
        self._paths, self._publish, self._complain = paths, publish, complain
        self._last: tuple[object, ...] = ()

    def keep(self, version: tuple[object, ...], knowledge: Callable[[], Knowledge]) -> None:
        """Publish and write what is known, unless it is of the same version as the last time."""
        if version == self._last:
            return
        self._last = version
        text = concepts_text(knowledge())
        for path in self._paths:
            try:
                write_text(path, text)
            except InputError as error:
                # The log, if there is one, has it all: no reason to stop asking.
                self._complain(str(error))
        self._publish(text)
