"""Advice on what to install if a module is missing."""

from __future__ import annotations

FOR_BAGS = {'rosbags': 'rosbags>=0.11,<0.12', 'mcap': 'mcap>=1'}
"""Requirements of the bag tools by module, as in setup.cfg; a ROS installation does not contain them."""


def remedy(module: str) -> str:
    """Return how to install a module that cannot be imported."""
    if module.split('.')[0] in FOR_BAGS:
        wanted = ' '.join(map(repr, FOR_BAGS.values()))
        return f'bags need what Ubuntu does not have: pip install {wanted} (there with --break-system-packages)'
    return 'without a ROS 2 installation, pip install ".[ros]" brings what is missing'
