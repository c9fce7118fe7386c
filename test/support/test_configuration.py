"""All that ships in config/ loads, and a name that does not ship is refused with those that do."""

from __future__ import annotations

from pathlib import Path

import pytest

from al_questioner.domain import InputError
from al_questioner.support.configuration import config_dir, named_bag, named_file, read_yaml


@pytest.mark.parametrize(
    ('name', 'reason'),
    [
        ('prepare_luch', r"unknown task 'prepare_luch'; known: .*prepare_lunch"),
        ('/no/mine.yaml', r'mine\.yaml does not exist'),
        ('/etc/passwd', r'^/etc/passwd is no task file: the name of one ends in .yaml$'),
    ],
)
def test_what_names_no_file_is_refused(name: str, reason: str) -> None:
    """A mistyped task is answered with the known ones, and a path is not taken for an unknown name."""
    with pytest.raises(InputError, match=reason):
        named_file('tasks', name, 'task')


def test_a_bag_at_a_path_comes_before_one_that_ships(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise people would train on our expert instead of theirs, or have to know where ours lies."""
    monkeypatch.chdir(tmp_path)
    assert (named_bag('expert_0') / 'metadata.yaml').is_file()
    with pytest.raises(InputError, match=r'^expert_7: there is no such bag$'):
        named_bag('expert_7')
    Path('expert_0').mkdir()
    assert named_bag('expert_0') == Path('expert_0')


def test_own_file_is_taken(tmp_path: Path) -> None:
    """Otherwise users could not bring a task of their own."""
    own = tmp_path / 'mine.yaml'
    own.write_text('a: 1\n')
    assert named_file('tasks', str(own), 'task') == own


def test_a_file_that_is_not_there_is_one_line() -> None:
    with pytest.raises(InputError, match=r'^/no/such.yaml: cannot be read \(No such file or directory\)$'):
        read_yaml(Path('/no/such.yaml'))


def test_every_task_has_parameters_for_its_nodes() -> None:
    """Otherwise `ros2 launch` would find no parameter file for a task."""
    tasks = {path.name for path in (config_dir() / 'tasks').glob('*.yaml')}
    assert {path.name for path in (config_dir() / 'params').glob('*.yaml')} == tasks
