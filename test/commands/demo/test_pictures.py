"""Captions of the pictures of an episode."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from matplotlib import pyplot as plt

from al_questioner.commands.demo import pictures
from al_questioner.commands.demo.new_table import recognise_new_table
from al_questioner.domain import QueryKind
from al_questioner.questioning import Human, make_strategy
from al_questioner.simulation import Evaluation, PerceivedWorld, WorldSpec, episode_settings, play
from shared.durable_sessions import TASK, TEACHER, WITH_RELEVANCE, ask_what_matters


def test_a_relevance_query_is_drawn(tmp_path: Path) -> None:
    """Otherwise the pictures of an episode with one would be missing."""
    settings = dataclasses.replace(WITH_RELEVANCE, turns=3)
    world_spec, asks = WorldSpec(TASK, 4, 4), Human(ask_what_matters)
    world = PerceivedWorld(world_spec.open())
    evaluation = Evaluation(world_spec, settings, None, world)
    play(evaluation, asks, TEACHER)
    result, new_table = evaluation.result(), recognise_new_table(evaluation, world)
    assert QueryKind.RELEVANCE in {record.kind for record in result.queries}
    assert all(path.is_file() for path in pictures.draw_pictures(result, new_table, world, tmp_path))


@pytest.mark.parametrize('strategy', ['random_fsq', 'rarest_demo'])
def test_the_caption_of_the_scene_counts_every_query(
    tmp_path: Path, strategy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Queries about no single object are counted, so that the numbers add up to the budget that was spent."""
    world_spec = WorldSpec(TASK, 4, 4)
    world = PerceivedWorld(world_spec.open())
    evaluation = Evaluation(world_spec, episode_settings(TASK, strategy, 12.0, 7), None, world)
    play(evaluation, make_strategy(strategy, {}), TEACHER)
    result, new_table = evaluation.result(), recognise_new_table(evaluation, world)
    titles = {}

    def keep(figure: plt.Figure, path: Path) -> Path:
        titles[path.stem] = figure.axes[0].get_title(loc='left')
        plt.close(figure)
        return path

    monkeypatch.setattr(pictures, 'save', keep)
    pictures.draw_pictures(result, new_table, world, tmp_path)
    kinds = [record.kind for record in result.queries]
    assert kinds.count(QueryKind.FEATURE_SUBSET) == 1
    for kind in set(kinds):
        words = f'{kind.value.replace("_", " ")} quer{"y" if kinds.count(kind) == 1 else "ies"}'
        assert f'{kinds.count(kind)} {words}' in titles['scene']
    assert f'{len(new_table.right)} of {TASK.scenes.objects} things' in titles['new_table']
