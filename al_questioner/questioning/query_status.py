"""The queries of an episode: how far each has come, and what came of it in the end."""

from __future__ import annotations

import math
from enum import Enum

from al_questioner.domain import Query, QueryRecord


class QueryStatus(Enum):
    """Status of a query.

    A query is awaited in the turn in which it is asked. Each turn can time out; the next one then awaits the same query
    or, if it cannot be answered any more as it was meant, withdraws it. An answer is taken in every status.
    """

    AWAITED = 'awaited'
    TIMED_OUT = 'timed out'
    WITHDRAWN = 'withdrawn'
    ANSWERED = 'answered'


PENDING = (QueryStatus.AWAITED, QueryStatus.TIMED_OUT)
"""The statuses of a query that is still put to the teacher."""


def query_id(number: int) -> str:
    """Return the id of the query of this number in its episode, 1 for the first."""
    return f'q{number}'


class QueryBook:
    """The queries of an episode in the order in which they were asked; no more than the last one is pending.

    Attributes:
        unanswered_turns: consecutive turns that timed out.
    """

    def __init__(self) -> None:
        self.by_id: dict[str, Query] = {}
        self.unanswered_turns = 0
        self._status: dict[str, QueryStatus] = {}
        self._records: dict[int, QueryRecord] = {}

    @property
    def pending(self) -> Query | None:
        """The query that waits for its answer; it may be of a turn that has timed out."""
        query = next(reversed(self.by_id.values()), None)
        return None if query is None or self._status[query.query_id] not in PENDING else query

    @property
    def awaited(self) -> Query | None:
        """The query for whose answer the present turn waits."""
        query = self.pending
        return None if query is None or self._status[query.query_id] is QueryStatus.TIMED_OUT else query

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """Records of the queries that were answered or withdrawn, in the order of their turns."""
        return tuple(self._records[turn] for turn in sorted(self._records))

    @property
    def spent(self) -> float:
        """Costs of the queries so far, the pending one included as if it were answered."""
        settled = [record.cost for record in self._records.values()]
        return math.fsum(settled if self.pending is None else [*settled, self.pending.cost])

    def record_of(self, query: Query) -> QueryRecord | None:
        """Return what came of a query; None while it is pending."""
        return self._records.get(query.turn)

    def await_answer(self, query: Query) -> None:
        """Note that the present turn waits for the answer to a query: a new one, or the pending one."""
        self.by_id[query.query_id] = query
        self._status[query.query_id] = QueryStatus.AWAITED

    def time_out(self, query: Query) -> None:
        """Note that the turn is over without the answer to the awaited query."""
        self._status[query.query_id] = QueryStatus.TIMED_OUT
        self.unanswered_turns += 1

    def withdraw(self, query: Query, record: QueryRecord) -> None:
        """Note that the pending query is no longer put to the teacher."""
        self._status[query.query_id] = QueryStatus.WITHDRAWN
        self._records[query.turn] = record

    def answer(self, query: Query, record: QueryRecord) -> None:
        """Note what came of a query that was answered, or that was answered otherwise before."""
        if self._status[query.query_id] is not QueryStatus.ANSWERED:
            self.unanswered_turns = 0
        self._status[query.query_id] = QueryStatus.ANSWERED
        self._records[query.turn] = record
