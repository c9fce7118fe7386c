"""The look-ahead over its whole range, against models that are fitted again with one label more."""

import logging
import tracemalloc
import warnings

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner, ConceptModels, concept_models
from al_questioner.concepts.kernel import GROUPED, KernelShape
from al_questioner.concepts.laplace import look_ahead
from al_questioner.domain import NO_SYMBOL, InputError, Scene

TOLERANCE = 1e-6
"""Error that the look-ahead promises not to exceed."""

AMPLITUDES = [1.0, 4.0, 25.0, 100.0, 300.0]


def some_pairs(state, count, seed=0):
    """A few (thing, symbol): the oracle is slow, and chance finds what is wrong everywhere."""
    rng = np.random.default_rng(seed)
    return [(int(rng.integers(len(state.scene))), int(rng.integers(len(state.symbols)))) for _ in range(count)]


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_equals_scikit_learn_refitted_to_convergence(learning_state, sklearn_probability, amplitude):
    """An oracle that shares no line with the package, wherever it can answer."""
    compared = 0
    for seed in range(6):
        state = learning_state(seed, amplitude=amplitude, n=[2, 5, 10, 20, 30, 40][seed], duplicates=seed % 2 == 1)
        table = state.fitted().look_ahead(state.scene)
        for i, j in some_pairs(state, 2, seed):
            features, labels = state.had_been_labelled(i, state.symbols[j])
            for column, symbol in enumerate(state.symbols):
                targets = np.array([label == symbol for label in labels], dtype=int)
                if 0 < targets.sum() < len(targets):
                    scale = np.sqrt(features.shape[1])
                    expected = sklearn_probability(features, targets, state.scene, amplitude, scale)
                    if expected is not None:
                        compared += 1
                        np.testing.assert_allclose(table[i, j, :, column], expected, rtol=0, atol=TOLERANCE)
    assert compared >= 20


@pytest.mark.parametrize('amplitude', AMPLITUDES)
@pytest.mark.parametrize('n', [0, 1, 2, 20, 60, 150])
def test_equals_fitting_again(learning_state, n, amplitude):
    """From no label to 150."""
    state = learning_state(n, n=n, amplitude=amplitude)
    pairs = some_pairs(state, 2 if n == 150 else 8)
    assert state.largest_error(state.fitted().look_ahead(state.scene), pairs) <= TOLERANCE


@pytest.mark.parametrize('amplitude', AMPLITUDES)
@pytest.mark.parametrize('class_balance', [0.0, 0.5, 1.0])
@pytest.mark.parametrize('shape', [GROUPED, KernelShape(1.0, 1.0), KernelShape(np.inf, 0.5)])
def test_equals_fitting_again_with_every_kernel_and_balance(learning_state, shape, class_balance, amplitude):
    """The promise holds for the kernels that ship, and for degrees that balancing moves."""
    state = learning_state(7, n=30, amplitude=amplitude, shape=shape, class_balance=class_balance, n_symbols=4)
    assert state.largest_error(state.fitted().look_ahead(state.scene), some_pairs(state, 8)) <= TOLERANCE


@pytest.mark.parametrize('amplitude', AMPLITUDES)
@pytest.mark.parametrize('seed', range(4))
def test_views_that_are_named_again_and_otherwise(learning_state, seed, amplitude):
    """Duplicated points with contradicting labels make kernel matrices singular and curvatures small."""
    state = learning_state(100 + seed, n=24, amplitude=amplitude, duplicates=True)
    assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_examples_of_one_class(learning_state, amplitude):
    """All labels alike: there is only agreement to extrapolate, and the first contradiction changes much."""
    for seed, n in ((0, 1), (1, 12)):
        state = learning_state(seed, n=n, amplitude=amplitude, n_symbols=3, one_class=True)
        assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE


@pytest.mark.parametrize('n_symbols', range(1, 7))
@pytest.mark.parametrize('n_things', [1, 2, 5])
def test_any_number_of_symbols_and_things(learning_state, n_symbols, n_things):
    """One symbol, or one thing, must not be lost among the axes."""
    state = learning_state(n_symbols, n=9, n_symbols=n_symbols, n_things=n_things)
    assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE


@pytest.mark.parametrize('n_features', [10, 30, 70])
def test_any_number_of_features(learning_state, n_features):
    state = learning_state(n_features, n=30, n_features=n_features)
    assert state.largest_error(state.fitted().look_ahead(state.scene), some_pairs(state, 6)) <= TOLERANCE


@pytest.mark.parametrize('length_scale', [0.1, 1.0, 50.0])
def test_any_length_scale(learning_state, length_scale):
    """From things that know nothing of each other to things that are all alike."""
    state = learning_state(3, n=15, length_scale=length_scale, n_features=10)
    assert state.largest_error(state.fitted().look_ahead(state.scene), some_pairs(state, 6)) <= TOLERANCE


def test_after_the_teacher_has_named_the_relevant_features():
    """The subset shrinks the length scale of `ConceptLearner`, and must reach both sides of the comparison."""
    rng = np.random.default_rng(8)
    names = tuple(f'{group}_{i}' for group in ('colour', 'size', 'noise') for i in range(12))
    table = rng.normal(loc=3, scale=2, size=(8, 36)).astype(np.float32)
    scene = Scene(tuple(range(8)), np.zeros((8, 3), dtype=np.float32), table, names)

    def taught(*more):
        concepts = ConceptLearner(('snack', 'fruit', 'beverage'), amplitude=25.0)
        concepts.observe(scene)
        for turn, (thing, symbol) in enumerate([(0, 'snack'), (1, 'fruit'), (2, NO_SYMBOL), (0, 'fruit'), *more]):
            concepts.label(thing, scene.features[thing], symbol, turn)
            if turn == 1:
                concepts.restrict_to_groups(('colour', 'size'))
        return concepts

    ahead = taught().look_ahead(scene)
    for i in (0, 5):
        for j, symbol in enumerate(('snack', 'fruit', 'beverage')):
            expected = taught((i, symbol)).predict_proba(scene.features)
            np.testing.assert_allclose(ahead[i, j], expected, rtol=0, atol=TOLERANCE)


@pytest.mark.slow
@pytest.mark.parametrize('amplitude', AMPLITUDES)
@pytest.mark.parametrize('duplicates', [False, True])
def test_sweep_of_states(learning_state, amplitude, duplicates):
    """Many states, so that what only rarely happens does happen."""
    for seed in range(1000, 1150):
        state = learning_state(seed, amplitude=amplitude, duplicates=duplicates, one_class=seed % 10 == 0)
        worst = state.largest_error(state.fitted().look_ahead(state.scene), some_pairs(state, 4, seed))
        assert worst <= TOLERANCE, f'seed {seed}'


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_what_is_not_certain_is_refitted(learning_state, monkeypatch, amplitude):
    """With no error small enough everything is refitted; and with a search of one step, what that left wrong."""
    state = learning_state(31, n=20, amplitude=amplitude, n_things=4, n_symbols=3, duplicates=True)
    refitted = []
    original = look_ahead._refit

    def refit(*arguments):
        refitted.append(len(arguments[-1]))
        return original(*arguments)

    monkeypatch.setattr(look_ahead, '_refit', refit)
    with monkeypatch.context() as patch:
        patch.setattr(concept_models, 'PROBABILITY_TOLERANCE', -1.0)
        assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE
        assert sum(refitted) == 2 * 4 * 3
        patch.setattr(look_ahead, 'MAX_REFIT_NUMBERS', 1)
        refitted.clear()
        assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE
        assert refitted == [1] * (2 * 4 * 3), 'one at a time where there is room for one'
    refitted.clear()
    monkeypatch.setattr(look_ahead, 'MOST_MODE_STEPS', 1)
    assert state.largest_error(state.fitted().look_ahead(state.scene)) <= TOLERANCE
    assert sum(refitted) > 0


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_nothing_is_refitted(learning_state, monkeypatch, amplitude):
    """A look-ahead that refits is right and a hundred times too slow."""
    refitted = []
    original = look_ahead._refit
    monkeypatch.setattr(look_ahead, '_refit', lambda *a: refitted.append(len(a[-1])) or original(*a))
    for seed in range(10):
        state = learning_state(seed, n=50, amplitude=amplitude, n_things=12, n_symbols=4, n_features=60)
        state.fitted().look_ahead(state.scene)
        state = learning_state(seed, n=30, amplitude=amplitude, duplicates=True)
        state.fitted().look_ahead(state.scene)
    assert sum(refitted) == 0


def test_chunks_make_up_the_table(learning_state, monkeypatch):
    """Consecutive slices from the first thing to the last, whatever their size."""
    state = learning_state(40, n=12, n_things=7, n_symbols=3)
    fitted = state.fitted()
    whole = fitted.look_ahead(state.scene)
    for numbers in (1, 2 * 3 * 7 * 12 * 3, 10**9):
        monkeypatch.setattr(concept_models, 'CHUNK_NUMBERS', numbers)
        rows, parts = zip(*fitted.look_ahead_chunks(state.scene), strict=True)
        assert [i for chosen in rows for i in range(7)[chosen]] == list(range(7))
        np.testing.assert_allclose(np.concatenate(parts), whole, rtol=0, atol=1e-8)
    assert list(fitted.look_ahead_chunks(np.empty((0, state.features.shape[1])))) == []


@pytest.mark.parametrize('exact', [True, False])
def test_memory_of_chunks_is_bounded(learning_state, monkeypatch, exact):
    """A pool must be scored without ever holding what its whole table would take."""
    state = learning_state(41, n=10, n_things=80, n_symbols=6, n_features=10)
    fitted = state.fitted()
    whole = 80 * 6 * 80 * 6 * 8
    monkeypatch.setattr(concept_models, 'CHUNK_NUMBERS', 10_000)
    for _ in fitted.look_ahead_chunks(state.scene[:3], exact):
        pass
    tracemalloc.start()
    try:
        for _ in fitted.look_ahead_chunks(state.scene, exact):
            pass
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < whole / 2


def test_approximation_is_close_but_not_exact(learning_state):
    """At amplitude 4: 1e-4 on average, rarely up to 1e-2, where the effects looked for are 0.03 and 0.25."""
    errors, effects = [], []
    for seed in range(20):
        state = learning_state(seed, n=30, amplitude=4.0, n_things=6, n_symbols=4)
        fitted = state.fitted()
        exact, rough = (fitted.look_ahead(state.scene, exact=mode) for mode in (True, False))
        assert ((rough > 0) & (rough < 1)).all()
        errors.append(np.abs(rough - exact))
        effects.append(np.abs(exact - fitted.predict_proba(state.scene)))
    assert 1e-6 < np.mean(errors) < 3e-4
    assert np.max(errors) < 2e-2
    assert np.mean(errors) < 0.01 * np.mean(effects)


def test_approximation_is_chosen_when_exactness_is_too_dear_and_said_once(learning_state, monkeypatch, caplog):
    state = learning_state(42, n=10, n_things=5, n_symbols=3, amplitude=4.0)
    fitted = state.fitted()
    exact, rough = (fitted.look_ahead(state.scene, exact=mode) for mode in (True, False))
    assert not np.array_equal(exact, rough)
    monkeypatch.setattr(concept_models, 'EXACT_OPERATIONS', 8 * 3 * (5 * 10) ** 2)
    with caplog.at_level(logging.WARNING, logger=concept_models.__name__):
        np.testing.assert_array_equal(fitted.look_ahead(state.scene), exact)
        assert not caplog.records
        monkeypatch.setattr(concept_models, 'EXACT_OPERATIONS', 8 * 3 * (5 * 10) ** 2 - 1)
        for _ in range(3):
            np.testing.assert_array_equal(fitted.look_ahead(state.scene), rough)
        np.testing.assert_array_equal(fitted.look_ahead(state.scene, exact=True), exact)
        assert len(caplog.records) == 1, 'once for the life of the models'
        fitted.fit(state.features, state.labels).look_ahead(state.scene)
        assert len(caplog.records) == 1
        state.fitted().look_ahead(state.scene)
        assert len(caplog.records) == 2, 'other models warn for themselves'
    assert 'look-ahead approximates: 5 things, 3 symbols and 10 labels' in caplog.text


def test_stacks_of_refits_stay_within_their_bound(learning_state, monkeypatch):
    """With many more labels than things the kernel matrices, not the predictions, would fill the memory."""
    state = learning_state(43, n=60, n_things=2, n_symbols=3, amplitude=4.0)
    original, sizes = look_ahead.find_modes, []

    def find(kernels, *others):
        sizes.append(kernels.size)
        return original(kernels, *others)

    fitted = state.fitted()
    monkeypatch.setattr(look_ahead, 'find_modes', find)
    monkeypatch.setattr(concept_models, 'PROBABILITY_TOLERANCE', -1.0)
    monkeypatch.setattr(look_ahead, 'MAX_REFIT_NUMBERS', 4 * 61 * 63)
    fitted.look_ahead(state.scene)
    assert sizes == [4 * 61 * 61] * 3


@pytest.mark.parametrize('amplitude', [100.0, 300.0])
def test_many_views_of_few_things_need_no_refit(monkeypatch, amplitude):
    """There a label changes dozens of other examples a little, all in the same direction."""
    rng = np.random.default_rng(4)
    places, kinds = rng.normal(size=(6, 12)), rng.integers(6, size=120)
    features = places[kinds] + 0.15 * rng.normal(size=(120, 12))
    scene = places[rng.integers(6, size=8)] + 0.6 * rng.normal(size=(8, 12))
    labels = [('a', 'b', 'c')[kind % 3] for kind in kinds]
    fitted = ConceptModels(('a', 'b', 'c'), amplitude).fit(features, labels)

    def refuse(*_):
        raise AssertionError('a hypothesis was refitted')

    with monkeypatch.context() as patched:
        patched.setattr(look_ahead, 'find_modes', refuse)
        table = fitted.look_ahead(scene)
    for thing in range(8):
        again = ConceptModels(('a', 'b', 'c'), amplitude).fit(np.vstack([features, scene[thing]]), [*labels, 'b'])
        np.testing.assert_allclose(table[thing, 1], again.predict_proba(scene), rtol=0, atol=TOLERANCE)


def test_models_with_another_kernel_do_not_say_it_again(learning_state, monkeypatch, caplog):
    """Otherwise a learner that tunes its kernel every few turns would repeat the warning each time."""
    state = learning_state(44, n=10, n_things=5, n_symbols=3, amplitude=4.0)
    monkeypatch.setattr(concept_models, 'EXACT_OPERATIONS', 0)
    with caplog.at_level(logging.WARNING, logger=concept_models.__name__):
        fitted = state.fitted()
        fitted.look_ahead(state.scene)
        fitted.with_kernel(9.0, 1.5).fit(state.features, state.labels).look_ahead(state.scene)
    assert len(caplog.records) == 1


def test_negative_error_bounds_let_no_wrong_probability_pass():
    """Two labels and a thing between them at amplitude 100: the curvatures grow many times over."""
    features, scene = np.array([[1.1], [-1.2]]), np.zeros((1, 1))
    fitted = ConceptModels(('a', 'b'), 100.0, 2.0).fit(features, ['b', 'a'])
    again = ConceptModels(('a', 'b'), 100.0, 2.0).fit(np.vstack([features, scene]), ['b', 'a', 'a'])
    np.testing.assert_allclose(fitted.look_ahead(scene)[0, 0], again.predict_proba(scene), rtol=0, atol=TOLERANCE)


@pytest.mark.parametrize('exact', [True, False])
@pytest.mark.parametrize('length_scale', [None, 0.5, 2.0, 4.0])
def test_no_warning_escapes_at_amplitude_100(learning_state, exact, length_scale):
    """Neither a division by a curvature that has vanished nor an overflow of single precision, in a fit either."""
    for seed in range(30):
        state = learning_state(seed, amplitude=100.0, n_features=2, length_scale=length_scale, duplicates=seed % 2 == 0)
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            fitted = state.fitted()
            table = fitted.look_ahead(state.scene, exact)
            fitted.fit(*state.had_been_labelled(0, state.symbols[0]))
        assert ((table > 0) & (table < 1)).all()


@pytest.mark.parametrize('exact', [True, False])
def test_no_warning_escapes_in_ordinary_states(learning_state, exact):
    """Otherwise warnings of numpy would reach a robot's log at every turn."""
    for seed in range(30):
        state = learning_state(seed, amplitude=4.0, duplicates=seed % 2 == 0)
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            table = state.fitted().look_ahead(state.scene, exact)
        assert ((table > 0) & (table < 1)).all()


def test_result_belongs_to_the_caller(learning_state):
    """A caller that writes into a table does not change the next one."""
    state = learning_state(43, n=8)
    fitted = state.fitted()
    first = fitted.look_ahead(state.scene)
    kept = first.copy()
    first[:] = -1
    np.testing.assert_array_equal(fitted.look_ahead(state.scene), kept)
    for _, part in fitted.look_ahead_chunks(state.scene):
        part[:] = -1
    np.testing.assert_array_equal(fitted.look_ahead(state.scene), kept)


def test_looking_ahead_changes_nothing(learning_state):
    """Neither the models' beliefs nor what they learn next."""
    state = learning_state(44, n=8)
    watched, plain = state.fitted(), state.fitted()
    watched.look_ahead(state.scene)
    more = state.had_been_labelled(0, state.symbols[0])
    np.testing.assert_array_equal(watched.predict_proba(state.scene), plain.predict_proba(state.scene))
    np.testing.assert_array_equal(
        watched.fit(*more).predict_proba(state.scene), plain.fit(*more).predict_proba(state.scene)
    )


def test_models_that_were_never_fitted(learning_state):
    """Before the first label, `fit` or not."""
    state = learning_state(45, n=0, n_symbols=2, n_things=3)
    np.testing.assert_array_equal(state.models().look_ahead(state.scene), state.fitted().look_ahead(state.scene))
    assert state.largest_error(ConceptModels(state.symbols, state.amplitude).look_ahead(state.scene)) <= TOLERANCE


@pytest.mark.parametrize('numbers', [1, 10**9])
@pytest.mark.parametrize('n', [0, 7])
def test_other_things_than_the_examples_can_be_asked_about(learning_state, monkeypatch, numbers, n):
    """Otherwise the oracle would judge labels by what other ones lead to, or differently in a large scene."""
    monkeypatch.setattr(concept_models, 'CHUNK_NUMBERS', numbers)
    state = learning_state(3, n=n)
    fitted = state.fitted()
    examples, labels = state.scene[[0, 1, 0, 1]], [state.symbols[0], NO_SYMBOL, state.symbols[1], state.symbols[0]]
    things = np.random.default_rng(0).normal(size=(5, state.scene.shape[1]))
    found = fitted.predict_after_each(examples, labels, things)
    for row, label, after in zip(examples, labels, found, strict=True):
        features = np.concatenate([state.features, row[None]])
        again = state.models().fit(features, [*state.labels, label])
        np.testing.assert_allclose(after, again.predict_proba(things), rtol=0, atol=TOLERANCE)
    with pytest.raises(InputError, match='unknown label'):
        fitted.predict_after_each(examples, ['x'] * 4, things)
    with pytest.raises(InputError, match='3 labels for 4'):
        fitted.predict_after_each(examples, labels[:3], things)
