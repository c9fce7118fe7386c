"""A machine that plays a bag: when it begins, what it publishes when, and when it must not."""

from __future__ import annotations

from typing import Any

import pytest

from al_questioner.bags import BagMessage, read_bag
from al_questioner.bags.playback import Playback
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.effects import AwaitArrival, Effect, Publish
from al_questioner.protocol.events import TimerFired
from al_questioner.protocol.replayer import (
    CLOCK,
    FASTER,
    KEY,
    LINGER,
    POLL,
    SETTLED,
    TICK,
    ReplayMachine,
    Rival,
    Surroundings,
)
from shared.bags import SHIPPED
from shared.machine_driver import Driver

BAG = read_bag(SHIPPED)
BEGIN, END = BAG.messages[0].stamp, BAG.messages[-1].stamp
SPAN = (END - BEGIN) / SECOND


class Replay(Driver):
    """A replay of the bag that ships, among listeners and others.

    Attributes:
        listeners: number of listeners.
        rival: another node that publishes turns.
        over_at_arrival: whether the replay was over when it waited for its last messages to arrive.
    """

    def __init__(
        self, listeners: int = 0, patience: float = 60.0, clock_period: float | None = None, **playback: Any
    ) -> None:
        self.listeners = listeners
        self.rival: Rival | None = None
        self.over_at_arrival: list[bool] = []
        self.playback = Playback(BAG.messages, **playback)
        surroundings = Surroundings(lambda: self.listeners, lambda: self.rival)
        self.replay = ReplayMachine(self.playback, surroundings, patience, clock_period)
        super().__init__(self.replay, self.watch)
        self.start()

    def watch(self, effect: Effect) -> None:
        """Note what was so when the replay waited for arrivals."""
        if isinstance(effect, AwaitArrival):
            assert effect.seconds == LINGER
            self.over_at_arrival.append(self.replay.over)

    def press(self, *keys: str) -> None:
        """Press keys."""
        for key in keys:
            self.enter(KEY, key)

    @property
    def played(self) -> list[tuple[float, BagMessage]]:
        """Time and message of all that was published."""
        said = [(at, effect) for at, effect in self.done if isinstance(effect, Publish) and effect.topic != CLOCK]
        assert all(effect.topic == effect.content.topic for _, effect in said)
        return [(at, effect.content) for at, effect in said]


def test_everything_is_played_once_in_its_order_at_its_time() -> None:
    """Otherwise a page or a second learner would see another demonstration."""
    replay = Replay(listeners=1, rate=2.0)
    replay.pass_until(SETTLED + SPAN / 2 + 1.0)
    assert [message for _, message in replay.played] == list(BAG.messages)
    began = replay.played[0][0]
    for at, message in replay.played:
        assert at - began == pytest.approx((message.stamp - BEGIN) / SECOND / 2, abs=2e-4)
    assert replay.replay.over
    assert replay.replay.failure is None


def test_a_replay_is_not_over_before_its_last_messages_have_arrived() -> None:
    """Otherwise they would be lost with the process that published them."""
    replay = Replay(rate=1000.0)
    replay.press('s', ' ')
    replay.pass_until(1.0)
    assert replay.over_at_arrival == [False]
    assert replay.replay.over
    assert replay.status == 'the end of the bag'


def test_nothing_is_played_before_those_who_listen_have_come() -> None:
    """A subscriber that is started together with the replay gets the first decisions."""
    replay = Replay()
    replay.pass_until(10.0)
    assert replay.status == 'waiting for listeners'
    replay.listeners = 1
    replay.pass_until(10.5)
    replay.listeners = 2
    replay.pass_until(10.5 + SETTLED)
    assert not replay.replay.started
    replay.pass_until(10.5 + SETTLED + 2 * POLL)
    assert replay.status == 'playing'
    assert replay.played[0][1] == BAG.messages[0]


def test_listeners_are_awaited_only_so_long() -> None:
    """Otherwise a replay of which only the clock is wanted would never begin."""
    replay = Replay(patience=5.0)
    replay.pass_until(5.0 - POLL)
    assert not replay.replay.started
    replay.pass_until(5.0 + POLL)
    assert replay.replay.started
    assert Replay(patience=0.0).replay.started


def test_a_key_begins_without_listeners() -> None:
    """Otherwise a person would have to wait for listeners that are not to come."""
    replay = Replay()
    replay.press('s')
    assert [message for _, message in replay.played] == [BAG.messages[0]]
    assert replay.playback.paused
    replay.press('x', 'up')
    assert replay.playback.rate == FASTER
    replay.press('down')
    assert replay.playback.rate == 1.0
    replay.pass_until(10.0)
    assert replay.playback.position == 1
    replay.press(' ')
    replay.pass_until(11.0 + SPAN)
    assert [message for _, message in replay.played] == list(BAG.messages)
    assert replay.replay.over


def test_an_unknown_key_does_nothing() -> None:
    """Otherwise a key that is hit by chance would begin the replay."""
    replay = Replay()
    replay.press('x')
    assert not replay.replay.started


def test_a_step_is_a_turn_of_the_learner() -> None:
    """Otherwise a person could not look at one turn after the other."""
    replay = Replay(paused=True)
    for turn, key in enumerate(('right', 'n', 'n'), start=1):
        replay.press(key)
        assert sum(message.topic.endswith('/turn') for _, message in replay.played) == turn
    assert replay.playback.turn == 3


def test_a_pause_stops_it_and_a_second_one_goes_on() -> None:
    """Otherwise what a person looks at would run away."""
    replay = Replay()
    replay.press('up', ' ')
    before = len(replay.played)
    replay.pass_until(100.0)
    assert len(replay.played) == before
    replay.press(' ')
    replay.pass_until(101.0 + SPAN)
    assert replay.replay.over


def test_quitting_ends_it_at_once() -> None:
    """Otherwise a person would have to see a long bag to its end."""
    replay = Replay()
    replay.press('up', 'q')
    before = len(replay.played)
    replay.press('s', ' ')
    replay.pass_until(100.0)
    assert len(replay.played) == before
    assert replay.replay.over
    assert replay.over_at_arrival == []


RIVAL = Rival('/robot/learner', '/robot/turn')
YIELDS = '/robot/learner publishes on /robot/turn, too; keep the replay apart: --ros-args -r __ns:=/replay'


def test_a_replay_does_not_begin_on_the_names_of_a_live_learner() -> None:
    """Otherwise a recorded turn could replace a live one before perception sees it: the robot waits for ever."""
    replay = Replay(listeners=1)
    replay.rival = RIVAL
    replay.pass_until(POLL)
    assert str(replay.replay.failure) == YIELDS
    assert replay.replay.over
    replay.press('n')
    replay.pass_until(10.0)
    assert replay.played == []
    assert not replay.replay.started


def test_a_replay_ends_when_a_learner_takes_its_names() -> None:
    """Otherwise a robot that is started beside a paused replay would be disturbed as soon as the replay goes on."""
    replay = Replay(paused=True)
    replay.press('n')
    before = len(replay.played)
    replay.pass_until(20.0)
    assert not replay.replay.over
    replay.rival = RIVAL
    replay.pass_until(20.0 + POLL)
    assert str(replay.replay.failure) == YIELDS
    replay.press(' ')
    replay.pass_until(40.0)
    assert len(replay.played) == before


def test_a_learner_that_comes_after_the_end_is_no_failure() -> None:
    """Otherwise the status of a replay would hang on who is started after it."""
    replay = Replay()
    replay.press('up', 'q')
    replay.rival = RIVAL
    replay.pass_until(1.0)
    assert replay.replay.failure is None


def test_the_recorded_time_is_told_at_its_period_to_the_recorded_end() -> None:
    """Otherwise use_sim_time would stand still, or run late by what the telling takes."""
    replay = Replay(clock_period=0.02)
    replay.press(' ', ' ')
    replay.pass_until(SPAN + 1.0)
    told = [(at, effect.content) for at, effect in replay.done if isinstance(effect, Publish) and effect.topic == CLOCK]
    stamps = [stamp for _, stamp in told]
    assert stamps == sorted(stamps)
    assert (stamps[0] - BEGIN, stamps[-1]) == (pytest.approx(0.02 * SECOND), END)
    assert len(told) == pytest.approx((SPAN + 1.0) / 0.02, abs=2)


def test_a_late_tick_does_not_put_the_next_ones_off() -> None:
    """Otherwise the clock would fall behind its rate on a busy machine."""
    replay = Replay(clock_period=0.1)
    for rings, next_ring in ((0.13, 0.2), (0.2, 0.3), (0.57, 0.6)):
        replay.seconds = rings
        replay.tell(TimerFired(TICK))
        assert replay.timers[TICK] == pytest.approx(next_ring)
    assert len(replay.published(CLOCK)) == 3


def test_the_last_stamp_is_told_however_rarely_the_time_is() -> None:
    """Otherwise those who wait for the end of the recording would wait for ever."""
    replay = Replay(clock_period=1000.0, rate=1000.0)
    replay.press('up')
    replay.pass_until(SPAN)
    assert replay.published(CLOCK) == [END]


def test_no_time_is_told_unless_wanted() -> None:
    """Otherwise every node of the robot would live in the past."""
    replay = Replay(rate=1000.0)
    replay.press('up')
    replay.pass_until(SPAN)
    assert replay.replay.over
    assert replay.published(CLOCK) == []


def test_a_loop_begins_again() -> None:
    """Otherwise a show would end."""
    replay = Replay(loop=True, rate=SPAN / 0.5)
    replay.press('up')
    replay.pass_until(2.0)
    assert len(replay.played) > 2 * len(BAG.messages)
    assert not replay.replay.over
