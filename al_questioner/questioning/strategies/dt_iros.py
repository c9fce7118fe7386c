"""`dt_iros`: the decision-theoretic baseline of the paper (section 2.1.1)."""

from __future__ import annotations

from al_questioner.domain import DECISION_FEATURES
from al_questioner.questioning.strategies.decision_theoretic import DecisionTheoretic


class DtIros(DecisionTheoretic):
    """Weighs two features of the learning task: discriminability and class uniformity."""

    name = 'dt_iros'
    weight_names = DECISION_FEATURES[:2]
