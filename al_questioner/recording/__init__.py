"""Bags: writing ones that survive a crash, reading, repairing, the episodes that they hold; and the session log."""

from al_questioner.recording.bags import Bag, BagError, BagMessage, Topic, deserialize, digest, read_bag
from al_questioner.recording.repair import RepairReport, repair
from al_questioner.recording.session import LeftOut, RecordedTurn, Session, read_sessions
from al_questioner.recording.session_log import LogWriteError, SessionLog, SessionLogError, read_log, repair_log
from al_questioner.recording.writing import BagWriter

__all__ = [
    'Bag',
    'BagError',
    'BagMessage',
    'BagWriter',
    'LeftOut',
    'LogWriteError',
    'RecordedTurn',
    'RepairReport',
    'Session',
    'SessionLog',
    'SessionLogError',
    'Topic',
    'deserialize',
    'digest',
    'read_bag',
    'read_log',
    'read_sessions',
    'repair',
    'repair_log',
]
