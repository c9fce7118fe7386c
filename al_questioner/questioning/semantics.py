"""Version of the method: what is asked, given the settings, the scenes and the answers."""

from __future__ import annotations

SEMANTICS = 3
"""Present version. Raise it with every change after which the same settings give another episode.

`test/experiments/test_semantics.py` compares a few episodes with those of this version. Sessions that another version
began go on with the questions that were asked (`event_log.replay`), and experiments are not mixed.
"""
EARLIEST_SEMANTICS = 1
"""Version of what does not tell one."""
