"""The ask/tell episode: whole episodes, rules of budget and time, and everything that is refused."""

import subprocess
import sys

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, Action, AnswerError, Costs, Outcome, QueryKind, SceneError, random_stream
from al_questioner.questioning import STRATEGIES, Episode
from shared.checkout import ROOT

AUTOMATIC = [name for name in STRATEGIES if name != 'human']
"""The strategies that ask nobody what to ask."""


def play(toy, strategy, seed=0, world=None, watch=None, **settings):
    """A whole episode in a toy world: the episode and its decisions."""
    episode = Episode(toy.settings(strategy, **settings), random_stream(seed, 'strategy'))
    return episode, toy.play(episode, world or toy.world(seed), watch)


@pytest.fixture
def scripted(toy):
    """An episode that asks what the test wants."""
    strategy = toy.asks()
    episode = Episode(toy.settings('u_sampling'), random_stream(0, 'strategy'), strategy=strategy)
    scene = toy.scene(np.random.default_rng(0).normal(size=(4, 5)), object_ids=(10, 11, 12, 13))

    def ask(action, seen=scene):
        strategy.actions = (action,)
        decision = episode.ask(seen)
        assert decision.candidates[decision.chosen] == action
        return decision.query

    return episode, scene, ask


LABEL = Action(QueryKind.LABEL, object_id=11)
DEMONSTRATION = Action(QueryKind.DEMONSTRATION, symbol='snack')
SUBSET = Action(QueryKind.FEATURE_SUBSET)
NOTHING = Action(QueryKind.NO_QUERY)


@pytest.mark.parametrize('unknown_rate', [0.0, 0.3])
@pytest.mark.parametrize('strategy', AUTOMATIC)
def test_whole_episode(toy, strategy, unknown_rate):
    """Every strategy ends in time, within its budget, with a record per query and numbers that agree."""
    episode, decisions = play(toy, strategy, world=toy.world(1, unknown_rate=unknown_rate))
    assert episode.turn == len(decisions) == 20
    assert [d.turn for d in decisions] == list(range(1, 21))
    queries = [d.query for d in decisions if d.query]
    assert [q.query_id for q in queries] == [f'q{i + 1}' for i in range(len(queries))]
    assert len(episode.records) == len(queries) > 0
    assert episode.spent == sum(record.cost for record in episode.records) <= 12
    assert [q.budget_left for q in queries] == list(12 - np.cumsum([r.cost for r in episode.records]))
    assert sum(episode.positives.values()) <= len(episode.records)
    for decision in decisions:
        assert decision.features.shape == (len(decision.candidates), 7)
        assert decision.utilities.shape == (len(decision.candidates),)
        best = np.nanmax(decision.utilities)
        assert decision.utilities[decision.chosen] >= best - 1e-9 * abs(best)


@pytest.mark.parametrize('strategy', ['dt_iros', 'dt_task', 'dt_task_env'])
def test_published_utilities_are_weights_times_features(toy, strategy):
    """A recorded decision must explain itself: utility = w . features for each candidate."""
    _, decisions = play(toy, strategy)
    weights = toy.settings(strategy).weights
    order = ('discriminability', 'class_uniformity', 'instance_variation', 'prediction_margin',
             'budget_consumption', 'remaining_time', 'non_query_time')  # fmt: skip
    vector = np.array([weights.get(name, 0.0) for name in order])
    for decision in decisions:
        considered = ~np.isnan(decision.utilities)
        np.testing.assert_allclose(decision.utilities[considered], (decision.features @ vector)[considered], atol=1e-14)
        # All but the feature subset query that was asked, and the symbols of which there is nothing here.
        assert {decision.candidates[row].kind for row in np.flatnonzero(~considered)} <= {
            QueryKind.FEATURE_SUBSET,
            QueryKind.DEMONSTRATION,
        }


@pytest.mark.parametrize(
    'strategy', ['u_sampling_fsq', 'random_fsq', 'farthest_fsq', 'rarest_demo', 'typiclust', 'probcover']
)
@pytest.mark.parametrize('seed', range(3))
def test_controls_never_repeat_themselves(toy, strategy, seed):
    """No label query about a labelled view, at most one FSQ, no DQ for what the scene was said not to hold."""
    refused = set()
    scenes = {}

    def watch(episode, scene, decision):
        scenes[decision.turn] = scene.object_ids
        action = decision.candidates[decision.chosen]
        if action.kind is QueryKind.LABEL:
            assert not episode.concepts.is_labelled(scene)[scene.index_of(action.object_id)]
        if action.kind is QueryKind.DEMONSTRATION:
            assert (scene.object_ids, action.symbol) not in refused
        refused.update((scenes[r.turn], r.symbol) for r in episode.records if r.object_id is None)

    episode, _ = play(toy, strategy, seed, watch=watch, budget=100.0, turns=24)
    assert [r.kind for r in episode.records].count(QueryKind.FEATURE_SUBSET) == 1


def test_same_seed_same_queries_in_another_process(toy):
    """Hash randomisation and iteration order must not reach a decision."""
    program = (
        'import sys; sys.path[:0] = sys.argv[1:]; from shared import toys as toy\n'
        'from al_questioner.domain import random_stream; from al_questioner.questioning import STRATEGIES, Episode\n'
        'for name in STRATEGIES:\n'
        '    if name == "human": continue\n'
        '    episode = Episode(toy.make_settings(name), random_stream(3, "strategy"))\n'
        '    toy.play(episode, toy.ToyWorld(3)); print(name, episode.records)\n'
    )
    command = [sys.executable, '-c', program, str(ROOT / 'test')]
    child = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    expected = [f'{name} {play(toy, name, seed=3)[0].records}' for name in AUTOMATIC]
    assert child.stdout.splitlines() == expected


@pytest.mark.parametrize('strategy', AUTOMATIC)
def test_no_budget_means_no_queries(toy, strategy):
    episode, decisions = play(toy, strategy, budget=0.0, turns=5)
    assert episode.records == ()
    assert all(d.candidates == (NOTHING,) and d.query is None for d in decisions)


def test_single_object_scene(toy):
    """One object is a scene; no strategy may stumble over it."""
    for strategy in AUTOMATIC:
        play(toy, strategy, world=toy.world(0, n_objects=1), turns=6)


@pytest.mark.parametrize('strategy', AUTOMATIC)
@pytest.mark.parametrize('first', ['empty', 'full'])
def test_a_scene_without_things_is_a_scene(toy, strategy, first):
    """Otherwise an empty table, at the start or later, would end the episode, or be asked about at a price."""
    nothing, full = toy.scene(np.empty((0, 5))), toy.world(0, change_interval=1)
    episode = Episode(toy.settings(strategy, budget=40.0), random_stream(0, 'strategy'))
    kinds = set()
    for turn in range(1, 21):
        is_empty = (turn % 4 < 2) == (first == 'empty')
        things = full.scene(turn)
        decision = episode.ask(nothing if is_empty else things)
        if is_empty:
            assert {action.kind for action in decision.candidates} <= {SUBSET.kind, NOTHING.kind}
            assert decision.features.shape == (len(decision.candidates), 7)
        assert episode.concepts.kernel.length_scale > 0
        if decision.query:
            kinds.add(decision.query.action.kind)
            episode.tell(full.answer(decision.query))
    assert kinds - {SUBSET.kind}, 'it goes on where there are things again'


@pytest.mark.parametrize('strategy', AUTOMATIC)
def test_a_single_group_of_features_is_not_asked_about(toy, strategy):
    """There is only one answer. What waits for it, or sets its price aside, is to go on without."""

    class OneGroup(toy.world):
        def scene(self, turn):
            seen = super().scene(turn)
            return toy.scene(seen.features, seen.object_ids, tuple(f'colour_{i}' for i in range(5)))

    episode, decisions = play(toy, strategy, world=OneGroup(0), budget=12.0)
    assert SUBSET not in {action for decision in decisions for action in decision.candidates}
    assert {record.kind for record in episode.records} & {QueryKind.LABEL, QueryKind.DEMONSTRATION}
    if strategy == 'expert':
        assert episode.spent == 12.0, 'an even pace ends with nothing left'


@pytest.mark.parametrize('action', [LABEL, DEMONSTRATION])
def test_what_waits_is_withdrawn_when_nothing_is_in_view_any_more(scripted, toy, action):
    """Otherwise nobody could answer a question about what has gone."""
    episode, _, ask = scripted
    query = ask(action)
    episode.time_out()
    assert ask(NOTHING, toy.scene(np.empty((0, 5)))) is None
    assert episode.pending is None
    assert [record.outcome for record in episode.records] == [Outcome.UNANSWERED]
    assert query.query_id == 'q1'


def test_free_queries_need_no_budget(toy):
    episode, _ = play(toy, 'u_sampling', budget=0.0, turns=3, costs=Costs(label=0.0))
    assert len(episode.records) == 3


def test_label_is_learnt(scripted, toy):
    episode, scene, ask = scripted
    query = ask(LABEL)
    assert (query.text, query.choices, query.cost) == ('What is object 11?', toy.symbols, 1.0)
    assert (query.budget_left, query.turns_left, query.turn) == (11.0, 19, 1)
    record = episode.tell(toy.reply(query, 'snack'))
    assert (record.kind, record.object_id, record.symbol, record.outcome) == (
        QueryKind.LABEL, 11, 'snack', Outcome.ANSWERED,
    )  # fmt: skip
    assert episode.positives == {'main_dish': 0, 'snack': 1, 'fruit': 0}
    assert episode.concepts.predict_proba(scene.features)[1].argmax() == 1


def test_label_none_is_learnt_as_clutter(scripted, toy):
    episode, scene, ask = scripted
    assert episode.tell(toy.reply(ask(LABEL), NO_SYMBOL)).symbol == NO_SYMBOL
    assert episode.concepts.is_labelled(scene).tolist() == [False, True, False, False]
    assert sum(episode.positives.values()) == 0
    assert (episode.concepts.predict_proba(scene.features)[1] < 0.5).all()


def test_demonstration_is_learnt(scripted, toy):
    episode, scene, ask = scripted
    query = ask(DEMONSTRATION)
    assert query.choices == ('10', '11', '12', '13')
    record = episode.tell(toy.reply(query, 13))
    assert (record.object_id, record.symbol, record.cost) == (13, 'snack', 2.0)
    assert episode.concepts.is_labelled(scene).tolist() == [False, False, False, True]


def test_a_demonstration_query_tells_what_is_known(scripted, toy):
    """It is known as it looks now: the teacher shows nothing that was named, but again what has changed."""
    episode, scene, ask = scripted
    episode.tell(toy.reply(ask(LABEL), NO_SYMBOL))
    assert ask(SUBSET).known is None
    episode.tell(toy.reply(episode.pending, None, Outcome.UNKNOWN))
    query = ask(DEMONSTRATION)
    assert query.known == (11,)
    episode.tell(toy.reply(query, 13))
    assert ask(DEMONSTRATION).known == (11, 13)
    episode.tell(toy.reply(episode.pending, 13))
    turned = scene.features.copy()
    turned[3] += 1
    assert ask(DEMONSTRATION, toy.scene(turned, scene.object_ids)).known == (11,)


def test_demonstration_of_nothing_teaches_nothing_but_costs(scripted, toy):
    episode, scene, ask = scripted
    record = episode.tell(toy.reply(ask(DEMONSTRATION), NO_SYMBOL))
    assert (record.object_id, record.symbol, record.outcome) == (None, 'snack', Outcome.ANSWERED)
    assert episode.spent == 2.0
    assert not episode.concepts.is_labelled(scene).any()


def test_subset_restricts_the_features(scripted, toy):
    episode, _, ask = scripted
    query = ask(SUBSET)
    assert query.choices == ('colour', 'size', 'noise')
    record = episode.tell(toy.reply(query, ('size', 'colour', 'size')))
    assert record.groups == ('size', 'colour')
    assert episode.concepts.kernel.length_scale == pytest.approx(3**0.5)


@pytest.mark.parametrize('outcome', [Outcome.UNKNOWN, Outcome.SKIP])
@pytest.mark.parametrize('action', [LABEL, DEMONSTRATION, SUBSET])
def test_unanswered_query_costs_and_teaches_nothing(scripted, toy, action, outcome):
    episode, scene, ask = scripted
    query = ask(action)
    before = episode.concepts.predict_proba(scene.features)
    record = episode.tell(toy.reply(query, None, outcome))
    assert (record.outcome, record.object_id, record.groups) == (outcome, action.object_id, ())
    assert record.symbol == action.symbol, 'a label that was not given is None'
    assert episode.spent == query.cost
    np.testing.assert_array_equal(episode.concepts.predict_proba(scene.features), before)


@pytest.mark.parametrize(
    ('action', 'content', 'reason'),
    [
        (LABEL, Outcome.SKIP, "outcome 'skip' has no content"),
        (LABEL, 'pizza', "unknown label 'pizza'; known: main_dish, snack, fruit, none"),
        (LABEL, 11, 'a label is one of .*, not 11'),
        (LABEL, None, 'a label is one of .*, not None'),
        (DEMONSTRATION, 99, 'object 99 is not in the scene'),
        (DEMONSTRATION, 'snack', "object id or 'none', not 'snack'"),
        (DEMONSTRATION, True, 'not True'),
        (DEMONSTRATION, None, 'not None'),
        (SUBSET, ('colour', 'taste'), "unknown feature group 'taste'; known: colour, size, noise"),
        (SUBSET, (), 'some of colour, size, noise'),
        (SUBSET, 'colour', "not 'colour'"),
    ],
)
def test_refused_content_leaves_the_query_pending(scripted, toy, action, content, reason):
    episode, _, ask = scripted
    query = ask(action)
    before = episode.concepts.model_version
    said = ('snack', content) if isinstance(content, Outcome) else (content,)
    with pytest.raises(AnswerError, match=reason):
        episode.tell(toy.reply(query, *said))
    assert episode.pending is query
    assert episode.records == ()
    assert episode.spent == query.cost
    assert episode.concepts.model_version == before
    episode.tell(toy.reply(query, None, Outcome.SKIP))
    assert episode.pending is None


def test_answer_to_another_query_is_refused(scripted, toy):
    episode, _, ask = scripted
    query = ask(LABEL)
    with pytest.raises(AnswerError, match="to query 'q7', the pending one is 'q1'"):
        episode.tell(toy.reply(query, 'snack', query_id='q7'))
    episode.tell(toy.reply(query, 'snack'))
    with pytest.raises(AnswerError, match='no query is pending'):
        episode.tell(toy.reply(query, 'snack', query_id='q7'))


def test_object_that_has_gone_cannot_be_shown(scripted, toy):
    """The scene that counts is the one in which the question was asked."""
    episode, scene, ask = scripted
    episode.tell(toy.reply(ask(DEMONSTRATION), 13))
    smaller = toy.scene(scene.features[:2], object_ids=(10, 11))
    query = ask(DEMONSTRATION, smaller)
    with pytest.raises(AnswerError, match='object 13 is not in the scene'):
        episode.tell(toy.reply(query, 13))


def test_refused_scene_leaves_the_turn_to_be_tried_again(scripted, toy):
    episode, _, ask = scripted
    ask(NOTHING)
    with pytest.raises(SceneError, match='the scene has 1 features'):
        ask(NOTHING, toy.scene([[1.0]], names=('size_height',)))
    assert (episode.turn, episode.pending, episode.spent) == (1, None, 0.0)
    ask(NOTHING)
    assert episode.turn == 2


def test_asking_out_of_turn(scripted, toy):
    """A pending query and the end of the episode are the caller's mistakes."""
    episode, _, ask = scripted
    query = ask(LABEL)
    with pytest.raises(RuntimeError, match='query q1 has not been answered yet'):
        ask(LABEL)
    episode.tell(toy.reply(query, 'snack'))
    for _ in range(18):
        ask(NOTHING)
    last = ask(LABEL)
    assert not episode.done
    episode.tell(toy.reply(last, 'snack'))
    assert episode.done
    with pytest.raises(RuntimeError, match='the episode is over: all 20 turns have passed'):
        ask(NOTHING)


@pytest.mark.parametrize('strategy', ['u_sampling', 'dt_task_env', 'rarest_demo'])
def test_replaying_the_records_gives_the_same_knowledge(toy, strategy):
    """Accuracy is measured outside the learner by replaying what it was told."""
    scenes = []
    episode, _ = play(toy, strategy, watch=lambda e, scene, d: scenes.append(scene), budget=30.0)
    replayed = toy.learnt(toy.settings(strategy), scenes, episode.records)
    features = scenes[-1].features
    np.testing.assert_array_equal(replayed.predict_proba(features), episode.concepts.predict_proba(features))
    assert replayed.model_version == episode.concepts.model_version
