"""Bags: writing ones that survive a crash, reading, repairing, the episodes that they hold; and the session log.

What a name stands for is imported when it is asked for: the log needs no bags, and a robot may lack what bags need.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from al_questioner.recording.bags import Bag, BagError, BagMessage, Topic, deserialize, digest, read_bag
    from al_questioner.recording.repairing import RepairReport, repair
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

_HOMES = ('session_log', 'bags', 'session', 'writing', 'repairing')
"""The modules that these names are from; each imports no more than those before it."""


def __getattr__(name: str) -> object:
    if name in __all__:
        for home in _HOMES:
            module = import_module(f'{__name__}.{home}')
            if hasattr(module, name):
                return getattr(module, name)
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
