"""What to install where a module is missing."""

from __future__ import annotations

FOR_BAGS = {'rosbags': 'rosbags>=0.11,<0.12', 'mcap': 'mcap>=1'}
"""What only those need who use bags, as setup.cfg requires it, by module; a ROS installation does not bring it."""


def remedy(module: str) -> str:
    """How to get a module that cannot be imported."""
    if module.split('.')[0] in FOR_BAGS:
        wanted = ' '.join(map(repr, FOR_BAGS.values()))
        return f'bags need what Ubuntu does not have: pip install {wanted} (there with --break-system-packages)'
    return 'without a ROS 2 installation, pip install ".[ros]" brings what is missing'
