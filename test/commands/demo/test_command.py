"""`demo` as its users call it, without ROS: what it writes, and how it refuses."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import cv2
import pytest

from al_questioner.cli import main
from al_questioner.commands.demo.progress import answer_text
from al_questioner.domain import Outcome, QueryKind, QueryRecord

SMALL = ['demo', '--offline', '--task', 'prepare_lunch', '--budget', '6', '--turns', '7', '--seed', '4']


def run(tmp_path: Path, *more: str) -> int:
    return main([*SMALL, '--out', str(tmp_path / 'out'), *more])


def test_json_holds_what_the_contract_names(tmp_path: Path) -> None:
    """Otherwise scripts that read an episode would not find their members."""
    path = tmp_path / 'deep' / 'episode.json'
    assert run(tmp_path, '--strategy', 'rarest_demo', '--json', str(path)) == 0
    episode = json.loads(path.read_text())
    assert (episode['task'], episode['strategy'], episode['seed']) == ('prepare_lunch', 'rarest_demo', 4)
    assert (episode['budget'], episode['turns']) == (6, 7)
    assert len(episode['accuracy']) == 7
    assert episode['final_accuracy'] == episode['accuracy'][-1]
    assert episode['spent'] == sum(query['cost'] for query in episode['queries']) <= 6
    for query in episode['queries']:
        assert {'turn', 'kind', 'object_id', 'symbol', 'cost', 'outcome'} <= set(query)


def test_the_teacher_is_told_of(tmp_path: Path) -> None:
    """Otherwise an episode could not be played again as it was, and the option would do nothing."""
    shown, path = {}, tmp_path / 'episode.json'
    for options in ((), ('--repeat-shown',)):
        arguments = ['--strategy', 'rarest_demo', '--budget', '40', '--turns', '14', '--json', str(path), *options]
        assert run(tmp_path, *arguments) == 0
        episode = json.loads(path.read_text())
        assert episode['repeat_shown'] is bool(options)
        shown[options] = [query['object_id'] for query in episode['queries']]
    assert len(set(map(tuple, shown.values()))) == 2


def test_labels_follow_things_if_told_to(tmp_path: Path) -> None:
    """An option that does nothing, or that nobody can tell from the episode."""
    spent, path = {}, tmp_path / 'episode.json'
    for options in ((), ('--carry-labels',)):
        arguments = ['--strategy', 'random_fsq', '--budget', '40', '--turns', '22', '--json', str(path), *options]
        assert run(tmp_path, *arguments) == 0
        episode = json.loads(path.read_text())
        assert episode['carry_labels'] is bool(options)
        spent[options] = episode['spent']
    assert spent['--carry-labels',] < spent[()]


@pytest.mark.parametrize(
    ('objects', 'told'),
    [((10, 3), 'Objects 3, 10.'), ((3,), 'Object 3.'), ((), 'Nothing here.'), (None, 'I do not know.')],
)
def test_what_matters_is_told_in_words(objects: tuple[int, ...] | None, told: str) -> None:
    """Otherwise the line of the turn would be empty, or that of a label."""
    outcome = Outcome.UNKNOWN if objects is None else Outcome.ANSWERED
    assert answer_text(QueryRecord(1, QueryKind.RELEVANCE, None, None, 4.0, outcome, objects=objects)) == told


@pytest.mark.parametrize('strategy', ['dt_task_env', 'random_fsq'])
def test_pictures_are_drawn(tmp_path: Path, strategy: str) -> None:
    """Otherwise the demo would end with nothing to look at."""
    assert run(tmp_path, '--strategy', strategy) == 0
    for name in ('learning_curve', 'timeline', 'scene', 'new_table'):
        picture = cv2.imread(str(tmp_path / 'out' / f'{name}.png'))
        assert picture.shape[1] >= 900
        assert picture.std() > 5


def test_an_episode_without_queries_is_drawn_too(tmp_path: Path) -> None:
    """Otherwise a budget of nothing would end in a traceback."""
    assert run(tmp_path, '--budget', '0') == 0


def test_progress_and_summary_are_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise people would wait before an empty terminal, and not learn how it ended."""
    run(tmp_path, '--strategy', 'random_fsq')
    printed = capsys.readouterr().out
    assert 'What is object' in printed
    assert 'accuracy on held-out images' in printed
    assert 'scene.png' in printed
    assert 'things on a table it has not seen' in printed


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['--task', 'prepare_luch'], 'unknown task'),
        (['--strategy', 'clever'], 'unknown strategy'),
        (['--budget', '-1'], 'budget'),
        (['--budget', 'nan'], 'budget'),
        (['--budget', 'much'], '--budget'),
        (['--turns', '0'], 'turns'),
        (['--seed', '-1'], 'seed'),
        (['--wrong-rate', '2'], '--wrong-rate: must be at least 0 and at most 1, not 2'),
        (['--task', 'tabletop'], 'needs a dataset'),
        (['--task', 'tabletop', '--dataset', '/no/such/folder'], '/no/such/folder'),
        (['--dataset', '/tmp'], 'takes no dataset'),
        (['--weights-file', '/no/such/file.yaml'], '/no/such/file.yaml'),
        (['--json', '/proc/no/such.json'], '/proc/no cannot be made a folder'),
        (['--json', '/proc/such.json'], '/proc/such.json cannot be written'),
        (['--out', '/dev/null'], '/dev/null cannot be made a folder'),
        (['--turns', '100000000000'], 'must be at least 1 and at most 10000, not 100000000000'),
        (['--tune-every', '5'], '--tune-every'),
        (['--turn-period', '-1'], '--turn-period'),
        (['--turn-period', 'nan'], '--turn-period'),
        (['--sample', '-1'], '--sample'),
        (['--seed', '9' * 30], '--seed'),
        (['--frobnicate'], '--frobnicate'),
    ],
)
def test_unusable_input_ends_with_status_2_and_one_line(
    tmp_path: Path, refusal: Callable[..., str], arguments: list[str], reason: str
) -> None:
    """Otherwise a mistyped option would end in a traceback, or in another episode than was meant."""
    assert reason in refusal(*SMALL, '--out', tmp_path / 'out', *arguments)


def test_help_names_the_tasks(capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise one would have to look into the folder of the package."""
    for executable in ('demo', 'experiment'):
        with pytest.raises(SystemExit):
            main([executable, '--help'])
        printed = ' '.join(capsys.readouterr().out.split())
        assert 'kitchen_table, mixed_kitchens, pack_lunchbox, prepare_lunch' in printed


def test_a_dry_run_plays_a_task_whose_things_nobody_can_simulate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A task file can be tried without the robot; a name with brackets is not taken for markup."""
    task = tmp_path / 'mine.yaml'
    task.write_text('symbols: [screwdriver, "bold[/green]"]\ncosts: {label: 2}\nepisode: {budget: 8, turns: 9}\n')
    arguments = ['demo', '--task', str(task), '--out', str(tmp_path / 'out'), '--json', str(tmp_path / 'json')]
    assert main([*arguments, '--dry-run']) == 0
    printed = capsys.readouterr().out
    assert printed.count('dry run on made-up features: colour, size matter, noise does not') == 2
    assert 'accuracy on held-out made-up views' in printed
    assert 'telling screwdriver and bold[/green] apart' in printed
    assert sorted(path.name for path in (tmp_path / 'out').iterdir()) == ['learning_curve.png', 'timeline.png']
    episode = json.loads((tmp_path / 'json').read_text())
    assert (episode['dry_run'], episode['task'], episode['costs']['label']) == (True, 'mine', 2)
    assert episode['final_accuracy'] > 0.5
    assert main([*arguments, '--offline']) == 2
    assert '--dry-run plays on made-up features' in capsys.readouterr().err


def test_help_and_an_unknown_executable_list_the_known(capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a mistyped executable would be met with silence, and a newcomer not learn what there is."""
    assert main(['lerner']) == 2
    assert 'learner' in capsys.readouterr().err
    assert main(['--help']) == 0
    assert 'teacher' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('options', 'reason'),
    [
        (['--offline', '--record', 'bag'], '--record is of no use with --offline'),
        (['--offline', '--namespace', 'robot'], '--namespace is of no use with --offline'),
        (['--dry-run', '--record', 'bag'], '--record is of no use with --dry-run'),
        (['--dry-run', '--one-process'], '--one-process is of no use with --dry-run'),
        (['--dry-run', '--dataset', 'crops'], '--dataset is of no use with --dry-run'),
        (['--one-process', '--record', 'bag'], '--record needs a process for each node'),
        (['--record', '/'], '--record: / exists already; a bag is never overwritten'),
    ],
)
def test_options_that_would_be_ignored_are_refused(tmp_path, capsys, options, reason):
    """Otherwise a user would wait for a recording that nobody makes."""
    assert main(['demo', *options, '--out', str(tmp_path)]) == 2
    printed = capsys.readouterr()
    assert reason in printed.err
    assert printed.out == ''
