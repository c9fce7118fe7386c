"""Kinds of objects and the states that they go through."""

from __future__ import annotations

from dataclasses import dataclass

from al_questioner.simulation.kitchen.things.vessels import Draw


@dataclass(frozen=True)
class State:
    """Look of a kind of object at some stage.

    Attributes:
        name: name of the state.
        draw: makes the solid.
        weight_kg: typical weight.
    """

    name: str
    draw: Draw
    weight_kg: float


@dataclass(frozen=True)
class Kind:
    """A kind of object.

    Attributes:
        name: its everyday name.
        symbol: the concept it belongs to, or 'none'.
        states: one, or several that it goes through in this order.
        cold: it is kept in the refrigerator.
    """

    name: str
    symbol: str
    states: tuple[State, ...]
    cold: bool = False


def thing(name: str, symbol: str, draw: Draw, weight_kg: float, cold: bool = False) -> Kind:
    """Return a kind of object that always looks the same."""
    return Kind(name, symbol, (State(name, draw, weight_kg),), cold)
