"""Containers of food: boxes, cans, bottles, bowls, plates, pots."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Concatenate, ParamSpec

import numpy as np
from numpy.random import Generator

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.geometry import Solid, ball_profile, rounded_rectangle, unit_circle
from al_questioner.simulation.kitchen.drawing.texture import Color, Decal, Material, label_image, shifted


@dataclass(frozen=True)
class Look:
    """Individual look of one object of a kind, in all its states and views.

    Attributes:
        size: factor of its lengths.
        hue_deg, tone: shift of its colours around the colour wheel, and factor of their brightness.
        variant: a random number in [0, 1) that selects among designs.
    """

    size: float
    hue_deg: float
    tone: float
    variant: float

    def color(self, color: Color) -> Color:
        """Return this object's variety of a colour."""
        return shifted(color, self.hue_deg, self.tone)

    def pick(self, *designs: Color) -> Color:
        """Return the colour of one of several designs, varied."""
        return self.color(designs[int(self.variant * len(designs))])


Design = ParamSpec('Design')
Draw = Callable[[Look, Generator], Solid]
Filling = Callable[[Solid, float, float, Look, Generator], None]
"""Function that puts food into a solid: (solid, level of the surface, its radius, look, rng)."""

WHITE: Color = (0.9, 0.9, 0.88)
STEEL: Color = (0.62, 0.63, 0.66)
Size = tuple[float, float]
"""Radius and height, in metres."""


@dataclass(frozen=True)
class Print:
    """Printing on a package: colours of the ground, of the word and of the design, one design a tuple.

    Attributes:
        designs: (ground, ink, accent) of each design.
        word: printed word.
        motif: see `label_image`.
    """

    designs: tuple[tuple[Color, Color, Color], ...]
    word: str
    motif: str = 'disc'

    def image(self, look: Look, repeats: int = 2) -> FloatArray:
        """Return the label of one object: the same in all its views."""
        ground, ink, accent = (look.color(c) for c in self.designs[int(look.variant * len(self.designs))])
        return label_image(ground, ink, accent, self.word, look.variant, repeats, self.motif)

    def ground(self, look: Look) -> Color:
        """Return the colour of the paper."""
        return look.color(self.designs[int(look.variant * len(self.designs))][0])


def drawing(build: Callable[Concatenate[Solid, Look, Generator, Design], None]) -> Callable[Design, Draw]:
    """Turn a function that adds a thing to an empty solid into one that takes its design and returns a `Draw`."""

    @wraps(build)
    def designed(*design: Design.args, **options: Design.kwargs) -> Draw:
        def draw(look: Look, rng: Generator) -> Solid:
            solid = Solid()
            build(solid, look, rng, *design, **options)
            return solid

        return draw

    return designed


@drawing
def bowl_of(
    solid: Solid, look: Look, rng: Generator, filling: Filling, color: Color = WHITE, size: Size = (0.075, 0.052)
) -> None:
    """Draw a round bowl with something in it."""
    radius, height = size
    glaze = solid.material(Material(look.color(color), shine=0.35, sharpness=40, grain=0.015))
    within = solid.material(Material(look.color(color), shine=0.1, grain=0.015))
    bulge = [(0, 0.5), (0.004, 0.52), (0.3 * height, 0.74), (0.65 * height, 0.92), (height, 1.0)]
    solid.lathe([(z, r * radius) for z, r in bulge], glaze)
    rim = 0.93 * radius
    with solid.inside(height, rim):
        solid.lathe([(height, rim), (0.55 * height, 0.84 * radius)], within, tone=0.86)
        filling(solid, 0.74 * height, 0.86 * radius, look, rng)


@drawing
def pot_of(solid: Solid, look: Look, rng: Generator, filling: Filling) -> None:
    """Draw a cooking pot with two handles, uncovered."""
    solid.turn_deg = (-25, 25)
    steel = solid.material(Material(STEEL, shine=0.7, sharpness=25, grain=0.05, grain_m=0.03))
    grip = solid.material(Material((0.12, 0.12, 0.13), shine=0.3))
    radius, height = 0.1, 0.1
    solid.lathe([(0, 0.93 * radius), (0.008, radius), (height, radius), (height, 1.05 * radius)], steel)
    for side in (-1, 1):
        angles = np.linspace(-0.5, 0.5, 9)
        reach = radius + 0.028 * np.cos(angles * np.pi)
        curve = np.stack([side * reach, 0.035 * angles / 0.5, np.full(9, 0.082)], axis=1)
        solid.strand(curve, 0.006, grip)
    with solid.inside(height, 0.97 * radius):
        solid.lathe([(height, 0.97 * radius), (0.045, 0.97 * radius)], steel, tone=0.75)
        filling(solid, 0.07, 0.96 * radius, look, rng)


@drawing
def pan_of(solid: Solid, look: Look, rng: Generator, filling: Filling) -> None:
    """Draw a flat black pan with a long handle."""
    solid.turn_deg = (-60, 60)
    iron = solid.material(Material((0.13, 0.13, 0.14), shine=0.45, sharpness=15, grain=0.08))
    solid.lathe([(0, 0.065), (0.03, 0.082)], iron)
    solid.strand([(0.078, 0, 0.026), (0.12, 0, 0.034), (0.16, 0, 0.038)], 0.008, iron)
    with solid.inside(0.03, 0.078):
        solid.lathe([(0.03, 0.078), (0.011, 0.067)], iron, tone=0.8)
        filling(solid, 0.011, 0.067, look, rng)


@drawing
def plate_of(solid: Solid, look: Look, rng: Generator, filling: Filling | None) -> None:
    """Draw a dinner plate with something on it, or empty."""
    glaze, radius = solid.material(Material(look.color(WHITE), shine=0.3, sharpness=50, grain=0.01)), 0.098
    solid.lathe([(0, 0.6 * radius), (0.004, 0.66 * radius), (0.016, 0.97 * radius), (0.017, radius)], glaze)
    solid.lathe([(0.017, 0.96 * radius), (0.008, 0.7 * radius)], glaze, tone=0.93)
    solid.lathe([(0.008, 0.68 * radius), (0.008, 0.6 * radius)], glaze, tone=0.98)
    if filling is not None:
        filling(solid, 0.009, 0.7 * radius, look, rng)


@drawing
def carton(
    solid: Solid, look: Look, rng: Generator, design: Print, size: tuple[float, float, float], gable: bool = False
) -> None:
    """Draw an upright box with printed walls; with a gable, a drink carton."""
    width, depth, height = size
    image = design.image(look, repeats=4)
    decal = Decal(image, 'box', (0, height), (width / 2, depth / 2))
    walls = solid.material(Material(design.ground(look), shine=0.12, sharpness=12, grain=0.02, decal=decal))
    top = solid.material(Material(design.ground(look), shine=0.12, grain=0.03))
    solid.box(size, walls, lid=None if gable else top)
    if gable:
        outline = rounded_rectangle(width, depth, 0.003)
        rise = np.linspace(0, 1, 16)
        roof = np.stack([np.outer(1 - 0.04 * rise, outline[:, 0]), np.outer(1 - 0.9 * rise, outline[:, 1])], axis=2)
        levels = np.broadcast_to((height + 0.3 * width * rise)[:, None, None], (16, len(outline), 1))
        solid.slices(np.concatenate([roof, levels], axis=2), top)
        ridge = height + 0.3 * width
        solid.box((0.96 * width, 0.006, 0.015), top, low=ridge, radius=0.001)
        cap = solid.material(Material(look.color(design.designs[0][2]), shine=0.3))
        solid.lathe([(height + 0.01, 0.012), (height + 0.024, 0.012)], cap, center=(0, -depth / 4))


@drawing
def can(solid: Solid, look: Look, rng: Generator, design: Print, size: Size = (0.033, 0.122), tab: bool = True) -> None:
    """Draw a metal can with a printed wall: a drink can with a tab, or a food can."""
    metal = solid.material(Material((0.72, 0.73, 0.75), shine=0.6, sharpness=20, grain=0.03))
    (radius, height), paper = size, 0.9 if tab else 0.84
    low, high = (1 - paper) / 2 * height, (1 + paper) / 2 * height
    decal = Decal(design.image(look), 'wrap', (low, high))
    gloss = 0.55 if tab else 0.15
    wall = solid.material(Material(design.ground(look), shine=gloss, sharpness=30, grain=0.01, decal=decal))
    solid.lathe([(0, 0.8 * radius), (low, radius)], metal)
    solid.lathe([(low, radius), (high, radius)], wall)
    neck = 0.82 * radius if tab else radius
    solid.lathe([(high, radius), (height, neck)], metal)
    solid.lathe([(height + 0.0005, 0.9 * neck), (height + 0.0005, 0.85 * neck)], metal, tone=0.8)
    if tab:
        hole = solid.material(Material((0.3, 0.3, 0.32), shine=0.2))
        tongue = unit_circle(14) * np.array([0.009, 0.006], dtype=np.float32)
        solid.plate(tongue + np.array([0, 0.004], dtype=np.float32), 0.001, metal, low=height + 0.001, tone=1.15)
        solid.plate(0.6 * tongue - np.array([0, 0.011], dtype=np.float32), 0.0005, hole, low=height + 0.001)


def tin(design: Print, size: Size = (0.037, 0.105)) -> Draw:
    """Return a function that draws a food can with a paper label."""
    return can(design, size, tab=False)


@drawing
def bottle(
    solid: Solid,
    look: Look,
    rng: Generator,
    liquid: Color,
    design: Print,
    cap: Color,
    *,
    radius: float = 0.033,
    height: float = 0.21,
    clear: float = 0.35,
) -> None:
    """Draw a plastic or glass bottle with a label around its belly."""
    body = solid.material(Material(look.color(liquid), shine=0.8, sharpness=35, grain=0.03, clear=clear))
    low, high = 0.32 * height, 0.56 * height
    decal = Decal(design.image(look), 'wrap', (low, high))
    paper = solid.material(Material(design.ground(look), shine=0.15, grain=0.02, decal=decal))
    lid = solid.material(Material(look.color(cap), shine=0.3, grain=0.03))
    solid.lathe([(0, 0.85 * radius), (0.03 * height, radius), (low, radius)], body)
    solid.lathe([(low, 1.01 * radius), (high, 1.01 * radius)], paper)
    neck = 0.4 * radius
    curve = [(high, radius), (0.66 * height, radius), (0.86 * height, 1.1 * neck), (0.93 * height, neck)]
    solid.lathe(curve, body)
    solid.lathe([(0.92 * height, 1.18 * neck), (height, 1.18 * neck)], lid)


@drawing
def jar(
    solid: Solid, look: Look, rng: Generator, content: Color, design: Print, lid: Color, size: Size = (0.035, 0.1)
) -> None:
    """Draw a jar with a screw lid."""
    radius, height = size
    glass = solid.material(Material(look.color(content), shine=0.7, sharpness=40, grain=0.1, clear=0.12))
    decal = Decal(design.image(look), 'wrap', (0.2 * height, 0.62 * height))
    paper = solid.material(Material(design.ground(look), shine=0.1, grain=0.02, decal=decal))
    metal = solid.material(Material(look.color(lid), shine=0.45, grain=0.02))
    solid.lathe([(0, 0.92 * radius), (0.06 * height, radius), (0.2 * height, radius)], glass)
    solid.lathe([(0.2 * height, radius), (0.62 * height, radius)], paper)
    solid.lathe([(0.62 * height, radius), (0.72 * height, radius), (0.8 * height, 0.85 * radius)], glass)
    solid.lathe([(0.8 * height, 0.92 * radius), (height, 0.92 * radius)], metal)


@drawing
def mug_of(solid: Solid, look: Look, rng: Generator, drink: Color | None, *designs: Color, froth: float = 0.0) -> None:
    """Draw a mug with a handle; `drink` None for an empty one."""
    solid.turn_deg = (-75, 5)
    glaze = solid.material(Material(look.pick(*designs), shine=0.5, sharpness=45, grain=0.015))
    radius, height = 0.041, 0.092
    angles = np.linspace(-1.35, 1.35, 12)
    curve = np.stack([radius - 0.01 + 0.04 * np.cos(angles), 0 * angles, 0.047 + 0.031 * np.sin(angles)], axis=1)
    solid.lathe([(0, 0.92 * radius), (0.006, radius), (height, radius)], glaze)
    solid.strand(curve, 0.0055, glaze, tone=0.95)
    within = solid.material(Material(WHITE, shine=0.2, grain=0.01))
    with solid.inside(height, 0.9 * radius):
        solid.lathe([(height, 0.9 * radius), (0.02, 0.88 * radius)], within, tone=0.75)
        if drink is not None:
            surface = solid.material(Material(look.color(drink), shine=0.5, sharpness=60, grain=0.05 + froth))
            level = 0.8 * height
            solid.lathe([(level, 0.9 * radius), (level, 0.85 * radius)], surface)


@drawing
def glass_of(solid: Solid, look: Look, rng: Generator, drink: Color | None, straw: Color | None = None) -> None:
    """Draw a tumbler with a drink, or empty."""
    glass = solid.material(Material((0.9, 0.94, 0.95), shine=0.9, sharpness=40, grain=0.01, clear=0.82))
    radius, height = 0.033, 0.125
    level = 0.78 * height

    def width(z: float) -> float:
        return radius * (0.82 + 0.18 * z / height)

    solid.lathe([(0, width(0)), (0.008, width(0.008))], glass, tone=0.8)
    if drink is None:
        solid.lathe([(0.008, width(0.008)), (height, width(height))], glass)
    else:
        color = look.color(drink)
        body = solid.material(Material(color, shine=0.8, sharpness=40, grain=0.03, clear=0.1))
        surface = solid.material(Material(color, shine=0.3, grain=0.04))
        solid.lathe([(0.008, width(0.008)), (level, width(level))], body)
        solid.lathe([(level, width(level)), (height, width(height))], glass)
    with solid.inside(height, 0.95 * width(height)):
        solid.lathe([(height, 0.95 * width(height)), (level, 0.93 * width(level))], glass, tone=0.9)
        if drink is not None:
            solid.lathe([(level, 0.96 * width(level)), (level, 0.9 * width(level))], surface, tone=1.1)
    if straw is not None:
        tint = solid.material(Material(look.color(straw), shine=0.2))
        solid.strand([(0.0, 0.01, level), (0.03, 0.02, height + 0.06)], 0.003, tint)


@drawing
def bag(
    solid: Solid, look: Look, rng: Generator, design: Print, size: tuple[float, float, float] = (0.13, 0.16, 0.05)
) -> None:
    """Draw a puffed-up foil bag lying on the table."""
    solid.turn_deg = (-40, 40)
    width, depth, height = size
    image = design.image(look, repeats=1)
    decal = Decal(image, 'top', (width, depth))
    foil = Material(design.ground(look), shine=0.6, sharpness=12, grain=0.09, grain_m=0.035, decal=decal)
    part = solid.material(foil)
    seam = solid.material(Material(design.ground(look), shine=0.5, grain=0.1))
    zigzag = depth * (0.5 + 0.015 * (np.arange(16) % 2))
    edge = np.linspace(-0.46, 0.46, 16) * width
    flap = np.r_[np.stack([edge, zigzag], axis=1), np.stack([edge, -zigzag], axis=1)[::-1]]
    solid.plate(flap, 0.004, seam)
    pillow = rounded_rectangle(width, 0.92 * depth, 0.3 * width)
    solid.lathe(ball_profile(1.0, height, 0.003), part, outline=pillow)
