"""Settings that no episode can have."""

from __future__ import annotations

import pytest

from al_questioner.domain import Costs, EpisodeSettings, SettingsError


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'budget': -1.0}, 'budget must be 0 or more, not -1'),
        ({'budget': float('nan')}, 'budget must be a finite number, not nan'),
        ({'budget': float('inf')}, 'budget'),
        ({'turns': 0}, 'turns must be 1 or more, not 0'),
        ({'change_interval': 0}, 'change_interval'),
        ({'symbols': ('a',)}, 'at least two'),
        ({'symbols': ('a', 'a')}, 'distinct'),
        ({'symbols': ('a', 'none')}, 'none'),
        ({'budget': 1e308}, r'budget must lie in \[0, 1e\+12\], not 1e\+308'),
        ({'costs': Costs(demonstration=1e200)}, r'costs.demonstration must lie in \[0, 1e\+12\]'),
        ({'costs': Costs(relevance=-1.0)}, 'costs.relevance must be 0 or more, not -1'),
        ({'costs': Costs(relevance=float('inf'))}, 'costs.relevance must be a finite number'),
        ({'costs': Costs(relevance='never')}, "costs.relevance must be a number or None, not 'never'"),
        ({'amplitude': 0.0}, 'amplitude'),
        ({'amplitude': 1e200}, r'amplitude must lie in \[0.001, 1000\], not 1e\+200'),
        ({'length_scale': 1e200}, r'length_scale must lie in \[0.001, 1000\] standard deviations, not 1e\+200'),
        ({'length_scale': 1e-200}, r'length_scale must lie in \[0.001, 1000\] standard deviations, not 1e-200'),
        ({'length_scale': 0.0}, 'length_scale'),
        ({'length_scale': float('nan')}, 'length_scale'),
        ({'weights': {'gain': -1e200}}, r'the weight of gain must lie in \[-1e\+09, 1e\+09\]'),
        ({'weights': {'remaining_time': float('nan')}}, 'the weight of remaining_time must be a finite number'),
    ],
)
def test_settings_out_of_range_are_refused(changes: dict[str, object], reason: str) -> None:
    """Otherwise an episode would be played under limits that make no sense."""
    with pytest.raises(SettingsError, match=reason):
        EpisodeSettings(**{'symbols': ('a', 'b'), 'budget': 1.0, 'turns': 1, 'strategy': 'random_fsq', **changes})


def test_a_program_may_give_more_than_a_command_line() -> None:
    """Programs, and logs, from the time without these limits keep working."""
    EpisodeSettings(('a', 'b'), 1.0, turns=20_000, strategy='random_fsq', change_interval=20_000)
