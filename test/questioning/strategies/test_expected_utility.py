"""Expected utility against a brute-force implementation: plain loops and slow refits."""

import numpy as np
import pytest
from sklearn.feature_selection import f_classif

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import DECISION_FEATURES, NO_SYMBOL, QueryKind
from al_questioner.questioning.strategies.expected_utility import expected_features
from shared.textbook import optimised_probability

AMPLITUDE = 4.0


def slow_beliefs(features, labels, test, symbols):
    """q_y(x) by the textbook, one classifier at a time."""
    if not labels:
        return np.full((len(test), len(symbols)), 0.5)
    targets = [np.array([float(label == symbol) for label in labels]) for symbol in symbols]
    scale = np.sqrt(features.shape[1])
    return np.array([optimised_probability(features, y, test, AMPLITUDE, scale) for y in targets]).T


def slow_task_features(q, counts):
    """ACD, CDU, IV and PM from their definitions in DESIGN section 4."""
    n_objects, n_symbols = len(q), len(q[0])
    acd = sum(max(q[x][y] for x in range(n_objects)) - min(q[x][y] for x in range(n_objects)) for y in range(n_symbols))
    cdu = min(counts) / max(counts) if max(counts) else 0.0
    iv = 0.0
    for y in range(n_symbols):
        total = sum(q[x][y] for x in range(n_objects))
        share = [q[x][y] / total for x in range(n_objects)]
        mean = sum(share) / n_objects
        iv += (sum((s - mean) ** 2 for s in share) / n_objects) ** 0.5 / mean / (n_objects - 1) ** 0.5
    pm = 0.0
    for x in range(n_objects):
        ranked = sorted(q[x][y] / sum(q[x]) for y in range(n_symbols))
        pm += ranked[-1] - ranked[-2]
    return np.array([acd / n_symbols, cdu, iv / n_symbols, pm / n_objects])


def slow_expected_features(toy, context, labelled, told_columns):
    """E[phi | a] of every candidate by enumerating outcomes."""
    scene = context.scene
    seen = scene.features.astype(float)
    standard = (seen - seen.mean(axis=0)) / seen.std(axis=0)
    use = list(range(standard.shape[1])) if told_columns is None else told_columns
    ids, symbols = scene.object_ids, toy.symbols
    rows = [ids.index(object_id) for object_id, _ in labelled]
    labels = [label for _, label in labelled]

    def beliefs(extra_rows=(), extra_labels=(), columns=None):
        table = standard[:, use if columns is None else columns]
        return slow_beliefs(table[[*rows, *extra_rows]], [*labels, *extra_labels], table, symbols)

    def counts(*extra):
        return [[*labels, *extra].count(symbol) for symbol in symbols]

    now = beliefs()
    after = {
        (x, y): slow_task_features(beliefs([x], [symbols[y]]), counts(symbols[y]))
        for x in range(len(ids))
        for y in range(len(symbols))
    }
    expected = []
    for action in context.candidates:
        if action.kind is QueryKind.LABEL:
            x = ids.index(action.object_id)
            task = sum(now[x][y] / sum(now[x]) * after[x, y] for y in range(len(symbols)))
        elif action.kind is QueryKind.DEMONSTRATION:
            y = symbols.index(action.symbol)
            task = sum(now[x][y] / sum(now[:, y]) * after[x, y] for x in range(len(ids)))
        elif action.kind is QueryKind.FEATURE_SUBSET and labels and told_columns is None:
            columns = list(range(standard.shape[1]))
            if 2 <= len(set(labels)) < len(labels):
                p = f_classif(standard[rows], labels)[1]
                best = sorted(columns, key=lambda c: p[c])[:5]
                columns = [c for c in columns if p[c] <= 0.05 or c in best]
            task = slow_task_features(beliefs(columns=columns), counts())
        else:
            task = slow_task_features(now, counts())
        cost = {'label': 1, 'demonstration': 2, 'feature_subset': 2, 'no_query': 0}[action.kind.value]
        idle = context.non_query_turns + 1 if action.kind is QueryKind.NO_QUERY else 0
        spent = (context.spent + cost) / context.budget
        left = (context.turns - context.turn) / context.turns
        expected.append([*task, spent, left, min(1, idle / context.change_interval)])
    return np.array(expected)


NAMES = tuple(f'{group}_{i}' for group in ('colour', 'size', 'noise') for i in range(3))


def make_context(toy, seed, n_labels, told=None, n_objects=6, **changes):
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(n_objects, len(NAMES)))
    scene = toy.scene(table, object_ids=rng.permutation(50)[:n_objects].tolist(), names=NAMES)
    concepts = ConceptLearner(toy.symbols, AMPLITUDE)
    concepts.observe(scene)
    labelled = []
    for row in rng.integers(0, n_objects, size=n_labels):
        label = str(rng.choice([*toy.symbols, NO_SYMBOL]))
        concepts.label(scene.object_ids[row], scene.features[row], label, 1)
        labelled.append((scene.object_ids[row], label))
    if told is not None:
        concepts.restrict_to_groups(told)
    values = {'turn': 5, 'scene': scene, 'budget': 16.0, 'spent': 6.0, 'change_interval': 4, 'non_query_turns': 2}
    return toy.context(concepts=concepts, **{**values, **changes}), labelled


@pytest.mark.parametrize('told', [None, ('colour', 'noise')])
@pytest.mark.parametrize('n_labels', [0, 1, 4, 8])
def test_expected_features_equal_brute_force(toy, n_labels, told):
    """Every candidate, FSQ included, before and after the teacher has named the relevant features."""
    context, labelled = make_context(toy, seed=n_labels, n_labels=n_labels, told=told)
    columns = None if told is None else [0, 1, 2, 6, 7, 8]
    assert len(context.candidates) == 3 + 6 + 2
    expected = slow_expected_features(toy, context, labelled, columns)
    np.testing.assert_allclose(expected_features(context), expected, rtol=0, atol=1e-7)


def test_subset_query_is_valued_by_what_a_selector_would_pick(toy):
    """With labels that allow a selection it must differ from asking nothing, else FSQ would never be asked."""
    context, _ = make_context(toy, seed=8, n_labels=8)
    subset, nothing = expected_features(context)[-2:]
    assert (np.abs(subset - nothing)[[0, 2, 3]] > 1e-4).all()


def test_environment_features_by_hand(toy):
    """DQ, LQ, FSQ, NQ at turn 5 of 20, 6 of 16 spent, two turns without a query in a window of four."""
    context, _ = make_context(toy, seed=0, n_labels=2)
    by_kind = {a.kind: f[4:] for a, f in zip(context.candidates, expected_features(context), strict=True)}
    assert by_kind[QueryKind.DEMONSTRATION].tolist() == [0.5, 0.75, 0]
    assert by_kind[QueryKind.LABEL].tolist() == [7 / 16, 0.75, 0]
    assert by_kind[QueryKind.FEATURE_SUBSET].tolist() == [0.5, 0.75, 0]
    assert by_kind[QueryKind.NO_QUERY].tolist() == [6 / 16, 0.75, 0.75]


@pytest.mark.parametrize('seed', range(5))
def test_features_lie_in_the_unit_interval(toy, seed):
    for n_objects in (1, 2, 7):
        context, _ = make_context(toy, seed, n_labels=seed, n_objects=n_objects, non_query_turns=9)
        features = expected_features(context)
        assert features.shape == (3 + n_objects + 2, len(DECISION_FEATURES))
        assert ((features >= 0) & (features <= 1)).all()


def test_no_candidate_is_beyond_the_budget(toy):
    """With 1 left only label queries and NQ remain; with nothing left only NQ, and no look-ahead is needed."""
    for spent, kinds in ((15.0, {QueryKind.LABEL, QueryKind.NO_QUERY}), (16.0, {QueryKind.NO_QUERY})):
        context, _ = make_context(toy, seed=1, n_labels=3, spent=spent)
        assert {action.kind for action in context.candidates} == kinds
        assert np.isfinite(expected_features(context)).all()


def test_order_of_the_objects_only_permutes_the_candidates(toy):
    context, _ = make_context(toy, seed=2, n_labels=4)
    scene = context.scene
    order = [3, 1, 5, 0, 2, 4]
    shuffled = toy.scene(scene.features[order], [scene.object_ids[i] for i in order], NAMES)
    other, _ = make_context(toy, seed=2, n_labels=4, scene=shuffled)
    by_action = dict(zip(other.candidates, expected_features(other), strict=True))
    expected = np.array([by_action[action] for action in context.candidates])
    np.testing.assert_allclose(expected_features(context), expected, atol=1e-9)
