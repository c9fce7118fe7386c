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

    Each turn: `ask(scene)`, if the decision holds a query, `tell(answer)`, and at the turn's end `tune()`. A scene or
    an answer that is refused leaves the episode as it was, so that the turn can be tried again. The same settings,
    scenes, answers and generator give the same queries in any process.

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
        self.knowledge = new_knowledge(settings, view_tolerance, self._strategy)
        self._turn = 0
        self._spent = 0.0
        self._records: list[QueryRecord] = []
        self._pending: Query | None = None
        self._n_queries = 0
        self._non_query_turns = 0
        self._scene: Scene | None = None
        self._scene_turn = 1
        self._tuned_turn = 0

    @property
    def turn(self) -> int:
        """The present turn, 1-based; 0 before the first."""
        return self._turn

    @property
    def turns_left(self) -> int:
        """Turns after the present one."""
        return self.settings.turns - self._turn

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
        turn = self._turn + 1
        unchanged = self._scene is not None and self.knowledge.is_unchanged(self._scene, scene)
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
        self._turn, self._scene, self._scene_turn = turn, scene, scene_turn
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
        query, scene = self._pending, self._scene
        if query is None or scene is None:
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
            object_id = self._shown_object(answer, scene)
        else:
            groups = self._named_groups(answer)
        record = QueryRecord(query.turn, action.kind, object_id, symbol, query.cost, answer.outcome, groups)
        self.knowledge.learn(record, scene)
        self._records.append(record)
        self._pending = None
        return record

    def tune(self) -> bool:
        """Re-optimise the kernel if this turn is one for it; call it at the end of a turn, when nobody waits.

        Returns:
            Whether the beliefs may have changed.

        Raises:
            RuntimeError: a query is pending: the turn is not over.
        """
        if self._pending is not None:
            raise RuntimeError(f'query {self._pending.query_id} has not been answered yet')
        if self._tuned_turn == self._turn or not self.settings.tunes_after(self._turn):
            return False
        self._tuned_turn = self._turn
        return self.knowledge.tune()

    def _query(self, action: Action, scene: Scene) -> Query | None:
        """Put the action to the teacher and charge for it; None if it asks nothing."""
        if action.kind is QueryKind.NO_QUERY:
            return None
        cost = self.settings.costs.of(action.kind)
        self._spent += cost
        self._n_queries += 1
        return Query(
            query_id=f'q{self._n_queries}',
            turn=self._turn,
            action=action,
            choices=choices(action, scene, self.settings.symbols, self.knowledge.groups),
            cost=cost,
            budget_left=self.budget_left,
            turns_left=self.turns_left,
            model_version=self.knowledge.model_version,
            text=question_text(action, self.settings.symbols),
        )

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
