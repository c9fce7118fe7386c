"""Prepared food: sandwiches and the like, bars."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from al_questioner.simulation.kitchen.drawing.geometry import Solid, resample, rounded_rectangle, unit_circle
from al_questioner.simulation.kitchen.drawing.texture import Color, Material, shifted
from al_questioner.simulation.kitchen.things.fillings import spots_on_disc
from al_questioner.simulation.kitchen.things.vessels import Look, drawing

LEAF: Color = (0.2, 0.5, 0.15)


@drawing
def sandwich(solid: Solid, look: Look, rng: Generator, bread: Color, layers: tuple[Color, ...], triangle: bool) -> None:
    """Draw two slices of bread with layers between them, square or cut across."""
    solid.turn_deg = (-70, 70)
    crumb = solid.material(Material(look.color(bread), shine=0.03, grain=0.1, grain_m=0.004))
    crust = solid.material(Material(shifted(look.color(bread), 0, 0.62), shine=0.03, grain=0.1))
    if triangle:
        outline = np.array([[-0.07, -0.03], [0.07, -0.03], [0.005, 0.04], [-0.005, 0.04]], dtype=np.float32)
    else:
        outline = rounded_rectangle(0.11, 0.1, 0.02)
    edge = crumb if triangle else crust
    solid.plate(outline, 0.013, edge)
    low = 0.013
    for color in layers:
        layer = solid.material(Material(look.color(color), shine=0.2, grain=0.12))
        ruffle = 1 + 0.035 * rng.standard_normal((len(outline), 1))
        solid.plate(outline * ruffle * 1.02, 0.006, layer, low=low)
        low += 0.006
    solid.plate(outline, 0.013, edge, low=low)
    solid.plate(outline * 0.93, 0.0006, crumb, low=low + 0.0132, tone=1.03)


@drawing
def burger(solid: Solid, look: Look, rng: Generator) -> None:
    """Draw a hamburger."""
    bread = solid.material(Material(look.color((0.78, 0.5, 0.22)), shine=0.3, sharpness=12, grain=0.06))
    parts = [solid.material(Material(look.color(c), shine=0.15, grain=0.15)) for c in
             ((0.35, 0.65, 0.2), (0.3, 0.17, 0.1), (0.95, 0.75, 0.2), (0.8, 0.2, 0.12))]  # fmt: skip
    solid.lathe([(0, 0.045), (0.015, 0.05)], bread)
    for i, part in enumerate(parts):
        ruffle = (0.052 + 0.002 * rng.standard_normal(28)).astype(np.float32)
        solid.plate(unit_circle(28) * ruffle[:, None], 0.006, part, low=0.015 + 0.006 * i)
    solid.ball(0.05, 0.032, bread, low=0.039, waist=0.1)
    seed = solid.material(Material((0.96, 0.9, 0.72)))
    spots = spots_on_disc(16, 0.036, rng)
    rise = 0.0715 - 0.013 * (np.linalg.norm(spots, axis=1) / 0.036) ** 2
    solid.pieces(np.column_stack([spots, rise]), unit_circle(6) * 0.0022, 0.0005, seed, np.ones(16), np.zeros(16))


@drawing
def roll(
    solid: Solid,
    look: Look,
    rng: Generator,
    skin: Color,
    filling: tuple[Color, ...],
    length: float = 0.16,
    radius: float = 0.027,
    topping: Color | None = None,
) -> None:
    """Draw a lying roll (wrap, burrito, hot dog) whose filling shows at its ends or its top."""
    wrap = solid.material(Material(look.color(skin), shine=0.08, grain=0.16, grain_m=0.012))
    along = np.linspace(-length / 2, length / 2, 16)
    path = np.stack([along, 0.004 * np.sin(along / length * 5)], axis=1)
    ends = np.clip((1 - np.abs(np.linspace(-1, 1, 16))) / 0.1, 0.72, 1)
    if topping is None:
        for i, color in enumerate(filling):
            inner = solid.material(Material(look.color(color), shine=0.2, grain=0.2))
            solid.tube(path * (1.06 - 0.012 * i), radius * (0.72 - 0.16 * i), inner, low=0.006 + 0.004 * i)
        solid.tube(path, radius * ends, wrap)
    else:
        solid.tube(path * 0.9, radius * ends * 1.25, wrap, flat=0.7)
        sausage = solid.material(Material(look.color(filling[0]), shine=0.4, grain=0.05))
        solid.tube(path * 1.08, radius * 0.58 * ends, sausage, low=0.022)
        sauce = solid.material(Material(look.color(topping), shine=0.4))
        steps = np.linspace(-0.42, 0.42, 26) * length
        solid.strand(np.stack([steps, 0.006 * np.sin(steps * 260), 0 * steps + 0.054], axis=1), 0.0028, sauce)


@drawing
def pizza_slice(solid: Solid, look: Look, rng: Generator) -> None:
    """Draw a slice of pizza."""
    cheese = solid.material(Material(look.color((0.9, 0.68, 0.25)), shine=0.25, grain=0.16, grain_m=0.012))
    crust = solid.material(Material((0.75, 0.5, 0.25), shine=0.1, grain=0.12))
    slices = solid.material(Material(look.color((0.7, 0.15, 0.1)), shine=0.3, grain=0.1))
    green = solid.material(Material(LEAF))
    arc = np.linspace(-0.36, 0.36, 10)
    rim = 0.15 * np.stack([np.sin(arc), np.cos(arc)], axis=1) - np.array([0, 0.09])
    solid.plate(np.r_[rim, [[0, -0.09]]], 0.009, cheese)
    solid.tube(rim, 0.011, crust)
    spots = np.array([[0.0, -0.03, 0.01], [-0.02, 0.015, 0.01], [0.025, 0.02, 0.01]])
    solid.pieces(spots, unit_circle(14) * 0.014, 0.002, slices, [1, 0.9, 1.05], [0, 0, 0])
    herbs = np.column_stack([rng.uniform(-0.02, 0.02, 6), rng.uniform(-0.04, 0.04, 6), np.full(6, 0.0125)])
    solid.pieces(herbs, unit_circle(6) * 0.004, 0.0006, green, np.ones(6), np.zeros(6))


@drawing
def bar(
    solid: Solid, look: Look, rng: Generator, wrapper: Color, accent: Color, length: float = 0.125, width: float = 0.038
) -> None:
    """Draw a chocolate or cereal bar in its wrapper."""
    foil = solid.material(Material(look.color(wrapper), shine=0.6, sharpness=12, grain=0.08, grain_m=0.012))
    stripe = solid.material(Material(look.color(accent), shine=0.5, grain=0.05))
    teeth = width * (0.5 + 0.05 * (np.arange(12) % 2))
    ends = np.linspace(-0.5, 0.5, 12) * width
    flap = np.r_[
        np.stack([teeth * 0 + length / 2 + 0.012, ends], axis=1),
        np.stack([-teeth * 0 - length / 2 - 0.012, ends[::-1]], axis=1),
    ]
    solid.plate(flap, 0.002, foil)
    solid.lathe(resample([(0.002, 1), (0.014, 1), (0.018, 0.9)]), foil, outline=rounded_rectangle(length, width, 0.006))
    band = rounded_rectangle(length * 0.55, width * 0.62, 0.004)
    solid.plate(band, 0.0005, stripe, low=0.0185)
