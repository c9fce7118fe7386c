"""Kinds of objects on a kitchen table that belong to no symbol; some look much like food."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from al_questioner.domain import NO_SYMBOL
from al_questioner.simulation.kitchen.drawing.geometry import Solid, rounded_rectangle, turned, unit_circle
from al_questioner.simulation.kitchen.drawing.texture import Color, Decal, Material, label_image, shifted
from al_questioner.simulation.kitchen.things.fruits import Peel, apple, round_fruit
from al_questioner.simulation.kitchen.things.kinds import Kind, thing
from al_questioner.simulation.kitchen.things.vessels import (
    STEEL,
    WHITE,
    Look,
    Print,
    bottle,
    can,
    carton,
    drawing,
    glass_of,
    jar,
    mug_of,
    plate_of,
    tin,
)

BLACK: Color = (0.11, 0.11, 0.12)
WOOD: Color = (0.68, 0.48, 0.28)
PALE_WOOD: Color = (0.85, 0.7, 0.48)
LEAF: Color = (0.22, 0.48, 0.2)
TERRACOTTA: Color = (0.72, 0.38, 0.24)
BLUE: Color = (0.15, 0.3, 0.65)
RED: Color = (0.75, 0.14, 0.13)
YELLOW: Color = (0.93, 0.8, 0.2)
GREEN: Color = (0.3, 0.6, 0.25)
CREAM: Color = (0.95, 0.9, 0.75)
PURPLE: Color = (0.4, 0.2, 0.5)
ORANGE: Color = (0.92, 0.5, 0.1)
STEEL_LOOK = Material(STEEL, shine=0.8, sharpness=18, grain=0.04, grain_m=0.03)


@drawing
def _fork(solid: Solid, look: Look, rng: Generator) -> None:
    steel = solid.material(STEEL_LOOK)
    solid.tube([(-0.1, 0), (-0.06, 0), (0.0, 0), (0.035, 0)], [0.007, 0.005, 0.0035, 0.005], steel, flat=0.4)
    solid.plate(
        [(0.03, -0.004), (0.045, -0.012), (0.06, -0.012), (0.06, 0.012), (0.045, 0.012), (0.03, 0.004)], 0.005, steel
    )
    for y in (-0.0105, -0.0035, 0.0035, 0.0105):
        solid.strand([(0.058, y, 0.003), (0.1, y, 0.005)], 0.0018, steel)


@drawing
def _knife(solid: Solid, look: Look, rng: Generator) -> None:
    steel, grip = solid.material(STEEL_LOOK), solid.material(Material(look.color(BLACK), shine=0.3))
    blade = [(0.0, -0.009), (0.09, -0.01), (0.115, -0.002), (0.118, 0.006), (0.09, 0.009), (0.0, 0.009)]
    solid.plate(blade, 0.004, steel)
    solid.tube([(-0.1, 0), (-0.05, 0.001), (0.002, 0)], [0.009, 0.008, 0.0085], grip, flat=0.8)


@drawing
def _spoon(solid: Solid, look: Look, rng: Generator) -> None:
    steel = solid.material(STEEL_LOOK)
    solid.tube([(-0.1, 0), (-0.05, 0), (0.03, 0)], [0.007, 0.004, 0.0035], steel, flat=0.5)
    bowl = unit_circle() * np.array([0.028, 0.018], dtype=np.float32)
    solid.ball(1, 0.012, steel, center=(0.055, 0), outline=bowl, waist=0.8)
    solid.lathe([(0.011, 0.85), (0.006, 0.4)], steel, center=(0.055, 0), outline=bowl, tone=0.7)


@drawing
def _wooden_spoon(solid: Solid, look: Look, rng: Generator) -> None:
    wood = solid.material(Material(look.color(PALE_WOOD), shine=0.05, grain=0.12, grain_m=0.015))
    solid.tube([(-0.09, 0), (0.0, 0), (0.07, 0)], [0.007, 0.006, 0.006], wood)
    bowl = unit_circle() * np.array([0.034, 0.023], dtype=np.float32)
    solid.ball(1, 0.014, wood, center=(0.1, 0), outline=bowl, waist=0.7)
    solid.lathe([(0.013, 0.8), (0.008, 0.3)], wood, center=(0.1, 0), outline=bowl, tone=0.82)


@drawing
def _keys(solid: Solid, look: Look, rng: Generator) -> None:
    brass = solid.material(Material((0.78, 0.66, 0.35), shine=0.7, sharpness=15))
    steel = solid.material(STEEL_LOOK)
    fob = solid.material(Material(look.pick(RED, BLUE, GREEN, BLACK), shine=0.3))
    for angle, part in ((0.4, steel), (1.1, brass), (1.9, steel)):
        along = [0.012, 0.055, 0.055, 0.048, 0.046, 0.04, 0.038, 0.012]
        across = [-0.003, -0.003, 0.002, 0.002, 0.006, 0.006, 0.003, 0.003]
        solid.plate(turned(np.column_stack([along, across]), angle), 0.003, part)
        head = turned(unit_circle(16) * 0.011 + np.array([0.014, 0], dtype=np.float32), angle)
        solid.plate(head, 0.004, part)
    ring = unit_circle(20) * 0.011
    solid.strand(np.column_stack([ring, np.full(20, 0.005)]), 0.0013, steel)
    solid.plate(
        turned(rounded_rectangle(0.045, 0.022, 0.008) - np.array([0.034, 0], dtype=np.float32), -0.5), 0.006, fob
    )


@drawing
def _phone(solid: Solid, look: Look, rng: Generator) -> None:
    case = solid.material(Material(look.pick(BLACK, WHITE, BLUE), shine=0.4))
    glass = solid.material(Material((0.05, 0.06, 0.09), shine=0.9, sharpness=25, grain=0.02))
    icon = solid.material(Material((0.3, 0.5, 0.8), shine=0.4))
    solid.plate(rounded_rectangle(0.075, 0.15, 0.01), 0.008, case)
    solid.plate(rounded_rectangle(0.069, 0.142, 0.008), 0.0005, glass, low=0.0085)
    spots = [(x, y, 0.0092) for y in (0.04, 0.01, -0.05) for x in (-0.02, 0.0, 0.02)]
    solid.pieces(spots, rounded_rectangle(0.011, 0.011, 0.003), 0.0002, icon, np.linspace(0.7, 1.3, 9), np.zeros(9))


@drawing
def book(solid: Solid, look: Look, rng: Generator, title: str, *covers: Color) -> None:
    """Draw a closed book lying down."""
    solid.turn_deg = (-50, 50)
    cover = look.pick(*covers)
    pages = solid.material(Material((0.93, 0.91, 0.84), shine=0.02, grain=0.08, grain_m=0.004))
    image = label_image(cover, WHITE, shifted(cover, 60, 1.2), title, look.variant, 1, 'blocks')
    board = solid.material(Material(cover, shine=0.2, grain=0.02, decal=Decal(image, 'top', (0.11, 0.16))))
    solid.plate(rounded_rectangle(0.11, 0.16, 0.003), 0.003, board)
    solid.plate(rounded_rectangle(0.102, 0.154, 0.002), 0.018, pages, low=0.003)
    solid.plate(rounded_rectangle(0.11, 0.16, 0.003), 0.003, board, low=0.021)


@drawing
def _newspaper(solid: Solid, look: Look, rng: Generator) -> None:
    solid.turn_deg = (-40, 40)
    image = np.full((150, 120, 3), 0.86, dtype=np.float32)
    image[8:24, 10:110] = 0.25
    image[34:82, 64:112] = 0.5
    for row in range(34, 144, 5):
        image[row : row + 2, 8:56] = 0.45
        if row > 86:
            image[row : row + 2, 64:112] = 0.45
    paper = solid.material(Material((0.8, 0.8, 0.8), shine=0.0, grain=0.03, decal=Decal(image, 'top', (0.14, 0.18))))
    solid.plate(rounded_rectangle(0.14, 0.18, 0.002), 0.006, paper)


@drawing
def _plant(solid: Solid, look: Look, rng: Generator) -> None:
    clay = solid.material(Material(look.pick(TERRACOTTA, WHITE, BLUE), shine=0.1, grain=0.06))
    soil = solid.material(Material((0.2, 0.14, 0.1), shine=0, grain=0.25, grain_m=0.004))
    leaf = solid.material(Material(look.color(LEAF), shine=0.25, grain=0.1))
    solid.lathe([(0, 0.035), (0.06, 0.047), (0.06, 0.051), (0.075, 0.051)], clay)
    with solid.inside(0.075, 0.046):
        solid.lathe([(0.068, 0.046), (0.068, 0.04)], soil)
    blade = unit_circle(12) * np.array([0.028, 0.011], dtype=np.float32) + np.array([0.026, 0], dtype=np.float32)
    n = 30
    angles = 2.39996 * np.arange(n) + rng.uniform(0, 6)
    reach = np.linspace(0.03, 0.0, n)
    centers = np.column_stack([reach * np.cos(angles), reach * np.sin(angles), np.linspace(0.08, 0.15, n)])
    solid.pieces(centers, blade, 0.001, leaf, rng.uniform(0.7, 1.25, n), angles, tilt=0.35)


@drawing
def _sponge(solid: Solid, look: Look, rng: Generator) -> None:
    foam = solid.material(Material(look.pick(YELLOW, (0.9, 0.55, 0.6)), shine=0, grain=0.16, grain_m=0.004))
    scour = solid.material(Material((0.15, 0.4, 0.2), shine=0, grain=0.2, grain_m=0.003))
    solid.box((0.11, 0.07, 0.026), foam, radius=0.006)
    solid.box((0.11, 0.07, 0.008), scour, low=0.026, radius=0.006)


@drawing
def _roll_of_paper(solid: Solid, look: Look, rng: Generator) -> None:
    paper = solid.material(Material(look.color((0.93, 0.93, 0.92)), shine=0, grain=0.035, grain_m=0.008))
    tube = solid.material(Material((0.45, 0.35, 0.25), shine=0, grain=0.05))
    solid.lathe([(0, 0.055), (0.2, 0.055)], paper)
    solid.lathe([(0.2005, 0.045), (0.2005, 0.03)], paper, tone=0.95)
    solid.lathe([(0.201, 0.02), (0.201, 0.015)], tube)


@drawing
def shaker(solid: Solid, look: Look, rng: Generator, body: Color, holes: Color) -> None:
    """Draw a salt cellar or pepper pot with a steel top."""
    glass = solid.material(Material(look.color(body), shine=0.7, sharpness=30, grain=0.06, clear=0.15))
    steel, dots = solid.material(STEEL_LOOK), solid.material(Material(holes))
    solid.lathe([(0, 0.02), (0.055, 0.0175)], glass)
    solid.lathe([(0.055, 0.019), (0.068, 0.018), (0.076, 0.01)], steel)
    ring = np.column_stack([unit_circle(6) * 0.006, np.full(6, 0.077)])
    solid.pieces(ring, unit_circle(6) * 0.0016, 0.0002, dots, np.ones(6), np.zeros(6))


@drawing
def _board(solid: Solid, look: Look, rng: Generator) -> None:
    solid.turn_deg = (-60, 60)
    wood = solid.material(Material(look.color(PALE_WOOD), shine=0.08, grain=0.09, grain_m=0.03))
    hole = solid.material(Material((0.3, 0.22, 0.15), shine=0))
    solid.plate(rounded_rectangle(0.17, 0.11, 0.018), 0.014, wood)
    solid.plate(unit_circle(14) * 0.009 + np.array([0.068, 0], dtype=np.float32), 0.0004, hole, low=0.0142)


@drawing
def _candle(solid: Solid, look: Look, rng: Generator) -> None:
    wax = solid.material(Material(look.pick(CREAM, RED, GREEN, WHITE), shine=0.25, sharpness=10, grain=0.03))
    wick = solid.material(Material(BLACK))
    solid.lathe([(0, 0.032), (0.088, 0.032), (0.09, 0.028)], wax)
    solid.lathe([(0.0895, 0.024), (0.086, 0.008)], wax, tone=0.85)
    solid.strand([(0, 0, 0.086), (0.001, 0, 0.1)], 0.0012, wick)


@drawing
def _scissors(solid: Solid, look: Look, rng: Generator) -> None:
    steel, grip = solid.material(STEEL_LOOK), solid.material(Material(look.pick(RED, ORANGE, BLACK, BLUE), shine=0.3))
    for side in (-1, 1):
        blade = np.array([(0.0, -0.007), (0.095, 0.0), (0.0, 0.007)])
        solid.plate(turned(blade, 0.12 * side), 0.004, steel)
        loop = unit_circle(18) * np.array([0.026, 0.016], dtype=np.float32) + np.array([-0.058, 0], dtype=np.float32)
        ring = np.vstack([loop, loop[:1]])
        solid.strand(np.column_stack([turned(ring, -0.36 * side), np.full(19, 0.004)]), 0.0045, grip)
        shank = turned([[-0.034, 0.0], [0.004, 0.0]], -0.3 * side)
        solid.strand(np.column_stack([shank, [0.004, 0.004]]), 0.0045, grip)


@drawing
def _remote(solid: Solid, look: Look, rng: Generator) -> None:
    body = solid.material(Material((0.14, 0.14, 0.15), shine=0.25, grain=0.03))
    keys, red = solid.material(Material((0.72, 0.72, 0.74))), solid.material(Material(RED))
    solid.lathe([(0, 1), (0.014, 1), (0.018, 0.94)], body, outline=rounded_rectangle(0.045, 0.16, 0.012))
    spots = np.array([(x, y, 0.018) for y in np.linspace(0.035, -0.06, 6) for x in (-0.012, 0.0, 0.012)])
    solid.pieces(spots, unit_circle(8) * 0.0038, 0.0015, keys, np.ones(18), np.zeros(18))
    solid.pieces(np.array([(0.012, 0.062, 0.018)]), unit_circle(8) * 0.004, 0.0015, red, [1.0], [0.0])


def _tennis_ball(look: Look, rng: Generator) -> Solid:
    solid = round_fruit((0.8, 0.87, 0.25), radius=0.033, squat=1.0, peel=Peel(0.1, 0.003, 0.0))(look, rng)
    seam = solid.material(Material(WHITE, shine=0))
    angles = np.linspace(-1.2, 1.2, 14)
    curve = np.stack([0.031 * np.sin(angles), -0.012 - 0.014 * np.cos(angles), 0.036 + 0.024 * np.cos(angles)], axis=1)
    solid.strand(curve, 0.0014, seam)
    return solid


@drawing
def _yarn(solid: Solid, look: Look, rng: Generator) -> None:
    color = look.pick(ORANGE, RED, BLUE, GREEN)
    wool = solid.material(Material(color, shine=0, grain=0.15, grain_m=0.004))
    solid.ball(0.038, 0.07, wool)
    angles = np.linspace(-np.pi / 2, np.pi / 2, 9)
    loops = []
    for bearing in rng.uniform(0, np.pi, 16):
        tilt = rng.uniform(-0.02, 0.02)
        ring = np.stack([0.037 * np.sin(angles), tilt * np.cos(angles), 0.036 + 0.034 * np.cos(angles)], axis=1)
        loops.append(turned(ring, bearing))
    solid.slices(np.array(loops), wool, rng.uniform(0.7, 1.25, 16), stroke=0.003)


@drawing
def _soap(solid: Solid, look: Look, rng: Generator) -> None:
    dish = solid.material(Material(WHITE, shine=0.4))
    bar = solid.material(
        Material(look.pick((0.75, 0.85, 0.6), (0.95, 0.75, 0.75), CREAM), shine=0.3, sharpness=10, grain=0.03)
    )
    solid.lathe([(0, 0.85), (0.014, 1)], dish, outline=rounded_rectangle(0.12, 0.085, 0.03))
    solid.ball(1, 0.024, bar, low=0.008, outline=rounded_rectangle(0.085, 0.055, 0.022))


@drawing
def _glasses_case(solid: Solid, look: Look, rng: Generator) -> None:
    leather = solid.material(
        Material(look.pick((0.35, 0.2, 0.12), BLACK, (0.3, 0.1, 0.12)), shine=0.25, sharpness=10, grain=0.08)
    )
    solid.ball(1, 0.042, leather, outline=rounded_rectangle(0.16, 0.065, 0.03))


@drawing
def _napkin(solid: Solid, look: Look, rng: Generator) -> None:
    cloth = solid.material(Material(look.pick(RED, WHITE, BLUE, YELLOW), shine=0, grain=0.06, grain_m=0.012))
    for i in range(3):
        solid.plate(
            turned(rounded_rectangle(0.13 - 0.004 * i, 0.13 - 0.004 * i, 0.004), 0.04 * i),
            0.003,
            cloth,
            low=0.003 * i,
            tone=0.9 + 0.05 * i,
        )


DISH = Print(((YELLOW, GREEN, GREEN), (WHITE, BLUE, GREEN)), 'DISH', 'wave')
CLEAN = Print(((BLUE, WHITE, YELLOW), (GREEN, WHITE, YELLOW)), 'CLEAN', 'stripes')
SOFT = Print(((BLUE, WHITE, CREAM), (GREEN, WHITE, YELLOW), (PURPLE, WHITE, CREAM)), 'SOFT', 'wave')
FIRE = Print(((RED, YELLOW, CREAM), (YELLOW, RED, BLUE)), 'FIRE', 'blocks')
CAT = Print(((PURPLE, WHITE, ORANGE), (RED, WHITE, YELLOW), (BLUE, WHITE, CREAM)), 'CAT', 'disc')
GLUE = Print(((YELLOW, BLUE, BLUE), (RED, WHITE, WHITE)), 'GLUE', 'blocks')

CLUTTER: tuple[Kind, ...] = tuple(
    thing(name, NO_SYMBOL, draw, weight_kg)
    for name, draw, weight_kg in (
        ('empty mug', mug_of(None, WHITE, BLUE, RED, GREEN), 0.35),
        ('empty glass', glass_of(None), 0.2),
        ('empty plate', plate_of(None), 0.45),
        ('fork', _fork(), 0.04),
        ('knife', _knife(), 0.07),
        ('spoon', _spoon(), 0.04),
        ('wooden spoon', _wooden_spoon(), 0.05),
        ('keys', _keys(), 0.08),
        ('phone', _phone(), 0.18),
        ('cookbook', book('COOK', RED, GREEN, BLUE), 0.5),
        ('novel', book('NOVEL', PURPLE, (0.2, 0.35, 0.4), ORANGE), 0.35),
        ('newspaper', _newspaper(), 0.2),
        ('plant', _plant(), 0.9),
        ('sponge', _sponge(), 0.02),
        ('paper towel', _roll_of_paper(), 0.25),
        ('salt', shaker((0.93, 0.93, 0.92), BLACK), 0.12),
        ('pepper', shaker((0.25, 0.2, 0.17), BLACK), 0.11),
        ('cutting board', _board(), 0.7),
        ('candle', _candle(), 0.3),
        ('scissors', _scissors(), 0.09),
        ('remote control', _remote(), 0.12),
        ('tennis ball', _tennis_ball, 0.06),
        ('ball of wool', _yarn(), 0.1),
        ('soap', _soap(), 0.2),
        ('glasses case', _glasses_case(), 0.1),
        ('napkin', _napkin(), 0.02),
        ('wooden apple', apple(PALE_WOOD, WOOD), 0.15),
        ('washing-up liquid', bottle((0.35, 0.75, 0.35), DISH, RED, radius=0.034, height=0.22, clear=0.2), 0.55),
        ('spray can', can(CLEAN, (0.028, 0.17)), 0.4),
        ('box of tissues', carton(SOFT, (0.13, 0.1, 0.07)), 0.15),
        ('box of matches', carton(FIRE, (0.055, 0.035, 0.02)), 0.02),
        ('cat food', tin(CAT, (0.037, 0.06)), 0.4),
        ('jar of glue', jar((0.92, 0.92, 0.88), GLUE, BLUE, (0.03, 0.08)), 0.25),
    )
)
"""Kinds of clutter, about as many as of food."""
