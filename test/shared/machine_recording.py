"""Recording of a machine at work, and its repetition by another machine."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Generator, Iterator, Mapping
from typing import Any

import numpy as np

from al_questioner.protocol.effects import Effect, Effects
from al_questioner.protocol.events import Event, Now
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import PictureToDraw


@dataclasses.dataclass
class Step:
    """An event, and all that went in and out of the machine while it handled it.

    Attributes:
        readings: each reading of a clock: which clock, and what it showed.
        effects: all that it wanted done, in order.
        errors: errors of what could not be done, by the number of the effect.
        failure: error that the machine left to its node; empty if it left none.
    """

    event: Event
    readings: list[tuple[str, float | int]] = dataclasses.field(default_factory=list)
    effects: list[Effect] = dataclasses.field(default_factory=list)
    errors: dict[int, Exception] = dataclasses.field(default_factory=dict)
    failure: str = ''


class _NotedTime:
    """A time whose readings are noted."""

    def __init__(self, now: Now, step: Step) -> None:
        self._now = now
        self._readings = step.readings

    @property
    def steady(self) -> float:
        """See `Now`."""
        self._readings.append(('steady', self._now.steady))
        return self._readings[-1][1]

    @property
    def clock(self) -> int:
        """See `Now`."""
        self._readings.append(('clock', self._now.clock))
        return int(self._readings[-1][1])


class _ReadAgain:
    """A time that shows the readings of a step once more, each clock its own."""

    def __init__(self, step: Step) -> None:
        self._left = list(step.readings)

    @property
    def steady(self) -> float:
        """See `Now`."""
        return self._next('steady')

    @property
    def clock(self) -> int:
        """See `Now`."""
        return int(self._next('clock'))

    def _next(self, name: str) -> float | int:
        assert self._left, f'the clock {name} is read once more than before'
        clock, reading = self._left.pop(0)
        assert clock == name, f'the clock {name} is read where {clock} was'
        return reading

    def check_all_read(self) -> None:
        """Fail if fewer readings were taken than before."""
        assert not self._left, f'not read: {self._left}'


class Recording:
    """Recording of all that goes in and out of a machine from now on.

    Attributes:
        machine: whose it is.
        steps: one for each event, in order.
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.steps: list[Step] = []
        handle = machine.handle

        def handle_noted(event: Event, now: Now) -> Effects:
            self.steps.append(step := Step(event))
            yield from _noted(handle(event, _NotedTime(now, step)), step)

        machine.handle = handle_noted

    @property
    def effects(self) -> list[Effect]:
        """All that the machine wanted done."""
        return [effect for step in self.steps for effect in step.effects]


def repeat(steps: list[Step], machine: Machine) -> Iterator[tuple[Step, Step]]:
    """Have a machine handle the same events at the same times, with the same errors; yield each step as it was and is.

    Raises:
        AssertionError: it reads the time otherwise.
    """
    for before in steps:
        now, again = _ReadAgain(before), Step(before.event)
        effects = _noted(machine.handle(before.event, now), again)
        _exhaust(effects, lambda number, errors=before.errors: errors.get(number))
        now.check_all_read()
        yield before, again


def value_of(thing: Any) -> Any:
    """Return what is equal for equal things: arrays to the last bit, pictures as drawn, dataclasses by their fields."""
    if isinstance(thing, PictureToDraw):
        return value_of(thing.drawn())
    if isinstance(thing, np.ndarray):
        return (str(thing.dtype), thing.shape, thing.tobytes())
    if dataclasses.is_dataclass(thing):
        fields = {field.name: value_of(getattr(thing, field.name)) for field in dataclasses.fields(thing)}
        return (type(thing).__name__, fields)
    if isinstance(thing, Mapping):
        return {key: value_of(each) for key, each in thing.items()}
    if isinstance(thing, (list, tuple)):
        return [value_of(each) for each in thing]
    return thing


def _noted(effects: Effects, step: Step) -> Generator[Effect, None, None]:
    """Pass effects on, and errors back, and note both."""
    try:
        effect = next(effects)
        while True:
            step.effects.append(effect)
            try:
                yield effect
            except Exception as error:  # noqa: BLE001 - it goes to the machine
                step.errors[len(step.effects) - 1] = error
                effect = effects.throw(error)
            else:
                effect = next(effects)
    except StopIteration:
        return
    except Exception as error:
        step.failure = f'{type(error).__name__}: {error}'
        raise


def _exhaust(effects: Effects, error_of: Callable[[int], Exception | None]) -> None:
    """Take all effects; throw errors back where there are any. The step has noted how it ended."""
    try:
        next(effects)
        number = 0
        while True:
            error = error_of(number)
            if error is None:
                next(effects)
            else:
                effects.throw(error)
            number += 1
    except AssertionError:
        raise
    except Exception:  # noqa: BLE001 - the end, or a failure that the step holds
        return
