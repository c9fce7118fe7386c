"""Stored cells are refused for another version of the method, and for nothing else."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest

from al_questioner.domain import SettingsError
from al_questioner.experiments.plan import Condition, Plan
from al_questioner.experiments.semantics import SOURCES_OF_1
from al_questioner.experiments.storing import Store
from al_questioner.questioning import STRATEGIES
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, run_episode
from al_questioner.simulation.made_up_world import MadeUpWorld, made_up_scene
from shared.lunches import TASK

PLAN = Plan(tasks=('prepare_lunch',), conditions=(Condition(2, 2),), strategies=('random_fsq',), samples=(0,))
EPISODES = {1: '59b894199f2e541a', 2: 'bc23fed136fa892b', 3: 'bc23fed136fa892b'}
"""Digests by version.

A strategy that joins, and other weights that ship, change the present one, which need not raise the version: a store
holds the strategies and the weights of its cells.
"""


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


@pytest.mark.parametrize(('source', 'version'), [(SOURCES_OF_1[0], '1'), ('0123456789abcdef', "'0123456789abcdef'")])
def test_folders_from_the_time_without_versions_are_known_by_their_source(
    tmp_path: Path, source: str, version: str
) -> None:
    """Hours of playing are not lost because a file has another name, nor mixed with those of another method."""
    Store(tmp_path, PLAN)
    (tmp_path / 'cells' / 'some').mkdir()
    (tmp_path / 'cells' / 'some' / 'cell.json').write_text('{}')
    manifest = json.loads((tmp_path / 'manifest.json').read_text())
    del manifest['semantics']
    manifest |= {'code': source, 'version': '0.0.1'}
    (tmp_path / 'manifest.json').write_text(json.dumps(manifest))
    with pytest.raises(SettingsError, match=f'with semantics {version}, not {SEMANTICS}'):
        Store(tmp_path, PLAN)
