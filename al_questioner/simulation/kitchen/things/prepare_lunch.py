"""Kinds of objects of the prepare-lunch task: they go through states while lunch is made."""

from __future__ import annotations

from collections.abc import Mapping

from al_questioner.simulation.kitchen.things.fillings import liquid, noodles, pile
from al_questioner.simulation.kitchen.things.foods import sandwich
from al_questioner.simulation.kitchen.things.fruits import apple, bananas, round_fruit
from al_questioner.simulation.kitchen.things.kinds import Kind, State
from al_questioner.simulation.kitchen.things.palette import (
    BISCUIT,
    BLUE,
    BROWN,
    CREAM,
    DARK_RED,
    DRINK,
    FRUIT,
    GREEN,
    LIME,
    MAIN,
    ORANGE,
    PAPER,
    PURPLE,
    RED,
    SKY,
    SNACK,
    SPAGHETTI,
    TAN,
    TOMATO,
    YELLOW,
)
from al_questioner.simulation.kitchen.things.servings import (
    apple_wedges,
    banana_slices,
    cookies,
    crisps,
    last_cookies,
    nuts,
    orange_slices,
    rice,
)
from al_questioner.simulation.kitchen.things.vessels import (
    WHITE,
    Print,
    bag,
    bowl_of,
    can,
    carton,
    glass_of,
    jar,
    mug_of,
    plate_of,
    pot_of,
    tin,
)

PASTA = Print(((BLUE, YELLOW, SPAGHETTI), (DARK_RED, CREAM, SPAGHETTI)), 'PASTA', 'wave')
SOUP = Print(((RED, WHITE, YELLOW), (ORANGE, WHITE, RED)), 'SOUP', 'disc')
RICE = Print(((PAPER, RED, GREEN), (CREAM, BLUE, RED)), 'RICE', 'stripes')
CHIPS = Print(((YELLOW, RED, RED), (RED, YELLOW, WHITE)), 'CHIPS', 'disc')
COOKIE = Print(((BROWN, CREAM, BISCUIT), (PURPLE, CREAM, BISCUIT)), 'COOKIE', 'disc')
NUTS = Print(((GREEN, CREAM, BISCUIT), (BLUE, CREAM, BISCUIT)), 'NUTS', 'blocks')
JUICE = Print(((ORANGE, WHITE, GREEN), (PAPER, ORANGE, ORANGE)), 'JUICE', 'disc')
CAFE = Print(((DARK_RED, CREAM, CREAM), (CREAM, BROWN, BROWN)), 'CAFE', 'blocks')
COLA = Print(((RED, WHITE, WHITE), (BLUE, WHITE, RED)), 'COLA', 'wave')

_STATES: Mapping[tuple[str, str], tuple[State, ...]] = {
    ('pasta', MAIN): (
        State('in box', carton(PASTA, (0.085, 0.045, 0.185)), 0.5),
        State('in pot', pot_of(noodles(SPAGHETTI, None)), 1.6),
        State('in bowl', bowl_of(noodles(SPAGHETTI, TOMATO)), 0.45),
    ),
    ('soup', MAIN): (
        State('in can', tin(SOUP), 0.4),
        State('in pot', pot_of(liquid(TOMATO, ORANGE, 18, 0.008)), 1.5),
        State('in bowl', bowl_of(liquid(TOMATO, GREEN), SKY), 0.5),
    ),
    ('rice', MAIN): (
        State('in bag', bag(RICE, (0.1, 0.15, 0.045)), 0.5),
        State('in pot', pot_of(rice), 1.3),
        State('on plate', plate_of(rice), 0.6),
    ),
    ('sandwich', MAIN): (
        State('bread', sandwich(TAN, (), False), 0.12),
        State('whole', sandwich(TAN, (GREEN, YELLOW, TOMATO), False), 0.25),
        State('cut', sandwich(TAN, (GREEN, YELLOW, TOMATO), True), 0.15),
    ),
    ('crisps', SNACK): (
        State('in bag', bag(CHIPS), 0.15),
        State('in bowl', bowl_of(crisps, RED), 0.35),
        State('on plate', plate_of(crisps), 0.45),
    ),
    ('cookies', SNACK): (
        State('in box', carton(COOKIE, (0.14, 0.05, 0.07)), 0.3),
        State('on plate', plate_of(cookies), 0.55),
        State('left over', pile(last_cookies, 0.03), 0.03),
    ),
    ('nuts', SNACK): (
        State('in tin', tin(NUTS, (0.042, 0.085)), 0.25),
        State('in bowl', bowl_of(nuts, BROWN, (0.055, 0.04)), 0.25),
        State('spilled', pile(nuts, 0.055), 0.1),
    ),
    ('banana', FRUIT): (
        State('bunch', bananas(4, YELLOW), 0.6),
        State('single', bananas(1, YELLOW), 0.15),
        State('sliced', plate_of(banana_slices), 0.5),
    ),
    ('apple', FRUIT): (
        State('whole', apple(RED, LIME, YELLOW, blush=DARK_RED), 0.18),
        State('sliced', plate_of(apple_wedges), 0.55),
        State('in bowl', bowl_of(apple_wedges), 0.45),
    ),
    ('orange', FRUIT): (
        State('whole', round_fruit(ORANGE), 0.2),
        State('sliced', plate_of(orange_slices), 0.55),
        State('in bowl', bowl_of(orange_slices, SKY), 0.45),
    ),
    ('orange juice', DRINK): (
        State('in carton', carton(JUICE, (0.07, 0.07, 0.16), gable=True), 1.0),
        State('in glass', glass_of((0.97, 0.65, 0.15)), 0.4),
        State('with straw', glass_of((0.97, 0.65, 0.15), straw=RED), 0.4),
    ),
    ('coffee', DRINK): (
        State('in jar', jar((0.25, 0.13, 0.07), CAFE, BROWN), 0.4),
        State('in mug', mug_of((0.22, 0.12, 0.06), WHITE, BLUE, RED), 0.6),
        State('with milk', mug_of((0.68, 0.48, 0.3), WHITE, BLUE, RED, froth=0.1), 0.65),
    ),
    ('soda', DRINK): (
        State('in can', can(COLA), 0.36),
        State('in glass', glass_of((0.2, 0.08, 0.05)), 0.45),
        State('with straw', glass_of((0.2, 0.08, 0.05), straw=GREEN), 0.45),
    ),
}
_COLD = ('orange', 'orange juice', 'soda')
PREPARE_LUNCH = tuple(Kind(name, symbol, states, name in _COLD) for (name, symbol), states in _STATES.items())
"""Objects that go through states, as in the prepare-lunch task of the paper."""
