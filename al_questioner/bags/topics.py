"""Topics of a recording, and a test for our messages on them, since other nodes may use the same names."""

from __future__ import annotations

from collections.abc import Mapping

from al_questioner.bags.reading import BagMessage

STRING = 'std_msgs/msg/String'
CLOUD = 'sensor_msgs/msg/PointCloud2'
TYPES: Mapping[str, str] = {
    'episode': STRING,
    'turn': STRING,
    'objects': CLOUD,
    'query': STRING,
    'answer': STRING,
    'answer_ack': STRING,
    'decision': CLOUD,
    'learner_state': STRING,
}
"""Message type of each recorded topic, by the last part of the topic's name."""


def last_name(topic: str) -> str:
    """Return the last part of a topic's name."""
    return topic.rpartition('/')[2]


def is_document(message: BagMessage, kind: str) -> bool:
    """Return whether a message on the topic of a kind of document is such a document, whole or damaged."""
    is_there = last_name(message.topic) == kind and message.type == STRING
    return is_there and f'al_questioner/{kind}/'.encode() in message.data
