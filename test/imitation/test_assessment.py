"""Agreement with an expert, by hand."""

import numpy as np
import pytest

from al_questioner.domain import Action, QueryKind
from al_questioner.imitation.assessment import agreement, imitate, predict_queries
from al_questioner.imitation.demonstration import Demonstration, Step
from al_questioner.simulation import PerceivedWorld

LABELS = (Action(QueryKind.LABEL, 1), Action(QueryKind.LABEL, 2), Action(QueryKind.NO_QUERY))


def demonstration(*chosen):
    table = np.zeros((3, 7))
    table[:, 0] = [1.0, 0.0, 1.0]
    return Demonstration(
        'x', None, None, len(chosen), tuple(Step(i + 1, LABELS, table, c) for i, c in enumerate(chosen))
    )


def test_agreement_by_hand():
    """Candidates 0 and 2 tie at the top: guessing between them is right half the time."""
    weights = np.array([np.log(2), 0, 0, 0, 0, 0, 0])
    found = agreement(weights, [demonstration(0, 1, 2)])
    assert found.kind == pytest.approx((0.5 + 0.5 + 0.5) / 3)
    assert found.ask == pytest.approx(0.5)
    assert found.choice == pytest.approx((0.5 + 0 + 0.5) / 3)
    assert found.log_likelihood == pytest.approx(np.log([0.4, 0.2, 0.4]).mean())


def test_equal_weights_are_uniform():
    """The baseline must be that of guessing."""
    found = agreement(np.zeros(7), [demonstration(0, 2)])
    assert found.log_likelihood == pytest.approx(-np.log(3))
    assert found.kind == pytest.approx((2 / 3 + 1 / 3) / 2)


def test_the_learner_is_tried_in_the_experts_place(experts):
    """World, budget and time are the same, so that the gap is not that of other circumstances."""
    shown = experts[0]
    tried = imitate(np.array([1, 1, 1, 1, -1, 0, -9.0]), shown, PerceivedWorld(shown.world.open()))
    assert sum(record.cost for record in tried.queries) <= shown.settings.budget
    assert tried.feature_counts[5] == pytest.approx(shown.feature_counts[5]), 'the time is the same'


def test_predicted_queries_are_the_best_candidates_of_each_state(experts):
    """Otherwise the picture of a robot's training would show another learner."""
    always = predict_queries(np.array([0, 0, 0, 0, -1.0, 0, -1000]), experts[0])
    assert {query.turn for query in always} == {s.turn for s in experts[0].steps if len(s.actions) > 1}
    assert predict_queries(np.array([0, 0, 0, 0, -1.0, 0, 0]), experts[0]) == ()
