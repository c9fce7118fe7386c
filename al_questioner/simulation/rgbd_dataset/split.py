"""Split of real crops into training and test, and samples of a given size from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.simulation.kitchen.pool import apportion
from al_questioner.simulation.rgbd_dataset.files import CropFiles

CropsByCategory = Mapping[str, Sequence[CropFiles]]


@dataclass(frozen=True)
class Split:
    """Disjoint crops by category.

    Attributes:
        training, test: crops by category; every category has an entry in both.
        lines: the split of each category, in words.
    """

    training: dict[str, tuple[CropFiles, ...]]
    test: dict[str, tuple[CropFiles, ...]]
    lines: tuple[str, ...]


def split_crops(crops: CropsByCategory, test_share: float, rng: np.random.Generator) -> Split:
    """Hold out a share of each category: whole objects if it has several, otherwise views of its only one.

    At least one object (or view) goes to either side; the only view of a category is for training.

    Args:
        crops: at least one crop by category.
        test_share: share of the objects (or views) to hold out, in (0, 1).
        rng: decides which.
    """
    training: dict[str, tuple[CropFiles, ...]] = {}
    test: dict[str, tuple[CropFiles, ...]] = {}
    lines = []
    for category, found in crops.items():
        things = sorted({crop.thing for crop in found})
        units = things if len(things) > 1 else sorted(found)
        order = rng.permutation(len(units))
        held_out = {units[i] for i in order[: _number_held_out(len(units), test_share)]}
        parts: tuple[list[CropFiles], list[CropFiles]] = ([], [])
        for crop in sorted(found):
            parts[crop.thing in held_out or crop in held_out].append(crop)
        training[category], test[category] = tuple(parts[0]), tuple(parts[1])
        lines.append(f'{category}: {_how(things, parts)}')
    return Split(training, test, tuple(lines))


def _number_held_out(units: int, share: float) -> int:
    return min(max(1, round(share * units)), units - 1)


def _how(things: Sequence[tuple[str, int]], parts: tuple[list[CropFiles], list[CropFiles]]) -> str:
    training, test = parts
    if len(things) > 1:
        numbers = ', '.join(str(instance) for _, instance in sorted({crop.thing for crop in test}))
        return f'split by object, {len(training)} training views, {len(test)} test views (of object {numbers})'
    if test:
        return f'split by view (one object only), {len(training)} training views, {len(test)} test views'
    return 'one view only: for training, nothing to test it with'


@dataclass(frozen=True)
class Draw:
    """Crops of a category in the order in which a sample takes them.

    Attributes:
        crops: crops of the sample.
        spares: the others, to replace crops that turn out to be unreadable.
    """

    crops: tuple[CropFiles, ...]
    spares: tuple[CropFiles, ...]


def draw_sample(
    pool: CropsByCategory, size: int, shares: Mapping[str, float], rng: np.random.Generator
) -> dict[str, Draw]:
    """Draw a sample without replacement; it is smaller if a category does not have enough crops.

    Args:
        pool: crops by category.
        size: size of the whole sample.
        shares: share of the sample by category; the shares of categories without any crop go to the others.
        rng: decides which.
    """
    present = {name: share for name, share in shares.items() if pool.get(name) and share > 0}
    counts = apportion({name: share / sum(present.values()) for name, share in present.items()}, size)
    drawn = {}
    for category, count in counts.items():
        order = [pool[category][i] for i in rng.permutation(len(pool[category]))]
        drawn[category] = Draw(tuple(order[:count]), tuple(order[count:]))
    return drawn
