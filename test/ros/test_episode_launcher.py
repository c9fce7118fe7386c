"""The graph of processes that a demo brings up, held against what may happen to them."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from al_questioner.bags import read_episodes
from al_questioner.ros.episode_launcher import EpisodeLauncher

DEADLINE = 60.0
WORLD = {'task': 'prepare_lunch', 'seed': 4}


@pytest.mark.slow
def test_a_recorder_may_end_before_the_last_turn_was_watched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise on a busy machine a demo would end in failure, with its recording complete."""
    started: list[subprocess.Popen[bytes]] = []
    popen = subprocess.Popen

    def start(*arguments: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(popen(*arguments, **options))
        return started[-1]

    monkeypatch.setattr('al_questioner.ros.episode_launcher.subprocess.Popen', start)
    seen = []

    def watch(turn: int, _: object) -> None:
        end = time.monotonic() + DEADLINE
        # The return code is set when the graph has looked at the process.
        while turn == 3 and started[0].returncode is None:
            assert time.monotonic() < end, 'the recorder did not end'
            time.sleep(0.02)
        seen.append(turn)

    EpisodeLauncher(
        namespace=f'graph_{os.getpid()}',
        episode_id='e1',
        parameters={
            'perception': WORLD,
            'teacher': WORLD,
            'learner': {**WORLD, 'strategy': 'random_fsq', 'budget': 2.0, 'turns': 3, 'episode_id': 'e1'},
        },
        one_process=False,
        log_dir=tmp_path,
        patience=DEADLINE,
        bag=tmp_path / 'bag',
    ).play(watch)
    assert seen[-1] == 3
    (episode,) = read_episodes(tmp_path / 'bag')
    assert len(episode.turns) == 3
