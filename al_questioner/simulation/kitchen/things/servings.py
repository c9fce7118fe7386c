"""Loose food of the simulated tasks, in common sizes and colours."""

from __future__ import annotations

import numpy as np

from al_questioner.simulation.kitchen.drawing.geometry import rounded_rectangle, unit_circle
from al_questioner.simulation.kitchen.things.fillings import heap, ring_slices, wedges
from al_questioner.simulation.kitchen.things.palette import BISCUIT, BROWN, CREAM, GREEN, ORANGE, PAPER, RED, TOMATO

_CRISP = unit_circle(10) * np.array([0.021, 0.016], dtype=np.float32)
_COOKIE = unit_circle(16) * 0.026
_GRAIN = unit_circle(8) * np.array([0.006, 0.003], dtype=np.float32)
_NUT = unit_circle(8) * np.array([0.011, 0.006], dtype=np.float32)
_LEAFLET = unit_circle(9) * np.array([0.022, 0.014], dtype=np.float32)
_TRIANGLE = np.array([[0.03, 0], [-0.017, 0.026], [-0.017, -0.026]], dtype=np.float32)
_CUBE = rounded_rectangle(0.018, 0.016, 0.003)
_TUBE = rounded_rectangle(0.03, 0.01, 0.004)

crisps = heap(((0.93, 0.76, 0.35), (0.97, 0.83, 0.45)), _CRISP, 26, peak=0.028, tilt=0.25)
cookies = heap((BISCUIT, (0.7, 0.48, 0.24)), _COOKIE, 9, peak=0.024, thickness=0.008, chips=BROWN)
nuts = heap(((0.66, 0.42, 0.2), (0.8, 0.58, 0.32)), _NUT, 40, peak=0.014, thickness=0.006)
last_cookies = heap((BISCUIT,), _COOKIE, 2, peak=0.01, thickness=0.008, chips=BROWN)
popcorn = heap(((0.97, 0.93, 0.78), (0.95, 0.85, 0.55)), unit_circle(7) * 0.009, 46, peak=0.034, thickness=0.007)
nachos = heap(((0.93, 0.66, 0.2), (0.88, 0.58, 0.16)), _TRIANGLE, 18, peak=0.024, thickness=0.002, tilt=0.3)
salad = heap((GREEN, (0.45, 0.7, 0.25), TOMATO), _LEAFLET, 34, peak=0.03, tilt=0.25)
rice = heap((PAPER, CREAM), _GRAIN, 60, peak=0.02, thickness=0.0015, bed=0.9)
curry = heap(((0.8, 0.5, 0.12), (0.72, 0.38, 0.1)), _CUBE, 20, peak=0.014, thickness=0.008)
macaroni = heap(((0.95, 0.7, 0.2), (0.97, 0.77, 0.3)), _TUBE, 36, peak=0.022, thickness=0.007, shine=0.3)
banana_slices = ring_slices((0.93, 0.83, 0.4), (0.97, 0.92, 0.7), (0.85, 0.76, 0.5), 0.0155)
orange_slices = ring_slices(ORANGE, (0.97, 0.66, 0.2), CREAM, 0.03, 6)
apple_wedges = wedges(RED, (0.96, 0.92, 0.75))
