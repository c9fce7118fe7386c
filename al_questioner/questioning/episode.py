"""A learning episode as ask and tell: scenes and answers go in, questions come out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import (
    AUTO,
    DECISION_FEATURES,
    Action,
    Answer,
    AnswerError,
    Decision,
    EpisodeSettings,
    Knowledge,
    Origin,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
    Scene,
    ViewTolerance,
)
from al_questioner.questioning.answers import AnswerHistory, PreparedAnswer, Receipt, content_of
from al_questioner.questioning.candidates import choices
from al_questioner.questioning.concept_history import ConceptHistory
from al_questioner.questioning.keeping import knowledge_after
from al_questioner.questioning.query_status import QueryBook, query_id
from al_questioner.questioning.question_wording import question_text
from al_questioner.questioning.reliability import TeacherRecord, teacher_records
from al_questioner.questioning.strategies.choice import Strategy, ask_nothing
from al_questioner.questioning.strategies.registry import make_strategy
from al_questioner.questioning.turn_context import LastResult, TurnContext


class Episode:
    """One learning episode (section 2.3 of the paper), with the ask-and-tell interface of Optuna and scikit-optimize.

    Each turn: `ask(scene)`; if the decision holds a query, `tell(answer)`, or `time_out()` if nobody answers. An
    answer that replaces one that was wrong can be told at any time. Callers whose answers may be late, or sent twice,
    give them to `take`. A scene or an answer that is refused leaves the episode as it was, so that the turn can be
    tried again. The same settings, scenes, answers and generator give the same queries in any process.

    Args:
        settings: what is given to the learner before it asks; what it knows already, too.
        rng: breaks the strategy's ties.
        view_tolerance: when two views of an object are the same: a number, see `ConceptLearner`, or 'auto': they
            differ by no more than the sensors' noise, see `ViewMemory`.
        strategy: who decides; if not given, `make_strategy` makes the one that the settings name.

    Attributes:
        strategy: who decides.
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
        self.answers = AnswerHistory()
        self._rng = rng
        self.strategy = make_strategy(settings.strategy, settings.weights) if strategy is None else strategy
        self._queries = QueryBook()
        self._history = ConceptHistory(settings, view_tolerance, self.strategy.selector, self._queries)
        self._look_ahead = LastResult()
        self._non_query_turns = 0
        self._scene_turn = 1

    @property
    def concepts(self) -> ConceptLearner:
        """Concepts that the learner has learnt."""
        return self._history.concepts

    @property
    def turn(self) -> int:
        """The present turn, 1-based; 0 before the first."""
        return len(self._history.scenes)

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
        return self._queries.spent

    @property
    def budget_left(self) -> float:
        """Budget that is left for later queries."""
        return max(0.0, self.settings.budget - self.spent)

    @property
    def pending(self) -> Query | None:
        """The query that waits for its answer; it may be of a turn that has timed out."""
        return self._queries.pending

    @property
    def awaited(self) -> Query | None:
        """The query without whose answer, or `time_out`, the present turn does not go on; None if it does."""
        return self._queries.awaited

    @property
    def awaits_answer(self) -> bool:
        """True if the present turn goes on only with the answer to the pending query, or by `time_out`."""
        return self.awaited is not None

    @property
    def unanswered_turns(self) -> int:
        """Consecutive turns that timed out."""
        return self._queries.unanswered_turns

    @property
    def done(self) -> bool:
        """True once all turns have passed and nothing is pending."""
        return self.turns_left == 0 and self.pending is None

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """Records of the queries that are settled, in the order of their turns."""
        return self._queries.records

    @property
    def scene(self) -> Scene:
        """The scene of the present turn, without the sensors' noise.

        Raises:
            RuntimeError: no turn has begun.
        """
        if not self._history.scenes:
            raise RuntimeError('the first turn has not begun')
        return self._history.scenes[-1]

    @property
    def view_noise(self) -> Mapping[str, float]:
        """Noise of each feature by its name, as share of its spread among things; empty if it is not estimated."""
        return self._history.view_noise

    @property
    def positives(self) -> Mapping[str, int]:
        """Number of positive examples of each symbol."""
        return self.concepts.positives

    @property
    def teachers(self) -> dict[str, TeacherRecord]:
        """Statistics of everybody who answered, and how far each can be relied on."""
        return teacher_records(
            self.answers,
            self._queries.by_id,
            self.settings.symbols,
            self._history.beliefs,
            self.settings.concepts,
        )

    @property
    def tuned_turns(self) -> frozenset[int]:
        """Turns at whose end the kernel was tuned, as learners of earlier versions could."""
        return frozenset(self._history.tuned_turns)

    def ask(self, scene: Scene) -> Decision:
        """Start the next turn and decide what to ask.

        While a query of an earlier turn waits for its answer nothing is asked. It is withdrawn, and another one
        asked, when what it is about is not in view any more as it was.

        Raises:
            SceneError: the scene's features are not those of the scenes before.
            RuntimeError: the present turn waits for an answer, or the episode is over.
        """
        self._check_not_awaiting()
        if self.turns_left == 0:
            raise RuntimeError(f'the episode is over: all {self.settings.turns} turns have passed')
        scene = self._history.observe(scene)
        if self.pending is not None and not self._is_in_view(self.pending, scene):
            self._withdraw(self.pending)
        turn = self.turn + 1
        unchanged = self.turn > 0 and self.concepts.is_unchanged(self.scene, scene)
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
            look_ahead=self._look_ahead,
        )
        pending = self.pending
        choice = self.strategy.choose(context, self._rng) if pending is None else ask_nothing(context)
        self._history.begin_turn(scene)
        self._scene_turn = scene_turn
        query = self._query(context.candidates[choice.index], scene)
        awaited = query if pending is None else pending
        if awaited is not None:
            self._queries.await_answer(awaited)
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
        self._queries.time_out(query)
        if self.turns_left == 0:
            self._withdraw(query)

    def tell(self, answer: Answer) -> QueryRecord:
        """Take in the answer to the pending query, to one that was withdrawn, or one that replaces a wrong answer.

        Returns:
            What came of the query.

        Raises:
            AnswerError: the answer is invalid, see `prepare`, was told before, or is late.
        """
        prepared = self.prepare(answer)
        if prepared.record is None:
            which = f'the answer {answer.answer_id!r} to query {answer.query_id!r}'
            raise AnswerError(f'{which} does not count: {prepared.reason}')
        self.commit(prepared)
        return prepared.record

    def take(self, answer: Answer) -> PreparedAnswer:
        """Take an answer for what it is: each counts once, however often it is sent, and a late one is only kept.

        Returns:
            What became of it.

        Raises:
            AnswerError: it is invalid, see `prepare`.
        """
        prepared = self.prepare(answer)
        self.commit(prepared)
        return prepared

    def prepare(self, answer: Answer) -> PreparedAnswer:
        """Check an answer, and say what `commit` will do with it; nothing changes.

        An answer to a query counts in whichever turn it comes: what is known then is what it would be had the answer
        come in the query's turn. So does one that replaces an answer: it counts as if it had been given at once. What
        was asked since stays asked. An answer is replaced once; what replaced it can be replaced in turn.

        Raises:
            AnswerError: there is no such query, the answer does not fit it, another one of the same ids was taken, or
                the one that it replaces was not, or was replaced already.
        """
        receipt = self.answers.receipt_for(answer)
        reason = self.answers.why_not(answer, receipt)
        if receipt is Receipt.DUPLICATE:
            return PreparedAnswer(answer, receipt, reason=reason, is_kept=False)
        query = self._queries.by_id.get(answer.query_id)
        if query is None:
            if self.pending is None:
                raise AnswerError(f'no query is pending; the answer was to {answer.query_id!r}')
            other = self.pending.query_id
            raise AnswerError(f'the answer is to query {answer.query_id!r}, the pending one is {other!r}')
        scene = self._scene_of(query)
        told = content_of(answer, query.action, self.settings.symbols, self.concepts.groups, scene)
        if receipt is Receipt.LATE:
            return PreparedAnswer(answer, receipt, reason=reason, is_kept=self.answers.keeps_late(answer))
        before = self._queries.record_of(query)
        if answer.replaces is None or before is None:
            answered_in = None if query.turn == self.turn else self.turn
        else:
            answered_in = before.answered_in
        record = QueryRecord(
            query.turn,
            query.action.kind,
            told.object_id,
            told.symbol,
            self._charged(query, answer.outcome),
            answer.outcome,
            told.groups,
            answered_in,
            told.objects,
        )
        return PreparedAnswer(answer, receipt, record)

    def commit(self, prepared: PreparedAnswer) -> None:
        """Take in an answer that was prepared; nothing else may have happened to the episode since."""
        answer, record = prepared.answer, prepared.record
        if record is not None:
            query = self._queries.by_id[answer.query_id]
            self._queries.answer(query, record)
            self.answers.take(answer, query)
            self._history.learn(record, is_correction=answer.replaces is not None)
        elif prepared.is_kept:
            self.keep_late(answer)

    def keep_late(self, answer: Answer) -> None:
        """Keep an answer that is known to be late; a replay has it from what was recorded."""
        self.answers.keep_late(answer)

    def repeat_tuning(self) -> None:
        """Tune the kernel as a learner of an earlier version did at the end of this turn; a replay of its log needs it.

        Raises:
            RuntimeError: the turn is not over: it waits for an answer.
        """
        self._check_not_awaiting()
        self._history.repeat_tuning()

    def knowledge(
        self,
        episode_id: str,
        stamps: Mapping[int, int] | None = None,
        world: Mapping[str, Any] | None = None,
        version: str = '',
    ) -> Knowledge:
        """Return all that is known now, to keep it, and to begin another episode with it.

        Args:
            episode_id: of this episode; no earlier one of what is known may have the same.
            stamps: time of each turn in nanoseconds, as far as it is known.
            world: the simulated world, as in an `episode` document; None if it is another one.
            version: of this package.

        Raises:
            InputError: nothing was seen yet, or an earlier episode had the same id.
        """
        return knowledge_after(
            self.settings,
            self._history,
            self._queries,
            self.answers,
            self.teachers,
            Origin(episode_id, self.settings.symbols, self.settings.strategy, world, version),
            {} if stamps is None else stamps,
        )

    def _check_not_awaiting(self) -> None:
        if self.awaited is not None:
            raise RuntimeError(f'query {self.awaited.query_id} has not been answered yet')

    def _scene_of(self, query: Query) -> Scene:
        return self._history.scenes[query.turn - 1]

    def _is_in_view(self, query: Query, scene: Scene) -> bool:
        """Return whether a scene still shows what a query of an earlier turn is about."""
        if query.action.object_id is not None:
            return self.concepts.still_shows(query.action.object_id, self._scene_of(query), scene)
        return query.action.kind is QueryKind.FEATURE_SUBSET or self.concepts.is_unchanged(self._scene_of(query), scene)

    def _withdraw(self, query: Query) -> None:
        """Wait no longer for the answer to a query."""
        action, outcome = query.action, Outcome.UNANSWERED
        cost = self._charged(query, outcome)
        record = QueryRecord(query.turn, action.kind, action.object_id, action.symbol, cost, outcome)
        self._queries.withdraw(query, record)

    def _charged(self, query: Query, outcome: Outcome) -> float:
        """Return what a query costs in the end; once it is settled, no more than what is left."""
        price = query.cost * self.settings.costs.charged_fraction(outcome)
        before = self._queries.record_of(query)
        return price if before is None else min(price, self.budget_left + before.cost)

    def _query(self, action: Action, scene: Scene) -> Query | None:
        """Return the query that an action puts to the teacher; None if it asks nothing."""
        if action.kind is QueryKind.NO_QUERY:
            return None
        cost = self.settings.costs.price(action.kind)
        return Query(
            query_id=query_id(len(self._queries.by_id) + 1),
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
