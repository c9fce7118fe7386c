"""Quality of service of all topics (docs/reference/topics.md), so that both ends of a topic agree."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Profile of topics whose last message reaches every subscriber, also a late one."""

EVENTS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
"""Profile of topics of which every message counts; a message that must not be lost has a number and is repeated."""

RECORDED_LATCHED = QoSProfile(
    depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
RECORDED_EVENTS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
"""Profiles of a recorder, which must not miss a message even if it is busy for a while."""

DIAGNOSTICS = QoSProfile(depth=10)

SENSED = ('objects', 'scene_image')
"""Topics that drivers publish; a subscriber begins with the lowest request, so that no driver warns about it."""
