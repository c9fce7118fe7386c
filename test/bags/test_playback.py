"""The schedule of a playback, with a clock that the test turns."""

from __future__ import annotations

from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.bags import BagMessage
from al_questioner.bags.playback import FASTEST, SLOWEST, Playback, without_steps_back
from al_questioner.domain import InputError
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.replayer import FASTER


def messages(*seconds, topic='/r/objects'):
    data = b'{"schema":"al_questioner/turn/1"}' if topic == '/r/turn' else b''
    return [BagMessage(topic, 'std_msgs/msg/String', 10**18 + round(s * SECOND), data) for s in seconds]


def stamps(found):
    return [(message.stamp - 10**18) / SECOND for message in found]


def test_messages_come_when_they_came():
    """Otherwise watchers would see another episode."""
    play = Playback(messages(0, 1, 1, 3))
    assert stamps(play.due(100.0)) == [0]
    assert play.wait(100.25) == pytest.approx(0.75)
    assert stamps(play.due(101.0)) == [1, 1]
    assert stamps(play.due(102.9)) == []
    assert not play.done
    assert stamps(play.due(103.0)) == [3]
    assert play.done
    assert play.wait(104.0) is None


def test_the_rate_divides_the_time():
    """Otherwise --rate would do nothing, or the opposite."""
    play = Playback(messages(0, 1, 3), rate=2.0)
    play.due(0.0)
    assert play.wait(0.0) == pytest.approx(0.5)
    assert stamps(play.due(0.5)) == [1]
    play.change_rate(0.5, 0.5)
    assert play.wait(0.5) == pytest.approx(2.0)
    assert play.stamp(1.5) == 10**18 + 2 * SECOND


def test_a_pause_loses_no_time():
    """Otherwise all messages of the pause would come at once after it."""
    play = Playback(messages(0, 1))
    play.due(0.0)
    play.pause(0.4)
    assert play.due(50.0) == []
    assert play.wait(50.0) is None
    assert play.elapsed(50.0) == pytest.approx(0.4)
    play.pause(60.0)
    assert play.wait(60.0) == pytest.approx(0.6)
    assert stamps(play.due(60.6)) == [1]


def test_a_step_is_a_turn_or_a_message():
    """Otherwise a person could not look at one turn after the other."""
    all_ = [*messages(0, topic='/r/turn'), *messages(0.1, 0.2), *messages(1.0, topic='/r/turn'), *messages(1.1)]
    play = Playback(all_, paused=True)
    assert play.due(0.0) == []
    assert stamps(play.step(0.0, turn=True)) == [0, 0.1, 0.2]
    assert play.elapsed(9.0) == pytest.approx(0.2)
    assert stamps(play.step(9.0, turn=False)) == [1.0]
    assert stamps(play.step(9.0, turn=True)) == [1.1]
    assert play.step(9.0, turn=True) == []
    assert play.done


def test_a_step_ends_with_the_turn_that_comes_next():
    """Messages before the first turn, or a part of a turn, make no step of their own."""
    all_ = [
        *messages(0, topic='/r/episode'),
        *messages(0.1, topic='/r/turn'),
        *messages(0.2),
        *messages(1.0, topic='/r/turn'),
        *messages(1.1, 1.2),
        *messages(2.0, topic='/r/turn'),
    ]
    play = Playback(all_, paused=True)
    assert stamps(play.step(0.0, turn=True)) == [0, 0.1, 0.2]
    assert play.turn == 1
    play = Playback(all_, paused=True)
    assert [stamps(play.step(0.0, turn=False)) for _ in range(2)] == [[0], [0.1]]
    assert stamps(play.step(0.0, turn=True)) == [0.2, 1.0, 1.1, 1.2]
    assert (play.turn, play.turns) == (2, 3)


def test_a_step_from_the_midst_of_playing_pauses_there():
    """Otherwise the rest of the bag would run away from the person who wanted to look at one turn."""
    play = Playback(messages(0, 1, 2, topic='/r/turn'))
    play.due(0.0)
    assert stamps(play.step(0.5, turn=True)) == [1]
    assert play.paused
    assert play.due(90.0) == []
    play.pause(100.0)
    assert play.wait(100.0) == pytest.approx(1.0)


def test_a_loop_begins_anew():
    """Otherwise --loop would stop, or play the end for ever."""
    play = Playback(messages(0, 1), loop=True)
    assert stamps(play.due(0.0) + play.due(1.0)) == [0, 1]
    assert not play.done
    assert play.wait(1.0) == 0.0
    assert stamps(play.due(1.5)) == [0]
    assert play.wait(1.5) == pytest.approx(1.0)


def test_a_paused_loop_stays_at_its_end_until_the_next_step():
    """Otherwise the last turn would not be shown as the last one."""
    play = Playback(messages(0, 1, topic='/r/turn'), loop=True, paused=True)
    for _ in range(2):
        play.step(0.0, turn=True)
    assert play.due(5.0) == []
    assert (play.position, play.turn, play.elapsed(5.0)) == (2, 2, 1.0)
    assert stamps(play.step(6.0, turn=True)) == [0]
    assert (play.position, play.turn, play.elapsed(6.0)) == (1, 1, 0.0)


def test_a_bag_of_one_moment_loops_without_end_but_not_at_once():
    """Otherwise one call would never return."""
    play = Playback(messages(0, 0), loop=True)
    assert len(play.due(0.0)) == 2
    assert len(play.due(0.0)) == 2


@pytest.mark.parametrize('rate', [0.0, -1.0, float('nan'), float('inf')])
def test_impossible_rates_are_refused(rate):
    """Otherwise a playback would stand still or run backwards."""
    with pytest.raises(InputError, match='rate must be a number above 0'):
        Playback(messages(0), rate)
    with pytest.raises(InputError, match='nothing to play'):
        Playback([])


def test_the_highest_rate_plays_everything_at_once():
    """Otherwise the time would become infinite, and the replay would end with a traceback."""
    play = Playback(messages(0, 1, 2), rate=1e308)
    play.due(0.0)
    assert stamps(play.due(1.0)) == [1, 2]
    assert play.elapsed(1.0) == 2.0


@pytest.mark.parametrize('factor', [FASTER, 1 / FASTER])
def test_a_key_that_is_held_down_changes_the_rate_within_bounds(factor):
    """Otherwise the rate would become 0 or infinite, from which no key leads back."""
    play = Playback(messages(0, 1))
    play.due(0.0)
    for _ in range(5000):
        play.change_rate(0.0, factor)
    assert play.rate == (FASTEST if factor > 1 else SLOWEST)
    play.change_rate(0.0, 1 / factor)
    assert SLOWEST < play.rate < FASTEST


def test_a_rate_beyond_the_bounds_of_the_keys_only_comes_nearer():
    """Otherwise a key for slower would make a very slow replay faster."""
    play = Playback(messages(0, 1), rate=1e-6)
    play.change_rate(0.0, 1 / FASTER)
    assert play.rate == 1e-6
    play.change_rate(0.0, FASTER)
    assert play.rate == pytest.approx(1.25e-6)


def test_a_change_of_the_rate_before_the_first_message_starts_no_time():
    """Otherwise the wait for listeners would count as playing time."""
    play = Playback(messages(0, 1))
    play.change_rate(0.0, 2.0)
    assert play.elapsed(50.0) == 0.0
    assert stamps(play.due(50.0)) == [0]
    assert play.wait(50.0) == pytest.approx(0.5)


@given(
    gaps=st.lists(st.floats(0.001, 5), min_size=1, max_size=20),
    rate=st.floats(0.1, 10),
    pauses=st.lists(st.tuples(st.floats(0, 3), st.floats(0, 100)), max_size=10),
)
def test_the_spacing_is_the_recorded_one_divided_by_the_rate_and_pauses_do_not_count(gaps, rate, pauses):
    """The replay is neither faster nor slower than asked for."""
    times = [0.0, *accumulate(gaps)]
    play, now, paused_for = Playback(messages(*times), rate), 0.0, 0.0
    play.due(now)
    at = [0.0]
    waits = iter(pauses)
    while not play.done:
        until, length = next(waits, (float('inf'), 0.0))
        wait = play.wait(now)
        now += min(wait, until)
        if until < wait:
            play.pause(now)
            now += length
            paused_for += length
            play.pause(now)
        at += [now - paused_for] * len(play.due(now + 1e-6))
    assert at == pytest.approx([time / rate for time in times], abs=1e-3)


@given(
    gaps=st.lists(st.floats(0, 2), min_size=1, max_size=20),
    looks=st.lists(st.tuples(st.floats(0, 1), st.sampled_from(['look', 'pause', 'turn', 'step', 'up', 'down']))),
)
def test_whatever_is_pressed_every_message_comes_once_and_in_order(gaps, looks):
    """Otherwise a watcher would miss part of the demonstration, or see it twice."""
    times = list(accumulate(gaps))
    all_ = [*messages(*times[::2], topic='/r/turn'), *messages(*times[1::2])]
    all_.sort(key=lambda message: message.stamp)
    play, now, seen = Playback(all_), 0.0, []
    for passed, key in looks:
        now += passed
        if key == 'pause':
            play.pause(now)
        elif key in ('up', 'down'):
            play.change_rate(now, FASTER if key == 'up' else 1 / FASTER)
        elif key in ('turn', 'step'):
            seen += play.step(now, turn=key == 'turn')
        seen += play.due(now)
    if play.paused:
        play.pause(now)
    while not play.done:
        now += play.wait(now) + 1e-6
        seen += play.due(now)
    assert seen == all_


def test_what_others_say_on_a_topic_of_that_name_is_no_turn():
    """Otherwise a step would end wherever a chat robot speaks."""
    play = Playback([*messages(0, topic='/r/turn'), *messages(1, topic='/chat/turn'), *messages(2, topic='/r/turn')])
    assert stamps(play.step(0.0, turn=True)) == [0, 1]
    assert (play.turn, play.turns) == (1, 2)


@pytest.mark.parametrize(
    ('recorded', 'played'),
    [
        ([0, 1, 2], [0, 1, 2]),
        ([0, 1, 0.999, 1.5], [0, 1, 1, 1.5]),
        ([10, 11, 3, 4, 4.5], [10, 11, 11, 12, 12.5]),
        ([10, 11, 3, 4, 0, 1], [10, 11, 11, 12, 12, 13]),
        ([0, 1, 100, 101], [0, 1, 100, 101]),
    ],
)
def test_a_clock_that_was_put_back_is_played_on(recorded, played):
    """Messages keep their recorded order, so that the last ones are not played first."""
    assert stamps(without_steps_back(messages(*recorded))) == played
