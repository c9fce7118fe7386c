"""Concept learners that were taught a little, for the tests of what they make of it."""

import numpy as np

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import NO_SYMBOL
from shared.scenes import make_scene

SYMBOLS = ('snack', 'fruit')
NAMES = ('colour_red', 'colour_green', 'size_height', 'noise_max')


def scene_of(features, object_ids=None, names=NAMES):
    return make_scene(features, object_ids, names)


def learner(*scenes, labels=(), **options):
    """A learner that has seen these scenes, and was told labels of the first things in the last one."""
    concepts = ConceptLearner(SYMBOLS, **{'amplitude': 4.0, **options})
    for scene in scenes:
        concepts.observe(scene)
    for row, label in enumerate(labels):
        concepts.label(row, scene.features[row], label, turn=row + 1)
    return concepts


def standardised(scene):
    table = scene.features.astype(np.float64)
    return (table - table.mean(axis=0)) / table.std(axis=0)


TOLD = ['snack', 'fruit', NO_SYMBOL]
