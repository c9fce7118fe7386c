"""Recognised things, and the answer to a wish for one of them."""

from __future__ import annotations

from dataclasses import dataclass

from al_questioner.domain.setting import Setting

_OF_THRESHOLD = 'smallest probability with which a thing is named; a thing of a smaller one is not known'
THRESHOLD = Setting('threshold', 0.5, _OF_THRESHOLD, '', 0, 1)


@dataclass(frozen=True)
class RecognisedThing:
    """One thing in view, and what it is taken for.

    Attributes:
        object_id: of the scene.
        position: (x, y, z) metres in the frame of the scene.
        probabilities: of each symbol, and as the last that of `NO_SYMBOL`; they add up to 1.
        best: the most probable of these, a symbol or `NO_SYMBOL`; the first of them if several are.
        question: that would tell what it is, in plain English; empty for a thing that is known.
    """

    object_id: int
    position: tuple[float, float, float]
    probabilities: tuple[float, ...]
    best: str
    question: str = ''

    @property
    def probability(self) -> float:
        """Probability of the best."""
        return max(self.probabilities)

    @property
    def is_known(self) -> bool:
        """True if it is named; otherwise the robot does not know what it is."""
        return not self.question


@dataclass(frozen=True)
class Recognition:
    """All things in view, and what they are taken for.

    Attributes:
        symbols: in the order of the probabilities.
        examples: number of labelled views that it is judged by.
        threshold: smallest probability of a thing that is known.
        things: in the order of the scene.
    """

    symbols: tuple[str, ...]
    examples: int
    threshold: float
    things: tuple[RecognisedThing, ...]


@dataclass(frozen=True)
class Candidate:
    """A thing, and the probability that it is what is wanted."""

    object_id: int
    position: tuple[float, float, float]
    probability: float


@dataclass(frozen=True)
class Finding:
    """Answer to a wish for a thing of some symbol.

    Attributes:
        wanted: what was said.
        symbol: that is meant; None if that is not known.
        target: the most probable thing of the symbol; None if there is none.
        runner_up: the most probable one of all other things; None if there is none.
        reason: why there is no target, in one line; empty if there is one.
    """

    wanted: str
    symbol: str | None = None
    target: Candidate | None = None
    runner_up: Candidate | None = None
    reason: str = ''

    @property
    def text(self) -> str:
        """Answer as a sentence."""
        if self.target is None:
            return f'{self.reason[:1].upper()}{self.reason[1:]}.'
        sentence = (
            f'Object {self.target.object_id} is {self.symbol} with a probability of {self.target.probability:.2g}'
        )
        if self.runner_up is None:
            return f'{sentence}; nothing else is in view.'
        return f'{sentence}; next is object {self.runner_up.object_id} with {self.runner_up.probability:.2g}.'
