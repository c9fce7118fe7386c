"""The concept models against independent implementations of the same mathematics."""

import numpy as np
import pytest
from scipy.special import expit, logit

from al_questioner.concepts import ConceptModels, concept_models
from al_questioner.concepts.concept_models import PROBABILITY_TOLERANCE
from al_questioner.concepts.kernel import GROUPED
from al_questioner.concepts.laplace import mode_shift
from al_questioner.domain import NO_SYMBOL, InputError
from shared.textbook import optimised_probability

SYMBOLS = ('main_dish', 'snack', 'fruit', 'beverage')


def assert_close(found, expected, atol=1e-8, what=''):
    """Compare with an absolute tolerance alone."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=atol, err_msg=what)


def random_task(seed, duplicates=False, one_class=False):
    """Labelled features, test features, an amplitude and a length scale."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(1, 25)), int(rng.integers(1, 8))
    features = rng.normal(size=(n, m))
    if duplicates:
        features = features[rng.integers(0, max(1, n // 3), size=n)]
    labels = ['snack'] * n if one_class else list(rng.choice([*SYMBOLS, NO_SYMBOL], size=n))
    return features, labels, rng.normal(size=(7, m)), float(rng.uniform(1, 100)), float(rng.uniform(0.3, 4))


@pytest.mark.parametrize('duplicates', [False, True])
def test_probabilities_equal_scikit_learn(duplicates, sklearn_probability):
    """The contract: 1e-6 wherever scikit-learn can answer, for amplitudes from 1 to 100, with duplicated points too."""
    compared = 0
    for seed in range(40):
        features, labels, test, amplitude, length_scale = random_task(seed, duplicates)
        q = ConceptModels(SYMBOLS, amplitude, length_scale).fit(features, labels).predict_proba(test)
        for column, symbol in enumerate(SYMBOLS):
            targets = np.array([label == symbol for label in labels], dtype=int)
            if 0 < targets.sum() < len(targets):
                expected = sklearn_probability(features, targets, test, amplitude, length_scale)
                if expected is not None:
                    compared += 1
                    assert_close(q[:, column], expected, atol=1e-6)
    assert compared > 80


@pytest.mark.parametrize('one_class', [False, True])
@pytest.mark.parametrize('duplicates', [False, True])
def test_probabilities_equal_textbook_formulas_and_a_general_optimiser(duplicates, one_class):
    """Also where scikit-learn refuses (one class) or its plain Newton iteration fails to settle."""
    for seed in range(8):
        features, labels, test, amplitude, length_scale = random_task(1000 + seed, duplicates, one_class)
        q = ConceptModels(SYMBOLS, amplitude, length_scale).fit(features, labels).predict_proba(test)
        for column, symbol in enumerate(SYMBOLS):
            targets = np.array([float(label == symbol) for label in labels])
            expected = optimised_probability(features, targets, test, amplitude, length_scale)
            assert_close(q[:, column], expected, atol=1e-6)


def test_one_example_by_hand():
    """One positive example: the mode solves f = amplitude (1 - logistic(f)), checked by substituting it back."""
    amplitude = 4.0
    classifier = ConceptModels(['a', 'b'], amplitude, 1.0).fit([[0.0]], ['a'])
    positive, negative = classifier._classifiers.posterior.modes[:, 0]
    assert positive == pytest.approx(amplitude * (1 - expit(positive)), abs=1e-10)
    assert negative == pytest.approx(-positive, abs=1e-10)
    q = classifier.predict_proba([[0.0], [100.0]])
    assert q[0, 0] + q[0, 1] == pytest.approx(1, abs=1e-7), 'a positive and a negative example mirror each other'
    np.testing.assert_allclose(q[1], 0.5, atol=1e-7, err_msg='far from all examples the prior holds')


def test_contradicting_duplicates_settle_in_the_middle():
    """The same thing called a and b equally often: 1/2, also where the plain Newton iteration could oscillate."""
    q = ConceptModels(['a', 'b'], 100.0, 1.0).fit(np.zeros((20, 3)), ['a', 'b'] * 10).predict_proba(np.zeros((1, 3)))
    np.testing.assert_allclose(q, 0.5, atol=1e-8)


@pytest.mark.parametrize('balance', [0.25, 0.5, 1.0])
def test_class_balance_takes_the_counts_of_examples_from_the_logits(balance):
    """Each logit is lowered by balance times log(n + 1/2) less its mean over the symbols, and nothing else changes."""
    rng = np.random.default_rng(5)
    features, test = rng.normal(size=(12, 3)), rng.normal(size=(6, 3))
    labels = [SYMBOLS[0]] * 7 + [SYMBOLS[1]] * 3 + [SYMBOLS[2], NO_SYMBOL]
    plain = ConceptModels(SYMBOLS).fit(features, labels).predict_proba(test)
    balanced = ConceptModels(SYMBOLS, class_balance=balance).fit(features, labels).predict_proba(test)
    logs = np.log(np.array([7, 3, 1, 0]) + 0.5)
    assert_close(logit(balanced), logit(plain) - balance * (logs - logs.mean()), atol=1e-9)


def test_class_balance_changes_nothing_where_all_symbols_have_as_many_examples():
    """Without examples, all degrees are still exactly 1/2."""
    models = ConceptModels(SYMBOLS, class_balance=0.5)
    assert (models.predict_proba([[0.0, 1.0]]) == 0.5).all()


@pytest.mark.parametrize('balance', [-0.1, 1.5, np.nan])
def test_a_class_balance_out_of_range_is_refused(balance):
    """It is a share."""
    with pytest.raises(InputError, match='class_balance must lie in'):
        ConceptModels(SYMBOLS, class_balance=balance)


@pytest.mark.parametrize('amplitude', [1.0, 4.0, 100.0])
@pytest.mark.parametrize('n', [0, 1, 12])
def test_look_ahead_is_what_fitting_again_gives(n, amplitude):
    """[i, j] must be the prediction of models fitted with the one label more, for every i and j."""
    rng = np.random.default_rng(n)
    features, scene = rng.normal(size=(n, 3)), rng.normal(size=(5, 3))
    scene[4] = features[0] if n else scene[3]  # a view that is known already
    labels = list(rng.choice([*SYMBOLS, NO_SYMBOL], size=n))
    ahead = ConceptModels(SYMBOLS, amplitude).fit(features, labels).look_ahead(scene)
    assert ahead.shape == (5, 4, 5, 4)
    for i in range(5):
        for j, symbol in enumerate(SYMBOLS):
            again = ConceptModels(SYMBOLS, amplitude).fit(np.vstack([features, scene[i]]), [*labels, symbol])
            assert_close(ahead[i, j], again.predict_proba(scene), atol=PROBABILITY_TOLERANCE)


def test_look_ahead_does_not_depend_on_the_size_of_its_chunks(monkeypatch):
    """Bounded memory must not change a number beyond rounding."""
    rng = np.random.default_rng(5)
    fitted = ConceptModels(SYMBOLS).fit(rng.normal(size=(9, 4)), list(rng.choice(SYMBOLS, size=9)))
    scene = rng.normal(size=(7, 4))
    whole = fitted.look_ahead(scene)
    monkeypatch.setattr(concept_models, 'CHUNK_NUMBERS', 1)
    assert_close(fitted.look_ahead(scene), whole)


@pytest.mark.parametrize('amplitude', [1.0, 4.0, 25.0, 100.0])
@pytest.mark.parametrize('duplicates', [False, True])
def test_one_label_more_is_learnt_as_from_nothing(learning_state, amplitude, duplicates):
    """The warm update must not show in the result: nor in the beliefs, nor in what is then foreseen."""
    for seed in range(8):
        state = learning_state(seed, amplitude=amplitude, duplicates=duplicates)
        for thing, symbol in ((0, state.symbols[0]), (len(state.scene) - 1, NO_SYMBOL)):
            more = state.had_been_labelled(thing, symbol)
            warm, fresh = state.fitted().fit(*more), state.models().fit(*more)
            assert_close(warm._classifiers.posterior.modes, fresh._classifiers.posterior.modes)
            assert_close(warm.predict_proba(state.scene), fresh.predict_proba(state.scene))
            assert_close(warm.look_ahead(state.scene), fresh.look_ahead(state.scene), atol=1e-6)


@pytest.mark.parametrize('amplitude', [4.0, 100.0])
def test_sixty_labels_one_by_one_do_not_drift(learning_state, amplitude):
    """Each fit starts from the last: what one leaves open must not add up."""
    state = learning_state(5, n=60, amplitude=amplitude, n_symbols=4, n_things=5, duplicates=True)
    growing = state.models()
    for n in range(1, 61):
        growing.fit(state.features[:n], state.labels[:n])
        if n % 15 == 0:
            fresh = state.models().fit(state.features[:n], state.labels[:n])
            assert_close(growing._classifiers.posterior.modes, fresh._classifiers.posterior.modes)
            assert_close(growing.predict_proba(state.scene), fresh.predict_proba(state.scene))


def changed_examples(state, rng):
    """Return examples that may follow a fit: features and labels that do not just continue the last ones."""
    features, labels = state.features, state.labels
    yield 'features that moved, as when the statistics change', features + 0.1 * rng.normal(size=features.shape), labels
    yield 'a subset of the features', features[:, ::2], labels
    yield 'one more label on features that moved', np.vstack([features, features[:1]]) + 0.01, [*labels, labels[0]]
    yield 'two more labels', np.vstack([features, features[:2]]), [*labels, *labels[:2]]
    yield 'another label for one of them', features, [NO_SYMBOL, *labels[1:]]
    yield 'one more label and another one corrected', np.vstack([features, features[:1]]), [NO_SYMBOL, *labels]
    yield 'fewer labels', features[:3], labels[:3]
    yield 'the same again', features, labels
    yield 'other features altogether', rng.normal(size=(4, 11)), labels[:4]


@pytest.mark.parametrize('amplitude', [4.0, 100.0])
def test_every_other_change_is_learnt_as_from_nothing(learning_state, amplitude):
    """A fit may start from the last one, but must not believe anything of it."""
    state = learning_state(6, n=20, amplitude=amplitude, n_symbols=3, n_features=10)
    for what, features, labels in changed_examples(state, np.random.default_rng(6)):
        again, fresh = state.fitted().fit(features, labels), state.models().fit(features, labels)
        scene = np.random.default_rng(7).normal(size=(4, features.shape[1]))
        q, expected = again.predict_proba(scene), fresh.predict_proba(scene)
        assert_close(q, expected, what=what)


def test_forgetting_is_complete(learning_state):
    """After a fit to nothing the models are as new, and may learn features of another number."""
    state = learning_state(7, n=10, n_symbols=3, n_features=10)
    fitted = state.fitted()
    fitted.look_ahead(state.scene)
    fitted.fit(np.empty((0, 10)), [])
    assert (fitted.predict_proba(state.scene) == 0.5).all()
    other = np.random.default_rng(7).normal(size=(6, 4))
    labels = state.labels[:6]
    fresh = state.models().fit(other, labels)
    for n in (0, 1, 6):
        fitted.fit(other[:n], labels[:n])
    assert_close(fitted.predict_proba(other), fresh.predict_proba(other))


def test_models_of_a_subset_leave_the_others_alone(learning_state):
    """`refitted` gives models of their own, of the same labels."""
    state = learning_state(8, n=15, n_features=12, n_symbols=3)
    fitted, expected = state.fitted(), state.fitted().predict_proba(state.scene)
    subset = fitted.refitted(state.features[:, :5])
    fresh = state.models().fit(state.features[:, :5], state.labels)
    assert_close(subset.predict_proba(state.scene[:, :5]), fresh.predict_proba(state.scene[:, :5]))
    assert_close(subset.look_ahead(state.scene[:, :5]), fresh.look_ahead(state.scene[:, :5]), atol=1e-6)
    subset.fit(np.empty((0, 5)), [])
    np.testing.assert_array_equal(fitted.predict_proba(state.scene), expected)
    with pytest.raises(InputError, match='15 labels for 14 feature vectors'):
        fitted.refitted(state.features[:14])


def test_a_refused_fit_changes_nothing(learning_state):
    """A teacher's slip of the tongue must not cost what was learnt before."""
    state = learning_state(9, n=8, n_symbols=3)
    fitted = state.fitted()
    expected = fitted.predict_proba(state.scene)
    with pytest.raises(InputError):
        fitted.fit(*state.had_been_labelled(0, 'pizza'))
    np.testing.assert_array_equal(fitted.predict_proba(state.scene), expected)


def test_asking_again_gives_the_same_and_belongs_to_the_asker(learning_state):
    """The caller gets a copy, and not the array that is kept of the last scene."""
    state = learning_state(10, n=8, n_symbols=3)
    fitted = state.fitted()
    first = fitted.predict_proba(state.scene)
    kept = first.copy()
    first[:] = -1
    np.testing.assert_array_equal(fitted.predict_proba(state.scene), kept)
    np.testing.assert_array_equal(fitted.predict_proba(state.scene.copy()), kept)


def test_points_that_change_in_place_are_new_points(learning_state):
    """A caller who reuses one array must not be told about what it held before."""
    state = learning_state(11, n=8, n_symbols=3, n_things=4)
    fitted, points = state.fitted(), state.scene.copy()
    fitted.predict_proba(points)
    points[1] += 1
    expected = state.fitted()
    np.testing.assert_array_equal(fitted.predict_proba(points), expected.predict_proba(points))
    points[2] -= 1
    np.testing.assert_array_equal(fitted.look_ahead(points), expected.look_ahead(points))
    np.testing.assert_array_equal(fitted.predict_proba(points[:2]), state.fitted().predict_proba(points[:2]))


def test_a_scene_is_seen_with_what_was_learnt_since(learning_state):
    """The cached values of the last scene belong to the fit that they were computed by."""
    state = learning_state(12, n=8, n_symbols=3)
    fitted = state.fitted()
    fitted.predict_proba(state.scene)
    fitted.fit(*state.had_been_labelled(0, state.symbols[1]))
    assert_close(fitted.predict_proba(state.scene), state.after(0, state.symbols[1]))


@pytest.mark.parametrize('amplitude', [25.0, 50.0, 100.0])
@pytest.mark.parametrize('n', range(2, 13))
def test_one_view_with_any_share_of_contradictions(n, amplitude):
    """A step of the search for the mode that gains nothing must not be taken back by the next one, for ever."""
    for positives in range(n + 1):
        labels = ['a'] * positives + ['b'] * (n - positives)
        q = ConceptModels(['a', 'b'], amplitude, 1.0).fit(np.zeros((n, 1)), labels).predict_proba(np.zeros((1, 1)))
        assert np.sign(q[0, 0] - 0.5) == np.sign(positives - n / 2) or abs(q[0, 0] - 0.5) < 1e-6


def test_a_search_that_came_nowhere_does_no_harm(learning_state, monkeypatch):
    """One more label must be learnt also where the steps of the look-ahead end in no number."""
    state = learning_state(3, n=8, amplitude=4.0)
    original = mode_shift.find_shift

    def find(*arguments, **options):
        shift = original(*arguments, **options)
        for array in (shift.change, shift.latent, shift.error):
            array[...] = np.nan
        return shift

    fitted = state.fitted()
    monkeypatch.setattr(mode_shift, 'find_shift', find)
    fitted.fit(*state.had_been_labelled(0, state.symbols[0]))
    assert_close(fitted.predict_proba(state.scene), state.after(0, state.symbols[0]))


def test_examples_may_change_in_place_after_a_fit():
    """A caller who keeps writing into one buffer must not rewrite what was learnt from it."""
    buffer, labels = np.array([[0.0], [3.0], [9.0]]), ['a', 'b', 'a']
    fitted = ConceptModels(['a', 'b']).fit(buffer[:2], labels[:2])
    before = fitted.predict_proba([[0.0]])
    buffer[0] = 5.0
    assert_close(fitted.predict_proba([[1.0], [0.0]])[1:], before, atol=1e-12)
    fresh = ConceptModels(['a', 'b']).fit(buffer.copy(), labels).predict_proba([[5.0]])
    assert_close(fitted.fit(buffer, labels).predict_proba([[5.0]]), fresh)


def test_without_examples_everything_is_one_half():
    """Before any label q = 1/2, whether or not `fit` was called."""
    for classifier in (ConceptModels(SYMBOLS), ConceptModels(SYMBOLS).fit(np.empty((0, 3)), [])):
        assert (classifier.predict_proba(np.zeros((2, 3))) == 0.5).all()
    assert (ConceptModels(SYMBOLS).fit([], []).predict_proba([[1.0]]) == 0.5).all()


def test_nothing_to_predict_gives_empty_arrays_of_the_right_shape():
    for classifier in (ConceptModels(SYMBOLS), ConceptModels(SYMBOLS).fit([[0.0, 1.0]], ['snack'])):
        assert classifier.predict_proba(np.empty((0, 2))).shape == (0, 4)
        assert classifier.look_ahead(np.empty((0, 2))).shape == (0, 4, 0, 4)


def test_none_is_negative_for_every_symbol():
    """Clutter lowers all the degrees of belonging."""
    q = ConceptModels(SYMBOLS).fit([[0.0, 0.0]], [NO_SYMBOL]).predict_proba([[0.0, 0.0]])
    assert (q < 0.5).all()
    assert np.ptp(q) == 0


def test_length_scale_none_is_the_root_of_the_number_of_columns():
    """With None the kernel must widen with the number of features in use."""
    rng = np.random.default_rng(3)
    features, labels, test = rng.normal(size=(6, 9)), list(rng.choice(SYMBOLS, size=6)), rng.normal(size=(4, 9))
    automatic = ConceptModels(SYMBOLS, length_scale=None).fit(features, labels).predict_proba(test)
    fixed = ConceptModels(SYMBOLS, length_scale=3.0).fit(features, labels).predict_proba(test)
    np.testing.assert_array_equal(automatic, fixed)


def test_probabilities_stay_inside_the_unit_interval():
    """The five-term sum itself leaves it by rounding; entropies and normalisations need the inside."""
    features = np.zeros((400, 1))
    q = ConceptModels(['a', 'b'], 100.0, 1.0).fit(features, ['a'] * 400).predict_proba([[0.0]])
    assert ((q > 0) & (q < 1)).all()


def test_order_of_symbols_and_objects_only_permutes_the_result():
    """Nothing may depend on the order in which symbols, examples or objects come."""
    rng = np.random.default_rng(8)
    features, labels, scene = rng.normal(size=(10, 3)), list(rng.choice(SYMBOLS, size=10)), rng.normal(size=(5, 3))
    symbols, objects, examples = rng.permutation(4), rng.permutation(5), rng.permutation(10)
    plain = ConceptModels(SYMBOLS).fit(features, labels).look_ahead(scene)
    shuffled = ConceptModels([SYMBOLS[i] for i in symbols]).fit(features[examples], [labels[i] for i in examples])
    expected = plain[np.ix_(objects, symbols, objects, symbols)]
    assert_close(shuffled.look_ahead(scene[objects]), expected, atol=1e-9)


@pytest.mark.parametrize(
    ('features', 'labels', 'reason'),
    [
        ([[0.0], [np.nan]], ['snack', 'fruit'], r'features\[1, 0\] is not finite'),
        ([[np.inf]], ['snack'], 'not finite'),
        ([[0.0]], ['pizza'], "unknown label 'pizza'"),
        ([[0.0]], ['snack', 'fruit'], '2 labels for 1 feature vectors'),
        ([0.0, 1.0], ['snack', 'fruit'], 'a row per thing'),
        ([['red']], ['snack'], 'not a table of numbers'),
        (np.empty((2, 0)), ['snack', 'fruit'], 'nothing to tell things apart'),
    ],
)
def test_examples_that_cannot_be_learnt_from(features, labels, reason):
    """Each kind of bad example has its own clear error."""
    with pytest.raises(InputError, match=reason):
        ConceptModels(SYMBOLS).fit(features, labels)


def test_scenes_that_do_not_fit_the_examples():
    """Another number of columns, or a value that is not finite, must not pass silently."""
    fitted = ConceptModels(SYMBOLS).fit([[0.0, 1.0]], ['snack'])
    with pytest.raises(InputError, match='3 columns, the models were fitted on 2'):
        fitted.predict_proba(np.zeros((1, 3)))
    with pytest.raises(InputError, match='not finite'):
        fitted.look_ahead([[0.0, np.nan]])


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        ({'symbols': []}, 'symbols must be'),
        ({'symbols': ['a', 'a']}, 'symbols must be'),
        ({'symbols': ['a', NO_SYMBOL]}, 'symbols must be'),
        ({'symbols': ['a', 'b'], 'amplitude': 0.0}, 'amplitude must be'),
        ({'symbols': ['a', 'b'], 'amplitude': np.nan}, 'amplitude must be'),
        ({'symbols': ['a', 'b'], 'length_scale': -1.0}, 'length_scale must be'),
    ],
)
def test_impossible_models(arguments, reason):
    with pytest.raises(InputError, match=reason):
        ConceptModels(**arguments)


def test_predictions_and_score_are_those_that_scikit_learn_users_expect() -> None:
    """Otherwise a notebook that compares classifiers would need code of its own for this one."""
    models = ConceptModels(('snack', 'fruit')).fit([[0.0], [1.0], [2.0]], ['snack', 'fruit', NO_SYMBOL])
    assert list(models.classes_) == ['snack', 'fruit']
    assert list(models.predict([[0.1], [0.9]])) == ['snack', 'fruit']
    assert models.score([[0.1], [0.9], [0.2], [0.3]], ['snack', 'fruit', 'fruit', 'snack']) == 0.75
    assert list(ConceptModels(('a', 'b')).predict([[0.1], [0.9]])) == ['a', 'a']
    for features, labels in (([[0.1]], ['snack', 'fruit']), ([], [])):
        with pytest.raises(InputError):
            models.score(features, labels)


def test_each_example_is_judged_by_the_others_alone():
    """A label would vouch for itself, or for the same example told twice."""
    rng = np.random.default_rng(3)
    points = rng.normal(size=(9, 4))
    points[5] = points[2]
    labels = ['a', 'b', 'none', 'a', 'b', 'a', 'none', 'b', 'a']
    models = ConceptModels(('a', 'b'), 100.0, shape=GROUPED, class_balance=0.5)
    found = models.fit(points, labels, list('ppqq')).predict_each_from_others()
    for row in range(9):
        others = [other for other in range(9) if other != row and {other, row} != {2, 5}]
        alone = ConceptModels(('a', 'b'), 100.0, shape=GROUPED, class_balance=0.5)
        alone.fit(points[others], [labels[other] for other in others], list('ppqq'))
        np.testing.assert_allclose(found[row], alone.predict_proba(points[[row]])[0], atol=1e-9)
