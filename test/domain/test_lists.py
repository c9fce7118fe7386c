"""Lists where tuples and arrays are meant, as people write them in notebooks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from al_questioner.concepts import ConceptModels
from al_questioner.domain import EpisodeSettings, Scene, SceneError, SettingsError, random_stream
from al_questioner.questioning import Episode
from al_questioner.simulation import accuracy

SCENE: dict[str, Any] = {
    'object_ids': [1, 2],
    'positions': [[0, 0, 0], [1, 1, 1]],
    'features': [[1, 2.5], [3, 4]],
    'feature_names': ['colour_hue', 'size_m'],
}


def test_a_scene_of_lists_is_that_of_arrays() -> None:
    """Otherwise a first try in a notebook would end in a traceback about an attribute of lists."""
    scene = Scene(**SCENE)
    tables = (np.array(SCENE[name], np.float32) for name in ('positions', 'features'))
    assert scene.equals(Scene((1, 2), *tables, ('colour_hue', 'size_m')))
    assert type(Scene(**{**SCENE, 'object_ids': np.array([1, 2])}).object_ids[0]) is int


@pytest.mark.parametrize('dtype', [np.float32, np.float64])
def test_arrays_stay_as_they_are(dtype: type) -> None:
    """The log and the model hold the same numbers."""
    features = np.array([[0.1, 0.2], [0.3, 0.4]], dtype)
    assert Scene(**{**SCENE, 'features': features}).features is features


@pytest.mark.parametrize(
    ('member', 'value', 'reason'),
    [
        ('object_ids', [1.5, 2], 'object_ids must be whole numbers'),
        ('object_ids', '12', 'object_ids must be whole numbers'),
        ('object_ids', 7, 'object_ids must be whole numbers'),
        ('feature_names', 'ab', 'feature_names must be a list of names'),
        ('feature_names', [1, 2], 'feature_names must be a list of names'),
        ('features', [[1, 2], [3]], 'features must be rows of numbers, all of the same length'),
        ('features', [['a', 'b'], ['c', 'd']], 'features must be rows of numbers'),
        ('features', [[1e39, 2], [3, 4]], 'colour_hue of object 1 is not finite'),
        ('features', None, 'features have shape'),
        ('positions', [[0, 0], [1, 1]], 'positions have shape'),
    ],
)
def test_what_is_no_scene_is_refused_in_words(member: str, value: object, reason: str) -> None:
    """Otherwise the reason would be one of numpy's, which names neither the member nor what is expected."""
    with pytest.raises(SceneError, match=reason):
        Scene(**{**SCENE, member: value})


def test_symbols_may_be_a_list_and_are_not_letters_of_a_word() -> None:
    """Otherwise an episode about a, b and c would be played for the one symbol abc, or a blank be asked for."""
    settings = EpisodeSettings(['cup', 'plate'], 4, 5, 'random_fsq')
    assert settings.symbols == ('cup', 'plate')
    for symbols in ('abc', [1, 2], None, ['cup', ' '], ['cup', 'cup'], ['cup', 'none']):
        with pytest.raises(SettingsError, match='symbol'):
            EpisodeSettings(symbols, 4, 5, 'random_fsq')


def test_an_episode_and_its_models_take_lists() -> None:
    """Otherwise a user who has features in lists would have to know which function wants what."""
    episode = Episode(EpisodeSettings(['cup', 'plate'], 4, 5, 'random_fsq'), random_stream(0, 'learner'))
    assert episode.ask(Scene(**SCENE)).query is not None
    assert episode.concepts.predict_proba([[1, 2], [3, 4], [5, 6]]).shape == (3, 2)
    models = ConceptModels(['cup', 'plate'])
    models.fit([[0, 1], [1, 0]], ['cup', 'plate'])
    assert models.look_ahead([[0, 1]]).shape == (1, 2, 1, 2)
    assert accuracy([[0.9, 0.1], [0.8, 0.2]], ['cup', 'plate'], ['cup', 'plate']) == 0.5
