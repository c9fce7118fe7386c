"""Beliefs that follow from labels: cases solved by hand, and the formula written out."""

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, Outcome, QueryKind, QueryRecord
from al_questioner.questioning.beliefs import class_beliefs, class_shares, prior_beliefs, with_labels

REACH, DOUBT = 0.5, 0.1


def named(symbol, outcome=Outcome.ANSWERED):
    return QueryRecord(2, QueryKind.LABEL, 90, symbol, 1.0, outcome)


def shown(symbol, object_id, turn=2, outcome=Outcome.ANSWERED):
    return QueryRecord(turn, QueryKind.DEMONSTRATION, object_id, symbol, 2.0, outcome)


def context_of(toy, labels=(), table=None, **changes):
    """Six objects, of which the first ones were labelled so."""
    scene = toy.scene(np.random.default_rng(3).normal(size=(6, 5)) if table is None else table)
    return toy.context(labels, scene, turns=40, **changes)


def test_shares_by_hand(toy):
    """Jeffreys: half an answer each for none and for the symbols; demonstrations say nothing of what lies around."""
    assert class_shares(context_of(toy)) == pytest.approx([1 / 6, 1 / 6, 1 / 6, 1 / 2])
    answers = [named(NO_SYMBOL), named(NO_SYMBOL), named('fruit'), named(None, Outcome.UNKNOWN), shown('snack', 4)]
    assert class_shares(context_of(toy, history=answers)) == pytest.approx([0.125, 0.125, 0.125, 0.625])


def test_beliefs_before_any_label_are_the_shares(toy):
    context = context_of(toy)
    assert class_beliefs(context, REACH, DOUBT) == pytest.approx(np.tile(class_shares(context), (6, 1)))


def test_beliefs_are_the_formula_written_out(toy):
    labels = ['snack', NO_SYMBOL, 'fruit', 'snack']
    context = context_of(toy, labels, history=[named(label) for label in labels])
    points = context.concepts.standardiser.transform(context.scene.features)
    none = class_shares(context)[-1]
    found = class_beliefs(context, REACH, DOUBT)
    for row in range(6):
        odds = {name: q / (1 - q) for name, q in zip(toy.symbols, context.probabilities[row], strict=True)}
        share = {name: (1 - none) * each / sum(odds.values()) for name, each in odds.items()} | {NO_SYMBOL: none}
        votes = {}
        for name in (*toy.symbols, NO_SYMBOL):
            squared = [np.mean((points[row] - points[i]) ** 2) for i, label in enumerate(labels) if label == name]
            nearest = max((np.exp(-d / (2 * REACH**2)) for d in squared), default=0.0)
            votes[name] = nearest + DOUBT * share[name]
        assert found[row] == pytest.approx([vote / sum(votes.values()) for vote in votes.values()])


def test_a_label_tells_of_what_is_near_and_not_of_what_is_far(toy):
    table = np.zeros((6, 5))
    table[:, 2] = [0, 0.01, 9, 10, 11, 12]
    context = context_of(toy, ['snack'], table, history=[named('snack')])
    beliefs = class_beliefs(context, 0.05, DOUBT)
    snack = toy.symbols.index('snack')
    assert beliefs[1, snack] > 0.9
    assert beliefs[5] == pytest.approx(prior_beliefs(context)[5], abs=1e-6)


def test_where_no_label_is_near_the_classifiers_tell_the_symbols_apart(toy):
    """The symbols share by their odds what none leaves; before any label they are equally probable."""
    context = context_of(toy, ['snack', 'fruit'], history=[named('snack'), named('fruit')])
    odds = context.probabilities / (1 - context.probabilities)
    prior = prior_beliefs(context)
    assert prior[:, -1] == pytest.approx(np.full(6, 0.5 / 3))
    assert prior[:, :-1] == pytest.approx((1 - 0.5 / 3) * odds / odds.sum(axis=1, keepdims=True))


def test_what_was_asked_for_in_vain_is_not_here_until_the_scene_changes(toy):
    """Otherwise a demonstration that is impossible now would be asked for again."""
    in_vain = shown('fruit', None, turn=2)
    here = context_of(toy, ['snack'], history=[in_vain])
    assert here.absent_symbols == {'fruit'}
    beliefs = class_beliefs(here, REACH, DOUBT)
    assert (beliefs[:, toy.symbols.index('fruit')] == 0).all()
    assert beliefs.sum(axis=1) == pytest.approx(np.ones(6))
    for other in (
        context_of(toy, history=[in_vain], scene_turn=3),
        context_of(toy, history=[shown('fruit', 4)]),
        context_of(toy, history=[shown('fruit', None, outcome=Outcome.SKIP)]),
        context_of(toy, history=[named(NO_SYMBOL)]),
    ):
        assert other.absent_symbols == set()


def test_what_was_labelled_is_certain(toy):
    context = context_of(toy, ['snack', NO_SYMBOL])
    beliefs = class_beliefs(context, REACH, DOUBT)
    before = beliefs.copy()
    known = with_labels(context, beliefs)
    assert known[0].tolist() == [float(symbol == 'snack') for symbol in toy.symbols]
    assert known[1].tolist() == [0.0] * 3
    np.testing.assert_array_equal(known[2:], beliefs[2:, :-1])
    np.testing.assert_array_equal(beliefs, before, 'beliefs are left as they are')


def test_a_scenes_first_turn_belongs_to_it(toy):
    """Otherwise the commonest failure, at once after a change, would be forgotten."""
    assert context_of(toy, history=[shown('fruit', None, turn=2)], scene_turn=2).absent_symbols == {'fruit'}
