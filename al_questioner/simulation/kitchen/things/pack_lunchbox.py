"""Kinds of objects of the pack-lunchbox task: a wide variety inside each category."""

from __future__ import annotations

from al_questioner.simulation.kitchen.things.fillings import liquid, noodles, pile
from al_questioner.simulation.kitchen.things.foods import bar, burger, pizza_slice, roll, sandwich
from al_questioner.simulation.kitchen.things.fruits import (
    Peel,
    apple,
    bananas,
    berries,
    bunch_of_grapes,
    melon_slice,
    pear,
    round_fruit,
)
from al_questioner.simulation.kitchen.things.kinds import Kind, thing
from al_questioner.simulation.kitchen.things.palette import (
    BLACK,
    BLUE,
    BROWN,
    CREAM,
    DARK_RED,
    DRINK,
    FRUIT,
    GREEN,
    LEMON,
    LIME,
    MAIN,
    ORANGE,
    PAPER,
    PEACH,
    PINK,
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
    cookies,
    curry,
    macaroni,
    nachos,
    nuts,
    popcorn,
    rice,
    salad,
)
from al_questioner.simulation.kitchen.things.vessels import (
    WHITE,
    Print,
    bag,
    bottle,
    bowl_of,
    can,
    carton,
    glass_of,
    mug_of,
    pan_of,
    plate_of,
)

CHIPS = Print(
    ((YELLOW, RED, RED), (RED, YELLOW, WHITE), (GREEN, WHITE, YELLOW), (BLUE, WHITE, YELLOW)), 'CHIPS', 'disc'
)
SALTY = Print(((BROWN, CREAM, TAN), (BLUE, CREAM, TAN)), 'SALTY', 'stripes')
SNAX = Print(((RED, YELLOW, TAN), (GREEN, CREAM, TAN)), 'SNAX', 'blocks')
RAISIN = Print(((RED, YELLOW, YELLOW), (PURPLE, WHITE, LIME)), 'RAISIN', 'disc')
SODAS = (RED, WHITE, WHITE), (BLUE, WHITE, RED), (GREEN, YELLOW, WHITE), (ORANGE, WHITE, YELLOW), (BLACK, RED, WHITE)
SODA = Print(SODAS, 'SODA', 'wave')
ZING = Print(((SKY, WHITE, RED), (PAPER, PURPLE, LIME)), 'ZING', 'stripes')
AQUA = Print(((BLUE, WHITE, SKY), (SKY, WHITE, BLUE), (PAPER, BLUE, GREEN)), 'AQUA', 'wave')
COLA = Print(((RED, WHITE, WHITE), (BLACK, RED, WHITE)), 'COLA', 'wave')
LIMO = Print(((YELLOW, GREEN, GREEN), (GREEN, WHITE, YELLOW)), 'LIMO', 'disc')
JUICE = Print(((ORANGE, WHITE, GREEN), (PURPLE, WHITE, PINK), (GREEN, WHITE, RED)), 'JUICE', 'disc')
MILK = Print(((PAPER, BLUE, SKY), (PAPER, RED, PINK)), 'MILK', 'wave')
DOWNY = Peel(0.03, 0.01, 0.04, (0.82, 0.25, 0.2))

PACK_LUNCHBOX: tuple[Kind, ...] = (
    thing('sandwich', MAIN, sandwich(TAN, (GREEN, YELLOW, TOMATO), False), 0.25),
    thing('cut sandwich', MAIN, sandwich((0.9, 0.82, 0.62), (PINK, GREEN), True), 0.15),
    thing('wrap', MAIN, roll((0.9, 0.8, 0.6), (GREEN, TOMATO)), 0.22),
    thing('burrito', MAIN, roll((0.84, 0.7, 0.48), (BROWN, YELLOW), 0.14, 0.032), 0.28),
    thing('hot dog', MAIN, roll((0.82, 0.58, 0.28), ((0.68, 0.25, 0.15),), 0.15, 0.026, YELLOW), 0.15),
    thing('burger', MAIN, burger(), 0.25),
    thing('pizza', MAIN, pizza_slice(), 0.14),
    thing('salad', MAIN, bowl_of(salad, WHITE), 0.3, cold=True),
    thing('pasta', MAIN, bowl_of(noodles(SPAGHETTI, TOMATO), SKY), 0.45),
    thing('macaroni', MAIN, bowl_of(macaroni, GREEN), 0.45),
    thing('soup', MAIN, bowl_of(liquid((0.85, 0.55, 0.15), GREEN), WHITE), 0.5),
    thing('curry', MAIN, plate_of(curry), 0.55),
    thing('fried rice', MAIN, pan_of(rice), 0.9),
    thing('crisps', SNACK, bag(CHIPS), 0.1),
    thing('nachos', SNACK, bowl_of(nachos, BROWN), 0.3),
    thing('popcorn', SNACK, bowl_of(popcorn, RED), 0.25),
    thing('pretzels', SNACK, bag(SALTY, (0.1, 0.14, 0.05)), 0.12),
    thing('chocolate bar', SNACK, bar(BROWN, YELLOW), 0.05),
    thing('cereal bar', SNACK, bar(GREEN, CREAM), 0.04),
    thing('fruit bar', SNACK, bar(DARK_RED, PINK, 0.1, 0.032), 0.035),
    thing('cookies', SNACK, pile(cookies, 0.04), 0.1),
    thing('crackers', SNACK, carton(SNAX, (0.11, 0.05, 0.16)), 0.2),
    thing('raisins', SNACK, carton(RAISIN, (0.055, 0.025, 0.08)), 0.05),
    thing('nuts', SNACK, bowl_of(nuts, GREEN, (0.05, 0.038)), 0.2),
    thing('apple', FRUIT, apple(RED, (0.55, 0.72, 0.22), YELLOW, (0.8, 0.3, 0.2), blush=RED), 0.18),
    thing('orange', FRUIT, round_fruit(ORANGE, peel=Peel(leaf=True)), 0.2),
    thing('mandarin', FRUIT, round_fruit((0.95, 0.55, 0.08), radius=0.03, squat=0.8, peel=Peel(shine=0.35)), 0.1),
    thing('peach', FRUIT, round_fruit(PEACH, (0.96, 0.74, 0.42), radius=0.036, peel=DOWNY), 0.16),
    thing('pear', FRUIT, pear((0.72, 0.74, 0.25), (0.8, 0.66, 0.25), (0.62, 0.45, 0.2), blush=(0.7, 0.35, 0.2)), 0.18),
    thing('banana', FRUIT, bananas(1, YELLOW, (0.8, 0.78, 0.25)), 0.15),
    thing('grapes', FRUIT, bunch_of_grapes((0.4, 0.12, 0.3), (0.65, 0.75, 0.3)), 0.25, cold=True),
    thing('strawberries', FRUIT, berries((0.8, 0.1, 0.12)), 0.08, cold=True),
    thing('lemon', FRUIT, round_fruit(LEMON, LIME, radius=0.029, squat=0.95, peel=Peel(shine=0.3)), 0.1),
    thing('plum', FRUIT, round_fruit(PURPLE, DARK_RED, radius=0.026, peel=Peel(0.1, 0.012, 0.25)), 0.07),
    thing('melon', FRUIT, melon_slice((0.2, 0.45, 0.18), (0.88, 0.25, 0.24)), 0.35, cold=True),
    thing('soda can', DRINK, can(SODA), 0.36, cold=True),
    thing('slim can', DRINK, can(ZING, (0.0265, 0.145)), 0.27, cold=True),
    thing('water bottle', DRINK, bottle((0.75, 0.87, 0.95), AQUA, BLUE, clear=0.7), 0.52),
    thing('cola bottle', DRINK, bottle((0.16, 0.06, 0.04), COLA, RED, clear=0.08), 0.55),
    thing('lemonade', DRINK, bottle((0.82, 0.87, 0.45), LIMO, GREEN, radius=0.03, height=0.2), 0.5),
    thing('juice box', DRINK, carton(JUICE, (0.05, 0.035, 0.105)), 0.22),
    thing('milk', DRINK, carton(MILK, (0.07, 0.07, 0.15), gable=True), 1.0, cold=True),
    thing('coffee', DRINK, mug_of((0.2, 0.11, 0.06), WHITE, BLUE, RED, GREEN), 0.6),
    thing('orange juice', DRINK, glass_of((0.97, 0.65, 0.15)), 0.4, cold=True),
)
"""Objects with a wide variety inside each category, as in the pack-lunchbox task of the paper."""
