"""Reliability of each teacher."""

import numpy as np
import pytest

from al_questioner.domain import Answer, Outcome, QueryKind, random_stream
from al_questioner.questioning import Episode
from al_questioner.questioning.reliability import Statement, label_beliefs, reliabilities

UNIFORM = np.full(4, 0.25)


def test_what_is_believed_of_a_thing_is_that_one_label_holds():
    """Otherwise beliefs would not be those of exactly one of the independent classifiers being right."""
    q = np.array([0.9, 0.2, 0.5])
    one_holds = [np.prod(np.where(np.arange(3) == y, q, 1 - q)) for y in range(3)]
    none_holds = np.prod(1 - q)
    expected = np.array([*one_holds, none_holds]) / (sum(one_holds) + none_holds)
    np.testing.assert_allclose(label_beliefs(q), expected)
    assert np.isfinite(label_beliefs(np.array([0.0, 1.0, 1.0]))).all()


def test_nothing_is_learnt_of_a_teacher_where_nothing_is_known():
    """Otherwise a teacher who speaks alone would gain or lose trust by speaking."""
    statements = [Statement(turn, 'anna', turn % 4) for turn in range(12)]
    found = reliabilities(statements, dict.fromkeys(range(12), UNIFORM))
    assert found == {'anna': pytest.approx(0.9, abs=1e-4)}


def test_two_certain_contradictions_by_hand():
    """With certain beliefs, expectation maximisation is counting: (9 + right) / (10 + all)."""
    certain = np.array([1.0, 0, 0, 0])
    statements = [Statement(1, 'anna', 0), Statement(2, 'anna', 0), Statement(3, 'anna', 1), Statement(4, 'anna', 2)]
    found = reliabilities(statements, dict.fromkeys((1, 2, 3, 4), certain))
    assert found['anna'] == pytest.approx(11 / 14, abs=1e-6)


def test_who_said_nothing_of_a_thing_is_credited_as_everybody():
    """A teacher who only said that they did not know would be without an estimate, or change those of others."""
    assert reliabilities([], {}, ['carl']) == {'carl': 0.9}
    statements = [Statement(1, 'anna', 0), Statement(1, 'bob', 1)]
    beliefs = {1: np.array([0.8, 0.1, 0.1])}
    alone = reliabilities(statements, beliefs)
    assert reliabilities(statements, beliefs, ['bob', 'carl']) == alone | {'carl': 0.9}


def test_it_is_the_fixed_point_of_the_formulas():
    """Otherwise the estimate would be another one than the documentation states: recomputed in loops."""
    rng = random_stream(5, 'reliability')
    beliefs = {turn: rng.dirichlet(np.ones(3)) for turn in range(20)}
    statements = [
        Statement(turn, name, int(rng.integers(3))) for turn in range(20) for name in 'abc' if rng.random() < 0.7
    ]
    found = reliabilities(statements, beliefs)
    right = dict.fromkeys(found, 9.0)
    for turn, belief in beliefs.items():
        said = [s for s in statements if s.item == turn]
        posterior = [
            belief[label]
            * np.prod([found[s.teacher_id] if s.label == label else (1 - found[s.teacher_id]) / 2 for s in said])
            for label in range(3)
        ]
        for s in said:
            right[s.teacher_id] += posterior[s.label] / sum(posterior)
    for name, estimate in found.items():
        count = sum(s.teacher_id == name for s in statements)
        assert estimate == pytest.approx(right[name] / (10 + count), abs=1e-5)


def test_a_careless_teacher_among_careful_ones_is_found():
    """A teacher who contradicts all others is trusted less than they are."""
    rng = random_stream(6, 'reliability')
    statements = []
    for turn in range(60):
        truth = int(rng.integers(4))
        for name, share in (('anna', 0.95), ('bert', 0.95), ('carl', 0.4)):
            label = truth if rng.random() < share else (truth + int(rng.integers(1, 4))) % 4
            statements.append(Statement(turn, name, label))
    found = reliabilities(statements, dict.fromkeys(range(60), UNIFORM))
    assert found['carl'] < 0.6 < 0.85 < min(found['anna'], found['bert'])


def test_the_record_of_each_teacher(toy):
    """Answers that were unknown, skipped, taken back or too late are counted apart."""
    own = toy.settings('random_fsq', budget=20.0, turns=8)
    episode = Episode(own, random_stream(2, 'learner'))
    world = toy.world(3)
    assert episode.teachers == {}
    first = [('anna', Outcome.ANSWERED, ('size',)), ('anna', Outcome.UNKNOWN, None), ('bert', Outcome.SKIP, None)]
    for turn, said in enumerate([*first, *[('anna', Outcome.ANSWERED, 'snack')] * 3], start=1):
        query = episode.ask(world.scene(turn)).query
        episode.tell(Answer(query.query_id, 'a', *said))
        if turn > len(first):
            episode.take(Answer(query.query_id, 'late', 'bert', Outcome.ANSWERED, 'fruit'))
    episode.tell(Answer(query.query_id, 'b', 'anna', Outcome.ANSWERED, 'fruit', replaces='a'))
    anna, bert = episode.teachers['anna'], episode.teachers['bert']
    assert (anna.answered, anna.unknown, anna.skipped, anna.corrected, anna.late) == (4, 1, 0, 1, 0)
    assert (bert.answered, bert.unknown, bert.skipped, bert.corrected, bert.late) == (0, 0, 1, 0, 3)
    assert 0 < bert.reliability < anna.reliability < 1


def test_what_stands_counts_and_only_what_is_about_the_same_thing(toy):
    """Otherwise a corrected answer, or a late demonstration of another thing, would tell against its teacher."""
    own = toy.settings('rarest_demo', budget=40.0, turns=20, change_interval=1)
    episode, world = Episode(own, random_stream(2, 'learner')), toy.world(3, change_interval=1)
    asked = []
    while not episode.done:
        query = episode.ask(world.scene(episode.turn + 1)).query
        if query is None:
            continue
        truth = world.answer(query)
        asked.append((query, truth))
        episode.tell(Answer(query.query_id, 'a', 'anna', truth.outcome, truth.content))
    shown = [(q, t) for q, t in asked if q.action.kind is QueryKind.DEMONSTRATION and isinstance(t.content, int)]
    before = episode.teachers['anna'].reliability
    assert before != pytest.approx(0.9, abs=1e-6)
    for query, truth in shown:
        episode.take(Answer(query.query_id, 'b', 'bert', truth.outcome, truth.content))
    assert episode.teachers['bert'].reliability == 0.9
    assert episode.teachers['anna'].reliability == before
    # A standing `unknown` says nothing of a thing.
    for query, truth in asked:
        if truth.outcome is Outcome.ANSWERED and query.action.kind is not QueryKind.FEATURE_SUBSET:
            episode.tell(Answer(query.query_id, 'c', 'anna', Outcome.UNKNOWN, replaces='a'))
    assert episode.teachers['anna'].reliability == 0.9
    assert episode.teachers['anna'].unknown == len(shown) + sum(t.content == 'none' for _, t in asked)
