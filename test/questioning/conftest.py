"""Fixtures of the tests of this folder."""

from shared.toys import toy as toy
