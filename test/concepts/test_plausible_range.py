"""A reading far from all others does not move the scale of its feature; what is merely rare does."""

from __future__ import annotations

import numpy as np
import pytest

from al_questioner.concepts import Standardiser
from al_questioner.concepts.plausible_range import PlausibleRange

WRONG = [1000.0, 65535.0, 3e38, -999.0, -3.4e38]


def readings_of(n: int) -> np.ndarray:
    return np.random.default_rng(0).random((n, 3))


def standardiser_of(readings: np.ndarray, batches: int = 1) -> Standardiser:
    """Return the statistics of readings that came in this number of batches."""
    standardiser = Standardiser(readings.shape[1])
    for batch in np.split(readings, batches):
        standardiser.update(batch)
    return standardiser


def limits_of(readings: np.ndarray) -> PlausibleRange:
    limits = PlausibleRange(readings.shape[1])
    limits.add(readings)
    return limits


@pytest.mark.parametrize('wrong', WRONG)
@pytest.mark.parametrize('row', [0, 11, 39])
def test_one_wrong_reading_leaves_the_scale_as_it_is_without_it(wrong: float, row: int) -> None:
    clean = readings_of(40)
    spoiled = clean.copy()
    spoiled[row, 1] = wrong
    standardiser = standardiser_of(spoiled, 4)
    others = np.delete(clean[:, 1], row)
    assert standardiser.mean[1] == pytest.approx(others.mean())
    assert standardiser.scale[1] == pytest.approx(others.std())
    assert standardiser.plausible_range.is_limited.tolist() == [False, True, False]


def test_a_wrong_reading_is_taken_for_the_end_of_the_range() -> None:
    spoiled = readings_of(40)
    spoiled[5, 0] = 65535
    highest = np.delete(spoiled[:, 0], 5).max()
    found = standardiser_of(spoiled).transform(np.array([[65535.0, 0.5, 0.5], [highest, 0.5, 0.5]]))
    assert found[0].tolist() == found[1].tolist()


def test_a_wrong_reading_among_the_first_ones_shows_once_more_is_known() -> None:
    standardiser = standardiser_of(np.array([[0.2], [1000.0]]))
    standardiser.update(readings_of(30)[:, :1])
    assert standardiser.scale[0] < 1


@pytest.mark.parametrize('row', range(4))
def test_65535_among_the_first_four_readings_shows_at_once(row: int) -> None:
    readings = np.array([[0.1], [0.4], [0.7], [0.9]])
    readings[row] = 65535
    assert limits_of(readings).are_implausible(readings)[:, 0].tolist() == [other == row for other in range(4)]


def test_what_no_sensor_means_is_wrong_however_often_it_comes() -> None:
    limits = limits_of(np.array([[3.4e38, 3e38], [3.4e38, 3e38], [0.5, 3e38]]))
    assert limits.highest.tolist() == [0.5, np.inf]


def test_a_sentinel_that_comes_again_and_again_and_one_at_either_end() -> None:
    spoiled = readings_of(40)
    spoiled[:6, 0], spoiled[6:9, 0] = 65535, -32768
    limits = limits_of(spoiled)
    assert 0 <= limits.lowest[0] < limits.highest[0] <= 1
    assert limits.are_implausible(spoiled)[:, 0].sum() == 9


@pytest.mark.parametrize('wrong', [(1000.0, 2000.0), (255.0, 1000.0), (32767.0, 65535.0), (-999.0, -9999.0)])
def test_several_wrong_readings_do_not_hide_each_other(wrong: tuple[float, float]) -> None:
    spoiled = readings_of(60)
    spoiled[7, 1], spoiled[30, 1] = wrong
    assert standardiser_of(spoiled, 10).scale[1] == pytest.approx(np.delete(spoiled[:, 1], [7, 30]).std())


@pytest.mark.parametrize('levels', [1, 2, 5])
@pytest.mark.parametrize('wrong', [1000.0, 65535.0, 3e38])
def test_a_feature_of_few_levels_is_not_ruined_either(levels: int, wrong: float) -> None:
    clean = np.random.default_rng(2).integers(levels, size=(60, 1)) / max(levels - 1, 1)
    spoiled = clean.copy()
    spoiled[20] = wrong
    others = np.delete(clean, 20)
    assert standardiser_of(spoiled, 10).scale[0] == pytest.approx(others.std() or 1.0)


def test_of_a_handful_of_equal_readings_nothing_is_known() -> None:
    assert not limits_of(np.array([[0.0]] * 5 + [[1000.0]])).is_limited.any()


def test_what_is_rare_or_heavy_tailed_is_plausible() -> None:
    rng = np.random.default_rng(1)
    sparse = np.where(rng.random(100) < 0.05, rng.random(100), 0.0)
    heavy = rng.lognormal(0, 1.5, 100)
    binary = (rng.random(100) < 0.01).astype(float)
    assert not limits_of(np.column_stack([sparse, heavy, binary])).is_limited.any()


def test_what_many_things_read_is_no_mistake() -> None:
    readings = readings_of(40)
    readings[:20, 0] += 10_000
    assert not limits_of(readings).is_limited.any()


def test_a_clean_feature_has_the_same_bits_whatever_its_neighbour_reads() -> None:
    table = readings_of(40)
    wrong = table.copy()
    wrong[3, 1] = 3e38
    clean, spoiled = standardiser_of(table, 4), standardiser_of(wrong, 4)
    assert clean.transform(table)[:, [0, 2]].tobytes() == spoiled.transform(table)[:, [0, 2]].tobytes()
