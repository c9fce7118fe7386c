"""The interface of every teacher, simulated or human."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from al_questioner.domain import Answer, Query


class Teacher(Protocol):
    """Somebody who answers questions about a scene."""

    def answer(self, query: Query, truth: Mapping[int, str]) -> Answer:
        """Answer a query; the truth is the symbol, or `NO_SYMBOL`, that this teacher sees in each thing of a scene."""
        ...
