"""The classifiers as an estimator of scikit-learn."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from sklearn.datasets import load_iris
from sklearn.model_selection import cross_val_score
from sklearn.utils.estimator_checks import parametrize_with_checks

from al_questioner import ConceptClassifier, ConceptModels, Scene
from al_questioner.concepts.kernel import KERNEL_SHAPES
from al_questioner.domain import DEFAULT_CLASSIFIERS, EpisodeSettings
from al_questioner.questioning import new_concept_learner
from shared.checkout import ROOT

FEATURES, TARGETS = load_iris(return_X_y=True)
FEW = np.r_[0:8, 50:56, 100:104]
NAMES = np.array(['cup', 'fork', 'plate'])[TARGETS]


@parametrize_with_checks([ConceptClassifier()])
def test_it_is_an_estimator(estimator: ConceptClassifier, check: Callable[[ConceptClassifier], None]) -> None:
    """scikit-learn's own checks, without an exception: pipelines and searches rely on each of them."""
    check(estimator)


def test_it_believes_what_a_learner_believes() -> None:
    """Otherwise what is measured with the estimator would say nothing about the robot."""
    names = ('width_a', 'width_b', 'height_a', 'height_b')
    examples = FEATURES[FEW].astype(np.float32)
    learner = new_concept_learner(EpisodeSettings(('cup', 'fork', 'plate'), 1, 1, 'random_fsq'), None)
    scene = Scene(tuple(range(len(FEW))), np.zeros((len(FEW), 3)), examples, names)
    learner.observe(scene)
    learner.label_scene(scene, dict(enumerate(NAMES[FEW])), 1)
    degrees = learner.predict_proba(FEATURES.astype(np.float32))
    estimator = ConceptClassifier(['width', 'width', 'height', 'height']).fit(examples, NAMES[FEW])
    shares = estimator.predict_proba(FEATURES.astype(np.float32))
    np.testing.assert_allclose(shares, degrees / degrees.sum(axis=1, keepdims=True), atol=1e-7)
    assert estimator.classes_.tolist() == ['cup', 'fork', 'plate']
    assert (estimator.predict(FEATURES) == estimator.classes_[degrees.argmax(axis=1)]).all()


def test_it_takes_the_settings_that_ship() -> None:
    """A default of its own would drift away from that of the learner."""
    parameters = ConceptClassifier().get_params()
    assert {name: parameters[name] for name in DEFAULT_CLASSIFIERS._fields} == DEFAULT_CLASSIFIERS._asdict()
    models = ConceptClassifier().fit(FEATURES[FEW], TARGETS[FEW]).models_
    assert isinstance(models, ConceptModels)
    assert models.kernels.shape == KERNEL_SHAPES[DEFAULT_CLASSIFIERS.kernel_shape]


def test_none_is_a_class_like_any_other() -> None:
    """To scikit-learn every label is a class; models of the learner take this word for things of no symbol."""
    labels = np.where(NAMES == 'cup', 'none', NAMES)
    found = ConceptClassifier().fit(FEATURES[FEW], labels[FEW])
    assert found.classes_.tolist() == ['fork', 'none', 'plate']
    assert found.score(FEATURES, labels) > 0.8


def test_it_stands_in_a_cross_validation_with_several_classes() -> None:
    """Most users do this with an estimator first."""
    assert cross_val_score(ConceptClassifier(), FEATURES, NAMES, cv=3).mean() > 0.9


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'kernel_shape': 'cube'}, "unknown kernel_shape 'cube'; known: grouped, rbf"),
        ({'amplitude': -1.0}, 'amplitude must be a number above 0, not -1.0'),
        ({'groups': ['size']}, '1 groups for 4 features'),
        ({'class_balance': 2}, r'class_balance must lie in \[0, 1\], not 2'),
    ],
)
def test_a_parameter_that_cannot_be_is_refused_by_the_fit(changes: dict[str, object], reason: str) -> None:
    """scikit-learn sets parameters without a look at them, so the fit is the first to see them."""
    with pytest.raises(ValueError, match=reason):
        ConceptClassifier(**changes).fit(FEATURES, TARGETS)


def test_without_scikit_learn_all_else_works(tmp_path: Path) -> None:
    """A ROS installation need not have it."""
    (tmp_path / 'sklearn.py').write_text('raise ImportError("not here")\n')
    code = (
        f'import sys; sys.path[:0] = [{str(tmp_path)!r}, {str(ROOT)!r}]\n'
        'from al_questioner import *\n'
        'ConceptModels, Pool\n'
        'from al_questioner import ConceptClassifier\n'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == "ImportError: scikit-learn is not installed: pip install '.[sklearn]'"
