"""Reading the weights of a strategy from a YAML file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from al_questioner.domain import Setting, SettingsError
from al_questioner.support.configuration import config_dir, named_file, read_yaml

WEIGHTS_FILE = Setting('weights_file', '', 'YAML file with weights of the strategy; empty: those in config/weights')

MEMBERS = ('weights', 'provenance', 'training')
"""Members of a weights file; the one on how the weights were learnt is for people."""


@dataclass(frozen=True)
class Weights:
    """Weights and constants of a strategy, by name, and where they come from, in words."""

    values: Mapping[str, float]
    provenance: str


def shipped_file(strategy: str) -> Path | None:
    """Return the file of the weights that ship for a strategy; None if there is none."""
    path = config_dir() / 'weights' / f'{strategy}.yaml'
    return path if path.is_file() else None


def load_weights(name_or_path: str) -> dict[str, float]:
    """Load the weights that ship under a name, such as that of a strategy, or those of a YAML file.

    Raises:
        InputError: there are none, or the file cannot be used.
    """
    return dict(read_weights(named_file('weights', str(name_or_path), 'weights')).values)


def read_weights(path: Path) -> Weights:
    """Read a file with a mapping `weights` of names to numbers, and a text `provenance`.

    Raises:
        InputError: the file cannot be read, a member that a weights file does not have, or a weight that is not a
            finite number.
    """
    content = read_yaml(path)
    for name in content:
        if name not in MEMBERS:
            raise SettingsError(f'{path}: unknown member {name!r}; a weights file has {", ".join(MEMBERS)}')
    values = content.get('weights')
    if not isinstance(values, dict) or not values:
        raise SettingsError(f'{path} has no mapping "weights" of names to numbers')
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise SettingsError(f'{path}: the weight of {name} must be a finite number, not {value!r}')
    return Weights({name: float(value) for name, value in values.items()}, str(content.get('provenance', '')).strip())
