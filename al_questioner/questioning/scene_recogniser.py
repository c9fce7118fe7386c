"""Recognition of things by what a learner knows, and answers to wishes for one of them."""

from __future__ import annotations

import re

from al_questioner.concepts import ConceptLearner
from al_questioner.concepts.lessons import check_fits
from al_questioner.concepts.recognition import Recogniser
from al_questioner.domain import (
    NO_SYMBOL,
    THRESHOLD,
    Action,
    Candidate,
    Finding,
    InputError,
    Knowledge,
    QueryKind,
    RecognisedThing,
    Recognition,
    Scene,
)
from al_questioner.domain.names import LONGEST_SAID, meant, quoted, suggestion
from al_questioner.domain.spelling import said
from al_questioner.questioning.question_wording import question_text
from al_questioner.questioning.review import KnowledgeFollower

_ARTICLE = re.compile(r'^(?:the|an?|some|my) ')


class SceneRecogniser:
    """Follower of what a learner knows that tells what the things of a scene are taken for.

    Args:
        threshold: smallest probability with which a thing is named, 0 to 1.

    Attributes:
        recognition: of the last scene since anything was learnt; None if there is none.

    Raises:
        SettingsError: a threshold out of range.
    """

    def __init__(self, threshold: float = THRESHOLD.default) -> None:
        THRESHOLD.check(threshold)
        self._threshold = threshold
        self._follower = KnowledgeFollower()
        self._knowledge: Knowledge | None = None
        self._recogniser: Recogniser | None = None
        self._fault = ''
        self.recognition: Recognition | None = None

    @property
    def concepts(self) -> ConceptLearner | None:
        """Learner of what is known; None as long as there is no example."""
        return None if self._recogniser is None else self._recogniser.concepts

    @property
    def feature_names(self) -> tuple[str, ...]:
        """Names of the features of what is known; none as long as nothing is."""
        return () if self._knowledge is None else self._knowledge.feature_names

    def follow(self, knowledge: Knowledge) -> None:
        """Learn what is known now; scenes are to be looked at again.

        Raises:
            InputError: lessons that do not fit each other, after which nothing is known.
        """
        # Should a lesson fail, the learner is no longer what it was either.
        self._recogniser = self._knowledge = self.recognition = None
        self._fault = ''
        concepts = self._follower.follow(knowledge)
        # One for all clouds: it keeps what it has measured of all that was seen.
        self._knowledge, self._recogniser = knowledge, Recogniser(concepts) if knowledge.examples else None

    def look(self, scene: Scene) -> Recognition | None:
        """Return what the things of a scene are taken for; None as long as nothing has been taught.

        Raises:
            InputError: the scene has other features than what is known.
        """
        self.recognition, self._fault = None, ''
        if self._knowledge is None or self._recogniser is None:
            return None
        try:
            check_fits(self._knowledge, scene.feature_names)
        except InputError as error:
            self._fault = str(error)
            raise
        self.recognition = recognise_scene(self._recogniser, scene, self._threshold)
        return self.recognition

    def find(self, text: str) -> Finding:
        """Return the most probable thing of the symbol that a plain word means, or why there is none."""
        if self.concepts is None:
            return Finding(text, reason='nothing has been taught yet')
        symbols = self.concepts.symbols
        symbol, reason = _symbol_meant(text, symbols)
        if symbol is None:
            return Finding(text, reason=reason)
        if self.recognition is None:
            return Finding(text, symbol, reason=self._fault or 'no objects have been seen yet')
        column = symbols.index(symbol)
        found = [
            Candidate(each.object_id, each.position, each.probabilities[column]) for each in self.recognition.things
        ]
        if not found:
            return Finding(text, symbol, reason='there is nothing in view')
        first, *others = sorted(found, key=lambda each: -each.probability)
        if first.probability < self._threshold:
            nearest = f'the most probable one is object {first.object_id} with {first.probability:.2g}'
            reason = f'nothing in view is {symbol} with a probability of {self._threshold:g} or more; {nearest}'
            return Finding(text, symbol, None, first, reason)
        taken_for = next(each.best for each in self.recognition.things if each.object_id == first.object_id)
        if taken_for != symbol:
            # With a threshold below one half, several symbols can reach it.
            nearest = f'object {first.object_id} is the most probable one with {first.probability:.2g}'
            return Finding(text, symbol, None, first, f'{nearest}, but is rather {taken_for}')
        return Finding(text, symbol, first, others[0] if others else None)


def recognise_scene(recogniser: Recogniser, scene: Scene, threshold: float = THRESHOLD.default) -> Recognition:
    """Return what the things of a scene are taken for; those that are not known with the question to ask.

    Not known are those below the threshold, and all of them where nothing has been taught: that none of the symbols
    stands out is then no knowledge.
    """
    symbols, examples = recogniser.concepts.symbols, len(recogniser.concepts.labelled_views)
    names = (*symbols, NO_SYMBOL)
    things = []
    rows = zip(
        scene.object_ids, scene.positions.tolist(), recogniser.probabilities(scene.features).tolist(), strict=True
    )
    for object_id, (x, y, z), probabilities in rows:
        highest = max(probabilities)
        is_known = examples > 0 and highest >= threshold
        question = '' if is_known else question_text(Action(QueryKind.LABEL, object_id), symbols)
        best = names[probabilities.index(highest)]
        things.append(RecognisedThing(object_id, (x, y, z), tuple(probabilities), best, question))
    return Recognition(symbols, examples, threshold, tuple(things))


def _symbol_meant(text: str, symbols: tuple[str, ...]) -> tuple[str | None, str]:
    """Return the symbol that a text means, with an article before it or without, or None and why it means none."""
    found = meant(text, symbols)
    if not found and len(text) <= LONGEST_SAID:
        spoken = _ARTICLE.sub('', said(text))
        found = [symbol for symbol in symbols if spoken and said(symbol) == spoken]
    word = quoted(text.strip())
    if len(found) > 1:
        return None, f'{word} could be {" or ".join(found)}: write it exactly so'
    if found:
        return found[0], ''
    return None, f'{word} is nothing that was taught{suggestion(text, symbols)}; known: {", ".join(symbols)}'
