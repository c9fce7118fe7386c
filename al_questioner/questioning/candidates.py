"""Communicative actions of a turn, and the answers that each query can have."""

from __future__ import annotations

from collections.abc import Sequence

from al_questioner.domain import Action, Costs, QueryKind, Scene, groups_of

BUDGET_ROUNDING = 1e-9
"""Largest amount by which rounding may exceed the budget: three times 0.1 is affordable with 0.3."""


def candidates(scene: Scene, symbols: Sequence[str], costs: Costs, budget_left: float) -> tuple[Action, ...]:
    """Return the actions of section 2.1 of the paper that the budget can pay and that have several answers.

    Without these limits there are |Y| + |X| + 2, and one more where the relevance query has a cost.

    Returns:
        DQ(y) in the order of the symbols, LQ(x) in the order of the scene, FSQ, the relevance query, NQ; of each kind
        all of them or none.
    """
    actions = [Action(QueryKind.DEMONSTRATION, symbol=symbol) for symbol in symbols]
    actions += [Action(QueryKind.LABEL, object_id=object_id) for object_id in scene.object_ids]
    actions += [Action(kind) for kind in (QueryKind.FEATURE_SUBSET, QueryKind.RELEVANCE, QueryKind.NO_QUERY)]
    kinds = {kind for kind in QueryKind if is_affordable(costs.price(kind), budget_left) and is_open(kind, scene)}
    return tuple(action for action in actions if action.kind in kinds)


def is_open(kind: QueryKind, scene: Scene) -> bool:
    """Return whether a question of this kind has more than one possible answer in this scene.

    In an empty scene nothing can be shown, and nothing matters. If all features are of one group, that is the group
    that matters.
    """
    if kind in (QueryKind.DEMONSTRATION, QueryKind.RELEVANCE):
        return len(scene) > 0
    if kind is QueryKind.FEATURE_SUBSET:
        return len(groups_of(scene.feature_names)) > 1
    return True


def is_affordable(cost: float, budget_left: float) -> bool:
    """Return whether the budget can pay a cost; a cost of 0 is always affordable."""
    return cost <= budget_left + BUDGET_ROUNDING


def choices(action: Action, scene: Scene, symbols: Sequence[str], groups: Sequence[str]) -> tuple[str, ...]:
    """Return the answers to choose from: symbols, object ids as text, or feature groups.

    `NO_SYMBOL` is a valid answer to every label, demonstration and relevance query and is not listed.

    Raises:
        ValueError: the action asks nothing.
    """
    if action.kind is QueryKind.LABEL:
        return tuple(symbols)
    if action.kind in (QueryKind.DEMONSTRATION, QueryKind.RELEVANCE):
        return tuple(str(object_id) for object_id in scene.object_ids)
    if action.kind is QueryKind.FEATURE_SUBSET:
        return tuple(groups)
    raise ValueError('NQ has no answers')
