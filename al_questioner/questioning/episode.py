"""A learning episode as ask and tell: scenes and answers go in, questions come out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from al_questioner.concepts import VIEW_TOLERANCE, Knowledge
from al_questioner.domain import (
    DECISION_FEATURES,
    NO_SYMBOL,
    Action,
    Answer,
    AnswerError,
    Decision,
    EpisodeSettings,
    LateAnswerError,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
    Scene,
)
from al_questioner.questioning.candidates import choices, question_text
from al_questioner.questioning.choice import Strategy
from al_questioner.questioning.situation import Situation
from al_questioner.questioning.strategies import make_strategy


def new_knowledge(
    settings: EpisodeSettings, view_tolerance: float = VIEW_TOLERANCE, strategy: Strategy | None = None
) -> Knowledge:
    """What a learner with these settings knows before the first turn.

    Args:
        settings: of the episode.
        view_tolerance: see `Knowledge`.
        strategy: who decides, and selects features, in the place of the strategy that the settings name.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """
    if strategy is None:
        strategy = make_strategy(settings.strategy, settings.weights)
    return Knowledge(
        settings.symbols,
        settings.amplitude,
        settings.length_scale,
        strategy.selector,
        view_tolerance,
    )


class Episode:
    """One learning episode (section 2.3 of the paper).

    Each turn: `ask(scene)`, if the decision holds a query, `tell(answer)`, and at the turn's end `tune()`. At any time
    `amend(answer)` takes another answer for one that was wrong. A scene or an answer that is refused leaves the episode
    as it was, so that the turn can be tried again. The same settings, scenes, answers and generator give the same
    queries in any process.

    Args:
        settings: what is given to the learner before it asks.
        rng: breaks the strategy's ties.
        view_tolerance: when two views of an object are the same, see `Knowledge`.
        strategy: who decides in the place of the strategy that the settings name.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """

    def __init__(
        self,
        settings: EpisodeSettings,
        rng: np.random.Generator,
        view_tolerance: float = VIEW_TOLERANCE,
        strategy: Strategy | None = None,
    ) -> None:
        self.settings = settings
        self._rng = rng
        self._strategy = make_strategy(settings.strategy, settings.weights) if strategy is None else strategy
        self._view_tolerance = view_tolerance
        self.knowledge = new_knowledge(settings, view_tolerance, self._strategy)
        self._spent = 0.0
        self._records: list[QueryRecord] = []
        self._pending: Query | None = None
        self._queries: dict[str, Query] = {}
        self._answers: dict[str, dict[str, Answer]] = {}
        self._non_query_turns = 0
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
    def spent(self) -> float:
        """Costs of the queries so far, the pending one included: asking costs, whatever the answer."""
        return self._spent

    @property
    def budget_left(self) -> float:
        """What later queries can cost."""
        return max(0.0, self.settings.budget - self._spent)

    @property
    def pending(self) -> Query | None:
        """The query that waits for its answer."""
        return self._pending

    @property
    def done(self) -> bool:
        """Whether all turns have passed and nothing is pending."""
        return self.turns_left == 0 and self._pending is None

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """The answered queries, in order."""
        return tuple(self._records)

    @property
    def positives(self) -> Mapping[str, int]:
        """Number of positive examples of each symbol."""
        return self.knowledge.positives

    def ask(self, scene: Scene) -> Decision:
        """Start the next turn and decide what to ask.

        Args:
            scene: what is seen this turn.

        Raises:
            SceneError: the scene's features are not those of the scenes before.
            RuntimeError: the last query is not answered yet, or the episode is over.
        """
        if self._pending is not None:
            raise RuntimeError(f'query {self._pending.query_id} has not been answered yet')
        if self.turns_left == 0:
            raise RuntimeError(f'the episode is over: all {self.settings.turns} turns have passed')
        self.knowledge.observe(scene)
        turn = self.turn + 1
        last = self._scenes[-1] if self._scenes else None
        unchanged = last is not None and self.knowledge.is_unchanged(last, scene)
        scene_turn = self._scene_turn if unchanged else turn
        situation = Situation(
            turn=turn,
            turns=self.settings.turns,
            scene=scene,
            knowledge=self.knowledge,
            budget=self.settings.budget,
            spent=self._spent,
            costs=self.settings.costs,
            change_interval=self.settings.change_interval,
            non_query_turns=self._non_query_turns,
            scene_turn=scene_turn,
            history=self.records,
        )
        choice = self._strategy.choose(situation, self._rng)
        # A scene that stays is kept once: an episode of a camera would fill the memory.
        self._scenes.append(last if last is not None and last.equals(scene) else scene)
        self._scene_turn = scene_turn
        self._pending = self._query(situation.candidates[choice.index], scene)
        self._non_query_turns = 0 if self._pending else self._non_query_turns + 1
        shape = (len(situation.candidates), len(DECISION_FEATURES))
        return Decision(
            turn=turn,
            candidates=situation.candidates,
            features=np.full(shape, np.nan) if choice.features is None else choice.features,
            utilities=choice.utilities,
            chosen=choice.index,
            query=self._pending,
        )

    def tell(self, answer: Answer) -> QueryRecord:
        """Take in the answer to the pending query.

        Raises:
            AnswerError: nothing is pending, another query is, or the answer does not fit the question.
        """
        if answer.replaces is not None:
            raise AnswerError(f'the answer replaces {answer.replaces!r}: it corrects, and does not answer')
        record = self.check(answer)
        self.knowledge.learn(record, self._scenes[-1])
        self._records.append(record)
        self._pending = None
        self._answers[answer.query_id] = {answer.answer_id: answer}
        return record

    def amend(self, answer: Answer) -> QueryRecord:
        """Take another answer for one that was accepted before and was wrong.

        What is recorded and known is then what it would be had the answer been this one at once: of that turn, at that
        cost. What was asked since stays asked, and what is pending stays pending. An answer is replaced once; what
        replaced it can be replaced in turn.

        Raises:
            AnswerError: the answer names none that it replaces, or one that was not accepted or was replaced already,
                its id is taken, or it does not fit the question.
        """
        if answer.replaces is None:
            raise AnswerError(f'the answer to query {answer.query_id!r} does not say what it replaces')
        record = self.check(answer)
        self._records = [record if old.turn == record.turn else old for old in self._records]
        self._answers[answer.query_id][answer.answer_id] = answer
        self._learn_anew()
        return record

    def check(self, answer: Answer) -> QueryRecord:
        """What `tell`, or `amend` if the answer replaces another, would record; nothing changes.

        Raises:
            AnswerError: the answer would be refused.
        """
        query = self._pending if answer.replaces is None else self._corrected(answer)
        if query is None:
            raise AnswerError(f'no query is pending; the answer was to {answer.query_id!r}')
        if answer.query_id != query.query_id:
            raise AnswerError(f'the answer is to query {answer.query_id!r}, the pending one is {query.query_id!r}')
        action = query.action
        object_id, symbol = action.object_id, action.symbol
        groups: tuple[str, ...] = ()
        if answer.outcome is not Outcome.ANSWERED:
            if answer.content is not None:
                raise AnswerError(f'an answer with outcome {answer.outcome.value!r} has no content')
        elif action.kind is QueryKind.LABEL:
            symbol = self._named_symbol(answer)
        elif action.kind is QueryKind.DEMONSTRATION:
            object_id = self._shown_object(answer, self._scenes[query.turn - 1])
        else:
            groups = self._named_groups(answer)
        return QueryRecord(query.turn, action.kind, object_id, symbol, query.cost, answer.outcome, groups)

    def has_taken(self, answer: Answer) -> bool:
        """Whether this very answer was accepted before.

        Raises:
            AnswerError: another answer of the same ids was.
            LateAnswerError: its query was settled by an answer of another id, which it does not replace.
        """
        accepted = self._answers.get(answer.query_id, {})
        same_id = accepted.get(answer.answer_id)
        if same_id is not None and same_id != answer:
            raise AnswerError(f'another answer {answer.answer_id!r} to query {answer.query_id!r} was taken already')
        if accepted and same_id is None and answer.replaces is None:
            first = next(iter(accepted))
            raise LateAnswerError(f'query {answer.query_id!r} was answered already, by {first!r}')
        return same_id is not None

    @property
    def tune_is_due(self) -> bool:
        """Whether `tune` would do something at the end of this turn, or has yet to."""
        return self.turn not in self._tuned_turns and self.settings.tunes_after(self.turn)

    def tune(self) -> bool:
        """Re-optimise the kernel if this turn is one for it; call it at the end of a turn, when nobody waits.

        Returns:
            Whether the beliefs may have changed.

        Raises:
            RuntimeError: a query is pending: the turn is not over.
        """
        if self._pending is not None:
            raise RuntimeError(f'query {self._pending.query_id} has not been answered yet')
        if not self.tune_is_due:
            return False
        self._tuned_turns.add(self.turn)
        return self.knowledge.tune()

    def _corrected(self, answer: Answer) -> Query:
        """The query of the answer that another one replaces."""
        accepted = self._answers.get(answer.query_id, {})
        if answer.replaces not in accepted:
            raise AnswerError(f'no answer {answer.replaces!r} to query {answer.query_id!r} was taken')
        if answer.answer_id in accepted:
            raise AnswerError(f'another answer {answer.answer_id!r} to query {answer.query_id!r} was taken already')
        last = next(reversed(accepted))
        if answer.replaces != last:
            raise AnswerError(
                f'answer {answer.replaces!r} to query {answer.query_id!r} was replaced, in the end by {last!r}'
            )
        return self._queries[answer.query_id]

    def _learn_anew(self) -> None:
        """Rebuild the knowledge from the scenes and the records, event by event as it came about."""
        knowledge = new_knowledge(self.settings, self._view_tolerance, self._strategy)
        by_turn = {record.turn: record for record in self._records}
        for turn, scene in enumerate(self._scenes, start=1):
            knowledge.observe(scene)
            if turn in by_turn:
                knowledge.learn(by_turn[turn], scene)
            if turn in self._tuned_turns:
                knowledge.tune()
        self.knowledge = knowledge

    def _query(self, action: Action, scene: Scene) -> Query | None:
        """Put the action to the teacher and charge for it; None if it asks nothing."""
        if action.kind is QueryKind.NO_QUERY:
            return None
        cost = self.settings.costs.of(action.kind)
        self._spent += cost
        query = Query(
            query_id=f'q{len(self._queries) + 1}',
            turn=self.turn,
            action=action,
            choices=choices(action, scene, self.settings.symbols, self.knowledge.groups),
            cost=cost,
            budget_left=self.budget_left,
            turns_left=self.turns_left,
            model_version=self.knowledge.model_version,
            text=question_text(action, self.settings.symbols),
        )
        self._queries[query.query_id] = query
        return query

    def _named_symbol(self, answer: Answer) -> str:
        known = (*self.settings.symbols, NO_SYMBOL)
        if not isinstance(answer.content, str):
            raise AnswerError(f'a label is one of {", ".join(known)}, not {answer.content!r}')
        if answer.content not in known:
            raise AnswerError(f'unknown label {answer.content!r}; known: {", ".join(known)}')
        return answer.content

    def _shown_object(self, answer: Answer, scene: Scene) -> int | None:
        if answer.content == NO_SYMBOL:
            return None
        if not isinstance(answer.content, int) or isinstance(answer.content, bool):
            raise AnswerError(f'a demonstration is an object id or {NO_SYMBOL!r}, not {answer.content!r}')
        if answer.content not in scene.object_ids:
            raise AnswerError(f'object {answer.content} is not in the scene')
        return answer.content

    def _named_groups(self, answer: Answer) -> tuple[str, ...]:
        known = self.knowledge.groups
        if not isinstance(answer.content, tuple) or not answer.content:
            raise AnswerError(f'a feature subset is some of {", ".join(known)}, not {answer.content!r}')
        for group in answer.content:
            if group not in known:
                raise AnswerError(f'unknown feature group {group!r}; known: {", ".join(known)}')
        return tuple(dict.fromkeys(answer.content))
