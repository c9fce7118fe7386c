"""Limits on how often something happens, on a clock that only the test moves."""

from __future__ import annotations

from al_questioner.support.rate_limiter import RepeatLimiter


def test_each_kind_passes_once_in_a_period() -> None:
    """Otherwise one fault ten times a second would fill the log, or hide another one."""
    throttle = RepeatLimiter(5, 1.0)
    passed = []
    for tick in range(30):
        now = tick / 10
        passed += [(kind, now) for kind in 'ab' if throttle.passes(kind, now)]
    assert passed == [(kind, at) for at in (0.0, 1.0, 2.0) for kind in 'ab']
    assert throttle.held_back() == 60 - 6
    assert throttle.held_back() == 0


def test_no_more_than_so_many_kinds_pass_in_a_period() -> None:
    """Otherwise a flood of garbage, each in its own way, would fill log and memory."""
    throttle = RepeatLimiter(5, 1.0)
    assert sum(throttle.passes(str(number), 0.0) for number in range(1000)) == 5
    assert throttle.passes('999', 1.0)
