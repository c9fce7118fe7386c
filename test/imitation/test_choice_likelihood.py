"""The likelihood of an expert's choices, against finite differences, logistic regression and known weights."""

import numpy as np
import pytest
from scipy.optimize import check_grad
from sklearn.linear_model import LogisticRegression

from al_questioner.domain import Action, InputError, QueryKind
from al_questioner.imitation.choice_likelihood import (
    balance_kinds,
    fit_choices,
    fit_temperature,
    negative_log_likelihood,
)
from al_questioner.imitation.demonstration import Demonstration, Step, all_steps, feature_scale

TRUE = np.array([3.0, 1.0, -2.0, 0.5, -4.0, 0.0, -3.0])


@pytest.mark.parametrize('seed', range(10))
def test_known_weights_are_recovered(made, seed):
    """Otherwise imitation would learn something else than what the expert wants."""
    rng = np.random.default_rng(100 + seed)
    weights = rng.normal(size=7) * 3
    weights[5] = 0.0
    found = fit_choices([made.synthetic(weights, seed)])
    assert found @ weights > 0.95 * np.linalg.norm(found) * np.linalg.norm(weights), 'they point the same way'
    assert found[5] == 0.0


def test_the_gradient_is_that_of_finite_differences(made):
    """Otherwise the optimum would be wrong by as much as the gradient."""
    steps = made.synthetic(TRUE, 0, 40).steps
    contrasts = [step.contrasts for step in steps]
    importance = balance_kinds(steps)
    rng = np.random.default_rng(1)
    for ridge in (0.0, 0.3):
        for _ in range(5):
            at = rng.normal(size=7)
            error = check_grad(
                lambda w, r=ridge: negative_log_likelihood(w, contrasts, importance, r)[0],
                lambda w, r=ridge: negative_log_likelihood(w, contrasts, importance, r)[1],
                at,
            )
            assert error < 1e-6


def test_it_is_convex(made):
    """Otherwise another start could find other weights."""
    contrasts = [step.contrasts for step in made.synthetic(TRUE, 0, 20).steps]
    rng = np.random.default_rng(2)
    ones = np.ones(20)
    for _ in range(50):
        a, b = rng.normal(size=(2, 7)) * 5
        middle = negative_log_likelihood((a + b) / 2, contrasts, ones)[0]
        ends = [negative_log_likelihood(w, contrasts, ones)[0] for w in (a, b)]
        assert middle <= np.mean(ends) + 1e-12


def test_two_candidates_are_a_logistic_regression():
    """An independent library must find the same weights: p(first) = logistic(w . (phi_first - phi_second))."""
    rng = np.random.default_rng(3)
    actions = (Action(QueryKind.FEATURE_SUBSET), Action(QueryKind.NO_QUERY))
    tables = rng.normal(size=(200, 2, 7))
    chosen = (rng.random(200) < 1 / (1 + np.exp(-(tables[:, 1] - tables[:, 0]) @ TRUE))).astype(int)
    steps = tuple(Step(i + 1, actions, t, int(c)) for i, (t, c) in enumerate(zip(tables, chosen, strict=True)))
    demonstration = Demonstration('two', None, None, len(steps), steps)
    found = fit_choices([demonstration], importance=np.ones(200), ridge=0.05)
    scale = feature_scale([demonstration])
    oracle = LogisticRegression(C=1 / (0.05 * 200), fit_intercept=False, tol=1e-10, max_iter=10_000)
    oracle.fit((tables[:, 1] - tables[:, 0]) / scale, chosen)
    np.testing.assert_allclose(found * scale, oracle.coef_[0], atol=2e-4)


def test_every_kind_of_query_matters_the_same_in_total(made):
    """Otherwise one feature subset query an episode would be drowned by the turns without a question."""
    steps = made.synthetic(TRUE, 0, 300).steps
    importance = balance_kinds(steps)
    kinds = sorted({step.kind for step in steps}, key=str)
    totals = [sum(i for i, s in zip(importance, steps, strict=True) if s.kind is kind) for kind in kinds]
    np.testing.assert_allclose(totals, 300 / len(kinds))


def test_separable_choices_give_finite_weights(made):
    """Otherwise an expert who always asks the same would make the weights grow without bound."""
    step = made.synthetic(TRUE, 0, 1).steps[0]
    always = tuple(Step(turn, step.actions, step.features, 9) for turn in range(1, 20))
    found = fit_choices([Demonstration('always', None, None, len(always), always)])
    assert np.isfinite(found).all()
    assert (step.features @ found).argmax() == 9


def test_without_a_choice_nothing_can_be_learnt():
    """Otherwise weights of nothing would be taken for an expert's."""
    step = Step(1, (Action(QueryKind.NO_QUERY),), np.zeros((1, 7)), 0)
    with pytest.raises(InputError, match='more than one candidate'):
        fit_choices([Demonstration('idle', None, None, 1, (step,))])


def test_the_temperature_gives_back_a_lost_scale(made):
    """Otherwise likelihoods of weights that were normalised could not be compared with others."""
    demonstration = made.synthetic(TRUE, 5, 500)
    steps = list(all_steps([demonstration]))
    assert fit_temperature(TRUE / 7, steps) == pytest.approx(7, rel=0.2)
    assert fit_temperature(-TRUE, steps) == pytest.approx(0.0, abs=1e-6)
