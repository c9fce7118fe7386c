"""What the tests of this folder share."""

from shared.toys import toy as toy
