"""Rosbags: writing ones that survive a crash, reading, repairing, and the episodes that they hold.

What a name stands for is imported when it is asked for.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.bags.episodes import LeftOut as LeftOut
    from al_questioner.bags.episodes import read_episodes as read_episodes
    from al_questioner.bags.reading import Bag as Bag
    from al_questioner.bags.reading import BagError as BagError
    from al_questioner.bags.reading import BagMessage as BagMessage
    from al_questioner.bags.reading import Topic as Topic
    from al_questioner.bags.reading import deserialize as deserialize
    from al_questioner.bags.reading import digest as digest
    from al_questioner.bags.reading import read_bag as read_bag
    from al_questioner.bags.recorded_episode import RecordedEpisode as RecordedEpisode
    from al_questioner.bags.recorded_episode import RecordedTurn as RecordedTurn
    from al_questioner.bags.repairing import RepairReport as RepairReport
    from al_questioner.bags.repairing import repair as repair
    from al_questioner.bags.writing import BagWriter as BagWriter

__all__, __getattr__ = lazy_names(
    __name__,
    {
        'episodes': ['LeftOut', 'read_episodes'],
        'reading': ['Bag', 'BagError', 'BagMessage', 'Topic', 'deserialize', 'digest', 'read_bag'],
        'recorded_episode': ['RecordedEpisode', 'RecordedTurn'],
        'repairing': ['RepairReport', 'repair'],
        'writing': ['BagWriter'],
    },
)
