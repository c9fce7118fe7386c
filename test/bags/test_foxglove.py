"""Bags as Foxglove reads them: with its own libraries, from npm."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from al_questioner.bags import deserialize, read_bag, read_episodes
from shared.bags import SHIPPED

PACKAGES = ('@mcap/core@2.2.2', '@foxglove/rosmsg@5.0.5', '@foxglove/rosmsg2-serialization@3.1.0')
SCRIPT = Path(__file__).with_name('read_as_foxglove.mjs')
SECONDS_TO_INSTALL = 120


@pytest.fixture
def as_foxglove(tmp_path):
    """Reads a file as Foxglove does; without node, or a registry of its packages, there is nothing to read with."""
    if shutil.which('node') is None or shutil.which('npm') is None:
        pytest.skip('node and npm are not installed')
    folder = tmp_path / 'node'
    folder.mkdir()
    options = ['--prefix', str(folder), '--prefer-offline', '--no-audit', '--no-fund', '--silent']
    try:
        subprocess.run(['npm', 'install', *options, *PACKAGES], cwd=folder, check=True, timeout=SECONDS_TO_INSTALL)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        pytest.skip(f"npm cannot install Foxglove's packages ({error})")
    script = shutil.copy(SCRIPT, folder)

    def read(file):
        done = subprocess.run(['node', script, str(file)], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return read


@pytest.mark.slow
def test_foxglove_reads_what_was_recorded(as_foxglove, bags, tmp_path):
    """Otherwise people who look at a recording in Foxglove would see nothing, or something else."""
    bags.write_episode(tmp_path / 'b')
    found = as_foxglove(tmp_path / 'b' / 'b_0.mcap')
    bag = read_bag(tmp_path / 'b')
    assert found['profile'] == 'ros2'
    assert {name: topic['type'] for name, topic in found['topics'].items()} == {t.name: t.type for t in bag.topics}
    assert all(topic['hash'].startswith('RIHS01_') for topic in found['topics'].values())
    for name, topic in found['topics'].items():
        ours = [message for message in bag.messages if message.topic == name]
        assert [int(message['stamp']) for message in topic['messages']] == [message.stamp for message in ours]
        for theirs, message in zip(topic['messages'], ours, strict=True):
            content = deserialize(message).data
            assert theirs['data'] == (content if isinstance(content, str) else base64.b64encode(content).decode())
    (episode,) = read_episodes(tmp_path / 'b')
    for cloud, turn in zip(found['topics']['/robot/decision']['messages'], episode.turns, strict=True):
        assert [field['name'] for field in cloud['fields'][:3]] == ['x', 'y', 'z']
        points = np.frombuffer(base64.b64decode(cloud['data']), np.uint8).reshape(-1, cloud['point_step'])
        positions = points[:, :12].copy().view(np.float32)
        for place, action in zip(positions, turn.decision.candidates, strict=True):
            if action.object_id is None:
                assert np.isnan(place).all()
            else:
                row = turn.scene.object_ids.index(action.object_id)
                np.testing.assert_array_equal(place, turn.scene.positions[row])


@pytest.mark.slow
def test_foxglove_reads_the_shipped_bags(as_foxglove):
    """They were recorded before the names and types of today were written."""
    topics = as_foxglove(SHIPPED / 'expert_0.mcap')['topics']
    assert sum(len(topic['messages']) for topic in topics.values()) == 163
