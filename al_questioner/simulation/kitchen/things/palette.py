"""Colours of food, packages and tableware, and the symbols of the simulated tasks."""

from __future__ import annotations

from al_questioner.simulation.kitchen.drawing.texture import Color

MAIN, SNACK, FRUIT, DRINK = 'main_dish', 'snack', 'fruit', 'beverage'

RED: Color = (0.78, 0.12, 0.12)
DARK_RED: Color = (0.5, 0.06, 0.1)
ORANGE: Color = (0.93, 0.5, 0.1)
YELLOW: Color = (0.95, 0.8, 0.18)
GREEN: Color = (0.3, 0.6, 0.18)
LIME: Color = (0.6, 0.75, 0.2)
BLUE: Color = (0.13, 0.28, 0.68)
SKY: Color = (0.45, 0.7, 0.9)
PURPLE: Color = (0.42, 0.16, 0.5)
PINK: Color = (0.9, 0.5, 0.6)
BROWN: Color = (0.36, 0.21, 0.11)
BLACK: Color = (0.1, 0.1, 0.11)
CREAM: Color = (0.95, 0.9, 0.75)
TAN: Color = (0.82, 0.66, 0.42)
BISCUIT: Color = (0.78, 0.56, 0.3)
PAPER: Color = (0.93, 0.93, 0.9)
SPAGHETTI: Color = (0.93, 0.8, 0.45)
TOMATO: Color = (0.8, 0.22, 0.1)
LEMON: Color = (0.97, 0.87, 0.25)
PEACH: Color = (0.95, 0.66, 0.36)
