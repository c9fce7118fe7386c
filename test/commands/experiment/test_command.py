"""The `experiment` executable."""

from __future__ import annotations

import csv
import dataclasses
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import mannwhitneyu, wilcoxon

from al_questioner.cli import main
from al_questioner.experiments import playing
from al_questioner.experiments.plan import Cell, Condition, Plan, Variation, strategy_to_compare
from al_questioner.experiments.results import read_results
from al_questioner.experiments.studies import STUDIES, Study
from al_questioner.support.configuration import config_dir

SMALL = ['--task', 'prepare_lunch', '--condition', '4/6', '--samples', '3', '--jobs', '1']


def test_the_command_writes_tables_figures_and_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The one command of the documentation does what it says; p-values are recomputed from the table."""
    strategies = ['u_sampling', 'dt_iros', 'dt_task', 'dt_task_env', 'random_fsq']
    arguments = [*SMALL, '--strategy', *strategies, '--ceilings']
    assert main(['experiment', *arguments, '--out', str(tmp_path)]) == 0
    page = (tmp_path / 'report.md').read_text()
    assert len(list((tmp_path / 'figures' / 'report').glob('*.png'))) == 5
    rows = list(csv.DictReader((tmp_path / 'episodes.csv').open()))
    finals = {row['strategy']: [] for row in rows}
    for row in sorted(rows, key=lambda row: int(row['sample'])):
        finals[row['strategy']].append(float(row['final_accuracy']))
    for name in ('u_sampling', 'random_fsq'):
        p = mannwhitneyu(finals['dt_task_env'], finals[name], alternative='greater').pvalue
        difference = np.round(np.subtract(finals['dt_task_env'], finals[name]), 12)
        paired = wilcoxon(difference, alternative='greater').pvalue if difference.any() else 1.0
        (line,) = [line for line in page.splitlines() if f'| `{name}` | {difference.mean():+.3f} | {p:.4f} |' in line]
        assert line.endswith(f' {paired:.4f} |')
    assert set(finals) == {*strategies, 'all_labels', 'greedy_oracle'}
    # A ceiling is no strategy to be tested against.
    assert '| `greedy_oracle` | +' not in page
    assert '| `greedy_oracle` | -' not in page
    assert '21 episodes, 0 failed' in capsys.readouterr().out
    elsewhere = tmp_path / 'docs' / 'page.md'
    assert main(['experiment', *arguments, '--out', str(tmp_path), '--page', str(elsewhere)]) == 0
    assert elsewhere.read_text().splitlines()[:-1] == page.replace('figures/report/', 'figures/page/').splitlines()[:-1]
    assert len(list((tmp_path / 'docs' / 'figures' / 'page').glob('*.png'))) == 5


def test_the_user_says_which_strategy_is_tested(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise who has a question of their own would get the answer to the paper's. Nothing is played again for it."""
    arguments = [*SMALL, '--strategy', 'rarest_demo', 'random_fsq', 'dt_task_env', '--out', str(tmp_path)]
    for options, name in (([], 'dt_task_env'), (['--compare', 'random_fsq'], 'random_fsq')):
        assert main(['experiment', *arguments, *options]) == 0
        page = (tmp_path / 'report.md').read_text()
        assert page.startswith(f'# {name} against 2 other strategies\n')
        first = page.split('\n\n')[1].replace('**', '')
        assert first.startswith(f'Of the strategies that were played, {name} is ')
        printed = capsys.readouterr().out
        assert first in printed
    assert '(9 from before)' in printed


def test_without_a_wish_the_method_of_the_paper_is_tested_or_else_the_first() -> None:
    """These are what most would have asked about; a ceiling, which knows the truth, is no strategy to ask about."""
    assert strategy_to_compare(['rarest_demo', 'dt_task_env', 'mine']) == 'dt_task_env'
    assert strategy_to_compare(['all_labels', 'mine', 'value_per_cost']) == 'mine'
    assert strategy_to_compare(['all_labels', 'greedy_oracle']) is None
    assert strategy_to_compare(['dt_task_env', 'mine'], 'mine') == 'mine'


@pytest.mark.parametrize(
    ('options', 'told'),
    [
        ([], ''),
        (
            ['--kernel-shape', 'rbf', '--class-balance', '0', '--cost-relevance', 'never', '--repeat-shown'],
            'no relevance query, the teacher shows also what is known, kernel shape rbf, class balance 0',
        ),
        (['--carry-labels'], 'labels are carried to all views of a thing'),
        (['--amplitude', '4', '--cost-relevance', '3'], 'cost 3.0 of a relevance query, amplitude 4'),
    ],
)
def test_the_page_says_what_is_varied_throughout(tmp_path: Path, options: list[str], told: str) -> None:
    """Otherwise results with other classifiers would pass for those of learners as they are."""
    play = [
        '--task',
        'prepare_lunch',
        '--condition',
        '2/2',
        '--samples',
        '1',
        '--strategy',
        'random_fsq',
        '--jobs',
        '1',
    ]
    assert main(['experiment', *play, *options, '--out', str(tmp_path)]) == 0
    page = (tmp_path / 'report.md').read_text()
    assert (f'**Varied throughout: {told}.**' if told else '') in page
    assert ('Varied throughout' in page) == bool(told)


def tiny_study(base: Variation, samples: tuple[int, ...]) -> Study:
    never = dataclasses.replace(base, repeats=False)
    plan = Plan(('prepare_lunch',), (Condition(12, 12),), ('u_sampling',), samples, never)
    return Study('tiny', 'Whether it may ask again', 'About a view.', 'asks again', {'Never asks again!': plan})


def test_studies_stand_beside_the_comparison(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page holds what the paper does not tell, about the same episodes as its tables."""
    monkeypatch.setitem(STUDIES, 'tiny', tiny_study)  # type: ignore[arg-type]
    arguments = ['--task', 'prepare_lunch', '--condition', '12/12', '--samples', '2', '--jobs', '1']
    command = ['experiment', *arguments, '--strategy', 'u_sampling', '--studies', 'tiny', '--out', str(tmp_path)]
    assert main(command) == 0
    page = (tmp_path / 'report.md').read_text()
    assert '### Whether it may ask again' in page
    for folder, label in (
        (tmp_path, 'asks again'),
        (tmp_path / 'studies' / 'tiny' / 'never_asks_again', 'Never asks again!'),
    ):
        rows = list(csv.DictReader((folder / 'episodes.csv').open()))
        accuracy = np.mean([float(row['final_accuracy']) for row in rows])
        (line,) = [line for line in page.splitlines() if line.startswith(f'| {label} |')]
        assert line.split(' | ')[1].startswith(f'{accuracy:.3f} ')
    assert '4 episodes, 0 failed' in capsys.readouterr().out


@pytest.mark.slow
def test_a_killed_experiment_goes_on_where_it_was(tmp_path: Path) -> None:
    """Otherwise a night's work would be lost, or its results be others than those of an undisturbed run."""
    arguments = ['--task', 'prepare_lunch', '--condition', 'C1', '10/20', '--samples', '4', '--jobs', '2']
    command = [sys.executable, '-m', 'al_questioner', 'experiment', *arguments]
    command += ['--strategy', 'random_fsq', 'dt_task_env']
    whole, killed = tmp_path / 'whole', tmp_path / 'killed'
    subprocess.run([*command, '--out', str(whole)], check=True, stdout=subprocess.DEVNULL, timeout=200)
    process = subprocess.Popen([*command, '--out', str(killed)], start_new_session=True, stdout=subprocess.DEVNULL)
    deadline = time.monotonic() + 200
    while not list(killed.glob('cells/**/*.json')):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    kept = {path: path.stat().st_mtime_ns for path in killed.glob('cells/**/*.json')}
    assert 0 < len(kept) < 16
    assert not (killed / 'episodes.csv').exists()
    subprocess.run([*command, '--out', str(killed)], check=True, stdout=subprocess.DEVNULL, timeout=200)
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    for name in ('episodes.csv', 'turns.csv'):
        assert (killed / name).read_text() == (whole / name).read_text()


def test_the_shipped_weights_are_recorded(tmp_path: Path) -> None:
    """Otherwise results with other weights would be mixed into a folder, and nobody could say which they were with."""
    arguments = ['--task', 'prepare_lunch', '--condition', '2/2', '--samples', '1', '--strategy', 'dt_task_env']
    command = ['experiment', *arguments, '--out', str(tmp_path)]
    assert main(command) == 0
    assert re.search('"dt_iros": {\\s+"discriminability"', (tmp_path / 'manifest.json').read_text())
    other = tmp_path / 'weights.yaml'
    other.write_text('weights: {discriminability: 1.0}\n')
    assert main([*command, '--weights-file', str(other)]) == 2


def test_unusable_arguments_end_with_status_2_and_one_line(tmp_path: Path, refusal: Callable[..., str]) -> None:
    """A typing error neither starts hours of work, nor ends in a traceback, nor publishes figures of other weights."""
    weights = config_dir() / 'weights' / 'value_per_cost.yaml'
    for arguments, reason in (
        (['--condition', 'C9'], 'C1, C2, C3, C4, or BUDGET/TURNS'),
        (['--condition', '5'], 'C1, C2, C3, C4, or BUDGET/TURNS'),
        (['--condition', '-5/40'], 'turns, not -5/40'),
        (['--condition', '5/10001'], 'BUDGET/TURNS of 1 to 10000 turns, not 5/10001'),
        (['--samples', '-3'], 'at most 100000, not -3'),
        (['--samples', '0'], 'must be at least 1'),
        (['--strategy', 'clever'], 'unknown strategy'),
        (['--compare', 'clever'], '--compare clever: not among the strategies that are played: u_sampling, dt_iros'),
        (['--compare', 'value_per_cost'], 'not among the strategies that are played'),
        (['--compare', 'all_labels', '--ceilings'], '--compare all_labels: it knows the truth'),
        (['--studies', 'magic'], 'unknown study'),
        (['--studies', 'repeats', 'repeats'], 'named twice'),
        (['--weights-file', 'missing.yaml'], 'cannot be read'),
        (['--backend', 'dask'], 'belong together'),
        (['--scheduler', 'tcp://127.0.0.1:1'], 'belong together'),
        (['--dataset', '/no/such/folder'], 'task prepare_lunch is simulated: it takes no dataset'),
        (['--task', 'uw_lunchbox'], 'needs a dataset'),
        (['--task', 'uw_lunchbox', '--dataset', '/no/such/folder'], '/no/such/folder'),
        (['--task', 'uw_lunchbox', '--dataset', str(tmp_path), '--studies', 'repeats'], str(tmp_path)),
        (['--strategy', 'random_fsq', '--weights-file', weights], '--weights-file holds no weights for any of the'),
        (['--strategy', 'dt_task_env', '--weights-file', weights], '--weights-file holds no weights for any of the'),
    ):
        assert reason in refusal('experiment', *arguments, '--out', tmp_path / 'x')
        assert not (tmp_path / 'x').exists()


def test_episodes_that_fail_alike_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a full disk would print a line for each of a thousand episodes."""

    def failing(cell: Cell, *_: object) -> None:
        raise RuntimeError('broken' if cell.sample else 'other')

    monkeypatch.setattr(playing, 'play_episode', failing)
    assert main(['experiment', *SMALL, '--strategy', 'random_fsq', 'dt_iros', '--out', str(tmp_path)]) == 1
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith('failed')]
    assert lines == [
        'failed: RuntimeError: other (prepare_lunch, 4/6, random_fsq, sample 0, and 1 more)',
        'failed: RuntimeError: broken (prepare_lunch, 4/6, random_fsq, sample 1, and 3 more)',
    ]


def test_an_interruption_says_what_is_there_and_the_next_run_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a user who stops a long run would not know whether anything of it is left."""
    original = playing.play_episode

    def interrupted(cell: Cell, *others: object) -> object:
        if cell.sample == 1:
            raise KeyboardInterrupt
        return original(cell, *others)  # type: ignore[arg-type]

    command = ['experiment', *SMALL, '--strategy', 'random_fsq', 'rarest_demo', '--out', str(tmp_path)]
    monkeypatch.setattr(playing, 'play_episode', interrupted)
    assert main(command) == 130
    printed = capsys.readouterr().out
    assert printed.endswith('interrupted, 2 of 6 episodes are finished; the same command goes on\n')
    monkeypatch.undo()
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert '6 episodes (2 from before), 0 failed' in printed
    # Not in a terminal, so a plain line now and then.
    assert '4 of 6 episodes, about 0:00:0' in printed


def test_weights_are_for_the_strategy_whose_features_they_name(tmp_path: Path) -> None:
    """Weights that were learnt from an expert are those that are played."""
    file = tmp_path / 'w.yaml'
    file.write_text('weights: {silence: 1000000000}\n')
    out = tmp_path / 'x'
    strategies = ['--strategy', 'dt_task_env', 'value_per_cost', '--condition', '4/3', '--samples', '1', '--jobs', '1']
    assert main(['experiment', *strategies, '--weights-file', str(file), '--out', str(out)]) == 0
    spent = {(row.cell.task, row.cell.strategy): row.spent for row in read_results(out).episodes}
    assert spent['prepare_lunch', 'value_per_cost'] == 0, 'with these weights nothing is worth a question'


def test_a_weights_file_of_a_constant_alone_is_whole(tmp_path: Path) -> None:
    """A file that the documentation calls whole is taken."""
    file, out = tmp_path / 'w.yaml', str(tmp_path / 'x')
    file.write_text('weights: {reach: 0.4}\n')
    tiny = ['--task', 'prepare_lunch', '--condition', '4/3', '--samples', '1', '--jobs', '1']
    command = ['experiment', '--strategy', 'value_per_cost', *tiny, '--weights-file', str(file), '--out', out]
    assert main(command) == 0
