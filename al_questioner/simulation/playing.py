"""One complete learning episode without ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from al_questioner.domain import Decision, EpisodeSettings, QueryRecord, random_stream
from al_questioner.questioning import Episode, Strategy, Teacher, make_strategy
from al_questioner.simulation.evaluation import EpisodeResult, Evaluation
from al_questioner.simulation.world import SeenWorld
from al_questioner.simulation.world_spec import WorldSpec

TurnWatcher = Callable[[int, QueryRecord | None, float], None]
"""Function that is called after each turn with its number, its query with the result, and the accuracy."""


def run_episode(
    world_spec: WorldSpec,
    settings: EpisodeSettings,
    teacher: Teacher,
    watch: TurnWatcher | None = None,
    world: SeenWorld | None = None,
    strategy: Strategy | None = None,
) -> EpisodeResult:
    """Play an episode in one process, as the three nodes do, without ROS.

    Args:
        world_spec: of the world; its seed is the learner's too.
        settings: settings of the episode.
        teacher: answers the queries.
        watch: called after each turn.
        world: the world, if it is open already.
        strategy: decides instead of the strategy that the settings name.
    """
    strategy = make_strategy(settings.strategy, settings.weights) if strategy is None else strategy
    evaluation = Evaluation(world_spec, settings, strategy.selector, world)
    play(evaluation, strategy, teacher, watch)
    return evaluation.result()


def play(evaluation: Evaluation, strategy: Strategy, teacher: Teacher, watch: TurnWatcher | None = None) -> None:
    """Play the episode that an evaluation is about to follow, see `run_episode`."""
    episode = Episode(evaluation.settings, random_stream(evaluation.world_spec.seed, 'learner'), strategy=strategy)
    for decision, record in turns(episode, evaluation.world, teacher):
        accuracy_now = evaluation.next_turn(record, episode.concepts)
        if watch is not None:
            watch(decision.turn, record, accuracy_now)


def turns(episode: Episode, world: SeenWorld, teacher: Teacher) -> Iterator[tuple[Decision, QueryRecord | None]]:
    """Play an episode turn by turn.

    Yields:
        The decision of each turn, and the result of its query, None if nothing was asked.
    """
    for turn in range(1, episode.settings.turns + 1):
        decision = episode.ask(world.scene(turn))
        record = None
        if decision.query is not None:
            record = episode.tell(teacher.answer(decision.query, world.truth(turn)))
        yield decision, record
