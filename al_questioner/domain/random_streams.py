"""Source of all random numbers: one generator for each named stream."""

from __future__ import annotations

import zlib

import numpy as np

from al_questioner.domain.errors import SettingsError


def random_stream(seed: int, stream: str) -> np.random.Generator:
    """Return an independent random generator for one part of an episode; the same seed gives the same in every process.

    Raises:
        SettingsError: a negative seed.
    """
    if seed < 0:
        raise SettingsError(f'seed must be 0 or more, not {seed}')
    return np.random.default_rng([seed, zlib.crc32(stream.encode())])
