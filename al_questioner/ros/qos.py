"""Every quality of service of the graph (docs/reference/topics.md), so that both ends of a topic agree."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""The last message reaches every subscriber, also one that comes later."""

EVENTS = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
"""Messages that count one by one; what must not be lost is numbered and sent again."""

RECORDED_LATCHED = QoSProfile(
    depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)
RECORDED_EVENTS = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.VOLATILE)
"""The same for a listener that must not miss a message, even if it is busy for a while."""

DIAGNOSTICS = QoSProfile(depth=10)

SENSED = ('objects', 'scene_image')
"""What drivers publish: an ear for it asks for the least at first, so that no driver warns that it is not heard."""

TOPICS = (
    'episode',
    'turn',
    'objects',
    'scene_image',
    'scene_markers',
    'query',
    'answer',
    'answer_ack',
    'decision',
    'learner_state',
    '/diagnostics',
)
"""All topics of the nodes."""
