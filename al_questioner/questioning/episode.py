"""A learning episode as ask and tell: scenes and answers go in, questions come out."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import VIEW_TOLERANCE, ConceptLearner, ViewMemory
from al_questioner.concepts.view_memory import corrected
from al_questioner.domain import (
    AUTO,
    DECISION_FEATURES,
    Action,
    Answer,
    AnswerError,
    Decision,
    EpisodeSettings,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
    Scene,
    ViewTolerance,
)
from al_questioner.questioning.answers import AnswerHistory, content_of
from al_questioner.questioning.candidates import choices, question_text
from al_questioner.questioning.initial_concepts import new_concept_learner
from al_questioner.questioning.reliability import TeacherRecord, label_beliefs, teacher_records
from al_questioner.questioning.strategies.choice import Strategy, ask_nothing
from al_questioner.questioning.strategies.registry import make_strategy
from al_questioner.questioning.turn_context import TurnContext


class Episode:
    """One learning episode (section 2.3 of the paper).

    Each turn: `ask(scene)`; if the decision holds a query, `tell(answer)`, or `time_out()` if nobody answers; at the
    turn's end `tune()`. At any time `correct(answer)` takes another answer for one that was wrong. A scene or an answer
    that is refused leaves the episode as it was, so that the turn can be tried again. The same settings, scenes,
    answers and generator give the same queries in any process.

    Args:
        settings: what is given to the learner before it asks.
        rng: breaks the strategy's ties.
        view_tolerance: when two views of an object are the same: a number, see `ConceptLearner`, or 'auto': they
            differ by no more than the sensors' noise, see `ViewMemory`.
        strategy: who decides in the place of the strategy that the settings name.

    Attributes:
        settings: what was given to the learner.
        concepts: what it knows now.
        answers: what was said to the queries.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """

    def __init__(
        self,
        settings: EpisodeSettings,
        rng: np.random.Generator,
        view_tolerance: ViewTolerance = AUTO,
        strategy: Strategy | None = None,
    ) -> None:
        self.settings = settings
        self._rng = rng
        self._strategy = make_strategy(settings.strategy, settings.weights) if strategy is None else strategy
        self._views = ViewMemory() if view_tolerance == AUTO else None
        self._view_tolerance = VIEW_TOLERANCE if view_tolerance == AUTO else view_tolerance
        self.concepts = new_concept_learner(settings, self._view_tolerance, self._strategy)
        self._records: dict[int, QueryRecord] = {}
        self._beliefs: dict[int, NDArray[np.float64]] = {}
        self._pending: Query | None = None
        self._queries: dict[str, Query] = {}
        self.answers = AnswerHistory()
        self._non_query_turns = 0
        self._passed_turn = 0
        self._unanswered_turns = 0
        self._scenes: list[Scene] = []
        self._scene_turn = 1
        self._tuned_turns: set[int] = set()

    @property
    def turn(self) -> int:
        """The present turn, 1-based; 0 before the first."""
        return len(self._scenes)

    @property
    def turns_left(self) -> int:
        """Turns after the present one."""
        return self.settings.turns - self.turn

    @property
    def turns_over(self) -> int:
        """Turns that are over: the present one is not while it waits for an answer."""
        return self.turn - self.awaits_answer

    @property
    def spent(self) -> float:
        """Costs of the queries so far, the pending one included as if it were answered."""
        settled = [record.cost for record in self._records.values()]
        return math.fsum(settled if self._pending is None else [*settled, self._pending.cost])

    @property
    def budget_left(self) -> float:
        """What later queries can cost."""
        return max(0.0, self.settings.budget - self.spent)

    @property
    def pending(self) -> Query | None:
        """The query that waits for its answer; it may be of a turn that has passed."""
        return self._pending

    @property
    def awaited(self) -> Query | None:
        """The query without whose answer, or `time_out`, the present turn does not go on; None if it does."""
        return self._pending if self._passed_turn < self.turn else None

    @property
    def awaits_answer(self) -> bool:
        """Whether the present turn goes on only with the answer to the pending query, or by `time_out`."""
        return self.awaited is not None

    @property
    def unanswered_turns(self) -> int:
        """Consecutive turns that were let pass without an answer."""
        return self._unanswered_turns

    @property
    def done(self) -> bool:
        """Whether all turns have passed and nothing is pending."""
        return self.turns_left == 0 and self._pending is None

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """What came of the queries that are settled, in the order of their turns."""
        return tuple(self._records[turn] for turn in sorted(self._records))

    @property
    def scene(self) -> Scene:
        """The scene of the present turn, without the sensors' noise.

        Raises:
            RuntimeError: no turn has begun.
        """
        if not self._scenes:
            raise RuntimeError('the first turn has not begun')
        return self._scenes[-1]

    @property
    def view_noise(self) -> Mapping[str, float]:
        """Noise of each feature by its name, as share of its spread among things; empty if it is not estimated."""
        return {} if self._views is None else self._views.noise

    @property
    def positives(self) -> Mapping[str, int]:
        """Number of positive examples of each symbol."""
        return self.concepts.positives

    def ask(self, scene: Scene) -> Decision:
        """Start the next turn and decide what to ask.

        While a query of an earlier turn waits for its answer nothing is asked. It is withdrawn, and another one
        asked, when what it is about is not in view any more as it was.

        Args:
            scene: what is seen this turn.

        Raises:
            SceneError: the scene's features are not those of the scenes before.
            RuntimeError: the present turn waits for an answer, or the episode is over.
        """
        if self.awaited is not None:
            raise RuntimeError(f'query {self.awaited.query_id} has not been answered yet')
        if self.turns_left == 0:
            raise RuntimeError(f'the episode is over: all {self.settings.turns} turns have passed')
        self.concepts.check_features(scene)
        if self._views is not None:
            scene = self._views.steady(scene, self.concepts.spread, self.concepts.are_implausible(scene))
            if self._views.corrections:
                self._scenes = [corrected(past, self._views.corrections) for past in self._scenes]
                self._learn_anew()
        self.concepts.observe(scene)
        if self._pending is not None and not self._is_in_view(self._pending, scene):
            self._withdraw(self._pending)
        turn = self.turn + 1
        last = self._scenes[-1] if self._scenes else None
        unchanged = last is not None and self.concepts.is_unchanged(last, scene)
        scene_turn = self._scene_turn if unchanged else turn
        context = TurnContext(
            turn=turn,
            turns=self.settings.turns,
            scene=scene,
            concepts=self.concepts,
            budget=self.settings.budget,
            spent=self.spent,
            costs=self.settings.costs,
            change_interval=self.settings.change_interval,
            non_query_turns=self._non_query_turns,
            scene_turn=scene_turn,
            history=self.records,
        )
        asks = self._pending is None
        choice = self._strategy.choose(context, self._rng) if asks else ask_nothing(context)
        # A scene that stays is kept once: an episode of a camera would fill the memory.
        self._scenes.append(last if last is not None and last.equals(scene) else scene)
        self._scene_turn = scene_turn
        query = self._query(context.candidates[choice.index], scene)
        self._non_query_turns = 0 if query else self._non_query_turns + 1
        shape = (len(context.candidates), len(DECISION_FEATURES))
        return Decision(
            turn=turn,
            candidates=context.candidates,
            features=np.full(shape, np.nan) if choice.features is None else choice.features,
            utilities=choice.utilities,
            chosen=choice.index,
            query=query,
        )

    def time_out(self) -> None:
        """End the turn without the answer that it waits for: the teacher is away.

        The query stays pending, so that it can still be answered; nothing is guessed. After the last turn it is
        withdrawn.

        Raises:
            RuntimeError: the turn does not wait for an answer.
        """
        query = self.awaited
        if query is None:
            raise RuntimeError('no query waits for its answer')
        self._passed_turn = self.turn
        self._unanswered_turns += 1
        if self.turns_left == 0:
            self._withdraw(query)

    def tell(self, answer: Answer) -> QueryRecord:
        """Take in the answer to the pending query, or to one that was withdrawn since nobody had answered.

        What is known then is what it would be had the answer come in the turn of its query.

        Raises:
            AnswerError: no such query waits for an answer, or the answer does not fit the question.
        """
        if answer.replaces is not None:
            raise AnswerError(f'the answer replaces {answer.replaces!r}: it corrects, and does not answer')
        record = self.check(answer)
        if self._pending is not None and answer.query_id == self._pending.query_id:
            self._pending = None
        self._unanswered_turns = 0
        self._records[record.turn] = record
        self.answers.take(answer, self._queries[answer.query_id])
        # After it was tuned, a turn's answer comes too late for the order in which everything else is learnt.
        if record.turn == self.turn and self.turn not in self._tuned_turns:
            self._learn(self.concepts, record)
        else:
            self._learn_anew()
        return record

    def correct(self, answer: Answer) -> QueryRecord:
        """Take another answer for one that was accepted before and was wrong.

        What is recorded and known is then what it would be had the answer been this one at once: of that turn. What
        was asked since stays asked, and what is pending stays pending. An answer is replaced once; what replaced it
        can be replaced in turn.

        Raises:
            AnswerError: the answer names none that it replaces, or one that was not accepted or was replaced already,
                its id is taken, or it does not fit the question.
        """
        if answer.replaces is None:
            raise AnswerError(f'the answer to query {answer.query_id!r} does not say what it replaces')
        record = self.check(answer)
        self._records[record.turn] = record
        self.answers.take(answer, self._queries[answer.query_id])
        self._learn_anew()
        return record

    def check(self, answer: Answer) -> QueryRecord:
        """What `tell`, or `correct` if the answer replaces another, would record; nothing changes.

        Raises:
            AnswerError: the answer would be refused.
        """
        query = self._addressed(answer)
        object_id, symbol, groups = self._content(answer, query)
        before = self._records.get(query.turn)
        if answer.replaces is None or before is None:
            answered_in = None if query.turn == self.turn else self.turn
        else:
            answered_in = before.answered_in
        cost = self._charged(query, answer.outcome)
        return QueryRecord(query.turn, query.action.kind, object_id, symbol, cost, answer.outcome, groups, answered_in)

    def check_late(self, answer: Answer) -> None:
        """Make sure that an answer to a query that another one has settled would have been one.

        Raises:
            AnswerError: it does not fit the question.
        """
        self._content(answer, self._queries[answer.query_id])

    @property
    def teachers(self) -> dict[str, TeacherRecord]:
        """What everybody who answered has said, and how far they can be relied on."""
        return teacher_records(self.answers, self._queries, self.settings.symbols, self._beliefs)

    @property
    def tune_is_due(self) -> bool:
        """Whether `tune` would do something at the end of this turn, or has yet to."""
        return self.turn not in self._tuned_turns and self.settings.tunes_after(self.turn)

    def tune(self) -> bool:
        """Re-optimise the kernel if this turn is one for it; call it at the end of a turn, when nobody waits.

        Returns:
            Whether the beliefs may have changed.

        Raises:
            RuntimeError: the turn is not over: it waits for an answer.
        """
        if self.awaited is not None:
            raise RuntimeError(f'query {self.awaited.query_id} has not been answered yet')
        if not self.tune_is_due:
            return False
        self._tuned_turns.add(self.turn)
        return self.concepts.tune()

    def _addressed(self, answer: Answer) -> Query:
        """The query that an answer is to: the pending one, one that was withdrawn, or that of what it replaces.

        Raises:
            AnswerError: there is none.
        """
        if answer.replaces is not None:
            self.answers.check_correction(answer)
            return self._queries[answer.query_id]
        query = self._queries.get(answer.query_id)
        if query is not None and query is self._pending:
            return query
        record = None if query is None else self._records.get(query.turn)
        if query is not None and record is not None and record.outcome is Outcome.UNANSWERED:
            return query
        if self._pending is None:
            raise AnswerError(f'no query is pending; the answer was to {answer.query_id!r}')
        raise AnswerError(f'the answer is to query {answer.query_id!r}, the pending one is {self._pending.query_id!r}')

    def _content(self, answer: Answer, query: Query) -> tuple[int | None, str | None, tuple[str, ...]]:
        return content_of(answer, query.action, self.settings.symbols, self.concepts.groups, self._scene_of(query))

    def _scene_of(self, query: Query) -> Scene:
        return self._scenes[query.turn - 1]

    def _is_in_view(self, query: Query, scene: Scene) -> bool:
        """Whether a scene still shows what a query of an earlier turn is about."""
        if query.action.object_id is not None:
            return self.concepts.still_shows(query.action.object_id, self._scene_of(query), scene)
        return query.action.kind is QueryKind.FEATURE_SUBSET or self.concepts.is_unchanged(self._scene_of(query), scene)

    def _withdraw(self, query: Query) -> None:
        """Wait no longer for the answer to a query."""
        self._pending = None
        action, outcome = query.action, Outcome.UNANSWERED
        cost = self._charged(query, outcome)
        self._records[query.turn] = QueryRecord(query.turn, action.kind, action.object_id, action.symbol, cost, outcome)

    def _charged(self, query: Query, outcome: Outcome) -> float:
        """What a query costs in the end; once it was withdrawn or answered otherwise, no more than there is left."""
        price = query.cost * self.settings.costs.charged_fraction(outcome)
        before = self._records.get(query.turn)
        return price if before is None else min(price, self.budget_left + before.cost)

    def _learn(self, concepts: ConceptLearner, record: QueryRecord) -> None:
        """Learn what came of a query, after a note of what was believed of the thing before."""
        scene = self._scenes[record.turn - 1]
        if record.outcome is Outcome.ANSWERED and record.object_id is not None and record.symbol is not None:
            features = scene.features[[scene.index_of(record.object_id)]]
            self._beliefs[record.turn] = label_beliefs(concepts.predict_proba(features)[0])
        concepts.learn(record, scene)

    def _learn_anew(self) -> None:
        """Learn the concepts anew from the scenes and the records, event by event as it came about."""
        concepts = new_concept_learner(self.settings, self._view_tolerance, self._strategy)
        self._beliefs.clear()
        for turn, scene in enumerate(self._scenes, start=1):
            concepts.observe(scene)
            if turn in self._records:
                self._learn(concepts, self._records[turn])
            if turn in self._tuned_turns:
                concepts.tune()
        self.concepts = concepts

    def _query(self, action: Action, scene: Scene) -> Query | None:
        """Put the action to the teacher; None if it asks nothing."""
        if action.kind is QueryKind.NO_QUERY:
            return None
        cost = self.settings.costs.price(action.kind)
        query = Query(
            query_id=f'q{len(self._queries) + 1}',
            turn=self.turn,
            action=action,
            choices=choices(action, scene, self.settings.symbols, self.concepts.groups),
            cost=cost,
            budget_left=max(0.0, self.settings.budget - (self.spent + cost)),
            turns_left=self.turns_left,
            model_version=self.concepts.model_version,
            text=question_text(action, self.settings.symbols),
            known=self.concepts.labelled_ids(scene) if action.kind is QueryKind.DEMONSTRATION else None,
        )
        self._queries[query.query_id] = self._pending = query
        return query
