"""Fixtures of the tests of this folder."""

from shared.dialogues import made as made
from shared.dialogues import person as person
