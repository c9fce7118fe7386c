"""Sessions of earlier versions, whose learners could tune their kernel: read, checked and gone on with.

`shared/tuned` holds the log of one and the bag that `session --bag` made of it, both written by the last version that
tuned (commit e51c0da): u_sampling_fsq with `tune_every` 2 in 7 of 10 turns, an answer corrected in turn 3, which nobody
answered.
"""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from al_questioner.bags import read_episodes
from al_questioner.bags.from_session import write_bag
from al_questioner.commands.session.export import session_document
from al_questioner.domain import Answer, Outcome
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.encoding import Encoder
from al_questioner.event_log.events import EpisodeStarted, KernelTuned, kind_of
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.state_documents import episode_members
from al_questioner.event_log.summary import SessionSummary, summarise_session
from al_questioner.simulation import PerceivedWorld, WorldSpec, accuracy, episode_settings
from shared.durable_sessions import TASK, WORLD, durable_of, episode_started, events, play_turns

TUNED = Path(__file__).parents[1] / 'shared' / 'tuned'
FOUND = (63.60811643358753, 8.385407968345813)
"""Amplitude and length scale after turn 6, as the version that tuned told them."""
WANTED = EpisodeStarted(
    'e1', episode_settings(TASK, 'u_sampling_fsq', 10.0, 10, kernel_shape='rbf', class_balance=0.0), 4, 1e-3, WORLD, '9'
)
"""The episode, as it is asked for today."""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return Path(shutil.copytree(TUNED / 'log', tmp_path / 'log'))


def summary_of(folder: Path) -> SessionSummary:
    return summarise_session(folder, read_log(folder))


def resumed(folder: Path) -> DurableEpisode:
    durable = durable_of(WANTED, SessionLog(folder))
    durable.start()
    return durable


def tuned_in(events: object) -> list[int]:
    return [event.turn for event in events if isinstance(event, KernelTuned)]


def kernel_of(durable: DurableEpisode) -> tuple[float, float]:
    kernel = durable.episode.concepts.kernel
    return kernel.amplitude, kernel.length_scale


@pytest.fixture(scope='module')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


def test_a_tuned_session_is_whole_and_tells_its_kernel(log: Path, world: PerceivedWorld) -> None:
    """Otherwise what people taught would be called damaged, since its decisions do not follow from another kernel."""
    summary = summary_of(log)
    assert summary.fault is None
    assert summary.turns_over == 7
    assert tuned_in(event for _, event in summary.events) == [2, 4, 6]
    document = session_document(summary)
    assert tuple(document['kernel'].values()) == pytest.approx(FOUND, rel=1e-6)
    features, labels = world.test_set
    right = accuracy(summary.episode.concepts.predict_proba(features), labels, TASK.symbols)
    # Another version of OpenCV draws other pictures than those in the log, of which no accuracy can be told.
    assert document['accuracy'][-1:] == [right] or 'scene' in document['no_accuracy_because']


def test_a_tuned_session_goes_on_with_its_last_kernel(log: Path, world: PerceivedWorld) -> None:
    """Otherwise nobody could go on teaching that robot, or it would tune on although no learner does."""
    durable = resumed(log)
    assert kernel_of(durable) == pytest.approx(FOUND, rel=1e-6)
    assert play_turns(durable, world, 3)
    assert durable.episode.done
    # The length scale follows the number of features in use, if a feature subset query is answered meanwhile.
    assert kernel_of(durable)[0] == pytest.approx(FOUND[0], rel=1e-6)
    durable.close()
    assert tuned_in(events(log)) == [2, 4, 6]
    assert summary_of(log).fault is None


def test_a_tuned_session_can_be_corrected(log: Path, world: PerceivedWorld) -> None:
    """The kernel follows from the labels: without one of them it was another one in its time."""
    durable = resumed(log)
    durable.take(Answer('q2', 'c2', 'anna', Outcome.UNKNOWN, replaces='q2/scripted'))
    assert kernel_of(durable) != pytest.approx(FOUND, rel=1e-3)
    again = resumed_copy(log)
    np.testing.assert_array_equal(
        durable.episode.concepts.predict_proba(world.scene(1).features),
        again.episode.concepts.predict_proba(world.scene(1).features),
    )
    durable.close()


def resumed_copy(folder: Path) -> DurableEpisode:
    """Return the session of another process, after what is on the disk by now."""
    return resumed(Path(shutil.copytree(folder, folder.with_name('copy'), ignore=shutil.ignore_patterns('*.lock'))))


@pytest.mark.parametrize('turns', [0, 3])
def test_its_bag_tells_when_it_was_tuned(log: Path, tmp_path: Path, world: PerceivedWorld, turns: int) -> None:
    """Otherwise the bag of a session that is gone on with would not lead to its decisions."""
    durable = resumed(log)
    play_turns(durable, world, turns)
    durable.close()
    write_bag(summary_of(log), tmp_path / 'bag')
    (recorded,) = read_episodes(tmp_path / 'bag')
    assert len(recorded.turns) == 7 + turns
    assert tuned_in(recorded.events) == [2, 4, 6]
    assert first_divergence(recorded.started, recorded.events) is None


def test_a_learner_that_goes_on_tells_when_it_was_tuned(log: Path) -> None:
    """Otherwise what is recorded from then on would be read as if it had been tuned in every second turn, or never."""
    durable = resumed(log)
    members = episode_members(durable.started, ('a',), durable.episode.tuned_turns)
    assert members['tuned_turns'] == [2, 4, 6]
    assert 'tune_every' not in members
    assert 'tuned_turns' not in episode_members(durable.started, ('a',))
    durable.close()


def test_a_tuned_bag_is_read_and_leads_to_its_decisions() -> None:
    """The recordings of earlier versions stay of use: to check them, to train from them, to look at them."""
    (recorded,) = read_episodes(TUNED / 'bag')
    assert tuned_in(recorded.events) == [2, 4, 6]
    assert first_divergence(recorded.started, recorded.events) is None
    others = [event for event in recorded.events if not isinstance(event, KernelTuned)]
    assert first_divergence(recorded.started, others) is not None, 'the recording would show no tuning'


def test_a_log_that_tells_it_was_never_tuned_is_gone_on_with(tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise every session of an earlier version would be refused for a setting that nobody has any more."""
    started = episode_started()
    members = {**started.members(), 'tune_every': 0}
    log = SessionLog(tmp_path / 'log')
    log.append((kind_of(started), json.dumps(members).encode()))
    log.close()
    durable = durable_of(started, SessionLog(tmp_path / 'log'))
    durable.start()
    play_turns(durable, world, 2)
    durable.close()
    assert summary_of(tmp_path / 'log').fault is None
    assert Encoder().encode(durable.started) == Encoder().encode(started)
