"""`dt_task`: the learning-centric strategy of the paper (section 2.1.2)."""

from __future__ import annotations

from al_questioner.domain import DECISION_FEATURES
from al_questioner.questioning.strategies.decision_theoretic import DecisionTheoretic


class DtTask(DecisionTheoretic):
    """Weighs four features of the learning task."""

    name = 'dt_task'
    weight_names = DECISION_FEATURES[:4]
