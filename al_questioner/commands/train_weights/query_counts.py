"""Number of queries that learnt weights ask beside the expert: weights that agree on average may hardly ask."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.markup import escape

from al_questioner.domain import AMPLITUDE, InputError, QueryRecord
from al_questioner.imitation.assessment import imitate
from al_questioner.imitation.demonstration import Demonstration
from al_questioner.imitation.training import Training
from al_questioner.simulation import PerceivedWorld
from al_questioner.support.text import number_of

TIMID = 0.5
"""Share of the expert's questions below which learnt weights are warned of."""

Queries = list[tuple[QueryRecord, ...]]
"""Numbers of queries, one for each episode."""


def warn_of_amplitudes(demonstrations: Sequence[Demonstration]) -> str:
    """Return a warning of demonstrations recorded with another amplitude than the default; empty if there are none."""
    found = sorted({demonstration.settings.amplitude for demonstration in demonstrations} - {AMPLITUDE.default})
    if not found:
        return ''
    count = sum(demonstration.settings.amplitude != AMPLITUDE.default for demonstration in demonstrations)
    of = f'{count} of {number_of(len(demonstrations), "demonstration")}'
    return (
        f'{of} recorded with amplitude {_listed(found)}; learners have {AMPLITUDE.default:g} unless told otherwise'
        ' (parameter amplitude), and the weights need not suit both'
    )


class FreePlay:
    """The learner with trained weights, by itself, in the demonstrations' worlds and with their limits and time.

    Attributes:
        hindrance: why it cannot play there; empty if it can.
    """

    def __init__(self, training: Training, demonstrations: Sequence[Demonstration]) -> None:
        self._weights = training.weights
        self._demonstrations = demonstrations
        self._worlds: list[PerceivedWorld] = []
        self._played: dict[float | None, Queries] = {}
        self.hindrance = ''
        try:
            self._worlds = [demonstration.open_world() for demonstration in demonstrations]
        except InputError as error:
            self.hindrance = str(error)

    def play(self, amplitude: float | None = None) -> Queries:
        """Play with classifiers of this amplitude, or of that of each demonstration, and count the queries."""
        if amplitude not in self._played:
            pairs = zip(self._demonstrations, self._worlds, strict=True)
            self._played[amplitude] = [imitate(self._weights, *pair, amplitude).queries for pair in pairs]
        return self._played[amplitude]


def tell_eagerness(demonstrations: Sequence[Demonstration], in_place: Queries | None, free: FreePlay) -> Iterator[str]:
    """Lines on how much the learner asks; a warning, in colour, if that is little.

    Nothing is said of the queries `in_place`, in the expert's states, if there are none.
    """
    by_expert = sum(len(demonstration.queries) for demonstration in demonstrations)
    asked: dict[str, int] = {}
    if in_place is not None:
        count = asked["in the expert's states"] = _count(in_place)
        questions = number_of(count, 'question')
        yield f"in the expert's states the best candidate is {questions}; the expert asked {by_expert}"
    if free.hindrance:
        yield f'what the learner asks by itself is not known: {escape(free.hindrance)}'
    else:
        amplitudes = {demonstration.settings.amplitude for demonstration in demonstrations}
        asked = {f'with amplitude {_listed(amplitudes)}, as in the demonstrations': _count(free.play())}
        if amplitudes != {AMPLITUDE.default}:
            usual = f'with {AMPLITUDE.default:g}, as learners have unless told otherwise'
            asked[usual] = _count(free.play(AMPLITUDE.default))
        told = ', and '.join(f'{number_of(count, "question")} {how}' for how, count in asked.items())
        yield f'by itself, taking the best candidate, the learner asks {told}; the expert asked {by_expert}'
    timid = [how for how, count in asked.items() if count < TIMID * by_expert]
    if timid:
        where = '; '.join(timid)
        yield f'[yellow]WARNING: with these weights it hardly asks ({where}); they are of little use[/yellow]'


def _count(queries: Queries) -> int:
    return sum(map(len, queries))


def _listed(amplitudes: Sequence[float] | set[float]) -> str:
    return ' and '.join(f'{amplitude:g}' for amplitude in sorted(amplitudes))
