"""Demonstrations: synthetic ones from known weights, and short ones of the scripted expert."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import softmax

from al_questioner.domain import Action, EpisodeSettings, QueryKind
from al_questioner.imitation.demonstration import Demonstration, Step
from al_questioner.simulation import WorldSpec, episode_settings
from demonstrating import demonstrate
from shared.lunches import TASK, teacher_of

ACTIONS = (
    Action(QueryKind.DEMONSTRATION, symbol='snack'),
    Action(QueryKind.DEMONSTRATION, symbol='fruit'),
    *(Action(QueryKind.LABEL, object_id=number) for number in range(6)),
    Action(QueryKind.FEATURE_SUBSET),
    Action(QueryKind.NO_QUERY),
)
SETTINGS = EpisodeSettings(symbols=('snack', 'fruit'), budget=15.0, turns=30, strategy='expert')


def synthetic(weights, seed, n_steps=400, features=None):
    """Steps in which a softmax with these weights chooses; remaining time is the same for all candidates."""
    rng = np.random.default_rng(seed)
    steps = []
    for turn in range(1, n_steps + 1):
        table = rng.random((len(ACTIONS), 7)) if features is None else features(rng)
        table[:, 5] = 1 - turn / (n_steps + 1)
        chosen = int(rng.choice(len(ACTIONS), p=softmax(table @ weights)))
        steps.append(Step(turn, ACTIONS, table, chosen))
    return Demonstration(f'synthetic {seed}', SETTINGS, None, len(steps), tuple(steps))


def expert(seed, budget=6.0, turns=10):
    """A short demonstration of the scripted expert."""
    settings = episode_settings(TASK, 'expert', budget, turns, change_interval=5)
    return demonstrate(WorldSpec(TASK, seed, seed), settings, teacher_of(TASK, seed))


@pytest.fixture(scope='session')
def made():
    """The helper above; test modules cannot import from each other in pytest's importlib mode."""
    return SimpleNamespace(synthetic=synthetic)


@pytest.fixture(scope='session')
def experts():
    """Two short demonstrations of the scripted expert."""
    return [expert(0), expert(1)]
