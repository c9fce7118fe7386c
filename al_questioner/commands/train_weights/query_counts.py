"""Number of queries that learnt weights ask beside the expert: weights that agree on average may hardly ask."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.markup import escape

from al_questioner.domain import DEFAULT_CLASSIFIERS, Classifiers, InputError, QueryRecord
from al_questioner.imitation.assessment import imitate
from al_questioner.imitation.demonstration import Demonstration
from al_questioner.imitation.training import Training
from al_questioner.simulation import PerceivedWorld
from al_questioner.support.text import number_of

TIMID = 0.5
"""Share of the expert's questions below which learnt weights are warned of."""

Queries = list[tuple[QueryRecord, ...]]
"""Numbers of queries, one for each episode."""


def warn_of_classifiers(demonstrations: Sequence[Demonstration]) -> str:
    """Return a warning of demonstrations with other classifiers than the default; empty if there are none."""
    found = {demonstration.settings.classifiers for demonstration in demonstrations} - {DEFAULT_CLASSIFIERS}
    if not found:
        return ''
    count = sum(demonstration.settings.classifiers != DEFAULT_CLASSIFIERS for demonstration in demonstrations)
    of = f'{count} of {number_of(len(demonstrations), "demonstration")}'
    return (
        f'{of} played with {_listed(found)}; learners have {DEFAULT_CLASSIFIERS} unless told otherwise'
        ' (parameters amplitude, kernel_shape, class_balance), and the weights need not suit both'
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
        self._played: dict[Classifiers | None, Queries] = {}
        self.hindrance = ''
        try:
            self._worlds = [demonstration.open_world() for demonstration in demonstrations]
        except InputError as error:
            self.hindrance = str(error)

    def play(self, classifiers: Classifiers | None = None) -> Queries:
        """Play with these classifiers, or with those of each demonstration, and return the queries."""
        if classifiers not in self._played:
            pairs = zip(self._demonstrations, self._worlds, strict=True)
            self._played[classifiers] = [imitate(self._weights, *pair, classifiers).queries for pair in pairs]
        return self._played[classifiers]


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
        found = {demonstration.settings.classifiers for demonstration in demonstrations}
        asked = {f'with {_listed(found)}, as it was trained': _count(free.play())}
        if found != {DEFAULT_CLASSIFIERS}:
            usual = f'with {DEFAULT_CLASSIFIERS}, as learners have unless told otherwise'
            asked[usual] = _count(free.play(DEFAULT_CLASSIFIERS))
        told = ', and '.join(f'{number_of(count, "question")} {how}' for how, count in asked.items())
        yield f'by itself, taking the best candidate, the learner asks {told}; the expert asked {by_expert}'
    timid = [how for how, count in asked.items() if count < TIMID * by_expert]
    if timid:
        where = '; '.join(timid)
        yield f'[yellow]WARNING: with these weights it hardly asks ({where}); they are of little use[/yellow]'


def _count(queries: Queries) -> int:
    return sum(map(len, queries))


def _listed(found: Iterable[Classifiers]) -> str:
    return ' and '.join(map(str, sorted(found)))
