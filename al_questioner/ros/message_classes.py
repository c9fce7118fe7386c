"""Classes of the installed message types, and the part of a bag that can be played with them."""

from __future__ import annotations

import importlib
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from al_questioner.bags import Bag
from al_questioner.domain import InputError


def message_class(type_: str) -> Any:
    """Return the class of a type such as 'std_msgs/msg/String'.

    Raises:
        InputError: it is not installed.
    """
    package, _, name = type_.partition('/msg/')
    try:
        return getattr(importlib.import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError, ValueError, TypeError) as error:
        raise InputError(f'message type {type_} of the bag is not installed ({error})') from error


def installed_part(bag: Bag) -> tuple[Bag, Mapping[str, Sequence[str]]]:
    """Return the part of a bag that can be played, and the topics that cannot, by message type that is not installed.

    Raises:
        InputError: no message can be played.
    """
    missing: dict[str, list[str]] = defaultdict(list)
    for topic in bag.topics:
        try:
            message_class(topic.type)
        except InputError:
            missing[topic.type].append(topic.name)
    messages = tuple(message for message in bag.messages if message.type not in missing)
    if not messages:
        raise InputError(f'{bag.path}: nothing can be played: {", ".join(missing)} is not installed')
    return replace(bag, topics=tuple(t for t in bag.topics if t.type not in missing), messages=messages), missing
