"""Correcting an answer: as if it had been the right one at once."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from al_questioner.domain import NO_SYMBOL, SAYABLE_OUTCOMES, Answer, AnswerError, Outcome, QueryKind, random_stream
from al_questioner.questioning import Episode, Receipt, make_strategy


def contents(query, choose):
    """Something that somebody could say to a query: an outcome and its content."""
    outcome = choose([*SAYABLE_OUTCOMES, Outcome.ANSWERED, Outcome.ANSWERED])
    if outcome is not Outcome.ANSWERED:
        return outcome, None
    if query.action.kind is QueryKind.FEATURE_SUBSET:
        return outcome, choose([query.choices[:1], query.choices[1:], query.choices])
    said = choose([*query.choices, NO_SYMBOL])
    is_object = query.action.kind is QueryKind.DEMONSTRATION and said != NO_SYMBOL
    return outcome, int(said) if is_object else said


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    data=st.data(),
    strategy=st.sampled_from(['u_sampling', 'random_fsq', 'rarest_demo', 'dt_iros']),
    is_tuned=st.booleans(),
)
def test_a_corrected_episode_is_that_of_the_right_answer(toy, data, strategy, is_tuned):
    """A wrong answer that was taken back would leave its traces in what the robot believes, tuned once or not."""
    own = toy.settings(strategy, turns=8, budget=20.0)
    world, scenes = toy.world(data.draw(st.integers(0, 5))), []
    episode = Episode(own, random_stream(1, 'strategy'))
    queries, last_ids, expected = [], {}, {}

    def choose(options):
        return data.draw(st.sampled_from(list(options)))

    def correct():
        query = choose(queries)
        outcome, content = contents(query, choose)
        answer_id = f'c{sum(map(len, last_ids.values()))}'
        answer = Answer(query.query_id, answer_id, 'anna', outcome, content, replaces=last_ids[query.query_id][-1])
        before = (episode.turn, episode.spent, episode.pending, [(r.turn, r.cost) for r in episode.records])
        expected[query.turn] = episode.tell(answer)
        last_ids[query.query_id].append(answer_id)
        assert before == (episode.turn, episode.spent, episode.pending, [(r.turn, r.cost) for r in episode.records])
        assert episode.take(answer).receipt is Receipt.DUPLICATE
        check()

    def check():
        assert list(episode.records) == [expected[turn] for turn in sorted(expected)]
        oracle = toy.learnt(own, scenes, episode.records, episode.tuned_turns)
        features = scenes[-1].features
        np.testing.assert_array_equal(episode.concepts.predict_proba(features), oracle.predict_proba(features))
        assert episode.concepts.model_version == oracle.model_version
        assert episode.concepts.kernel == oracle.kernel
        assert episode.positives == oracle.positives
        assert episode.concepts.seen.object_ids == oracle.seen.object_ids
        np.testing.assert_array_equal(episode.concepts.seen.features, oracle.seen.features)

    while not episode.done:
        scenes.append(world.scene(episode.turn + 1))
        query = episode.ask(scenes[-1]).query
        if queries and data.draw(st.booleans()):
            correct()
        if query is not None:
            outcome, content = contents(query, choose)
            expected[query.turn] = episode.tell(Answer(query.query_id, 'a1', 'anna', outcome, content))
            queries.append(query)
            last_ids[query.query_id] = ['a1']
        if is_tuned and episode.turn % 3 == 0:
            episode.repeat_tuning()
    if queries:
        correct()


def ask_until_answered(episode, world, n):
    """The next n queries of an episode, answered."""
    queries = []
    while len(queries) < n:
        query = episode.ask(world.scene(episode.turn + 1)).query
        if query is not None:
            episode.tell(world.answer(query))
            queries.append(query)
    return queries


@pytest.fixture
def answered(toy):
    """An episode with two answered queries and one pending."""
    world = toy.world(1)
    episode = Episode(toy.settings('u_sampling'), random_stream(0, 'strategy'))
    queries = ask_until_answered(episode, world, 2)
    queries.append(episode.ask(world.scene(episode.turn + 1)).query)
    return episode, queries


def correction(query, content, answer_id='c1', replaces='a1', outcome=Outcome.ANSWERED):
    return Answer(query.query_id, answer_id, 'anna', outcome, content, replaces)


def test_an_undone_answer_teaches_nothing(answered, toy):
    """Otherwise undo would leave the label."""
    episode, queries = answered
    episode.tell(correction(queries[0], None, outcome=Outcome.UNKNOWN))
    assert [record.outcome for record in episode.records] == [Outcome.UNKNOWN, Outcome.ANSWERED]
    assert len(episode.concepts.labelled_views) == 1
    assert episode.pending is queries[2]
    assert episode.spent == 3.0


def test_a_correction_is_judged_by_the_scene_of_its_question(toy):
    """Otherwise an object that came later could be shown, and one that was there then could not."""
    world = toy.world(2, change_interval=1)
    episode = Episode(toy.settings('rarest_demo'), random_stream(0, 'strategy'))
    while not (query := episode.ask(world.scene(episode.turn + 1)).query) or query.action.symbol is None:
        if query:
            episode.tell(world.answer(query))
    episode.tell(world.answer(query))
    there = [int(choice) for choice in query.choices]
    ask_until_answered(episode, world, 1)
    with pytest.raises(AnswerError, match='is not in the scene'):
        episode.tell(correction(query, episode.concepts.labelled_views[-1].object_id))
    assert episode.tell(correction(query, there[-1])).object_id == there[-1]


@pytest.mark.parametrize(
    ('number', 'changes', 'reason'),
    [
        (0, {'replaces': 'a9'}, "no answer 'a9' to query 'q1' was taken"),
        (0, {'replaces': None}, "'c1' to query 'q1' does not count: query 'q1' was answered already, by 'a1'"),
        (0, {'answer_id': 'a1'}, "another answer 'a1' to query 'q1' was taken already"),
        (0, {'content': 'pizza'}, "unknown label 'pizza'"),
        (0, {'outcome': Outcome.SKIP}, "outcome 'skip' has no content"),
        # Nor can the pending question be corrected: it was never answered.
        (2, {}, "no answer 'a1' to query 'q3' was taken"),
    ],
)
def test_a_refused_correction_changes_nothing(answered, number, changes, reason):
    """Otherwise a mistaken correction would damage what was right."""
    episode, queries = answered
    members = {'answer_id': 'c1', 'replaces': 'a1', 'content': 'snack', 'outcome': Outcome.ANSWERED, **changes}
    before, version = episode.records, episode.concepts.model_version
    with pytest.raises(AnswerError, match=reason):
        episode.tell(Answer(queries[number].query_id, teacher_id='anna', **members))
    assert (episode.records, episode.concepts.model_version, episode.pending) == (before, version, queries[2])


def test_a_correction_is_corrected_but_no_answer_twice(answered):
    """Otherwise of two corrections of one answer that cross, the later would win unseen."""
    episode, queries = answered
    episode.tell(correction(queries[0], 'snack'))
    with pytest.raises(AnswerError, match="'a1' to query 'q1' was replaced, in the end by 'c1'"):
        episode.tell(correction(queries[0], 'fruit', 'c2'))
    episode.tell(correction(queries[0], 'fruit', 'c2', replaces='c1'))
    assert episode.records[0].symbol == 'fruit'


def test_what_was_taken_is_known_again(answered, toy):
    """Otherwise a teacher that resends would be refused, or counted twice; another's late answer would be learnt."""
    episode, queries = answered
    records, version = episode.records, episode.concepts.model_version
    assert episode.take(toy.reply(queries[0], records[0].symbol)).receipt is Receipt.DUPLICATE
    other = 'fruit' if records[0].symbol != 'fruit' else 'snack'
    with pytest.raises(AnswerError, match="another answer 'a1' to query 'q1' was taken already"):
        episode.take(toy.reply(queries[0], other))
    late = Answer('q1', 'b1', 'bert', Outcome.ANSWERED, 'snack')
    for _ in range(2):
        assert episode.take(late).receipt is Receipt.LATE
    assert (episode.records, episode.concepts.model_version, episode.pending) == (records, version, queries[2])
    assert list(episode.answers.late) == [late]
    with pytest.raises(AnswerError, match="unknown label 'pizza'"):
        episode.take(Answer('q1', 'b2', 'bert', Outcome.ANSWERED, 'pizza'))


def test_what_does_not_count_cannot_be_told(answered, toy):
    """Otherwise a notebook would believe that an answer was learnt."""
    episode, queries = answered
    with pytest.raises(AnswerError, match="'a1' to query 'q1' does not count: already taken"):
        episode.tell(toy.reply(queries[0], episode.records[0].symbol))
    with pytest.raises(AnswerError, match="does not count: query 'q1' was answered already, by 'a1'"):
        episode.tell(Answer('q1', 'b1', 'bert', Outcome.SKIP))
    assert not episode.answers.late


def test_what_is_prepared_is_not_yet_taken(answered, toy):
    """Otherwise an answer would be learnt before it is on the disk."""
    episode, queries = answered
    prepared = episode.prepare(toy.reply(queries[2], 'snack'))
    assert (prepared.receipt, episode.pending, len(episode.records)) == (Receipt.ACCEPTED, queries[2], 2)
    episode.commit(prepared)
    assert (episode.pending, episode.records[-1]) == (None, prepared.record)


def test_the_strategy_sees_the_corrected_past(toy):
    """The next question does not follow from the wrong answer."""
    seen = []

    class Watching:
        selector = None

        def choose(self, context, rng):
            seen.append((context.history, context.concepts))
            return make_strategy('u_sampling', {}).choose(context, rng)

    world = toy.world(1)
    episode = Episode(toy.settings('u_sampling'), random_stream(0, 'strategy'), strategy=Watching())
    first, _ = ask_until_answered(episode, world, 2)
    episode.tell(correction(first, None, outcome=Outcome.UNKNOWN))
    episode.ask(world.scene(3))
    history, concepts = seen[-1]
    assert [record.outcome for record in history] == [Outcome.UNKNOWN, Outcome.ANSWERED]
    assert concepts is episode.concepts
    assert len(concepts.labelled_views) == 1
