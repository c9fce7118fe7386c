"""A picture must arrive as it was drawn, and what is no picture be refused."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from al_questioner.domain import InputError
from al_questioner.messages.pictures import image, picture_of_image

PICTURE = np.arange(4 * 5 * 3, dtype=np.uint8).reshape(4, 5, 3)


def message(**changes: Any) -> Any:
    made = image(PICTURE, None, SimpleNamespace, bytes)
    return SimpleNamespace(**{**vars(made), **changes})


def test_a_picture_survives() -> None:
    """Otherwise a person would be shown another table than the robot sees."""
    np.testing.assert_array_equal(picture_of_image(message()), PICTURE)


def test_padded_rows_are_understood() -> None:
    """Otherwise a camera driver that aligns its rows would give a skewed picture."""
    padded = np.pad(PICTURE.reshape(4, 15), ((0, 0), (0, 1)))
    np.testing.assert_array_equal(picture_of_image(message(step=16, data=padded.tobytes())), PICTURE)


@pytest.mark.parametrize(
    'changes',
    [{'encoding': 'mono16'}, {'height': 0}, {'width': 0}, {'step': 14}, {'height': 5}, {'data': b''}],
    ids=str,
)
def test_what_is_no_picture_is_refused(changes: dict[str, Any]) -> None:
    """Otherwise a broken camera driver would end the node, or have it read what is not there."""
    with pytest.raises(InputError, match='picture'):
        picture_of_image(message(**changes))
