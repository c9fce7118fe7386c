"""Tracks fail as the benchmark of labels that follow things says, and it measures both kinds of learners."""

import carry_labels
import numpy as np
import pytest

from shared.scenes import make_scene


class Table:
    """Ten things that all look different after each turn but the second."""

    def __init__(self):
        rng = np.random.default_rng(0)
        looks = [make_scene(rng.normal(size=(10, 3)), range(1, 11), ('a_1', 'a_2', 'b_1')) for _ in range(40)]
        self.scenes = [looks[0], *looks]

    def scene(self, turn):
        return self.scenes[turn - 1]

    def truth(self, turn):
        return {thing: f'thing {thing}' for thing in range(1, 11)}


def tracked(turns=40, **tracks):
    world = Table()
    failing = carry_labels.FailingTracks(world, carry_labels.Tracks(**tracks), 3)
    return world, failing, [failing.scene(turn) for turn in range(1, turns + 1)]


def test_whole_tracks_change_nothing():
    """A learner without and with failures would be compared in two worlds."""
    world, failing, scenes = tracked()
    for turn, scene in enumerate(scenes, start=1):
        assert scene.equals(world.scene(turn))
        assert failing.truth(turn) == world.truth(turn)
    assert scenes[0] is scenes[1]


@pytest.mark.parametrize(('tracks', 'share'), [({'breaks': 0.05}, 0.05), ({'breaks': 0.2}, 0.2), ({'swaps': 0.2}, 0.3)])
def test_tracks_fail_as_often_as_said(tracks, share):
    """Figures for one share would be told as those of another; an exchange confuses two things, one may be the same."""
    world, failing, scenes = tracked(**tracks)
    kept = []
    for turn in range(3, 41):
        truth = [failing.truth(each) for each in (turn - 1, turn)]
        now = scenes[turn - 1]
        np.testing.assert_array_equal(now.features, world.scene(turn).features)
        symbols = [f'thing {thing}' for thing in range(1, 11)]
        assert [truth[1][object_id] for object_id in now.object_ids] == symbols
        assert len(set(now.object_ids)) == 10
        kept += [truth[0].get(object_id) == symbol for object_id, symbol in truth[1].items()]
        if 'swaps' in tracks:
            assert set(truth[0]) == set(truth[1])
        else:
            # A new id is nobody's.
            assert all(truth[0].get(object_id, symbol) == symbol for object_id, symbol in truth[1].items())
    assert 1 - np.mean(kept) == pytest.approx(share, abs=0.06)
    assert failing.scene(7) is scenes[6]


def test_what_was_played_is_not_played_again(tmp_path, capsys, monkeypatch):
    """An hour of work would be lost with each interruption; the table tells both kinds of learners."""
    options = ['--task', 'prepare_lunch', '--strategy', 'u_sampling_fsq', '--turns', '12', '--samples', '1']
    arguments = [*options, '--breaks', '0', '--swaps', '--out', str(tmp_path / 'c.csv')]
    assert carry_labels.main(arguments) == 0
    first = capsys.readouterr().out
    assert 'whole: off' in first
    assert len((tmp_path / 'c.csv').read_text().splitlines()) == 2
    monkeypatch.setattr(carry_labels, 'play', None)
    assert carry_labels.main(arguments) == 0
    assert capsys.readouterr().out == first
