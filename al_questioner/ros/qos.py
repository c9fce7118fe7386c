"""Every quality of service of the graph (docs/interfaces.md), so that both ends of a topic agree."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""The last message reaches every subscriber, also one that comes later."""

EVENTS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
"""Messages that count one by one; what must not be lost is numbered and sent again."""

DIAGNOSTICS = QoSProfile(depth=10)
