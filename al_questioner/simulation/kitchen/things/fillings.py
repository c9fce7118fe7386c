"""Loose food that fills bowls, plates and pots, or lies in a heap."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.geometry import Solid, unit_circle
from al_questioner.simulation.kitchen.drawing.texture import Color, Material
from al_questioner.simulation.kitchen.things.vessels import Filling, Look, drawing


def spots_on_disc(n: int, radius: float, rng: Generator) -> FloatArray:
    """Return (n, 2) points spread over a disc, the farthest first."""
    distance = radius * np.sqrt((np.arange(n) + 0.5) / n)
    angle = 2.39996 * np.arange(n) + rng.uniform(0, 2 * np.pi)
    points = np.stack([distance * np.cos(angle), distance * np.sin(angle)], axis=1)
    return (points + rng.normal(0, 0.12 * radius / np.sqrt(n), (n, 2))).astype(np.float32)[::-1]


def _heaped(n: int, radius: float, low: float, peak: float, rng: Generator) -> FloatArray:
    """Return (n, 3) undersides of pieces in a heap, from the rim to the peak."""
    spots = spots_on_disc(n, radius, rng)
    rise = 1 - np.linalg.norm(spots, axis=1) / radius
    return np.column_stack([spots, low + peak * np.clip(rise, 0, 1)]).astype(np.float32)


def liquid(color: Color, bits: Color | None = None, count: int = 14, bit_m: float = 0.006) -> Filling:
    """Return a function that draws soup or sauce, perhaps with bits in it."""

    def fill(solid: Solid, level: float, radius: float, look: Look, rng: Generator) -> None:
        broth = solid.material(Material(look.color(color), shine=0.45, sharpness=40, grain=0.07, grain_m=0.015))
        solid.lathe([(level, radius), (level, 0.95 * radius)], broth)
        if bits is not None:
            chunk = solid.material(Material(look.color(bits), shine=0.3))
            spots = np.column_stack([spots_on_disc(count, 0.85 * radius, rng), np.full(count, level)])
            tones, angles = rng.uniform(0.75, 1.15, count), rng.uniform(0, 6.3, count)
            solid.pieces(spots, unit_circle(8) * bit_m, 0.002, chunk, tones, angles)

    return fill


def noodles(color: Color, sauce: Color | None, strands: int = 34) -> Filling:
    """Return a function that draws a tangle of spaghetti, perhaps with sauce on top."""

    def fill(solid: Solid, level: float, radius: float, look: Look, rng: Generator) -> None:
        pasta = solid.material(Material(look.color(color), shine=0.3, sharpness=25, grain=0.05))
        solid.lathe([(level, radius), (level + 0.012, 0.55 * radius), (level + 0.016, 0.05 * radius)], pasta, tone=0.7)
        middles = _heaped(strands, 0.62 * radius, level, 0.022, rng)
        sweep = np.linspace(0, 1, 9)[None, :] * rng.uniform(2, 4.5, (strands, 1)) + rng.uniform(0, 6.3, (strands, 1))
        loops = 0.38 * radius * rng.uniform(0.6, 1, (strands, 1))
        curves = np.repeat(middles[:, None], 9, axis=1)
        curves[..., 0] += loops * np.cos(sweep)
        curves[..., 1] += loops * np.sin(sweep)
        solid.slices(curves, pasta, rng.uniform(0.8, 1.15, strands), stroke=0.0042)
        if sauce is not None:
            red = solid.material(Material(look.color(sauce), shine=0.35, sharpness=25, grain=0.2, grain_m=0.01))
            lobes = 0.42 * radius * (1 + 0.18 * np.sin(3 * np.linspace(0, 2 * np.pi, 28, endpoint=False)))
            solid.ball(
                1, 0.016, red, low=level + 0.018, outline=unit_circle(28) * lobes[:, None].astype(np.float32), waist=0
            )

    return fill


def heap(
    colors: tuple[Color, ...],
    piece: FloatArray,
    count: int,
    *,
    peak: float = 0.02,
    thickness: float = 0.002,
    tilt: float = 0.0,
    shine: float = 0.1,
    bed: float = 0.62,
    chips: Color | None = None,
) -> Filling:
    """Return a function that draws a heap of pieces of one outline (k, 2) and some colours.

    A piece rises over its length by `tilt`, the ground between the pieces has the brightness `bed`, and each piece has
    dots of the colour `chips`, if any.
    """

    def fill(solid: Solid, level: float, radius: float, look: Look, rng: Generator) -> None:
        base = solid.material(Material(look.color(colors[0]), grain=0.2))
        profile = [(level, 0.95 * radius), (level + 0.5 * peak, 0.5 * radius), (level + 0.8 * peak, 0.05 * radius)]
        solid.lathe(profile, base, tone=bed)
        spots = _heaped(count, 0.86 * radius, level, peak, rng)
        parts = [solid.material(Material(look.color(c), shine=shine, grain=0.12, grain_m=0.006)) for c in colors]
        for start in range(0, count, 6):
            some = spots[start : start + 6]
            tones, angles = rng.uniform(0.8, 1.15, len(some)), rng.uniform(0, 6.3, len(some))
            if chips is None:
                solid.pieces(some, piece, thickness, parts[start // 6 % len(parts)], tones, angles, tilt)
                continue
            dark = solid.material(Material(look.color(chips), shine=0.2))
            for spot, tone, angle in zip(some, tones, angles, strict=True):
                solid.pieces(spot[None], piece, thickness, parts[start // 6 % len(parts)], [tone], [angle])
                dots = spot + np.column_stack([spots_on_disc(5, 0.017, rng), np.full(5, thickness)])
                solid.pieces(dots, unit_circle(6) * 0.0033, 0.001, dark, np.ones(5), np.zeros(5))

    return fill


def ring_slices(rind: Color, flesh: Color, core: Color, radius_m: float = 0.016, count: int = 11) -> Filling:
    """Return a function that draws round slices with a rind and a core, laid in a fan."""

    def fill(solid: Solid, level: float, radius: float, look: Look, rng: Generator) -> None:
        parts = [solid.material(Material(look.color(c), shine=0.2, grain=0.05)) for c in (rind, flesh, core)]
        spread = max(0.0, min(radius - radius_m, 0.055))
        spots = _heaped(count, spread + 1e-4, level, 0.012, rng)
        for spot in spots:
            tone = float(rng.uniform(0.92, 1.06))
            for part, size, lift in zip(parts, (1.0, 0.9, 0.3), (0.0, 0.005, 0.0055), strict=True):
                disc = unit_circle(16) * radius_m * size
                solid.pieces(
                    spot[None] + np.array([0, 0, lift]), disc, 0.004 if lift == 0 else 0.0006, part, [tone], [0.0]
                )

    return fill


def wedges(skin: Color, flesh: Color, count: int = 8, length_m: float = 0.034) -> Filling:
    """Return a function that draws half-moon slices with the skin on."""

    def fill(solid: Solid, level: float, radius: float, look: Look, rng: Generator) -> None:
        peel = solid.material(Material(look.color(skin), shine=0.3))
        pulp = solid.material(Material(look.color(flesh), shine=0.25, grain=0.05))
        arc = np.linspace(0, np.pi, 12)
        outer = np.stack([np.cos(arc), 0.75 * np.sin(arc)], axis=1).astype(np.float32) * length_m
        inner = np.concatenate([0.86 * outer, outer[:1] * 0]) + np.array([0, 0.04 * length_m], dtype=np.float32)
        for spot, angle in zip(
            _heaped(count, min(0.7 * radius, 0.05), level, 0.016, rng), rng.uniform(0, 6.3, count), strict=True
        ):
            solid.pieces(spot[None], outer, 0.007, peel, [1.0], [angle])
            solid.pieces(spot[None] + np.array([0, 0, 0.0072]), inner, 0.0006, pulp, [1.0], [angle])

    return fill


@drawing
def pile(solid: Solid, look: Look, rng: Generator, filling: Filling, radius: float = 0.05) -> None:
    """Draw loose food straight on the table."""
    filling(solid, 0.0005, radius, look, rng)
