"""Holding crops out, and drawing samples: disjoint, never empty where avoidable, of the size that was asked for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from al_questioner.simulation.rgbd_dataset.files import CropFiles
from al_questioner.simulation.rgbd_dataset.split import Draw, draw_sample, split_crops


def crops(category: str, *views: int) -> tuple[CropFiles, ...]:
    """A category whose n-th object has views[n] views."""
    return tuple(
        CropFiles(category, n, 1, frame, Path(f'{category}_{n}_1_{frame}'))
        for n, count in enumerate(views, start=1)
        for frame in range(1, count + 1)
    )


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_category_with_several_objects_is_split_by_object_and_says_so() -> None:
    split = split_crops({'apple': crops('apple', 3, 4, 5, 6)}, 0.25, rng())
    training, test = split.training['apple'], split.test['apple']
    assert len({crop.thing for crop in test}) == 1
    assert not {crop.thing for crop in test} & {crop.thing for crop in training}
    number = test[0].instance
    assert split.lines == (
        f'apple: split by object, {len(training)} training views, {len(test)} test views (of object {number})',
    )


@pytest.mark.parametrize(
    ('views', 'share', 'numbers', 'line'),
    [
        (6, 1 / 3, (4, 2), 'split by view (one object only), 4 training views, 2 test views'),
        (1, 0.9, (1, 0), 'one view only: for training, nothing to test it with'),
    ],
)
def test_category_with_one_object_is_split_by_view_and_says_so(
    views: int, share: float, numbers: tuple[int, int], line: str
) -> None:
    split = split_crops({'mug': crops('mug', views)}, share, rng())
    assert (len(split.training['mug']), len(split.test['mug'])) == numbers
    assert split.lines == (f'mug: {line}',)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(st.integers(1, 6), min_size=1, max_size=5), st.floats(0.01, 0.99), st.integers(0, 1000))
def test_split_loses_nothing_shares_nothing_and_leaves_neither_side_empty(
    views: list[int], share: float, seed: int
) -> None:
    found = crops('apple', *views)
    split = split_crops({'apple': found}, share, rng(seed))
    assert sorted(split.training['apple'] + split.test['apple']) == sorted(found)
    assert split.training['apple']
    assert bool(split.test['apple']) == (len(found) > 1)


def test_split_depends_on_the_generator_only() -> None:
    found = {'apple': crops('apple', *[3] * 8), 'mug': crops('mug', 9)}
    assert split_crops(found, 0.3, rng(4)) == split_crops(found, 0.3, rng(4))
    assert split_crops(found, 0.3, rng(4)) != split_crops(found, 0.3, rng(5))


def sizes(drawn: Mapping[str, Draw]) -> dict[str, int]:
    return {category: len(draw.crops) for category, draw in drawn.items()}


def test_sample_follows_the_shares_of_the_categories() -> None:
    pool = {name: crops(name, 100) for name in ('apple', 'pear', 'soda_can')}
    drawn = draw_sample(pool, 60, {'apple': 0.25, 'pear': 0.25, 'soda_can': 0.5}, rng())
    assert sizes(drawn) == {'apple': 15, 'pear': 15, 'soda_can': 30}
    for name, draw in drawn.items():
        assert sorted(draw.crops + draw.spares) == sorted(pool[name])


@pytest.mark.parametrize(
    ('available', 'size', 'shares', 'drawn'),
    [
        ({'apple': 50}, 20, {'apple': 0.25, 'pear': 0.75}, {'apple': 20}),
        ({'apple': 3}, 20, {'apple': 1.0}, {'apple': 3}),
        ({'apple': 3, 'stapler': 3}, 2, {'apple': 1.0, 'stapler': 0.0}, {'apple': 2}),
        ({'apple': 0}, 5, {'apple': 1.0}, {}),
    ],
)
def test_sample_is_of_what_is_there_and_wanted(
    available: dict[str, int], size: int, shares: dict[str, float], drawn: dict[str, int]
) -> None:
    """Shares of absent categories go to the others; no more is taken than there is, and nothing without a share."""
    assert sizes(draw_sample({name: crops(name, n) for name, n in available.items()}, size, shares, rng())) == drawn


@pytest.mark.parametrize('size', [1, 7, 80, 3200])
def test_rounding_keeps_the_size_of_the_sample(size: int) -> None:
    pool = {name: crops(name, 4000) for name in ('a', 'b', 'c', 'd', 'e', 'f', 'g')}
    numbers = sizes(draw_sample(pool, size, dict.fromkeys(pool, 1 / 7), rng()))
    assert sum(numbers.values()) == size
    assert max(numbers.values()) - min(numbers.values()) <= 1
