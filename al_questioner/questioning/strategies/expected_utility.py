"""Expected decision features of every candidate action, one step ahead.

Utility is linear in the decision features (equation 2 of the paper), so the expected utility of equation 1 is
EU(a) = w . E[phi | a]: the expectation is taken once, whatever the weights.
"""

from __future__ import annotations

import numpy as np

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import DECISION_FEATURES, Action, QueryKind, Scene
from al_questioner.questioning.strategies import decision_features as phi
from al_questioner.questioning.turn_context import TurnContext
from al_questioner.support.arrays import Array

INSTANCE_QUERIES = (QueryKind.LABEL, QueryKind.DEMONSTRATION)


def expected_features(context: TurnContext) -> Array:
    """E[phi | a] of each candidate a, (C, 7) in the order of `DECISION_FEATURES`.

    The outcomes of LQ(x) are the symbols y with p(y|x), those of DQ(y) the objects x with p(x|y); either way the
    learner would have one more example (x, y). NQ teaches nothing. The answer to FSQ is taken to be the features that a
    computational selector picks from the labels so far; without labels, or once the teacher has answered an FSQ, the
    beliefs stay as they are. So they do after a relevance query, as the beliefs q_y(x) do not tell which things matter.
    """
    expected = np.empty((len(context.candidates), len(DECISION_FEATURES)))
    concepts, scene, actions = context.concepts, context.scene, context.candidates
    # A turn in which nothing is learnt needs the same once more, and so does the recorder of what was computed.
    expected[:, :4] = context.look_ahead.of(
        (concepts, concepts.model_version, scene, actions), lambda: _expected_task_features(concepts, scene, actions)
    )
    expected[:, 4:] = environment_features(context)
    return expected


def _expected_task_features(concepts: ConceptLearner, scene: Scene, actions: tuple[Action, ...]) -> Array:
    """Return those of the learning task, (C, 4), of C candidates; a turn without a question changes none of them."""
    q = concepts.predict_proba(scene.features)
    positives = np.array(list(concepts.positives.values()))
    expected = np.empty((len(actions), 4))
    expected[:] = task_features(q, positives)

    if any(action.kind in INSTANCE_QUERIES for action in actions):
        by_object, by_symbol = _after_instance_queries(concepts, scene, q, positives)
        for row, action in enumerate(actions):
            if action.kind is QueryKind.LABEL and action.object_id is not None:
                expected[row] = by_object[scene.index_of(action.object_id)]
            elif action.kind is QueryKind.DEMONSTRATION and action.symbol is not None:
                expected[row] = by_symbol[concepts.symbols.index(action.symbol)]

    if concepts.labelled_views and not concepts.subset_was_told:
        for row, action in enumerate(actions):
            if action.kind is QueryKind.FEATURE_SUBSET:
                expected[row] = task_features(concepts.predict_after_selection(scene), positives)
    return expected


def _after_instance_queries(concepts: ConceptLearner, scene: Scene, q: Array, positives: Array) -> tuple[Array, Array]:
    """Expected task features after LQ(x), (|X|, 4), and after DQ(y), (|Y|, 4).

    The look-ahead is taken in as it comes: of a large scene its whole table need not fit into memory.
    """
    p_symbol, p_object = phi.symbol_given_object(q), phi.object_given_symbol(q)
    by_object, by_symbol = np.empty((len(p_symbol), 4)), np.zeros((len(positives), 4))
    one_more = positives + np.eye(len(positives), dtype=int)
    for rows, beliefs in concepts.look_ahead_chunks(scene):
        after = task_features(beliefs, one_more)
        by_object[rows] = np.einsum('xy,xyf->xf', p_symbol[rows], after)
        by_symbol += np.einsum('xy,xyf->yf', p_object[rows], after)
    return by_object, by_symbol


def task_features(q: Array, positives: Array) -> Array:
    """Return the (..., 4) learning-centric decision features of states, in the order of `DECISION_FEATURES`.

    Args:
        q: (..., |X|, |Y|) beliefs; where there are no things, what is believed of them is 0.
        positives: (..., |Y|) numbers of positive examples; leading axes broadcast against those of `q`.
    """
    uniformity, nothing = phi.class_uniformity(positives), np.zeros(q.shape[:-2])
    if q.shape[-2] == 0:
        return _side_by_side(nothing, uniformity, nothing, nothing)
    return _side_by_side(phi.discriminability(q), uniformity, phi.instance_variation(q), phi.prediction_margin(q))


def environment_features(context: TurnContext) -> Array:
    """Return (C, 3) budget consumption, remaining time and non-query time after each candidate."""
    kinds = [action.kind for action in context.candidates]
    spent = {kind: context.spent + context.costs.price(kind) for kind in QueryKind}
    idle = [context.non_query_turns + 1 if kind is QueryKind.NO_QUERY else 0 for kind in kinds]
    return _side_by_side(
        phi.budget_consumption([spent[kind] for kind in kinds], context.budget),
        phi.remaining_time(context.turns_left, context.turns),
        phi.non_query_time(idle, context.change_interval),
    )


def _side_by_side(*parts: Array) -> Array:
    """Stack parts whose shapes broadcast to (...) into (..., number of parts)."""
    table = np.empty((*np.broadcast_shapes(*(part.shape for part in parts)), len(parts)))
    for column, part in enumerate(parts):
        table[..., column] = part
    return table
