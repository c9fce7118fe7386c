"""Worth of a question: cases solved by hand, the formula written out, and what must never happen."""

import dataclasses

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import NO_SYMBOL, Action, Costs, Outcome, QueryKind, QueryRecord, random_stream
from al_questioner.questioning import FEATURE_SETS, Choice, Episode, FeatureRecorder, make_strategy, read_weights
from al_questioner.questioning.beliefs import class_beliefs
from al_questioner.questioning.strategies.choice import rows_of
from al_questioner.questioning.strategies.value_per_cost import (
    BY_DERIVATION,
    DEFAULTS,
    LEAST,
    VALUE_FEATURES,
    Constants,
    example_gains,
    later_answers,
    lead,
    log_prices,
    scarcity,
    value_features,
)
from shared.checkout import ROOT

SHIPPED = read_weights(ROOT / 'config' / 'weights' / 'value_per_cost.yaml').values
SUBSET_ASKED = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.ANSWERED, ('size', 'colour'))


def label_record(symbol, turn=2, outcome=Outcome.ANSWERED):
    return QueryRecord(turn, QueryKind.LABEL, 90, symbol, 1.0, outcome)


def context_of(toy, labels=(), table=None, scene=None, **changes):
    """Six objects, of which the first ones were labelled so; the budget is short unless it is changed."""
    scene = scene or toy.scene(np.random.default_rng(3).normal(size=(6, 5)) if table is None else table)
    return toy.context(labels, scene, **{'turn': 2, 'turns': 40, 'history': (SUBSET_ASKED,), **changes})


def decide(context, seed=0, weights=SHIPPED):
    choice = make_strategy('value_per_cost', weights).choose(context, np.random.default_rng(seed))
    return context.candidates[choice.index], choice


def values_by_brute_force(context, constants=DEFAULTS):
    """Gain and chance of label and demonstration queries, object by object (docs/explanation/value_per_cost.md)."""
    concepts, scene, symbols = context.concepts, context.scene, context.symbols
    q = concepts.predict_proba(scene.features)
    beliefs = class_beliefs(context, constants.reach, constants.doubt)
    seen = {(v.object_id, v.features.tobytes()): v.label for v in concepts.labelled_views}
    labels = [seen.get((i, scene.features[row].tobytes())) for row, i in enumerate(scene.object_ids)]

    def gain(row, j):
        best = [k for k in range(len(symbols)) if q[row, k] > max(q[row]) - 1e-9]
        called = 1 / len(best) if j in best else 0.0
        return 0.0 if labels[row] else (1 - called) / (1 + concepts.positives[symbols[j]]) ** constants.decline

    found = {}
    for row, object_id in enumerate(scene.object_ids):
        chance = sum(beliefs[row][j] for j in range(len(symbols)))
        found[object_id] = sum(beliefs[row][j] * gain(row, j) for j in range(len(symbols))) / chance, chance
    for j, symbol in enumerate(symbols):
        mass = [beliefs[row][j] if label is None else float(label == symbol) for row, label in enumerate(labels)]
        total = sum(mass)
        mean = sum(m * gain(row, j) for row, m in enumerate(mass)) / total if total else 0.0
        found[symbol] = mean, 1 - np.prod([1 - m for m in mass])
    return found


@pytest.mark.parametrize('constants', [DEFAULTS, Constants(reach=0.7, doubt=0.2, decline=1.5)])
@pytest.mark.parametrize('labels', [[], ['snack'], [NO_SYMBOL] * 5, ['snack', NO_SYMBOL, 'fruit', 'snack']])
def test_features_are_the_formula_written_out(toy, labels, constants):
    history = (SUBSET_ASKED, *(label_record(label) for label in labels))
    context = context_of(toy, labels, history=history)
    expected = values_by_brute_force(context, constants)
    features = value_features(context, constants)
    for action, row in zip(context.candidates, features, strict=True):
        found = dict(zip(VALUE_FEATURES, row, strict=True))
        if action.kind in (QueryKind.LABEL, QueryKind.DEMONSTRATION):
            about = action.symbol if action.object_id is None else action.object_id
            logs = [np.log(max(value, LEAST)) for value in expected[about]]
            assert [found['gain'], found['chance']] == pytest.approx(logs, abs=1e-6)
            assert found['price'] == pytest.approx(np.log(context.costs.price(action.kind) / 2))
        assert (found['silence'] == 1.0) == (action.kind is QueryKind.NO_QUERY)
    assert np.isfinite(features).all()


def test_gains_by_hand(toy):
    """Before any label each symbol is called by a third; then fewer examples gain more, and the labelled nothing."""
    assert example_gains(context_of(toy), 0.6) == pytest.approx(np.full((6, 3), 2 / 3))
    context = context_of(toy, ['snack', 'snack', 'fruit', NO_SYMBOL])
    gains, snack = example_gains(context, 2.0), toy.symbols.index('snack')
    assert (gains[:4] == 0).all()
    for row in (4, 5):
        called = int(np.argmax(context.probabilities[row]))
        worth = [1 / (1 + n) ** 2 for n in context.concepts.positives.values()]
        worth[called] = 0.0
        assert gains[row] == pytest.approx(worth)
        assert gains[row, snack] in (0.0, pytest.approx(1 / 9))


@pytest.mark.parametrize(
    ('changes', 'answers'),
    [
        ({'budget': 25.0, 'spent': 0.0, 'turn': 1}, 23),
        ({'budget': 500.0, 'spent': 0.0, 'turn': 1}, 39),
        ({'budget': 2.0, 'spent': 0.0}, 0),
        ({'budget': 2.0, 'spent': 0.0, 'costs': Costs(0, 0, 0)}, 38),
        # 0.3 / 0.1 is a little less than 3.
        ({'budget': 0.5, 'spent': 0.0, 'costs': Costs(0.1, 0.2, 0.2)}, 3),
    ],
)
def test_what_the_relevant_features_still_help(toy, changes, answers):
    context = context_of(toy, **changes)
    assert later_answers(context, context.costs.feature_subset) == answers


def test_the_relevant_features_come_first_unless_they_leave_no_answer(toy):
    fresh = {'history': (), 'spent': 0.0, 'turn': 1}
    assert decide(context_of(toy, **fresh))[0].kind is QueryKind.FEATURE_SUBSET
    assert decide(context_of(toy, **fresh, budget=500.0))[0].kind is QueryKind.FEATURE_SUBSET
    assert decide(context_of(toy, **fresh, budget=2.0))[0].kind is QueryKind.LABEL
    assert decide(context_of(toy))[0].kind is not QueryKind.FEATURE_SUBSET


@pytest.mark.parametrize(
    ('budget', 'costs', 'expected'),
    [
        # 39 turns are left, with this one.
        (80.0, Costs(), 0.0),
        (78.0 + 2.0, Costs(), 0.0),
        (39.0 + 2.0, Costs(), 1.0),
        (60.5, Costs(), 0.5),
        (20.0, Costs(), 1.0),
        (80.0, Costs(2, 2, 2), 0.0),
        (79.0, Costs(2, 2, 2), 1.0),
        (60.5, Costs(2, 1, 2), 0.5),
        (12.0, Costs(0.1, 2, 2), (78 - 10) / (1.9 * 39)),
        (2.0, Costs(0, 0, 0), 0.0),
        # As numbers are rounded, 44.9 - 2 is a little less than 39 times 1.1.
        (44.9, Costs(0.5, 1.1, 2), 0.0),
    ],
)
def test_how_short_the_budget_is_by_hand(toy, budget, costs, expected):
    """Otherwise labels for a penny would hide that demonstrations use up the budget, if theirs were the only price."""
    context = context_of(toy, ['snack'], budget=budget, costs=costs)
    assert scarcity(context) == pytest.approx(expected)
    assert (lead(context, 0.5) == 0) == (expected == 0)
    if expected:
        assert lead(context, 0.5) == pytest.approx(2 / budget - np.sqrt(2 / 40))
    ratio = log_prices(context)[0] - log_prices(context)[3]
    assert ratio == pytest.approx(expected * np.log(costs.demonstration / costs.label) if costs.label else 0.0)


def test_prices_are_shares_of_the_dearest_and_silence_has_none(toy):
    context = context_of(toy, ['snack'], costs=Costs(0.001, 1, 4))
    prices = value_features(context)[:, VALUE_FEATURES.index('price')]
    s = scarcity(context)
    assert 0 < s < 1
    expected = {
        QueryKind.DEMONSTRATION: s * np.log(1 / 4),
        QueryKind.LABEL: s * np.log(0.01),
        QueryKind.FEATURE_SUBSET: 0.0,
        QueryKind.NO_QUERY: 0.0,
    }
    assert prices == pytest.approx([expected[action.kind] for action in context.candidates])


def test_the_relevant_features_first_at_the_default_costs_alone(toy):
    """One label that can follow is enough; where they cost more than they can bring they are not worth it."""
    fresh = {'history': (), 'spent': 0.0, 'turn': 1}
    assert decide(context_of(toy, **fresh, budget=3.0))[0].kind is QueryKind.FEATURE_SUBSET
    assert decide(context_of(toy, **fresh, budget=25.0, costs=Costs(1, 2, 20)))[0].kind is QueryKind.LABEL


def test_the_unit_of_the_budget_does_not_matter(toy):
    """Otherwise somebody who counts in thousandths would be asked other questions."""
    for unit in (1e-3, 1e3):
        costs = Costs(unit, 2 * unit, 2 * unit)
        plain = decide(context_of(toy, ['snack']))[1]
        scaled = decide(context_of(toy, ['snack'], costs=costs, budget=20 * unit, spent=2 * unit))[1]
        np.testing.assert_allclose(scaled.utilities, plain.utilities, atol=1e-9)


def test_a_short_budget_is_paced(toy):
    """Half of the budget is gone by a quarter of the turns, and no more."""
    for spent, waits in ((9.0, False), (10.0, False), (10.01, True)):
        action, _ = decide(context_of(toy, ['snack'], turn=10, spent=spent))
        assert (action.kind is QueryKind.NO_QUERY) is waits
    assert decide(context_of(toy, ['snack'], turn=40, spent=19.0))[0].kind is not QueryKind.NO_QUERY


def test_a_demonstration_is_asked_for_where_turns_are_short_and_not_where_the_budget_is(toy):
    """Before any label, a symbol is probably here and any example gains; the cheaper label gains more per cost."""
    rich, poor = decide(context_of(toy, budget=500.0))[0], decide(context_of(toy))[0]
    assert (rich.kind, poor.kind) == (QueryKind.DEMONSTRATION, QueryKind.LABEL)


def test_a_symbol_of_which_there_is_none_here_is_not_asked_for(toy):
    """Others take its place."""
    in_vain = QueryRecord(2, QueryKind.DEMONSTRATION, None, 'main_dish', 2.0, Outcome.ANSWERED)
    action, choice = decide(context_of(toy, budget=500.0, turn=3, history=(SUBSET_ASKED, in_vain)))
    assert action.symbol in ('snack', 'fruit')
    assert np.isnan(choice.utilities[toy.symbols.index('main_dish')])


@pytest.mark.parametrize('kind', [QueryKind.LABEL, QueryKind.DEMONSTRATION])
def test_a_teacher_who_does_not_know_lowers_the_chance_of_an_answer_to_such_questions(toy, kind):
    silent = QueryRecord(2, kind, 90, 'snack', 1.0, Outcome.UNKNOWN)
    chance = VALUE_FEATURES.index('chance')
    answered = dataclasses.replace(silent, outcome=Outcome.ANSWERED)
    before, after = (
        value_features(context_of(toy, scene_turn=3, turn=3, history=(SUBSET_ASKED, *more)))[:, chance]
        for more in ((answered, answered), (answered, silent, answered, silent))
    )
    # With the two answers that are imagined, four of four and four of six.
    expected = [np.log(4 / 6) if action.kind is kind else 0.0 for action in context_of(toy, turn=3).candidates]
    assert after - before == pytest.approx(expected)


def test_a_question_that_nobody_heard_does_not_lower_the_chance_of_an_answer(toy):
    """Otherwise a teacher who went for coffee would be asked other questions on coming back."""
    unheard = label_record(None, outcome=Outcome.UNANSWERED)
    before, after = (value_features(context_of(toy, history=(SUBSET_ASKED, *more))) for more in ((), (unheard,)))
    np.testing.assert_array_equal(before, after)


def test_labelled_views_are_never_asked_about(toy):
    context = context_of(toy, ['snack', NO_SYMBOL, 'fruit'])
    _, choice = decide(context)
    labels = [u for a, u in zip(context.candidates, choice.utilities, strict=True) if a.kind is QueryKind.LABEL]
    assert np.isnan(labels).tolist() == [True] * 3 + [False] * 3
    assert decide(context_of(toy, ['snack'] * 6))[0].kind is QueryKind.NO_QUERY


def test_it_does_not_know_when_scenes_change(toy):
    """The robot is not told on a real table."""
    choices = [decide(context_of(toy, ['snack'], change_interval=n))[1] for n in (1, 5, 1000)]
    for other in choices[1:]:
        np.testing.assert_array_equal(other.utilities, choices[0].utilities)


def test_the_order_of_the_objects_does_not_matter(toy):
    table = np.random.default_rng(0).normal(size=(6, 5))
    order = np.array([4, 2, 0, 5, 1, 3])
    plain, shuffled = toy.scene(table), toy.scene(table[order], object_ids=tuple(map(int, order)))
    concepts = ConceptLearner(toy.symbols, 4.0)
    concepts.observe(plain)
    concepts.label(2, plain.features[2], 'snack', 1)
    rows = []
    for scene in (plain, shuffled):
        context = dataclasses.replace(context_of(toy, scene=scene), concepts=concepts)
        by_action = dict(zip(context.candidates, value_features(context), strict=True))
        rows.append(np.array([by_action[action] for action in sorted(by_action, key=str)]))
    np.testing.assert_allclose(rows[0], rows[1], atol=1e-12)


@pytest.mark.parametrize('costs', [Costs(), Costs(0, 0, 0), Costs(1, 0, 5), Costs(0.5, 3, 0)])
@pytest.mark.parametrize('budget', [0.0, 1.0, 2.0, 7.0, 100.0])
def test_whole_episodes_keep_the_rules(toy, costs, budget):
    """Never over budget, never a labelled view, the relevant features twice at most, with every budget and price."""
    world = toy.world(seed=1, unknown_rate=0.2)
    settings = toy.settings('value_per_cost', budget=budget, costs=costs)
    episode, asked = Episode(settings, random_stream(1, 'learner')), []

    def watch(episode, scene, decision):
        if decision.query is not None:
            action = decision.query.action
            if action.kind is QueryKind.LABEL:
                assert not episode.concepts.is_labelled(scene)[scene.index_of(action.object_id)]
            asked.append(action.kind)

    toy.play(episode, world, watch)
    assert episode.spent <= budget + 1e-9
    assert asked.count(QueryKind.FEATURE_SUBSET) <= 2
    assert asked or budget == 0.0


def test_two_symbols_are_enough(toy):
    scene = toy.scene(np.random.default_rng(0).normal(size=(4, 5)))
    concepts = ConceptLearner(('cup', 'plate'), 4.0)
    concepts.observe(scene)
    context = dataclasses.replace(context_of(toy, scene=scene), concepts=concepts)
    assert value_features(context).shape == (2 + 4 + 2, len(VALUE_FEATURES))
    assert decide(context)[0].kind is QueryKind.LABEL, 'cheapest while nothing is known'


def test_its_constants_can_be_set_beside_its_weights(toy):
    """Otherwise a user whose things look less alike would have no say."""
    strategy = make_strategy('value_per_cost', {'reach': 0.5, 'pace': 2.0, 'price': -0.5})
    assert strategy.constants == Constants(reach=0.5, pace=2.0)
    assert strategy.weights.tolist() == [1, 1, -0.5, 1e6, -10]
    assert decide(context_of(toy, ['snack'], turn=10, spent=9.0))[0].kind is not QueryKind.NO_QUERY
    late = decide(context_of(toy, ['snack'], turn=10, spent=9.0), weights={**SHIPPED, 'pace': 2.0})
    assert late[0].kind is QueryKind.NO_QUERY


def test_defaults_and_shipped_weights_are_those_of_the_documentation():
    """Otherwise the page would derive another questioner than the one that ships."""
    page = (ROOT / 'docs' / 'explanation' / 'value_per_cost.md').read_text()
    for name in ('reach', 'doubt', 'decline', 'pace'):
        assert f'| `{name}` | {getattr(DEFAULTS, name):g} |' in page
    assert make_strategy('value_per_cost', SHIPPED).constants == DEFAULTS
    assert SHIPPED == BY_DERIVATION
    assert list(SHIPPED.values()) == [1, 1, -1, 1e6, -10]
    assert '| weights of gain, chance, price | 1, 1, -1 |' in page
    assert '| weight of ahead | 1e6 |' in page
    assert '| weight of silence | -10 |' in page


@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('constants', [Constants(reach=1e-6, doubt=1e-6), Constants(1e6, 1e6, 1e6, 1e6)])
@pytest.mark.parametrize('labels', [[], [NO_SYMBOL] * 5, ['snack'] * 6])
def test_features_stay_finite(toy, labels, constants):
    """Otherwise the strategy would never ask again, and nobody would know why."""
    in_vain = [QueryRecord(2, QueryKind.DEMONSTRATION, None, symbol, 2.0, Outcome.ANSWERED) for symbol in toy.symbols]
    for history in ((), tuple(in_vain)):
        features = value_features(context_of(toy, labels, history=history), constants)
        assert np.isfinite(features).all()


def test_zero_weights_of_others_do_not_matter():
    """Otherwise weights that were learnt for one strategy could not be cut down to those of another."""
    make_strategy('value_per_cost', {'gain': 1, 'discriminability': 0})


def test_a_demonstration_shows_what_is_worthless_as_not_considered(toy):
    """A learner from it does not weigh candidates that the strategy never takes."""
    context = context_of(toy, ['snack', NO_SYMBOL, 'fruit'])
    feature_set = FEATURE_SETS['value_per_cost']
    worthless = feature_set.is_worthless(feature_set.of(context))
    assert worthless.any()
    for seed in range(20):
        choice = FeatureRecorder(RandomChoice(), feature_set).choose(context, np.random.default_rng(seed))
        assert not np.isnan(choice.utilities[choice.index])
        left_out = np.isnan(choice.utilities)
        left_out[choice.index] = worthless[choice.index]
        np.testing.assert_array_equal(left_out, worthless)


class RandomChoice:
    """Considers everything."""

    selector = None

    def choose(self, context, rng):
        utilities = np.zeros(len(context.candidates))
        return Choice(int(rng.integers(len(utilities))), utilities)


def relevance_gain_of(context):
    """Return the gain of the relevance query among the features."""
    rows = rows_of(context, QueryKind.RELEVANCE)
    return float(np.exp(value_features(context)[rows[0], VALUE_FEATURES.index('gain')]))


@pytest.mark.parametrize('budget_left', [20.0, 6.0])
@pytest.mark.parametrize('unknown', [0, 4])
def test_the_relevance_query_gains_what_later_labels_gain_the_more(toy, budget_left, unknown):
    """With the answer, things of some symbol are asked about; without it the best of all, each with its chance."""
    costs, labels = Costs(relevance=4.0), ['snack', NO_SYMBOL]
    history = (SUBSET_ASKED, *map(label_record, labels), *[label_record(None, outcome=Outcome.UNKNOWN)] * unknown)
    answered = 4 / (4 + unknown)
    context = context_of(toy, labels, costs=costs, budget=25.0, spent=25.0 - budget_left, history=history)
    beliefs = class_beliefs(context, DEFAULTS.reach, DEFAULTS.doubt)
    gains = example_gains(context, DEFAULTS.decline)
    things = range(2, 6)
    named = {thing: sum(beliefs[thing][:-1]) for thing in things}
    worth = {thing: sum(beliefs[thing][j] * gains[thing][j] for j in range(3)) for thing in things}
    count = min(round(sum(named.values())), int(budget_left - 4.0))
    informed = count * sum(worth.values()) / sum(named.values())
    best = sorted(worth.values(), reverse=True)[:count]
    assert count > 0
    assert relevance_gain_of(context) == pytest.approx(max(1e-6, answered * (informed - sum(best))))


def test_the_relevance_query_is_not_asked_before_anything_was_of_no_symbol(toy):
    """It tells nothing where there is no clutter, and a label finds that out for less."""
    costs = Costs(relevance=1.0)
    assert relevance_gain_of(context_of(toy, ['snack'], costs=costs)) == pytest.approx(1e-6)
    assert relevance_gain_of(context_of(toy, [NO_SYMBOL], costs=costs)) > 0.1


def test_the_relevance_query_is_asked_in_clutter_and_not_once_more_of_the_same_things(toy):
    """Things that were said to matter are certain, so that the same answer gains nothing."""
    costs = Costs(relevance=1.0)
    context = context_of(toy, [NO_SYMBOL], costs=costs, history=(SUBSET_ASKED, label_record(NO_SYMBOL)))
    assert decide(context)[0].kind is QueryKind.RELEVANCE
    context.concepts.judge_scene(context.scene, [2, 3], 2)
    again = dataclasses.replace(context, turn=3)
    assert relevance_gain_of(again) == pytest.approx(1e-6)
    assert decide(again)[0].kind is not QueryKind.RELEVANCE


def test_the_relevance_query_can_be_the_dearest(toy):
    """Its own price is never above 1, whatever it costs beside the others."""
    context = context_of(toy, ['snack', NO_SYMBOL], costs=Costs(relevance=8.0), budget=12.0)
    prices = dict(zip(context.candidates, log_prices(context), strict=True))
    s = scarcity(context)
    assert s > 0
    assert prices[Action(QueryKind.RELEVANCE)] == 0.0
    assert prices[Action(QueryKind.FEATURE_SUBSET)] == pytest.approx(s * np.log(2 / 8))
