"""Where everything that is drawn at random comes from."""

from __future__ import annotations

import zlib

import numpy as np

from al_questioner.domain.errors import SettingsError


def random_stream(seed: int, stream: str) -> np.random.Generator:
    """An independent random stream for one part of an episode, the same in every process for the same seed.

    Raises:
        SettingsError: a negative seed.
    """
    if seed < 0:
        raise SettingsError(f'seed must be 0 or more, not {seed}')
    return np.random.default_rng([seed, zlib.crc32(stream.encode())])
