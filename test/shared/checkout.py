"""The checkout under test, for what is no part of the package: `docs/`, `launch/`, `scripts/`, `bags/`."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
