"""Fruit, whole or in wedges."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.random import Generator

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.geometry import Solid, turned, unit_circle
from al_questioner.simulation.kitchen.drawing.texture import Color, Decal, Material, blush_image, shifted
from al_questioner.simulation.kitchen.things.fillings import spots_on_disc
from al_questioner.simulation.kitchen.things.vessels import Look, drawing

STALK: Color = (0.35, 0.25, 0.12)
LEAF: Color = (0.2, 0.5, 0.15)


def _skin(look: Look, ground: Color, blush: Color | None, height: float) -> Material:
    """Return the skin of a fruit, perhaps with a blush on one side."""
    decal = None
    if blush is not None:
        decal = Decal(blush_image(ground, look.color(blush), 0.25 + 0.35 * (3 * look.variant % 1)), 'wrap', (0, height))
    return Material(ground, grain=0.05, grain_m=0.008, decal=decal)


@drawing
def apple(solid: Solid, look: Look, rng: Generator, *designs: Color, blush: Color | None = None) -> None:
    """Draw an apple with its stalk."""
    skin = solid.material(replace(_skin(look, look.pick(*designs), blush, 0.07), shine=0.5, sharpness=30))
    stalk = solid.material(Material(STALK, grain=0.1))
    lower = [(0.0, 0.018), (0.006, 0.026), (0.02, 0.035), (0.04, 0.0395)]
    upper = [(0.055, 0.037), (0.066, 0.027), (0.07, 0.016)]
    solid.lathe(lower + upper, skin)
    solid.lathe([(0.069, 0.013), (0.064, 0.004)], skin, tone=0.68)
    solid.strand([(0, 0, 0.064), (0.004, 0.002, 0.084)], 0.0015, stalk)


@drawing
def pear(solid: Solid, look: Look, rng: Generator, *designs: Color, blush: Color | None = None) -> None:
    """Draw a pear standing up."""
    skin = solid.material(replace(_skin(look, look.pick(*designs), blush, 0.1), shine=0.25, sharpness=16))
    stalk = solid.material(Material(STALK, grain=0.1))
    belly = [(0.0, 0.016), (0.008, 0.028), (0.028, 0.0355), (0.045, 0.033)]
    neck = [(0.065, 0.022), (0.085, 0.017), (0.098, 0.012), (0.102, 0.003)]
    solid.lathe(belly + neck, skin)
    solid.strand([(0, 0, 0.1), (0.006, 0, 0.122)], 0.0016, stalk)


@dataclass(frozen=True)
class Peel:
    """The surface of a ball-like fruit.

    Attributes:
        grain, grain_m, shine: see `Material`.
        blush: colour of one side, if another.
        leaf: it has a leaf.
    """

    grain: float = 0.06
    grain_m: float = 0.0025
    shine: float = 0.2
    blush: Color | None = None
    leaf: bool = False


ORDINARY_PEEL = Peel()


@drawing
def round_fruit(
    solid: Solid,
    look: Look,
    rng: Generator,
    *designs: Color,
    radius: float = 0.038,
    squat: float = 0.94,
    peel: Peel = ORDINARY_PEEL,
) -> None:
    """Draw an orange, peach, plum or lime: a ball `squat` times as high as wide."""
    height = 2 * radius * squat
    color = look.pick(*designs)
    base = _skin(look, color, peel.blush, height)
    skin = solid.material(replace(base, shine=peel.shine, sharpness=16, grain=peel.grain, grain_m=peel.grain_m))
    solid.ball(radius, height, skin)
    navel = solid.material(Material(shifted(color, 0, 0.6), grain=0.1))
    solid.lathe([(height, 0.003), (height, 0.001)], navel)
    if peel.leaf:
        green = solid.material(Material(LEAF, shine=0.3))
        blade = np.array([[0, 0], [0.012, 0.007], [0.028, 0.002], [0.014, -0.006]], dtype=np.float32)
        solid.plate(turned(blade, rng.uniform(0, 6.3)), 0.001, green, low=height)


def _banana_path() -> tuple[FloatArray, FloatArray]:
    bend, points = 1.5, 22
    angles = np.linspace(-bend / 2, bend / 2, points)
    arc = 0.17 / bend
    path = np.stack([arc * np.sin(angles), arc * (np.cos(angles) - np.cos(bend / 2) * 0.5 - 0.5)], axis=1)
    along = np.linspace(-1, 1, points)
    radii = 0.0175 * (1 - 0.18 * along**2) * np.clip((1 - np.abs(along)) / 0.16, 0.3, 1) ** 0.6
    return path.astype(np.float32), radii.astype(np.float32)


@drawing
def bananas(solid: Solid, look: Look, rng: Generator, count: int, *designs: Color) -> None:
    """Draw one banana, or a bunch of several."""
    color = look.pick(*designs)
    peel = solid.material(Material(color, shine=0.25, sharpness=14, grain=0.07, grain_m=0.03))
    tip = solid.material(Material(STALK, grain=0.15))
    path, radii = _banana_path()
    for i in range(count):
        fan = (i - (count - 1) / 2) * 0.3
        root = path[-1]
        some = turned(path - root, fan) + root + np.array([0, 0.021 * (i - (count - 1) / 2)], dtype=np.float32) * 0.6
        tone, low = 1 - 0.07 * (i % 2), 0.007 * (i % 2)
        solid.tube(some, radii, peel, low=low, tone=tone)
        solid.tube(some[:2], radii[:2] * 0.9, tip, low=low + 0.009)
        solid.tube(some[-2:], radii[-2:], tip, low=low + 0.008)


@drawing
def bunch_of_grapes(solid: Solid, look: Look, rng: Generator, *designs: Color) -> None:
    """Draw grapes on their stem."""
    color = look.pick(*designs)
    berry = solid.material(Material(color, shine=0.55, sharpness=25, grain=0.05))
    stem = solid.material(Material(STALK))
    for layer, (count, spread, low) in enumerate(((14, 1.0, 0.0), (8, 0.7, 0.013), (4, 0.4, 0.025))):
        spots = spots_on_disc(count, 0.038 * spread, rng) * np.array([1.5, 1.0], dtype=np.float32)
        for x, y in spots[np.argsort(-spots[:, 1])]:
            solid.ball(0.0105, 0.02, berry, center=(x, y), low=low, tone=float(rng.uniform(0.8, 1.1) + 0.05 * layer))
    solid.strand([(0.05, 0, 0.02), (0.08, 0.005, 0.024)], 0.002, stem)


@drawing
def berries(solid: Solid, look: Look, rng: Generator, color: Color) -> None:
    """Draw a few strawberries side by side."""
    flesh = solid.material(Material(look.color(color), shine=0.4, grain=0.16, grain_m=0.003))
    green = solid.material(Material(LEAF, grain=0.1))
    for x, y in sorted(spots_on_disc(5, 0.034, rng).tolist(), key=lambda spot: -spot[1]):
        angle = rng.uniform(0, 6.3)
        direction = turned([[1.0, 0.0]], angle)[0]
        path = np.array([[x, y]]) + np.linspace(-0.016, 0.018, 8)[:, None] * direction
        solid.tube(path, np.array([0.013, 0.016, 0.0165, 0.015, 0.013, 0.01, 0.007, 0.003]), flesh)
        star = unit_circle(10) * (0.006 + 0.005 * (np.arange(10) % 2))[:, None].astype(np.float32)
        solid.plate(star + path[0].astype(np.float32), 0.002, green, low=0.021)


@drawing
def melon_slice(solid: Solid, look: Look, rng: Generator, rind: Color, flesh: Color) -> None:
    """Draw a wedge of melon lying on its side."""
    arc = np.linspace(0, np.pi, 24)
    half = np.stack([np.cos(arc), np.sin(arc)], axis=1).astype(np.float32) * 0.075
    skin, pale, pulp = (
        solid.material(Material(look.color(c), shine=0.2, grain=0.06)) for c in (rind, (0.85, 0.9, 0.7), flesh)
    )
    solid.plate(half, 0.028, skin)
    solid.plate(half * 0.95, 0.0005, pale, low=0.0285)
    solid.plate(half * 0.88, 0.0005, pulp, low=0.029)
    dark = solid.material(Material((0.12, 0.08, 0.06)))
    polar = np.linspace(0.4, 2.7, 9)
    spots = np.stack([0.045 * np.cos(polar), 0.045 * np.sin(polar), 0 * polar + 0.03], axis=1)
    solid.pieces(spots, unit_circle(8) * 0.003, 0.0003, dark, np.ones(9), np.zeros(9))
