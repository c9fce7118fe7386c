"""The question which things matter: what is learnt from its answers, and what is not."""

import dataclasses

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import (
    NO_SYMBOL,
    Action,
    Answer,
    AnswerError,
    Costs,
    Outcome,
    QueryKind,
    QueryRecord,
    random_stream,
)
from al_questioner.questioning import STRATEGIES, Episode, Receipt
from al_questioner.questioning.beliefs import class_beliefs, class_shares, prior_beliefs
from al_questioner.questioning.strategies.choice import settled_actions

COSTS = Costs(relevance=4.0)
RELEVANCE = Action(QueryKind.RELEVANCE)
REACH, DOUBT = 0.5, 0.1


def start(toy, *actions, **changes):
    """An episode that asks which things matter, and where it cannot these other questions."""
    settings = toy.settings('random_fsq', **{'budget': 20.0, 'turns': 6, 'costs': COSTS, **changes})
    return Episode(settings, random_stream(1, 'learner'), strategy=toy.asks(RELEVANCE, *actions))


def said(query, content, outcome=Outcome.ANSWERED, answer_id='a1', replaces=None):
    return Answer(query.query_id, answer_id, 'anna', outcome, content, replaces)


def judged(objects, turn=2, outcome=Outcome.ANSWERED):
    return QueryRecord(turn, QueryKind.RELEVANCE, None, None, 4.0, outcome, objects=objects)


def context_of(toy, mattering=None, labels=(), **changes):
    """Six objects, some labelled, of which then it was said which matter."""
    scene = toy.scene(np.random.default_rng(3).normal(size=(6, 5)))
    concepts = ConceptLearner(toy.symbols, 4.0)
    concepts.observe(scene)
    for row, label in enumerate(labels):
        concepts.label(row, scene.features[row], label, 1)
    if mattering is not None:
        concepts.learn(judged(mattering), scene)
    return toy.context(scene=scene, concepts=concepts, turns=40, costs=COSTS, **changes)


def test_an_answer_teaches_what_does_not_matter(toy):
    """Otherwise the question would be paid for, and nothing known after it."""
    episode, world = start(toy), toy.world(2)
    query = episode.ask(world.scene(1)).query
    assert (query.action, query.cost, query.text) == (RELEVANCE, 4.0, 'Which of these things matter?')
    assert query.choices == tuple(map(str, world.truth))
    record = episode.tell(world.answer(query))
    mattering = tuple(i for i, symbol in world.truth.items() if symbol != NO_SYMBOL)
    assert record == QueryRecord(1, QueryKind.RELEVANCE, None, None, 4.0, Outcome.ANSWERED, objects=mattering)
    labels = dict(zip(world.current.object_ids, episode.concepts.labels_of(world.current), strict=True))
    assert labels == {i: NO_SYMBOL if symbol == NO_SYMBOL else None for i, symbol in world.truth.items()}
    assert episode.positives == dict.fromkeys(toy.symbols, 0)
    assert episode.spent == 4.0


@pytest.mark.parametrize(
    ('content', 'reason'),
    [
        ('snack', "a list of object ids, not 'snack'"),
        (101, 'a list of object ids, not 101'),
        (None, 'a list of object ids, not None'),
        (('snack',), "are object ids, not 'snack'"),
        ((True,), 'are object ids, not True'),
        ((101, 7), 'object 7 is not in the scene'),
    ],
)
def test_what_is_no_list_of_things_here_is_refused(toy, content, reason):
    """Otherwise all other things would be learnt as clutter by mistake."""
    episode = start(toy)
    query = episode.ask(toy.world(2).scene(1)).query
    with pytest.raises(AnswerError, match=reason):
        episode.tell(said(query, content))
    assert episode.pending is query
    assert not episode.concepts.labelled_views


def test_a_thing_that_is_named_twice_matters_once(toy):
    episode = start(toy)
    query = episode.ask(toy.world(2).scene(1)).query
    assert episode.tell(said(query, (103, 101, 103))).objects == (103, 101)


@pytest.mark.parametrize('outcome', [Outcome.UNKNOWN, Outcome.SKIP])
def test_without_an_answer_nothing_is_learnt_and_the_question_rests(toy, outcome):
    """Otherwise it would be asked again at once; or all things would be clutter to somebody who does not know."""
    episode = start(toy)
    query = episode.ask(toy.world(2).scene(1)).query
    assert episode.tell(said(query, None, outcome)).objects is None
    assert not episode.concepts.judged_views
    assert RELEVANCE in settled_actions(context_of(toy, history=(judged(None, outcome=outcome),)))
    assert RELEVANCE not in settled_actions(context_of(toy, history=(judged(None, outcome=outcome),), scene_turn=3))


@pytest.mark.parametrize('content', [(), (101, 102), (100, 101, 102, 103, 104, 105)])
def test_a_corrected_answer_is_as_if_it_had_been_the_first(toy, content):
    """A thing that was left out by mistake would stay clutter to the robot."""
    label = Action(QueryKind.LABEL, object_id=101)
    episode, world, scenes = start(toy, label, budget=6.0), toy.world(5), []
    queries = []
    while not episode.done:
        scenes.append(world.scene(episode.turn + 1))
        query = episode.ask(scenes[-1]).query
        if query is not None:
            queries.append(query)
            episode.tell(said(query, (100, 103) if query.action == RELEVANCE else world.truth[101]))
    assert [query.action for query in queries] == [RELEVANCE, label, label]
    wrong = episode.records
    corrected = episode.tell(said(queries[0], content, answer_id='a2', replaces='a1'))
    assert episode.records == (dataclasses.replace(wrong[0], objects=content), *wrong[1:]) == (corrected, *wrong[1:])
    oracle = toy.learnt(episode.settings, scenes, episode.records)
    for scene in scenes:
        ours, theirs = episode.concepts, oracle
        np.testing.assert_array_equal(ours.predict_proba(scene.features), theirs.predict_proba(scene.features))
        np.testing.assert_array_equal(ours.matters(scene), theirs.matters(scene))
        np.testing.assert_array_equal(ours.distances_to_mattering(scene), theirs.distances_to_mattering(scene))
        assert ours.labels_of(scene) == theirs.labels_of(scene)
    assert episode.concepts.model_version == oracle.model_version
    episode.tell(said(queries[0], None, Outcome.UNKNOWN, 'a3', 'a2'))
    assert not episode.concepts.judged_views


def test_a_late_answer_of_another_is_only_kept(toy):
    episode = start(toy)
    query = episode.ask(toy.world(2).scene(1)).query
    episode.tell(said(query, (101,)))
    late = Answer(query.query_id, 'b1', 'bert', Outcome.ANSWERED, ())
    assert episode.take(late).receipt is Receipt.LATE
    assert episode.records[0].objects == (101,)
    assert episode.teachers['anna'].reliability == episode.teachers['bert'].reliability == 0.9


def test_an_answer_that_comes_turns_later_is_about_its_own_scene(toy):
    """Otherwise the things of another scene would be judged by their numbers."""
    episode, world = start(toy), toy.world(2, change_interval=2)
    query = episode.ask(world.scene(1)).query
    first = world.current
    episode.time_out()
    assert episode.ask(world.scene(2)).query is None
    assert episode.pending is query
    episode.time_out()
    assert episode.ask(world.scene(3)).query.query_id == 'q2', 'the scene that it was about has gone'
    assert episode.tell(said(query, (101,))).answered_in == 3
    assert episode.concepts.matters(first).tolist() == [i == 101 for i in first.object_ids]


def test_it_is_settled_once_it_is_known_of_everything_whether_it_matters(toy):
    """Otherwise a strategy could pay for what it knows."""
    assert RELEVANCE not in settled_actions(context_of(toy))
    assert RELEVANCE not in settled_actions(context_of(toy, labels=['snack', NO_SYMBOL]))
    assert RELEVANCE in settled_actions(context_of(toy, (1, 2)))
    assert RELEVANCE in settled_actions(context_of(toy, labels=['snack', NO_SYMBOL] * 3))
    partly = context_of(toy, (1, 2))
    more = toy.scene(np.vstack([partly.scene.features, np.ones(5)]))
    partly.concepts.observe(more)
    assert RELEVANCE not in settled_actions(dataclasses.replace(partly, scene=more))


@pytest.mark.parametrize('strategy', sorted(set(STRATEGIES) - {'human', 'value_per_cost'}))
def test_a_strategy_that_does_not_know_it_asks_as_if_it_were_not_there(toy, strategy):
    """A question whose worth it cannot tell would take its budget, or the same numbers would lead elsewhere."""
    played = []
    for costs in (Costs(), COSTS, Costs(relevance=0.0)):
        settings = toy.settings(strategy, budget=12.0, turns=10, costs=costs)
        episode = Episode(settings, random_stream(1, 'learner'))
        decisions = toy.play(episode, toy.world(3))
        assert episode.records
        assert (RELEVANCE in decisions[0].candidates) is (costs.relevance is not None)
        played.append([decision.candidates[decision.chosen] for decision in decisions])
    assert played[0] == played[1] == played[2]


def test_shares_count_each_thing_once(toy):
    """Jeffreys again: of seven things three are of none; one that was also labelled counts by its label."""
    assert class_shares(context_of(toy, (0, 1, 2, 3)))[-1] == pytest.approx((2 + 0.5) / 7)
    labels = [QueryRecord(1, QueryKind.LABEL, i, symbol, 1.0, Outcome.ANSWERED) for i, symbol in
              ((0, NO_SYMBOL), (90, 'snack'))]  # fmt: skip
    found = class_shares(context_of(toy, (0, 1, 2, 3), history=labels))
    assert found[-1] == pytest.approx((3 + 0.5) / 8)
    twice = context_of(toy, (0, 1, 2, 3))
    twice.concepts.learn(judged((0, 1)), twice.scene)
    assert class_shares(twice)[-1] == pytest.approx((4 + 0.5) / 7), 'the last word counts'


def test_beliefs_are_the_formula_written_out(toy):
    labels = ['snack', NO_SYMBOL]
    context = context_of(toy, (3, 4), labels)
    points = context.concepts.standardiser.transform(context.scene.features)
    prior = [dict(zip((*toy.symbols, NO_SYMBOL), each, strict=True)) for each in prior_beliefs(context)]
    of = {'snack': [0], NO_SYMBOL: [1, 2, 5]}

    def nearest(row, others):
        return max((np.exp(-np.mean((points[row] - points[i]) ** 2) / (2 * REACH**2)) for i in others), default=0.0)

    found = class_beliefs(context, REACH, DOUBT)
    for row in range(6):
        votes = {name: nearest(row, of.get(name, [])) + DOUBT * prior[row][name] for name in (*toy.symbols, NO_SYMBOL)}
        known = sum(votes[symbol] for symbol in toy.symbols)
        for symbol in toy.symbols:
            votes[symbol] *= 1 + nearest(row, [3, 4]) / known
        if row in (3, 4):
            votes[NO_SYMBOL] = 0.0
        assert found[row] == pytest.approx([vote / sum(votes.values()) for vote in votes.values()])
    assert found[[3, 4], -1].tolist() == [0.0, 0.0]


def test_what_matters_carries_over_to_what_looks_like_it(toy):
    """In the next scene, and not to what is far from it."""
    table = np.zeros((6, 5))
    table[:, 2] = [0, 5, 10, 15, 20, 25]
    concepts = ConceptLearner(toy.symbols, 4.0)
    scene = toy.scene(table)
    concepts.observe(scene)
    concepts.learn(judged((0,)), scene)
    table[:, 2] += 0.01
    later = toy.scene(table[:2], object_ids=(50, 51))
    concepts.observe(later)
    beliefs = class_beliefs(toy.context(scene=later, concepts=concepts), 0.05, DOUBT)
    assert beliefs[0, -1] < 0.1
    assert beliefs[1, -1] > 0.9
    assert beliefs[0, :-1] == pytest.approx(np.full(3, beliefs[0, 0])), 'of which symbol, nobody said'


def test_what_matters_may_be_of_no_symbol_that_is_left(toy):
    """Nobody can be sure of a thing when all symbols were asked for without success; but numbers stay numbers."""
    in_vain = [QueryRecord(2, QueryKind.DEMONSTRATION, None, symbol, 2.0, Outcome.ANSWERED) for symbol in toy.symbols]
    beliefs = class_beliefs(context_of(toy, (0, 1), history=in_vain), REACH, DOUBT)
    assert beliefs.tolist() == [[0.0, 0.0, 0.0, 1.0]] * 6
