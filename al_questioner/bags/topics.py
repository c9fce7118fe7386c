"""Which topics a recording has, and which messages on them are ours: other nodes use the same names."""

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
"""What a recording holds: message type by the last part of the topic's name."""


def last_name(topic: str) -> str:
    """The last part of a topic's name."""
    return topic.rpartition('/')[2]


def is_document(message: BagMessage, kind: str) -> bool:
    """Whether a message on the topic of a kind of document is one, whole or damaged, and not another node's."""
    is_there = last_name(message.topic) == kind and message.type == STRING
    return is_there and f'al_questioner/{kind}/'.encode() in message.data
