"""A teacher who is away: turns pass, the question stays, and nothing is guessed."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from al_questioner.domain import Action, Answer, AnswerError, Costs, Outcome, QueryKind, SettingsError, random_stream
from al_questioner.questioning import Episode

LABEL, DEMONSTRATION = Action(QueryKind.LABEL, object_id=0), Action(QueryKind.DEMONSTRATION, symbol='fruit')
SUBSET, NOTHING = Action(QueryKind.FEATURE_SUBSET), Action(QueryKind.NO_QUERY)


@pytest.fixture
def scene(toy):
    return toy.scene(np.random.default_rng(3).normal(size=(4, 5)))


@pytest.fixture
def start(toy):
    def make(*actions, **changes):
        own = toy.settings('random_fsq', **{'budget': 4.0, 'turns': 6, **changes})
        return Episode(own, random_stream(0, 'learner'), strategy=toy.asks(*actions))

    return make


@pytest.fixture
def start_alone(start, scene):
    """Starts an episode whose teacher is away for the first turn; the episode and its first query."""

    def make(*actions, **changes):
        episode = start(*actions, **changes)
        query = episode.ask(scene).query
        episode.time_out()
        return episode, query

    return make


def chosen(decision):
    return decision.candidates[decision.chosen]


def test_a_turn_passes_and_the_question_stays(start, scene):
    """Otherwise an absent teacher would stall the episode, or find another question when coming back."""
    episode = start(LABEL)
    query = episode.ask(scene).query
    assert (episode.awaits_answer, episode.turns_over) == (True, 0)
    with pytest.raises(RuntimeError, match='q1 has not been answered'):
        episode.ask(scene)
    with pytest.raises(RuntimeError, match='q1 has not been answered'):
        episode.repeat_tuning()
    episode.time_out()
    assert (episode.awaits_answer, episode.turns_over, episode.pending) == (False, 1, query)
    decision = episode.ask(scene)
    assert (chosen(decision), decision.query, episode.pending) == (NOTHING, None, query)
    assert np.flatnonzero(~np.isnan(decision.utilities)).tolist() == [decision.chosen]
    assert (episode.awaits_answer, episode.unanswered_turns, episode.spent) == (True, 1, 1.0)


def test_the_answer_counts_whenever_it_comes(start, start_alone, toy, scene):
    """An answer after a break is neither lost nor taken for one about another object."""
    episode, query = start_alone(LABEL)
    episode.ask(scene)
    record = episode.tell(toy.reply(query, 'snack'))
    assert (record.turn, record.answered_in, record.object_id, record.symbol) == (1, 2, 0, 'snack')
    assert (episode.pending, episode.unanswered_turns, episode.spent) == (None, 0, 1.0)
    # An answer that comes while the robot looks is not refused.
    between, query = start_alone(LABEL)
    assert between.tell(toy.reply(query, 'snack')).answered_in is None
    assert chosen(between.ask(scene)) == LABEL
    at_once = start(LABEL)
    at_once.tell(toy.reply(at_once.ask(scene).query, 'snack'))
    at_once.concepts.observe(scene)
    expected = at_once.concepts.predict_proba(scene.features)
    np.testing.assert_array_equal(episode.concepts.predict_proba(scene.features), expected)


def test_a_question_whose_object_is_gone_is_withdrawn(start_alone, toy, scene):
    """Otherwise the robot would ask on and on about a thing that nobody sees."""
    other = toy.scene(np.random.default_rng(4).normal(size=(4, 5)), [5, 6, 7, 8])
    episode, first = start_alone(LABEL, Action(QueryKind.LABEL, object_id=7))
    second = episode.ask(other).query
    assert (second.query_id, second.action.object_id, second.budget_left) == ('q2', 7, 3.0)
    assert [(r.turn, r.outcome, r.cost) for r in episode.records] == [(1, Outcome.UNANSWERED, 0.0)]
    record = episode.tell(toy.reply(first, 'snack'))
    assert (record.answered_in, record.object_id, record.outcome) == (2, 0, Outcome.ANSWERED)
    assert (episode.pending, episode.awaits_answer, episode.spent) == (second, True, 2.0)
    assert episode.positives['snack'] == 1
    assert episode.tell(toy.reply(second, 'fruit')).answered_in is None


@pytest.mark.parametrize(('action', 'stays'), [(LABEL, True), (DEMONSTRATION, False), (SUBSET, True)])
def test_what_is_still_in_view_is_still_asked(start_alone, toy, scene, action, stays):
    """Otherwise a question would be withdrawn that can still be answered, or kept that means something else now."""
    moved = toy.scene(np.vstack([scene.features[:2], scene.features[2:] + 1.0]))
    episode, query = start_alone(action)
    decision = episode.ask(moved)
    assert (episode.pending == query) == stays
    assert (decision.query is None) == stays


def test_after_the_last_turn_the_question_is_withdrawn(start_alone, toy, scene):
    """Otherwise the episode of a teacher who does not come back would never end; what they say later would be lost."""
    episode, query = start_alone(LABEL, turns=2)
    episode.ask(scene)
    assert not episode.done
    episode.time_out()
    assert episode.done
    assert episode.spent == 0.0
    assert [record.outcome for record in episode.records] == [Outcome.UNANSWERED]
    with pytest.raises(RuntimeError, match='no query waits'):
        episode.time_out()
    assert episode.tell(toy.reply(query, 'snack')).symbol == 'snack'
    assert episode.done
    assert episode.positives['snack'] == 1


def test_nobody_says_that_nobody_answered(start, toy, scene):
    """Otherwise a teacher could have a question charged as if it had not been heard."""
    episode = start(LABEL)
    with pytest.raises(AnswerError, match='nobody can say'):
        episode.tell(toy.reply(episode.ask(scene).query, None, Outcome.UNANSWERED))


@pytest.mark.parametrize(('outcome', 'spent'), [(Outcome.UNKNOWN, 0.5), (Outcome.SKIP, 0.0), (Outcome.ANSWERED, 2.0)])
def test_each_outcome_is_charged_its_share(start, toy, scene, outcome, spent):
    """Otherwise the costs of the configuration would be ignored."""
    episode = start(DEMONSTRATION, costs=Costs(unknown=0.25, skip=0.0))
    query = episode.ask(scene).query
    content = 1 if outcome is Outcome.ANSWERED else None
    assert episode.tell(toy.reply(query, content, outcome)).cost == spent
    assert (episode.spent, episode.budget_left) == (spent, 4.0 - spent)


def test_what_nobody_answered_is_charged_its_share(start, toy, scene):
    """Otherwise a question that was withdrawn would be free, or cost all, whatever the configuration says."""
    episode = start(DEMONSTRATION, turns=1, costs=Costs(unanswered=0.25))
    query = episode.ask(scene).query
    assert episode.spent == 2.0
    episode.time_out()
    assert (episode.spent, episode.records[0].cost) == (0.5, 0.5)
    assert episode.tell(toy.reply(query, 1)).cost == 2.0


def test_a_late_answer_can_be_corrected(start_alone, toy, scene):
    """Otherwise a correction would forget when the answer came, or a first answer pass for a correction."""
    episode, query = start_alone(LABEL)
    episode.ask(scene)
    episode.tell(toy.reply(query, 'snack'))
    correction = Answer('q1', 'b1', 'toy', Outcome.ANSWERED, 'fruit', replaces='a1')
    record = episode.tell(correction)
    assert (record.turn, record.answered_in, record.symbol) == (1, 2, 'fruit')


def test_a_late_answer_never_exceeds_the_budget(start_alone, toy, scene):
    """Otherwise answers to questions that were withdrawn, and corrections, would overspend."""
    other = toy.scene(np.random.default_rng(4).normal(size=(4, 5)), [5, 6, 7, 8])
    episode, first = start_alone(DEMONSTRATION, LABEL, budget=2.0)
    second = episode.ask(other).query
    episode.tell(toy.reply(second, 7))
    assert episode.spent == 2.0
    assert episode.tell(toy.reply(first, 1)).cost == 0.0
    assert episode.spent == 2.0


@pytest.mark.parametrize('share', [-0.1, 1.1, float('nan')])
@pytest.mark.parametrize('outcome', ['unknown', 'skip', 'unanswered'])
def test_a_share_is_between_none_and_all(toy, outcome, share):
    """Otherwise a question could earn budget, or cost more than it was said to."""
    with pytest.raises(SettingsError, match=rf'costs\.{outcome} must '):
        toy.settings('random_fsq', costs=Costs(**{outcome: share}))


@pytest.mark.parametrize(('outcome', 'again'), [(Outcome.UNKNOWN, False), (Outcome.SKIP, True)])
def test_what_nobody_can_name_is_not_asked_again_while_it_looks_the_same(toy, scene, outcome, again):
    """Otherwise the robot would ask again after every change elsewhere on the table."""
    episode = Episode(toy.settings('random_fsq', budget=20.0, turns=12), random_stream(0, 'learner'))
    asked = {}
    for turn in range(12):
        # All but object 0 are others in each turn.
        rows = np.vstack([scene.features[:1], np.random.default_rng(turn).normal(size=(2, 5))])
        query = episode.ask(toy.scene(rows, [0, 10 + 2 * turn, 11 + 2 * turn])).query
        if query is None:
            continue
        about_it = query.action.object_id == 0
        asked[turn] = about_it
        episode.tell(toy.reply(query, None, outcome if about_it else Outcome.SKIP))
    assert (sum(asked.values()) > 1) == again


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data(), strategy=st.sampled_from(['u_sampling', 'random_fsq', 'rarest_demo', 'dt_iros']))
def test_however_answers_come_what_is_known_is_what_was_said(toy, data, strategy):
    """An episode in which the teacher comes and goes would know other things than were said, or overspend."""
    own = toy.settings(strategy, turns=8, budget=9.0, costs=Costs(unknown=0.5, skip=0.0))
    world, scenes, open_queries = toy.world(data.draw(st.integers(0, 5)), change_interval=2), [], []
    episode = Episode(own, random_stream(1, 'strategy'))

    def answer_some():
        for waiting in list(open_queries):
            if data.draw(st.booleans()):
                open_queries.remove(waiting)
                answer(waiting)

    def answer(query):
        outcome = data.draw(st.sampled_from([Outcome.ANSWERED, Outcome.ANSWERED, Outcome.UNKNOWN, Outcome.SKIP]))
        content = None
        if outcome is Outcome.ANSWERED:
            content = {
                QueryKind.LABEL: 'snack',
                QueryKind.DEMONSTRATION: scenes[query.turn - 1].object_ids[0],
                QueryKind.FEATURE_SUBSET: ('size',),
            }[query.action.kind]
        episode.tell(Answer(query.query_id, f'a{query.query_id}', 'anna', outcome, content))

    while not episode.done:
        scenes.append(world.scene(episode.turn + 1))
        query = episode.ask(scenes[-1]).query
        if query is not None:
            open_queries.append(query)
        answer_some()
        if episode.awaits_answer:
            episode.time_out()
        # Between the turns, too.
        answer_some()
        assert episode.spent <= own.budget + 1e-9
    oracle = toy.learnt(own, scenes, episode.records)
    features = scenes[-1].features
    np.testing.assert_array_equal(episode.concepts.predict_proba(features), oracle.predict_proba(features))
    assert sum(record.outcome is Outcome.UNANSWERED for record in episode.records) == len(open_queries)
