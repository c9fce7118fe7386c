"""Things that stand still are asked about once, however the sensors wobble; what has changed is asked again."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from al_questioner.domain import Action, Answer, EpisodeSettings, InputError, Outcome, QueryKind, Scene, random_stream
from al_questioner.questioning import Episode
from shared.toys import Asks

TRUTH = {0: 'cup', 1: 'plate', 2: 'none', 3: 'cup'}
NAMES = ('colour_hue', 'size_height', 'size_width')
STRATEGIES = ('value_per_cost', 'u_sampling_fsq', 'farthest_fsq', 'random_fsq')
TURNS = 30


def an_episode(name: str, **options: object) -> Episode:
    settings = EpisodeSettings(symbols=('cup', 'plate'), budget=30, turns=TURNS, strategy=name)
    return Episode(settings, random_stream(0, 'learner'), **options)


def looks(noise: float, replaced_at: int = TURNS + 1, wrong: dict[int, float] | None = None) -> Iterator[Scene]:
    """Four still things; one of them is another one from some turn on; some turns have a wrong reading."""
    rng = np.random.default_rng(3)
    things = rng.random((4, 3))
    spread = things.std(axis=0)
    for turn in range(1, TURNS + 1):
        if turn == replaced_at:
            things = things.copy()
            things[1] += np.array([1.5, -1.5, 1.5]) * spread
        table = things + noise * spread * rng.normal(size=things.shape)
        if wrong and turn in wrong:
            table[3, 1] = wrong[turn]
        yield Scene(tuple(TRUTH), np.zeros((4, 3), np.float32), table.astype(np.float32), NAMES)


def asked_about(episode: Episode, scenes: Iterator[Scene], outcome: Outcome = Outcome.ANSWERED) -> list[int]:
    """Ids of the things that label queries were about, in order."""
    found = []
    for scene in scenes:
        query = episode.ask(scene).query
        if query is None:
            continue
        kind, content = query.action.kind, None
        if kind is QueryKind.LABEL:
            found.append(query.action.object_id)
        if outcome is Outcome.ANSWERED:
            shown = next(thing for thing in TRUTH if TRUTH[thing] == (query.action.symbol or 'cup'))
            content = {QueryKind.LABEL: TRUTH.get(query.action.object_id), QueryKind.DEMONSTRATION: shown}.get(
                kind, ('colour',)
            )
        episode.tell(Answer(query.query_id, f'a{query.turn}', 'me', outcome, content))
    return found


@pytest.mark.parametrize('strategy', STRATEGIES)
@pytest.mark.parametrize('noise', [0.0005, 0.005, 0.05])
def test_a_still_thing_is_asked_about_once(strategy: str, noise: float) -> None:
    asked = asked_about(an_episode(strategy), looks(noise))
    assert asked
    assert len(asked) == len(set(asked))


@pytest.mark.parametrize('noise', [0.0, 0.005])
def test_a_thing_that_was_replaced_is_asked_about_again(noise: float) -> None:
    asked = asked_about(an_episode('farthest_fsq'), looks(noise, replaced_at=15))
    assert sorted(asked) == [0, 1, 1, 2, 3]


def test_the_answer_at_the_first_look_of_a_small_change_is_about_what_was_seen() -> None:
    """Otherwise it would be learnt for the view before, and the question would come again once the change is sure."""
    asks = Asks(Action(QueryKind.LABEL, 0))
    episode = an_episode('farthest_fsq', strategy=asks)
    things = np.random.default_rng(3).random((5, 3)).astype(np.float32)
    changed = things.copy()
    changed[0, 1] += 0.6 * things[:, 1].std()
    for turn, table in enumerate([things, things, things, changed, changed, changed], start=1):
        asks.actions = (Action(QueryKind.LABEL, 0),) if turn == 4 else ()
        query = episode.ask(Scene(tuple(range(5)), np.zeros((5, 3), np.float32), table, NAMES)).query
        if query is not None:
            episode.tell(Answer(query.query_id, 'a', 'me', Outcome.ANSWERED, 'cup'))
    np.testing.assert_array_equal(episode.scene.features[0], changed[0])
    assert episode.concepts.labelled_ids(episode.scene) == (0,)


@pytest.mark.parametrize('outcome', [Outcome.SKIP, Outcome.UNKNOWN])
def test_what_was_skipped_is_not_asked_again_because_of_noise(outcome: Outcome) -> None:
    still, noisy = (asked_about(an_episode('value_per_cost'), looks(noise), outcome) for noise in (0.0, 0.01))
    assert len(noisy) == len(set(noisy))
    assert set(noisy) == set(still)


def test_a_question_waits_for_an_absent_teacher_although_the_sensors_wobble() -> None:
    episode = an_episode('farthest_fsq')
    for scene in looks(0.02):
        episode.ask(scene)
        if episode.awaits_answer:
            episode.time_out()
    assert [record.turn for record in episode.records] == [1]


@pytest.mark.parametrize('value', [1000.0, 65535.0, 3e38, -3e38])
@pytest.mark.parametrize('turn', [2, 14, TURNS])
def test_one_wrong_reading_changes_nothing_that_is_believed(value: float, turn: int) -> None:
    clean, spoiled = (an_episode('farthest_fsq') for _ in range(2))
    asked_about(clean, looks(0.005))
    asked_about(spoiled, looks(0.005, wrong={turn: value}))
    features = np.random.default_rng(9).random((50, 3))
    expected = clean.concepts.predict_proba(features)
    assert spoiled.concepts.predict_proba(features) == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize('value', [1000.0, 65535.0, 3e38])
@pytest.mark.parametrize('turn', [1, 2, 14, TURNS])
@pytest.mark.parametrize('n', [3, 4, 8])
def test_a_row_of_wrong_readings_costs_no_question_and_no_accuracy(value: float, turn: int, n: int) -> None:
    """Every feature of one thing reads what a sensor gives for nothing, once; all features tell the two symbols."""
    rng = np.random.default_rng(1)
    symbols = [('cup', 'plate')[thing % 2] for thing in range(n)]
    things = 0.3 * rng.random((n, 3)) + 0.6 * (np.arange(n) % 2)[:, None]
    episode, asked = an_episode('farthest_fsq'), []
    for now in range(1, TURNS + 1):
        table = things + 0.003 * rng.normal(size=things.shape)
        if now == turn:
            table[0] = value
        query = episode.ask(Scene(tuple(range(n)), np.zeros((n, 3)), table.astype(np.float32), NAMES)).query
        if query is not None:
            is_label = query.action.kind is QueryKind.LABEL
            asked += [query.action.object_id] if is_label else []
            content = symbols[query.action.object_id] if is_label else ('colour', 'size')
            episode.tell(Answer(query.query_id, f'a{now}', 'me', Outcome.ANSWERED, content))
    assert len(asked) == len(set(asked))
    held_out = 0.3 * rng.random((60, 3)) + 0.6 * (np.arange(60) % 2)[:, None]
    best = episode.concepts.predict_proba(held_out).argmax(axis=1)
    assert (best == np.arange(60) % 2).mean() == 1.0


def test_a_wrong_reading_of_a_still_thing_is_named() -> None:
    episode = an_episode('farthest_fsq')
    asked_about(episode, looks(0.005))
    scene = next(looks(0.005))
    assert episode.concepts.implausible_readings(scene) == []
    scene.features[2, 1] = 65535
    assert episode.concepts.implausible_readings(scene) == [(2, 'size_height', 65535.0)]


def test_a_number_fixes_the_tolerance() -> None:
    scene, other = list(looks(0.05))[:2]
    for tolerance, is_same in ((1e-3, False), (5.0, True)):
        episode = an_episode('farthest_fsq', view_tolerance=tolerance)
        episode.ask(scene)
        assert episode.concepts.is_unchanged(scene, other) == is_same
        assert episode.view_noise == {}


@pytest.mark.parametrize('tolerance', [-1.0, float('nan'), 'automatic'])
def test_a_tolerance_that_is_none_is_refused(tolerance: object) -> None:
    with pytest.raises(InputError, match='view_tolerance'):
        an_episode('farthest_fsq', view_tolerance=tolerance)
