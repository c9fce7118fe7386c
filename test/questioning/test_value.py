"""What a question is worth: cases solved by hand, the formula written out, and what must never happen."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from al_questioner.concepts import Knowledge
from al_questioner.domain import (
    NO_SYMBOL,
    VALUE_FEATURES,
    Costs,
    Outcome,
    QueryKind,
    QueryRecord,
    SettingsError,
    generator,
)
from al_questioner.questioning import Episode, Situation, make_strategy, read_weights
from al_questioner.questioning.value import (
    NONE_NEED,
    REACH,
    class_beliefs,
    class_needs,
    later_answers,
    lead,
    novelties,
    value_features,
)

SHIPPED = read_weights(Path(__file__).resolve().parents[2] / 'config' / 'weights' / 'value_per_cost.yaml').values
SUBSET_ASKED = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.ANSWERED, ('size', 'colour'))


def label_record(symbol, turn=2, outcome=Outcome.ANSWERED):
    return QueryRecord(turn, QueryKind.LABEL, 90, symbol, 1.0, outcome)


def situation_of(toy, labels=(), seed=3, table=None, **changes):
    """Six objects, of which the first ones were labelled so; the budget is short unless it is changed."""
    features = np.random.default_rng(seed).normal(size=(6, 5)) if table is None else table
    scene = changes.pop('scene', None) or toy.scene(features)
    knowledge = Knowledge(toy.symbols)
    knowledge.observe(scene)
    for row, label in enumerate(labels):
        knowledge.label(scene.object_ids[row], scene.features[row], label, 1)
    values = {
        'turn': 2, 'turns': 40, 'scene': scene, 'knowledge': knowledge, 'budget': 20.0, 'spent': 2.0, 'costs': Costs(),
        'change_interval': 5, 'non_query_turns': 0, 'scene_turn': 1, 'history': (SUBSET_ASKED,),
    }  # fmt: skip
    return Situation(**{**values, **changes})


def decide(situation, seed=0, weights=SHIPPED):
    choice = make_strategy('value_per_cost', weights).choose(situation, np.random.default_rng(seed))
    return situation.candidates[choice.index], choice


def values_by_brute_force(situation):
    """The formula of docs/method.md for the label and demonstration queries, object by object."""
    knowledge, scene, symbols = situation.knowledge, situation.scene, situation.symbols
    q = knowledge.predict_proba(scene.features)
    answers = [r.symbol for r in situation.history if r.kind is QueryKind.LABEL and r.outcome is Outcome.ANSWERED]
    names = [*symbols, NO_SYMBOL]
    share = {name: (answers.count(name) + 1 / len(names)) / (len(answers) + 1) for name in names}
    need = {}
    for symbol, n in knowledge.positives.items():
        need[symbol] = (1 / (1 + n) - 1 / (2 + n)) / 0.5
    need[NO_SYMBOL] = NONE_NEED * max(need.values())
    standardised = knowledge._standardiser.transform
    seen = {(v.object_id, v.features.tobytes()): v.label for v in knowledge.labelled_views}
    beliefs, novelty, shown = [], [], []
    for row in range(len(scene)):
        odds = {symbol: share[symbol] * q[row, j] / (1 - q[row, j]) for j, symbol in enumerate(symbols)}
        odds[NO_SYMBOL] = share[NO_SYMBOL]
        beliefs.append({name: odds[name] / sum(odds.values()) for name in names})
        label = seen.get((scene.object_ids[row], scene.features[row].tobytes()))
        shown.append({s: beliefs[-1][s] if label is None else float(label == s) for s in symbols})
        point = standardised(scene.features[row : row + 1])[0]
        told = [np.mean((point - standardised(v.features[None])[0]) ** 2) for v in knowledge.labelled_views]
        novelty.append(1 - max((np.exp(-d / (2 * REACH**2)) for d in told), default=0.0))
    found = {}
    for row, object_id in enumerate(scene.object_ids):
        found[object_id] = novelty[row], sum(beliefs[row][name] * need[name] for name in names)
    for symbol in symbols:
        mass = [shown[row][symbol] for row in range(len(scene))]
        absent = np.prod([1 - value for value in mass])
        found[symbol] = np.dot(mass, novelty) / sum(mass), need[symbol], 1 - absent
    return found


@pytest.mark.parametrize('labels', [[], ['snack'], ['snack', NO_SYMBOL, 'fruit', 'snack']])
def test_features_are_the_formula_written_out(toy, labels):
    history = (SUBSET_ASKED, *(label_record(label) for label in labels))
    situation = situation_of(toy, labels, history=history)
    expected = values_by_brute_force(situation)
    for action, row in zip(situation.candidates, value_features(situation), strict=True):
        named = dict(zip(VALUE_FEATURES, row, strict=True))
        if action.kind is QueryKind.LABEL:
            novelty, need = expected[action.object_id]
            assert named['novelty'] == pytest.approx(np.log(max(novelty, 1e-6)), abs=1e-7)
            assert named['need'] == pytest.approx(np.log(need), abs=1e-9)
            assert (named['chance'], named['price']) == (0.0, 0.0)
        elif action.kind is QueryKind.DEMONSTRATION:
            logs = [np.log(max(value, 1e-6)) for value in expected[action.symbol]]
            assert [named['novelty'], named['need'], named['chance']] == pytest.approx(logs, abs=1e-6)
            assert named['price'] == pytest.approx(np.log(2))
        assert (named['silence'] == 1.0) == (action.kind is QueryKind.NO_QUERY)
    assert np.isfinite(value_features(situation)).all()


def test_needs_by_hand(toy):
    """Of errors 2, 1, 2/3, 1/2 the first example saves 1, the third 1/6; none counts a share of the largest."""
    needs = class_needs(situation_of(toy, ['snack', 'snack', 'fruit', NO_SYMBOL]))
    assert needs == pytest.approx([1, 1 / 6, 1 / 3, NONE_NEED])


def test_beliefs_before_any_label_are_even_and_follow_the_answers(toy):
    """One prior answer, shared among three symbols and none; then three of four answers said none."""
    assert class_beliefs(situation_of(toy)) == pytest.approx(np.full((6, 4), 0.25))
    answers = [label_record(NO_SYMBOL)] * 3 + [label_record('fruit'), label_record(None, outcome=Outcome.UNKNOWN)]
    found = class_beliefs(situation_of(toy, history=(SUBSET_ASKED, *answers)))
    assert found[0] == pytest.approx([0.05, 0.05, 0.25, 0.65])


def test_novelty_by_hand(toy):
    """A labelled view tells all about itself, and exp(-1/2) of what lies one reach away in every feature."""
    table = np.zeros((6, 5))
    table[:, 2] = [0, 1, 2, 3, 4, 9]
    situation = situation_of(toy, ['snack'], table=table)
    distance = situation.knowledge.distance_to_labelled(situation.scene)
    expected = 1 - np.exp(-(distance**2) / (2 * REACH**2))
    assert novelties(situation) == pytest.approx(expected)
    assert novelties(situation)[0] == 0.0
    assert novelties(situation_of(toy)) == pytest.approx(np.ones(6))


@pytest.mark.parametrize(
    ('changes', 'answers'),
    [
        ({'budget': 25.0, 'spent': 0.0, 'turn': 1}, 23),
        ({'budget': 500.0, 'spent': 0.0, 'turn': 1}, 39),
        ({'budget': 2.0, 'spent': 0.0}, 0),
        ({'budget': 2.0, 'spent': 0.0, 'costs': Costs(0, 0, 0)}, 38),
    ],
)
def test_what_the_relevant_features_still_help(toy, changes, answers):
    assert later_answers(situation_of(toy, **changes)) == answers


def test_the_relevant_features_come_first_unless_they_leave_no_answer(toy):
    fresh = {'history': (), 'spent': 0.0, 'turn': 1}
    assert decide(situation_of(toy, **fresh))[0].kind is QueryKind.FEATURE_SUBSET
    assert decide(situation_of(toy, **fresh, budget=500.0))[0].kind is QueryKind.FEATURE_SUBSET
    assert decide(situation_of(toy, **fresh, budget=2.0))[0].kind is QueryKind.LABEL
    assert decide(situation_of(toy))[0].kind is not QueryKind.FEATURE_SUBSET


def test_price_matters_only_where_the_budget_is_short(toy):
    """A turn more than the budget has labels makes it short."""
    for budget, short in ((41.0, False), (40.9, True)):
        situation = situation_of(toy, ['snack'], budget=budget)
        price = value_features(situation)[:, VALUE_FEATURES.index('price')]
        assert bool(price.max() > 0) is short
        assert lead(situation) == (pytest.approx(2 / budget - np.sqrt(2 / 40)) if short else 0.0)


def test_a_short_budget_is_paced(toy):
    """By a quarter of the turns half of the budget is gone, and no more."""
    for spent, waits in ((9.0, False), (10.5, True)):
        action, _ = decide(situation_of(toy, ['snack'], turn=10, spent=spent))
        assert (action.kind is QueryKind.NO_QUERY) is waits
    assert decide(situation_of(toy, ['snack'], turn=40, spent=19.0))[0].kind is not QueryKind.NO_QUERY


def test_the_missing_symbol_is_asked_for_and_a_failure_lowers_its_chance(toy):
    labels = ['snack', 'snack', 'fruit', 'fruit']
    before = value_features(situation_of(toy, labels, budget=500.0))
    assert decide(situation_of(toy, labels, budget=500.0))[0].symbol == 'main_dish'
    in_vain = QueryRecord(1, QueryKind.DEMONSTRATION, None, 'main_dish', 2.0, Outcome.ANSWERED)
    after = value_features(situation_of(toy, labels, budget=500.0, scene_turn=2, history=(SUBSET_ASKED, in_vain)))
    chance = VALUE_FEATURES.index('chance')
    assert after[0, chance] == pytest.approx(before[0, chance] + np.log(2 / 3))
    assert after[1, chance] == before[1, chance]


def test_answers_that_say_nothing_lower_the_chance_of_an_answer(toy):
    silent = (SUBSET_ASKED, *[label_record(None, outcome=Outcome.UNKNOWN)] * 2)
    labels = value_features(situation_of(toy, history=silent))[3:9, VALUE_FEATURES.index('chance')]
    assert labels == pytest.approx(np.full(6, np.log(0.5)))


def test_a_question_that_nobody_heard_does_not_lower_the_chance_of_an_answer(toy):
    """A teacher who went for coffee would be asked other questions on coming back."""
    unheard = label_record(None, outcome=Outcome.UNANSWERED)
    before, after = (value_features(situation_of(toy, history=(SUBSET_ASKED, *more))) for more in ((), (unheard,)))
    np.testing.assert_array_equal(before, after)


def test_labelled_views_are_never_asked_about(toy):
    situation = situation_of(toy, ['snack', NO_SYMBOL, 'fruit'])
    _, choice = decide(situation)
    labels = [u for a, u in zip(situation.candidates, choice.utilities, strict=True) if a.kind is QueryKind.LABEL]
    assert np.isnan(labels).tolist() == [True] * 3 + [False] * 3
    assert decide(situation_of(toy, ['snack'] * 6))[0].kind is QueryKind.NO_QUERY


def test_it_does_not_know_when_scenes_change(toy):
    """The robot is not told on a real table."""
    choices = [decide(situation_of(toy, ['snack'], change_interval=n))[1] for n in (1, 5, 1000)]
    for other in choices[1:]:
        np.testing.assert_array_equal(other.utilities, choices[0].utilities)


def test_the_order_of_the_objects_does_not_matter(toy):
    table = np.random.default_rng(0).normal(size=(6, 5))
    order = np.array([4, 2, 0, 5, 1, 3])
    plain, shuffled = toy.scene(table), toy.scene(table[order], object_ids=tuple(map(int, order)))
    knowledge = Knowledge(toy.symbols)
    knowledge.observe(plain)
    knowledge.label(2, plain.features[2], 'snack', 1)
    rows = []
    for scene in (plain, shuffled):
        situation = dataclasses.replace(situation_of(toy, scene=scene), knowledge=knowledge)
        by_action = dict(zip(situation.candidates, value_features(situation), strict=True))
        rows.append(np.array([by_action[action] for action in sorted(by_action, key=str)]))
    np.testing.assert_allclose(rows[0], rows[1], atol=1e-12)


@pytest.mark.parametrize('costs', [Costs(), Costs(0, 0, 0), Costs(1, 0, 5), Costs(0.5, 3, 0)])
@pytest.mark.parametrize('budget', [0.0, 1.0, 2.0, 7.0, 100.0])
def test_whole_episodes_keep_the_rules(toy, costs, budget):
    """Never over budget, never a labelled view, the relevant features once, and with every budget and price."""
    world = toy.world(seed=1, unknown_rate=0.2)
    settings = toy.settings('value_per_cost', budget=budget, costs=costs)
    episode, asked = Episode(settings, generator(1, 'learner')), []
    for turn in range(1, settings.turns + 1):
        scene = world.scene(turn)
        decision = episode.ask(scene)
        if decision.query is not None:
            action = decision.query.action
            if action.kind is QueryKind.LABEL:
                assert not episode.knowledge.is_labelled(scene)[scene.index_of(action.object_id)]
            asked.append(action.kind)
            episode.tell(world.answer(decision.query))
    assert episode.spent <= budget + 1e-9
    assert asked.count(QueryKind.FEATURE_SUBSET) <= 1
    assert asked or budget == 0.0


def test_two_symbols_are_enough(toy):
    scene = toy.scene(np.random.default_rng(0).normal(size=(4, 5)))
    knowledge = Knowledge(('cup', 'plate'))
    knowledge.observe(scene)
    situation = dataclasses.replace(situation_of(toy, scene=scene), knowledge=knowledge)
    assert value_features(situation).shape == (2 + 4 + 2, len(VALUE_FEATURES))
    assert decide(situation)[0].kind is QueryKind.LABEL, 'cheapest while nothing is known'


@pytest.mark.parametrize(
    ('weights', 'reason'),
    [({}, 'value_per_cost needs weights'), ({'discriminability': 1}, "does not use 'discriminability'")],
)
def test_weights_that_do_not_fit(weights, reason):
    with pytest.raises(SettingsError, match=reason):
        make_strategy('value_per_cost', weights)


def test_other_strategies_do_not_take_its_weights():
    with pytest.raises(SettingsError, match="dt_task_env does not use 'novelty'"):
        make_strategy('dt_task_env', {'discriminability': 1, 'novelty': 1})
