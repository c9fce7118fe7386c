"""Bags: writing ones that survive a crash, reading, repairing, and the episodes that they hold."""

from al_questioner.recording.bags import Bag, BagError, BagMessage, Topic, deserialize, digest, read_bag
from al_questioner.recording.repair import RepairReport, repair
from al_questioner.recording.session import RecordedTurn, Session, read_sessions
from al_questioner.recording.writing import BagWriter

__all__ = [
    'Bag',
    'BagError',
    'BagMessage',
    'BagWriter',
    'RecordedTurn',
    'RepairReport',
    'Session',
    'Topic',
    'deserialize',
    'digest',
    'read_bag',
    'read_sessions',
    'repair',
]
