"""Stored cells are refused for another version of the method, and for nothing else."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from al_questioner.domain import SettingsError
from al_questioner.experiments.plan import Condition, Plan
from al_questioner.experiments.semantics import SEMANTICS, SOURCES_OF_1
from al_questioner.experiments.storing import Store
from al_questioner.questioning import STRATEGIES
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, run_episode
from al_questioner.simulation.made_up_world import MadeUpWorld, made_up_scene
from shared.lunches import TASK

PLAN = Plan(tasks=('prepare_lunch',), conditions=(Condition(2, 2),), strategies=('random_fsq',), samples=(0,))
EPISODES = {1: '59b894199f2e541a'}
"""Digests by version; a strategy that joins changes the present one, which need not raise the version."""


def digest_of_queries() -> str:
    """Of what each strategy asks in one short episode, and how often the learner is right then."""
    found = []
    for strategy in sorted(set(STRATEGIES) - {'human'}):
        # Made-up features: other versions of OpenCV draw other pictures.
        made_up = MadeUpWorld(TASK, 5, 5)
        settings = episode_settings(TASK, strategy, 8.0, 12)
        teacher = ScriptedTeacher(TASK.symbols, made_up.relevant_groups, 5)
        world = PerceivedWorld(made_up, made_up_scene)
        result = run_episode(WorldSpec(TASK, 5, 5), settings, teacher, world=world)
        asked = [(q.turn, q.kind.value, q.object_id, q.symbol, q.cost) for q in result.queries]
        found.append((strategy, asked, [round(accuracy, 9) for accuracy in result.accuracy]))
    return hashlib.sha256(repr(found).encode()).hexdigest()[:16]


def test_a_change_of_what_is_asked_raises_the_version() -> None:
    """Otherwise half of a table would be played by another method."""
    assert digest_of_queries() == EPISODES[SEMANTICS], 'episodes are others now: raise SEMANTICS, and add their digest'


@pytest.mark.parametrize(('told', 'is_taken'), [(SOURCES_OF_1[0], True), ('0123456789abcdef', False)])
def test_folders_of_before_there_were_versions(tmp_path: Path, told: str, is_taken: bool) -> None:
    """Otherwise hours of playing would be lost because a file has another name."""
    Store(tmp_path, PLAN)
    (tmp_path / 'cells' / 'some').mkdir()
    (tmp_path / 'cells' / 'some' / 'cell.json').write_text('{}')
    manifest = json.loads((tmp_path / 'manifest.json').read_text())
    del manifest['semantics']
    manifest |= {'code': told, 'version': '0.0.1'}
    (tmp_path / 'manifest.json').write_text(json.dumps(manifest))
    if is_taken:
        Store(tmp_path, PLAN)
    else:
        with pytest.raises(SettingsError, match="with semantics '0123456789abcdef', not 1"):
            Store(tmp_path, PLAN)
