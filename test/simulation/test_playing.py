"""A whole episode without ROS, played once and again."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from al_questioner.domain import DECISION_FEATURES, Answer, Costs, EpisodeSettings, Query, QueryKind
from al_questioner.questioning import STRATEGIES
from al_questioner.questioning.strategies.value_per_cost import VALUE_FEATURES
from al_questioner.simulation import EpisodeResult, PerceivedWorld, WorldSpec, episode_settings, load_task, run_episode
from shared.lunches import TASK, WORLD_SPEC, teacher


def repeats(result: EpisodeResult) -> int:
    """Count the things that were shown although named as they look, while others of the symbol were there."""
    world, known, count = PerceivedWorld(result.world_spec.open()), set(), 0
    for record in result.queries:
        if record.object_id is None:
            continue
        views = {o.object_id: (o.object_id, id(o)) for o in world.observations(record.turn)}
        truth = world.truth(record.turn)
        fresh = [i for i, view in views.items() if view not in known and truth[i] == record.symbol]
        count += bool(record.kind is QueryKind.DEMONSTRATION and views[record.object_id] in known and fresh)
        known.add(views[record.object_id])
    return count


@pytest.mark.parametrize('task', ['prepare_lunch', 'kitchen_table'])
def test_the_teacher_shows_what_the_learner_does_not_know(task: str) -> None:
    """A demonstration shows something new; and a teacher that is started again knows as much as before."""

    class StartedAnew:
        def answer(self, query: Query, truth: Mapping[int, str]) -> Answer:
            return teacher().answer(query, truth)

    world_spec = WorldSpec(load_task(task), 4, 4)
    settings = episode_settings(world_spec.task, 'rarest_demo', budget=100, turns=40)
    once = run_episode(world_spec, settings, teacher())
    assert repeats(once) == 0
    assert repeats(run_episode(world_spec, settings, teacher(repeat_shown=True))) > 0
    assert run_episode(world_spec, settings, StartedAnew()) == once


def test_episodes_on_an_open_world_are_those_on_a_new_one() -> None:
    """Otherwise a study whose strategies share a world would report episodes that nobody can play alone."""
    world = PerceivedWorld(WORLD_SPEC.open())
    for strategy in ('farthest_fsq', 'u_sampling', 'farthest_fsq'):
        settings = episode_settings(TASK, strategy, budget=7, turns=11)
        shared, alone = (run_episode(WORLD_SPEC, settings, teacher(), world=w) for w in (world, None))
        assert shared.queries == alone.queries
        assert shared.accuracy == alone.accuracy


@pytest.mark.parametrize('strategy', [name for name in STRATEGIES if name != 'human'])
def test_same_seed_same_episode_within_its_limits(strategy: str) -> None:
    """Otherwise a result could not be repeated, or would owe itself to queries that nobody granted."""
    settings = episode_settings(TASK, strategy, budget=7, turns=11)
    once, again = (run_episode(WORLD_SPEC, settings, teacher()) for _ in range(2))
    assert once.queries == again.queries
    assert once.accuracy == again.accuracy
    assert once.spent <= 7
    assert len(once.accuracy) == 11
    assert len({record.turn for record in once.queries}) == len(once.queries)


def test_other_seeds_give_other_episodes() -> None:
    """Otherwise all samples of a study would be one."""
    settings = episode_settings(TASK, 'random_fsq', budget=7, turns=11)
    other = WorldSpec(TASK, 5, 5)
    assert run_episode(WORLD_SPEC, settings, teacher()).queries != run_episode(other, settings, teacher()).queries


def test_a_teacher_who_never_knows_teaches_nothing() -> None:
    """Otherwise unknown answers would be learnt as labels."""
    result = run_episode(WORLD_SPEC, episode_settings(TASK, 'random_fsq', 6, 8), teacher(unknown_rate=1.0))
    assert {record.symbol for record in result.queries if record.kind.value == 'label'} == {None}
    assert result.final_accuracy == pytest.approx(1 / len(TASK.symbols))


@pytest.mark.parametrize(
    'changes',
    [
        {'length_scale': 1e-3, 'amplitude': 1e3},
        {'length_scale': 1e3, 'amplitude': 1e3},
        {'length_scale': 1e3, 'amplitude': 1e-3},
        {'budget': 1e12, 'costs': Costs(1e12, 1.0, 0.0)},
        {'strategy': 'dt_task_env', 'weights': dict.fromkeys(DECISION_FEATURES, 1e9)},
        {'weights': dict.fromkeys(VALUE_FEATURES, -1e9)},
    ],
)
@pytest.mark.filterwarnings('error')
def test_settings_at_the_ends_of_their_ranges_can_be_played(changes: dict[str, object]) -> None:
    """No setting within its range ends an episode, or leads to nothing but overflows."""
    changes = {'symbols': TASK.symbols, 'strategy': 'value_per_cost', 'budget': 4.0, 'turns': 5, **changes}
    played = run_episode(WORLD_SPEC, EpisodeSettings(**changes), teacher())
    assert len(played.accuracy) == 5
