"""`demo` brings up the graph, and the graph plays what the offline episode plays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from al_questioner.bags import read_bag
from al_questioner.cli import main
from al_questioner.imitation.bags import read_demonstrations
from al_questioner.questioning import STRATEGIES
from shared.checkout import ROOT

CROPS = ROOT.parent / 'shared' / 'data' / 'tabletop_rgbd' / 'crops' / 'rgbd-dataset'
SMALL = ['--task', 'prepare_lunch', '--budget', '6', '--turns', '7', '--seed', '4']
PAPER = ['--task', 'prepare_lunch', '--budget', '25', '--turns', '40', '--seed', '7']


def play(processes: Any, folder: Path, *arguments: str) -> dict[str, object]:
    path = folder.with_suffix('.json')
    done = processes.run('demo', *arguments, '--out', str(folder), '--json', str(path))
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(path.read_text())


def play_offline(folder: Path, *arguments: str) -> dict[str, object]:
    path = folder / 'offline.json'
    assert main(['demo', *arguments, '--offline', '--out', str(folder / 'offline'), '--json', str(path)]) == 0
    return json.loads(path.read_text())


def test_three_processes_play_the_offline_episode(processes: Any, tmp_path: Path) -> None:
    """A result that is found offline holds for the robot."""
    graph = play(processes, tmp_path / 'graph', *SMALL, '--strategy', 'dt_task_env')
    assert graph['queries']
    assert graph == play_offline(tmp_path, *SMALL, '--strategy', 'dt_task_env')
    logs = [path.stem for path in (tmp_path / 'graph' / 'logs').glob('*.log')]
    assert sorted(logs) == ['learner', 'perception', 'teacher']


@pytest.mark.slow
def test_one_process_plays_the_offline_episode(processes: Any, tmp_path: Path) -> None:
    """Otherwise nodes composed into one process would behave otherwise."""
    shown = [*SMALL, '--strategy', 'random_fsq']
    one = play(processes, tmp_path / 'one', *shown, '--one-process', '--namespace', '/a/robot_1/')
    assert one == play_offline(tmp_path, *shown)


@pytest.mark.slow
@pytest.mark.skipif(not CROPS.is_dir(), reason='the real RGB-D crops are not beside this checkout')
def test_real_crops_are_learnt_through_the_graph(processes: Any, tmp_path: Path) -> None:
    """Otherwise the robot would learn from drawings alone."""
    crops = ['--task', 'tabletop', '--dataset', str(CROPS), '--budget', '15', '--turns', '20', '--seed', '3']
    graph = play(processes, tmp_path / 'graph', *crops)
    assert graph == play_offline(tmp_path, *crops)
    assert graph['final_accuracy'] > 2 / 5
    assert graph['dataset_report'][-1] == 'skipped in all: 0'


@pytest.mark.slow
@pytest.mark.parametrize('strategy', [name for name in STRATEGIES if name != 'human'])
def test_every_strategy_asks_the_same_with_and_without_ros(processes: Any, tmp_path: Path, strategy: str) -> None:
    """Otherwise some strategy would behave otherwise on the robot, over a whole episode of the paper's length."""
    graph = play(processes, tmp_path / 'graph', *PAPER, '--strategy', strategy)
    assert graph == play_offline(tmp_path, *PAPER, '--strategy', strategy)


def test_an_unusable_namespace_is_named(tmp_path: Path, refusal: Any) -> None:
    """Otherwise a mistyped namespace would end in warnings of the middleware."""
    assert 'namespace' in refusal('demo', *SMALL, '--out', tmp_path, '--namespace', 'not a namespace')


@pytest.mark.slow
def test_a_recorded_demo_is_a_demonstration(processes: Any, tmp_path: Path) -> None:
    """Otherwise the bags that people share would not be what the real graph did."""
    bag = tmp_path / 'bag'
    shown = ['--task', 'prepare_lunch', '--strategy', 'expert', '--budget', '6', '--turns', '8', '--seed', '4']
    episode = play(processes, tmp_path / 'graph', *shown, '--record', str(bag))
    (demonstration,) = read_demonstrations([bag])
    assert len(demonstration.steps) == 8
    assert {topic.name.rpartition('/')[0] for topic in read_bag(bag).topics} == {'/demo'}
    assert [query.turn for query in demonstration.queries] == [query['turn'] for query in episode['queries']]
