"""A learner with a session log: a session belongs to one learner, and to one episode."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from al_questioner.event_log.log import SessionLogError
from al_questioner.ros.nodes.learner import LearnerNode

EPISODE = {'task': 'prepare_lunch', 'seed': 4, 'budget': 6.0, 'turns': 5, 'strategy': 'u_sampling'}


def test_a_session_belongs_to_one_learner_and_one_episode(graph: Any, tmp_path: Path) -> None:
    """Otherwise two learners, or two episodes, would be mixed in one log."""
    parameters = {**EPISODE, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: learner.machine._durable.is_ready, 'a learner that has begun')
    with pytest.raises(SessionLogError, match='another process is using this session'):
        graph.start(LearnerNode, **parameters)
    graph.stop(learner)
    with pytest.raises(SessionLogError, match=r'the session there has budget 6\.0, not 7\.0; turns 5, not 9'):
        graph.start(LearnerNode, **{**parameters, 'budget': 7.0, 'turns': 9})
    graph.start(LearnerNode, **parameters)
