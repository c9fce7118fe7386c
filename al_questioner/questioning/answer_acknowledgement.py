"""Acknowledgement of an answer, which the learner sends once it is on the disk."""

from __future__ import annotations

from al_questioner.domain import Answer
from al_questioner.questioning.answers import Receipt


def acknowledgement(answer: Answer | None, receipt: Receipt | None, reason: str) -> dict[str, object]:
    """Return the members of the `answer_ack` document.

    Args:
        answer: that is acknowledged; None if the text was no answer.
        receipt: what became of it; None if it was refused.
        reason: why it was not learnt from; empty if it was.
    """
    return {
        'query_id': None if answer is None else answer.query_id,
        'answer_id': None if answer is None else answer.answer_id,
        'accepted': receipt in (Receipt.ACCEPTED, Receipt.DUPLICATE),
        'reason': reason,
    }
