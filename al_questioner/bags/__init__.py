"""Rosbags: writing ones that survive a crash, reading, repairing, and the episodes that they hold.

What a name stands for is imported when it is asked for.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.bags.episodes import LeftOut, read_episodes
    from al_questioner.bags.reading import Bag, BagError, BagMessage, Topic, deserialize, digest, read_bag
    from al_questioner.bags.recorded_episode import RecordedEpisode, RecordedTurn
    from al_questioner.bags.repairing import RepairReport, repair
    from al_questioner.bags.writing import BagWriter

__all__ = [
    'Bag',
    'BagError',
    'BagMessage',
    'BagWriter',
    'LeftOut',
    'RecordedEpisode',
    'RecordedTurn',
    'RepairReport',
    'Topic',
    'deserialize',
    'digest',
    'read_bag',
    'read_episodes',
    'repair',
]

_HOMES = {
    'Bag': 'reading',
    'BagError': 'reading',
    'BagMessage': 'reading',
    'Topic': 'reading',
    'deserialize': 'reading',
    'digest': 'reading',
    'read_bag': 'reading',
    'LeftOut': 'episodes',
    'RecordedTurn': 'recorded_episode',
    'RecordedEpisode': 'recorded_episode',
    'read_episodes': 'episodes',
    'RepairReport': 'repairing',
    'repair': 'repairing',
    'BagWriter': 'writing',
}

__getattr__ = lazy_names(__name__, _HOMES)
