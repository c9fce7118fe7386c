"""A view that wobbles stays the same view, and one that has changed is another one."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from al_questioner.concepts.view_memory import Correction, ViewMemory, corrected
from al_questioner.domain import Scene

LOOKS = 40
CHANGE = 20
"""Number of the look from which the first thing is another one, where it is."""

Noise = Callable[[np.random.Generator, int, tuple[int, int]], np.ndarray]


def noise_of(size: float, factor: Callable[[np.random.Generator, int], float] = lambda rng, look: 1) -> Noise:
    """Normal noise, at some looks more or less of it."""
    return lambda rng, look, shape: size * rng.normal(size=shape) * factor(rng, look)


def bursts(size: float) -> Noise:
    """Every tenth look, by chance, ten times the noise."""
    return noise_of(size, lambda rng, look: 10 if rng.random() < 0.1 else 1)


def long_burst(size: float) -> Noise:
    return noise_of(size, lambda rng, look: 10 if 30 <= look < 33 else 1)


def one_noisy_feature(size: float, quiet: float) -> Noise:
    return lambda rng, look, shape: rng.normal(size=shape) * np.where(np.arange(shape[1]) == 0, size, quiet)


def drift(step: float, size: float) -> Noise:
    return lambda rng, look, shape: size * rng.normal(size=shape) + step * look


def common(size: float) -> Noise:
    """A lamp that flickers: all features of all things move together."""
    return lambda rng, look, shape: size * rng.normal() + size / 10 * rng.normal(size=shape)


def one_noisy_thing(size: float) -> Noise:
    """Every fourth thing wobbles, the others stand quite still."""
    return lambda rng, look, shape: size * rng.normal(size=shape) * (np.arange(shape[0]) % 4 == 0)[:, None]


def wrong_cells(size: float) -> Noise:
    """Single readings are off by twenty times the noise, but not before the third look."""

    def make(rng: np.random.Generator, look: int, shape: tuple[int, int]) -> np.ndarray:
        is_off = (rng.random(shape) < 0.03) & (look > 2)
        return size * rng.normal(size=shape) * np.where(is_off, 20, 1)

    return make


NOISES = {
    **{f'normal {size}': noise_of(size) for size in (0.0005, 0.005, 0.02, 0.05, 0.1)},
    **{f'bursts {size}': bursts(size) for size in (0.0005, 0.005)},
    'long burst': long_burst(0.005),
    # Readings repeat exactly, but for some looks.
    'rare burst': noise_of(0.02, lambda rng, look: rng.random() < 0.1),
    'one is all noise': one_noisy_feature(1.0, 0.002),
    'one is noisy': one_noisy_feature(0.3, 0.005),
    'drift': drift(0.01, 0.005),
    'drift alone': drift(0.02, 0.0005),
    'common': common(0.02),
    'one thing in four': one_noisy_thing(0.05),
    'noisier later': noise_of(0.05, lambda rng, look: 0.02 if look < 15 else 1),
    'wrong cells': wrong_cells(0.01),
}


def scenes(
    noise: Noise, n: int, m: int, seed: int, change: np.ndarray | None = None
) -> Iterator[tuple[Scene, np.ndarray]]:
    """Looks at n things, and the spread of each feature, which differs by far; features are in odd units."""
    rng = np.random.default_rng(seed)
    unit = 10 ** rng.uniform(-2, 3, m)
    things = rng.normal(size=(n, m)) + rng.normal(size=m) * 3
    spread = things.std(axis=0)
    names = tuple(f'group_{i}' for i in range(m))
    for look in range(1, LOOKS + 1):
        if look == CHANGE and change is not None:
            things = things.copy()
            things[0] += change * spread
        table = (things + noise(rng, look, (n, m)) * spread) * unit
        yield Scene(tuple(range(n)), np.zeros((n, 3), np.float32), table.astype(np.float32), names), spread * unit


def views_seen(noise: Noise, n: int, m: int, seed: int, change: np.ndarray | None = None) -> list[list[int]]:
    """Of each thing, the numbers of the looks at which it got features that it had not had before."""
    memory = ViewMemory()
    known: list[set[bytes]] = [set() for _ in range(n)]
    found: list[list[int]] = [[] for _ in range(n)]
    for look, (scene, spread) in enumerate(scenes(noise, n, m, seed, change), start=1):
        for thing, row in enumerate(memory.steady(scene, spread).features):
            if row.tobytes() not in known[thing]:
                known[thing].add(row.tobytes())
                found[thing].append(look)
    return found


def looks_of_a_still_thing(noise: Noise, m: int, spoil: Callable[[int, Scene, np.ndarray], object]) -> set[bytes]:
    """The features that the third of four things gets at all the looks at it, of which a function spoils some."""
    memory, kept = ViewMemory(), set()
    for look, (scene, spread) in enumerate(scenes(noise, 4, m, 0)):
        is_wrong = spoil(look, scene, spread)
        options = [is_wrong] if isinstance(is_wrong, np.ndarray) else []
        kept.add(memory.steady(scene, spread, *options).features[2].tobytes())
    return kept


SIZES = [(4, 3), (4, 26), (10, 74), (12, 12)]


@pytest.mark.parametrize('name', NOISES)
@pytest.mark.parametrize(('n', 'm'), SIZES)
def test_noise_makes_no_other_view(name: str, n: int, m: int) -> None:
    for seed in range(2):
        assert views_seen(NOISES[name], n, m, seed) == [[1]] * n


@pytest.mark.parametrize('name', NOISES)
@pytest.mark.parametrize(('n', 'm'), SIZES)
def test_another_thing_is_seen_by_the_second_look_at_it(name: str, n: int, m: int) -> None:
    change = np.random.default_rng(5).choice([-1.5, 1.5], size=m)
    first, *others = views_seen(NOISES[name], n, m, 0, change)
    assert len(first) == 2
    # A burst at that very moment may hide it for its duration.
    assert CHANGE <= first[1] <= CHANGE + 2
    assert others == [[1]] * (n - 1)


@pytest.mark.parametrize('size', [0.0005, 0.005, 0.05])
def test_a_change_of_some_features_only_is_seen_once_it_is_confirmed(size: float) -> None:
    change = np.where(np.arange(26) < 5, 1.0, 0.0)
    first, *others = views_seen(noise_of(size), 4, 26, 0, change)
    assert first == [1, CHANGE + 1]
    assert others == [[1]] * 3


def drift_undone(rng: np.random.Generator, look: int, shape: tuple[int, int]) -> np.ndarray:
    """A drift that was followed, until a lamp is switched off again."""
    return (0.05 * look if look < 12 else 0.0) + 0.02 * rng.normal(size=shape)


UNEVEN = [(long_burst(0.05), 10, 74, 3), (one_noisy_thing(0.2), 10, 3, 8), (drift_undone, 5, 4, 3)]


@pytest.mark.parametrize(('noise', 'n', 'm', 'seeds'), UNEVEN)
def test_noise_that_is_far_from_even_makes_no_other_view(noise: Noise, n: int, m: int, seeds: int) -> None:
    """A second look confirms a change only if it agrees with the first, and a view is known again after a drift."""
    for seed in range(seeds):
        assert views_seen(noise, n, m, seed) == [[1]] * n


def test_readings_that_repeat_exactly_pass_unchanged_and_changes_count_at_once() -> None:
    change = np.random.default_rng(5).normal(size=26)
    memory = ViewMemory()
    for scene, spread in scenes(noise_of(0), 4, 26, 0, change):
        assert memory.steady(scene, spread) is scene


def test_a_view_that_comes_back_has_the_features_that_it_had() -> None:
    memory = ViewMemory()
    rng = np.random.default_rng(0)
    views, others, names = rng.normal(size=(2, 5)), rng.normal(size=(3, 5)), tuple(f'group_{i}' for i in range(5))
    kept = []
    for look in range(40):
        table = np.vstack([views[look // 10 % 2], others])
        table = (table + 0.01 * rng.normal(size=table.shape)).astype(np.float32)
        scene = Scene((0, 1, 2, 3), np.zeros((4, 3), np.float32), table, names)
        kept.append(memory.steady(scene, np.ones(5)).features[0].tobytes())
    assert kept[20:] == kept[:20]
    assert len(set(kept)) == 2


def test_a_wrong_reading_of_one_feature_is_not_another_view() -> None:
    def spoil(look: int, scene: Scene, spread: np.ndarray) -> None:
        if look % 7 == 5:
            scene.features[2, look % 12] = 65535

    assert len(looks_of_a_still_thing(noise_of(0.01), 12, spoil)) == 1


@pytest.mark.parametrize('error', [0.3, 65535.0])
def test_the_only_look_at_a_view_is_corrected_by_those_after_it(error: float) -> None:
    """Otherwise a burst, or a wrong reading, in the first look would make two views of one thing."""
    memory = ViewMemory()
    corrections = []
    for look, (scene, spread) in enumerate(scenes(noise_of(0.005), 5, 4, 0)):
        if look == 0:
            first = scene.features[1].copy()
            scene.features[1, 2] += error * spread[2]
            wrong = scene.features[1].copy()
        known_spread = spread if look else np.zeros(0)
        kept = memory.steady(scene, known_spread).features[1]
        corrections += memory.corrections
    (correction,) = corrections
    assert correction.object_id == 1
    np.testing.assert_array_equal(correction.wrong, wrong)
    assert (np.abs(correction.right - first) < 0.05 * spread).all()
    np.testing.assert_array_equal(kept, correction.right)


@pytest.mark.parametrize('seed', range(4))
def test_a_change_amid_bursts_is_not_followed_as_if_it_were_noise(seed: int) -> None:
    """Otherwise its own noise would seem to explain it, and what the thing is now would never be asked."""
    noise = noise_of(0.05, lambda rng, look: 10 if look in (17, 19, 21) else 1)
    first, *others = views_seen(noise, 6, 5, seed, np.random.default_rng(seed).choice([-1.5, 1.5], size=5))
    assert len(first) == 2
    assert others == [[1]] * 5


def test_a_thing_that_was_seen_twice_as_it_was_is_not_corrected() -> None:
    memory = ViewMemory()
    change = np.array([0.0, 0.6, 0.0, 0.0])
    for scene, spread in scenes(noise_of(0.005), 5, 4, 0, change):
        memory.steady(scene, spread)
        assert [each for each in memory.corrections if not each.is_of_last_look] == []


def test_a_small_change_that_is_confirmed_began_with_the_look_before() -> None:
    """Otherwise what was said of a thing as it had just changed would be taken for said of how it was."""
    memory = ViewMemory()
    change = np.array([0.0, 0.6, 0.0, 0.0])
    told = []
    for scene, spread in scenes(noise_of(0.005), 5, 4, 0, change):
        memory.steady(scene, spread)
        told += [(each.object_id, each.is_of_last_look) for each in memory.corrections]
    assert told == [(0, True)]


def test_a_row_of_wrong_readings_is_not_another_view_even_if_it_comes_twice() -> None:
    """Otherwise the thing would be asked about again, and the answer would be learnt for what no sensor means."""

    def spoil(look: int, scene: Scene, spread: np.ndarray) -> np.ndarray:
        is_wrong = np.zeros((4, 6), dtype=bool)
        if look in (5, 6, 20):
            scene.features[2] = 65535
            is_wrong[2] = True
        return is_wrong

    assert len(looks_of_a_still_thing(noise_of(0.005), 6, spoil)) == 1


def test_one_row_that_is_like_nothing_else_waits_for_a_second_look() -> None:
    def spoil(look: int, scene: Scene, spread: np.ndarray) -> None:
        if look == LOOKS - 1:
            scene.features[2] += np.float32(100) * spread.astype(np.float32)

    assert len(looks_of_a_still_thing(noise_of(0.005), 6, spoil)) == 1


def test_scenes_of_before_are_corrected_where_they_show_the_wrong_look() -> None:
    wrong, right, other = np.float32([1, 9]), np.float32([1, 2]), np.float32([5, 6])
    shown = Scene((4, 7), np.zeros((2, 3), np.float32), np.array([wrong, other]), ('a_1', 'a_2'))
    found = corrected([shown, shown], [Correction(4, wrong, right)])
    for scene in found:
        np.testing.assert_array_equal(scene.features, [right, other])
    again = corrected(found, [Correction(4, wrong, right)])
    assert all(one is other for one, other in zip(again, found, strict=True))
    assert corrected([shown], [Correction(7, wrong, right)])[0] is shown


def test_of_a_last_look_only_the_last_scene_with_the_thing_is_corrected() -> None:
    """Otherwise what a thing was called before it changed would be forgotten."""
    before, after, other = np.float32([1, 9]), np.float32([1, 2]), np.float32([5, 6])
    names, nowhere = ('a_1', 'a_2'), np.zeros((1, 3), np.float32)
    shown = Scene((4,), nowhere, np.array([before]), names)
    without = Scene((7,), nowhere, np.array([other]), names)
    found = corrected([shown, shown, without], [Correction(4, before, after, is_of_last_look=True)])
    assert found[0] is shown
    assert found[2] is without
    np.testing.assert_array_equal(found[1].features, [after])


def test_the_estimate_names_the_noise_of_each_feature() -> None:
    memory = ViewMemory()
    for scene, spread in scenes(one_noisy_feature(0.3, 0.02), 8, 10, 1):
        memory.steady(scene, spread)
    noise = list(memory.noise.values())
    assert noise[0] == pytest.approx(0.3, rel=0.2)
    assert noise[1:] == pytest.approx([0.02] * 9, rel=0.2)


def test_before_anything_was_seen_twice_no_noise_is_told() -> None:
    memory = ViewMemory()
    assert memory.noise == {}
    scene, spread = next(scenes(noise_of(0.1), 4, 3, 0))
    memory.steady(scene, spread)
    assert memory.noise == {}
