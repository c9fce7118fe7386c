"""The events of an episode: encoding, durable log, replay, the episode that is written down, and what is told of it.

What reads a session is imported when it is asked for.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.event_log.log import LogContents as LogContents
    from al_questioner.event_log.log import SessionLogError as SessionLogError
    from al_questioner.event_log.log import read_log as read_log
    from al_questioner.event_log.summary import SessionSummary as SessionSummary
    from al_questioner.event_log.summary import StatedAnswer as StatedAnswer
    from al_questioner.event_log.summary import summarise_session as summarise_session

__all__, __getattr__ = lazy_names(
    __name__,
    {
        'log': ['LogContents', 'SessionLogError', 'read_log'],
        'summary': ['SessionSummary', 'StatedAnswer', 'summarise_session'],
    },
)
