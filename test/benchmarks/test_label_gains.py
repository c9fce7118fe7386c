"""Measured worth of labels, against really giving them and against sums by hand."""

from __future__ import annotations

import math

import pytest

from al_questioner.domain import NO_SYMBOL, random_stream
from al_questioner.questioning import Episode, make_strategy
from al_questioner.simulation import PerceivedWorld, WorldSpec, accuracy, episode_settings, load_task, turns
from shared.lunches import teacher_of


def test_a_gain_is_what_the_label_would_have_changed() -> None:
    """Otherwise the page would tell of labels that nobody could give."""
    from label_gains import Measuring

    world_spec = WorldSpec(load_task('kitchen_table'), 3, 3)
    world = PerceivedWorld(world_spec.open())
    settings = episode_settings(world_spec.task, 'random_fsq', 8, 6)
    strategy = Measuring(make_strategy('random_fsq', {}), world, 6)
    episode = Episode(settings, random_stream(3, 'learner'), strategy=strategy)
    playing = turns(episode, world, teacher_of(world_spec.task, 3))
    for _ in range(5):
        next(playing)
    assert strategy.found == []
    scene, (features, labels) = world.scene(6), world.test_set
    episode.concepts.observe(scene)
    before = accuracy(episode.concepts.predict_proba(features), labels, settings.symbols)
    positives, labelled = dict(episode.concepts.positives), episode.concepts.is_labelled(scene)
    row = int((~labelled).argmax())
    next(playing)
    found = strategy.found[0]
    assert len(strategy.found) == (~labelled).sum()
    assert found.symbol == world.truth(6)[scene.object_ids[row]]
    assert found.examples == positives.get(found.symbol, 0)

    again = Episode(settings, random_stream(3, 'learner'))
    replayed = turns(again, world, teacher_of(world_spec.task, 3))
    for _ in range(5):
        next(replayed)
    again.concepts.observe(scene)
    again.concepts.label(scene.object_ids[row], scene.features[row], found.symbol, 6)
    after = accuracy(again.concepts.predict_proba(features), labels, settings.symbols)
    assert found.gain == pytest.approx(after - before)


def test_sums_by_hand() -> None:
    """Otherwise a table would hold other groups than its headings say."""
    from label_gains import Label, area_under_curve, gain_rows

    labels = [
        Label('snack', 0, 0.0, 0.10, 0, 0),
        Label('snack', 0, 0.0, 0.20, 0, 0),
        Label('fruit', 3, 1.0, 0.01, 0, 0),
        Label('fruit', 2, 1.0, 0.01, 0, 0),
        Label('fruit', 2, 0.5, 9.0, 0, 0),
        Label(NO_SYMBOL, 0, 0.0, 0.0, 0, 0),
        Label(NO_SYMBOL, 0, 0.0, 0.0, 0, 0),
    ]
    assert gain_rows('t', labels) == [
        ['t, called something else', '+150.0 ± 50.0 (2)', '', '', '', ''],
        ['t, called right', '', '', '+10.0 ± 0.0 (2)', '', ''],
        ['t, of no symbol', '+0.0 ± 0.0 (2)', '', '', '', ''],
    ]
    assert area_under_curve([3, 1, 2, 1], [True, True, False, False]) == (1 + 1 + 0 + 0.5) / 4
    assert math.isnan(area_under_curve([1, 2], [True, True]))
