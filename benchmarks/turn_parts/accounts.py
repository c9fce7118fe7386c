"""Shares of a turn's wall time: work, encoding, and the rest for transport."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from measuring import Seconds

if TYPE_CHECKING:
    from turn_parts.echo import Hop
    from turn_parts.encoding import Encoding

THERE = ('turn', 'objects')
THERE_IF_ASKED = ('query', 'answer')
"""Messages that the turn waits for: written, sent, and read before it goes on."""
AWAY = ('learner_state',)
AWAY_IF_ASKED = ('answer_ack',)
AWAY_IF_NOT = ('decision',)
"""Messages that the learner has to send, and no more, before it goes on.

If it asks, it writes the decision and the markers while the teacher answers; after the answer it writes the markers
while perception looks. Neither is on the turn's way.
"""


def waited_for(asked: bool) -> tuple[str, ...]:
    """Topics whose messages a turn waits for."""
    return (*THERE, *(THERE_IF_ASKED if asked else ()))


def sent_away(asked: bool) -> tuple[str, ...]:
    """Topics of the messages that the learner publishes for others while the turn waits."""
    return (*AWAY, *(AWAY_IF_ASKED if asked else AWAY_IF_NOT))


def encoding_seconds(encodings: Mapping[str, Encoding], asked: bool) -> float:
    """Mean seconds that the encoding on a turn's way takes."""
    both = sum(float(np.mean(encodings[t].writing) + np.mean(encodings[t].reading)) for t in waited_for(asked))
    return both + sum(float(np.mean(encodings[topic].writing)) for topic in sent_away(asked))


def transport_seconds(hops: Mapping[str, Hop], asked: bool) -> float:
    """Median seconds that the transport on a turn's way takes, as measured by itself."""
    there = sum(float(np.median(hops[topic].there)) for topic in waited_for(asked))
    return there + sum(float(np.median(hops[topic].publishing)) for topic in sent_away(asked))


def remainders(
    walls: Seconds, work: Seconds, asked: Sequence[bool], encodings: Mapping[str, Encoding]
) -> tuple[Seconds, Seconds]:
    """Each turn's encoding, and what remains of its wall time without work and encoding.

    Args:
        walls: (k,) seconds from turn to turn.
        work: (k,) seconds that the same turns took offline.
        asked: whether each of them asked a question.
        encodings: by topic.

    Returns:
        (k,) seconds of encoding, (k,) seconds that remain; these are negative where the turn was faster than the sum
        of its parts, as it may be when processes work at the same time.
    """
    encoding = np.array([encoding_seconds(encodings, turn_asked) for turn_asked in asked])
    return encoding, walls - work - encoding
