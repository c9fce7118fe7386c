"""Version of the method that played an episode; cells of different versions must not be compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from al_questioner.questioning.semantics import EARLIEST_SEMANTICS

SOURCES_OF_1 = ('f2692c07bc960135', '88588064bb742b17', '5b84a455e9410d92', '5a10b2e0f61fa920')
"""Hashes of the source in older manifests, which have no version; these sources gave the episodes of version 1."""


def semantics_of(manifest: Mapping[str, Any]) -> object:
    """Return the version of a manifest, or the hash of the source that an older one holds."""
    source = manifest.get('code')
    return manifest.get('semantics', EARLIEST_SEMANTICS if source in SOURCES_OF_1 else source)
