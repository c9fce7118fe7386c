"""The `replay` executable, as its users call it."""

from __future__ import annotations

import dataclasses
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import yaml

from al_questioner.bags import BagWriter, LeftOut, Topic, read_bag, read_episodes
from al_questioner.cli import main
from al_questioner.commands.replay import command
from al_questioner.questioning.semantics import SEMANTICS
from shared.bags import SHIPPED as BAG

DEADLINE = 60.0


def test_checking_tells_of_the_first_divergence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a change of the questioner would go unnoticed."""
    assert main(['replay', str(BAG), '--check']) == 0
    assert '30 decisions, all as recorded' in capsys.readouterr().out.replace('\n', ' ')


def test_checking_names_what_differs_and_what_cannot_be_checked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a recording that is no good, or of which a part is, would be taken for a whole one."""
    (recorded,) = read_episodes(BAG)
    other = dataclasses.replace(recorded.started.settings, strategy='random_fsq')
    changed = dataclasses.replace(recorded, started=dataclasses.replace(recorded.started, settings=other))
    for episode, status, text in (
        (recorded, 1, 'short: cannot be checked: too short'),
        (changed, 1, f' was recorded (by version 1 of the method, this is version {SEMANTICS})\n'),
    ):

        def read(_: Path, left_out: list[LeftOut], episode: Any = episode) -> list[Any]:
            left_out.append(LeftOut('short', 'too short'))
            return [episode]

        monkeypatch.setattr(command, 'read_episodes', read)
        assert main(['replay', str(BAG), '--check']) == status
        printed = capsys.readouterr()
        assert text in printed.out + printed.err


def test_unusable_arguments_end_with_status_2_and_one_line(tmp_path: Path, refusal: Callable[..., str]) -> None:
    """Otherwise a typing error would play nothing, or for ever."""
    with BagWriter(tmp_path / 'foreign', [Topic('/a', 'stereo_msgs/msg/DisparityImage', False)]) as foreign:
        foreign.write('/a', bytes(8), 1)
    for arguments, reason in (
        ([str(tmp_path)], 'is no bag'),
        ([str(tmp_path / 'none')], 'none: there is no such bag'),
        *(([BAG, '--rate', rate], 'rate must be a number above 0') for rate in ('0', '-1', 'nan', 'inf')),
        ([BAG, '--rate', 'fast'], 'invalid float value'),
        ([BAG, '--clock', '-1'], 'must be at least 0'),
        ([BAG, '--clock', 'nan'], 'must be at least 0'),
        ([BAG, '--wait-for-subscribers', 'nan'], 'must be at least 0'),
        ([BAG, '--as-perception', '--start-paused'], '--start-paused has no meaning together with --as-perception'),
        ([BAG, '--check', '--as-perception'], '--as-perception has no meaning together with --check'),
        ([str(tmp_path / 'foreign'), '--as-perception'], 'no turn with its objects'),
        ([], 'required: BAG'),
    ):
        assert reason in refusal('replay', *arguments)


def test_unusable_ros_arguments_are_one_line_of_ours(capsys: pytest.CaptureFixture[str]) -> None:
    """The middleware's own log lines do not say whose arguments they are."""
    assert main(['replay', str(BAG), '--ros-args', '-r', '__ns:=/a b']) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert 'unusable ROS arguments' in line


def test_what_is_played_otherwise_than_recorded_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a page would show another episode than was recorded, without a word."""
    recorded = read_bag(BAG)
    with BagWriter(tmp_path / 'b', recorded.topics) as bag:
        for place, message in enumerate(recorded.messages):
            bag.write(message.topic, message.data, message.stamp - (3600 * 10**9 if place >= 50 else 0))
    metadata = yaml.safe_load((tmp_path / 'b' / 'metadata.yaml').read_text())
    topics = metadata['rosbag2_bagfile_information']['topics_with_message_count']
    split = {'name': '/events/write_split', 'type': 'rosbag2_interfaces/msg/WriteSplitEvent'}
    topics.append({'message_count': 0, 'topic_metadata': {**topics[0]['topic_metadata'], **split}})
    (tmp_path / 'b' / 'metadata.yaml').write_text(yaml.safe_dump(metadata))
    arguments = ['--rate', '1e9', '--wait-for-subscribers', '0', '--ros-args', '-r', '__ns:=/put_back']
    assert main(['replay', str(tmp_path / 'b'), *arguments]) == 0
    first, second, length, played = capsys.readouterr().out.splitlines()
    assert first == (
        'WARNING: /events/write_split: passed over, as the message type rosbag2_interfaces/msg/WriteSplitEvent'
        ' is not installed'
    )
    assert second.startswith("WARNING: the recorder's clock was put back by 3600.0 s meanwhile")
    assert length.endswith('163 messages, 2.1 s')
    assert played == '163 of 163 messages played, 30 of 30 turns'


@contextmanager
def terminal_replay(*arguments: str) -> Iterator[tuple[subprocess.Popen[bytes], int, int, list[Any]]]:
    """A replay at a terminal: its process, our end of the terminal, its own, and what the terminal was like before."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, 'COLUMNS': '120', 'TERM': 'xterm'}
    command = [sys.executable, '-m', 'al_questioner', 'replay', str(BAG), *arguments]
    command += ['--ros-args', '-r', f'__ns:=/keys_{os.getpid()}']
    before = termios.tcgetattr(theirs)
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment)
    try:
        yield process, ours, theirs, before
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(theirs)
        os.close(ours)


def test_keys_pause_step_and_quit() -> None:
    """At a terminal a paused replay plays turn by turn, and leaves the terminal as it was."""
    with terminal_replay('--start-paused', '--wait-for-subscribers', '0') as (process, ours, theirs, before):
        _read_until(ours, b'paused')
        for keys, shown in ((b'n', b'turn 1 '), (b'\x1b[C', b'turn 2 of 30'), (b'\x1b[A\x1b[A', b'rate 1.56')):
            os.write(ours, keys)
            _read_until(ours, shown)
        assert termios.tcgetattr(theirs) != before
        os.write(ours, b'q')
        _read_until(ours, b'2 of 30 turns')
        assert process.wait(DEADLINE) == 0
        assert termios.tcgetattr(theirs) == before


@pytest.mark.parametrize('number', [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_signal_leaves_the_terminal_as_it_was(number: signal.Signals) -> None:
    """Otherwise a shell would stay without echo after Ctrl-C."""
    with terminal_replay('--start-paused') as (process, ours, theirs, before):
        _read_until(ours, b'paused')
        process.send_signal(number)
        _read_until(ours, b'nothing was played')
        assert process.wait(DEADLINE) == 0
        assert termios.tcgetattr(theirs) == before


def _read_until(terminal: int, wanted: bytes) -> None:
    """Read what a terminal shows up to some text, which is all on one line."""
    seen, end = b'', time.monotonic() + DEADLINE
    while wanted not in seen:
        assert time.monotonic() < end, seen.decode(errors='replace')
        if select.select([terminal], [], [], 0.1)[0]:
            seen += os.read(terminal, 4096)
