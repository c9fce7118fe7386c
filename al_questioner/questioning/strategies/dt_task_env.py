"""`dt_task_env`: the environmentally aware strategy of the paper (section 2.1.2)."""

from __future__ import annotations

from al_questioner.domain import DECISION_FEATURES
from al_questioner.questioning.strategies.decision_theoretic import DecisionTheoretic


class DtTaskEnv(DecisionTheoretic):
    """Weighs four features of the learning task and three of the environment."""

    name = 'dt_task_env'
    weight_names = DECISION_FEATURES
