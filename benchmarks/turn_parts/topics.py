"""The topics of a turn and their message types."""

from __future__ import annotations

from collections.abc import Mapping

from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

TYPES: Mapping[str, type] = {
    'turn': String,
    'objects': PointCloud2,
    'scene_image': Image,
    'query': String,
    'decision': PointCloud2,
    'scene_markers': MarkerArray,
    'answer': String,
    'answer_ack': String,
    'learner_state': String,
}
"""In the order of their first message; `episode` comes once in an episode."""
SPOKEN: Mapping[str, tuple[str, ...]] = {
    'perception': ('objects', 'scene_image'),
    'teacher': ('answer',),
    'learner': ('turn', 'query', 'decision', 'scene_markers', 'answer_ack', 'learner_state'),
}
"""Topics by the node that publishes them."""
IF_ASKED = ('query', 'answer', 'answer_ack')
"""Topics on which nothing comes in an episode without a question."""
VOLATILE = ('answer', 'answer_ack', 'decision')
