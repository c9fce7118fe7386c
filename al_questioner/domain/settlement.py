"""Ways to settle a contradiction between labels of one view."""

from __future__ import annotations

REFUSE, NEWEST, RELIABLE = 'refuse', 'newest', 'reliable'
SETTLEMENTS = (REFUSE, NEWEST, RELIABLE)
"""Names of the ways; `refuse` is to settle none."""
