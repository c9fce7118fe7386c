"""A dask cluster gives the numbers of local processes."""

from __future__ import annotations

from pathlib import Path

import pytest

from al_questioner.cli import main
from al_questioner.experiments import running

SMALL = ['--task', 'prepare_lunch', '--condition', '3/4', '--strategy', 'random_fsq', 'dt_task_env', '--samples', '2']


def experiment(out: Path, *options: str) -> int:
    status: int = main(['experiment', *SMALL, *options, '--out', str(out)])
    return status


@pytest.mark.slow
def test_a_cluster_of_two_workers_gives_the_same_tables(tmp_path: Path) -> None:
    """Otherwise a study on a cluster would not be the one that others can repeat."""
    distributed = pytest.importorskip('dask.distributed', reason='dask is not installed: pip install .[cluster]')
    assert experiment(tmp_path / 'local', '--jobs', '1') == 0
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host='127.0.0.1', dashboard_address=None, processes=True
    ) as cluster:
        assert experiment(tmp_path / 'dask', '--backend', 'dask', '--scheduler', cluster.scheduler_address) == 0
    for name in ('episodes.csv', 'turns.csv'):
        assert (tmp_path / 'dask' / name).read_text() == (tmp_path / 'local' / name).read_text()


@pytest.mark.slow
def test_a_cluster_that_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a mistyped address would wait for ever, or end in a traceback."""
    pytest.importorskip('dask.distributed', reason='dask is not installed: pip install .[cluster]')
    assert experiment(tmp_path, '--backend', 'dask', '--scheduler', 'tcp://127.0.0.1:1') == 2
    error = capsys.readouterr().err
    assert 'no dask scheduler answers at tcp://127.0.0.1:1' in error
    assert error.count('\n') == 1


@pytest.mark.slow
def test_a_cluster_without_workers_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise people would wait for ever."""
    distributed = pytest.importorskip('dask.distributed', reason='dask is not installed: pip install .[cluster]')
    monkeypatch.setattr(running, 'WAIT_SECONDS', 1)
    with distributed.LocalCluster(n_workers=0, host='127.0.0.1', dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        assert experiment(tmp_path / 'dask', '--backend', 'dask', '--scheduler', address) == 1
    assert f'experiment: {address}: no worker came within 1 s' in capsys.readouterr().err
