"""The parameter files that ship must say what the nodes declare, value by value."""

from __future__ import annotations

from pathlib import Path

import pytest

from al_questioner.configuration import config_dir, read_yaml
from al_questioner.domain import InputError
from al_questioner.ros.parameters import Setting, help_text
from al_questioner.ros.settings import PERCEPTION_SETTINGS, TEACHER_SETTINGS, WORLD_SETTINGS, learner_settings
from al_questioner.world import load_task

FILES = sorted((config_dir() / 'params').glob('*.yaml'))


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_file_lists_every_parameter_at_its_default(path: Path) -> None:
    """A user would change a parameter that does not exist, or miss one that does."""
    content = read_yaml(path)
    settings = (*WORLD_SETTINGS, *PERCEPTION_SETTINGS, *TEACHER_SETTINGS, *learner_settings(load_task(path.stem)))
    expected = {setting.name: setting.default for setting in settings if setting.name != 'sample'}
    assert content == {'/**': {'ros__parameters': {**expected, 'task': path.stem}}}


@pytest.mark.parametrize(
    ('value', 'taken'), [(1, 1.0), (0.5, 0.5), (0, 0.0), (2, None), (-0.1, None), (float('nan'), None), ('1', None)]
)
def test_numbers_are_checked_and_integers_taken_for_floats(value: object, taken: float | None) -> None:
    """`-p budget:=25` would be refused, or nonsense be taken."""
    setting = Setting('share', 0.1, 'a share', lower=0.0, upper=1.0)
    if taken is None:
        with pytest.raises(InputError, match='parameter share'):
            setting.checked(value)
    else:
        assert setting.checked(value) == taken
        assert isinstance(setting.checked(value), float)


@pytest.mark.parametrize(('default', 'value'), [(3, True), (3, 2.0), ('a', 3), (False, 1)])
def test_other_types_are_refused(default: object, value: object) -> None:
    """A truth value would be taken for a number, or a number for a name."""
    with pytest.raises(InputError, match='must be of type'):
        Setting('thing', default, 'a thing').checked(value)


def test_help_names_every_parameter() -> None:
    """Without the `ros2` command a user would not learn what can be set."""
    text = help_text('What it does.', learner_settings(load_task('prepare_lunch')))
    for setting in learner_settings(load_task('prepare_lunch')):
        assert f'  {setting.name} ' in text
    assert '[cost of a label query]' in text
