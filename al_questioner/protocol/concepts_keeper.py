"""Knowledge of a learner, published and written to files whenever it has changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from al_questioner.domain import InputError, Knowledge
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.protocol.effects import Effects, Level, Publish, Say, WriteFile


class ConceptsKeeper:
    """Part of a machine that publishes and writes the `concepts` document; each change is told once.

    Args:
        paths: files to write. If one cannot be written, that is said, and the topic and what the file held before stay.

    Attributes:
        warning: why files lag behind what is known; empty if none does. Another thread may read it.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = paths
        self._last: tuple[object, ...] = ()
        self.warning = ''

    def keep(self, version: tuple[object, ...], knowledge: Callable[[], Knowledge]) -> Effects:
        """Publish and write what is known, unless it is of the same version as the last time."""
        if version == self._last:
            return
        self._last = version
        text = concepts_text(knowledge())
        failures = []
        for path in self._paths:
            try:
                yield WriteFile(path, text)
            except InputError as error:
                # The log, if there is one, has it all: no reason to stop asking.
                failures.append(str(error))
                yield Say(str(error), Level.ERROR)
        self.warning = '; '.join(failures)
        yield Publish('concepts', text)
