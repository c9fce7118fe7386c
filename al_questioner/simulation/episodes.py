"""One whole learning episode without ROS, and how well the learner does while it lasts.

Accuracy is measured from outside: models of what the learner was told are held against observations that it never
sees. A learner in another process is followed with models of the evaluation's own, which are the same to the last bit.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import Kernel, Knowledge
from al_questioner.domain import (
    AMPLITUDE,
    Costs,
    Decision,
    EpisodeSettings,
    Observation,
    QueryRecord,
    Scene,
    SettingsError,
    generator,
)
from al_questioner.perception import perceive, view_features
from al_questioner.questioning import STRATEGIES, Episode, Strategy, Teacher, new_knowledge, read_weights, shipped_file
from al_questioner.simulation.opening import make_world
from al_questioner.simulation.task import Task
from al_questioner.simulation.world import World


@dataclass(frozen=True)
class WorldChoice:
    """Which world an episode plays in.

    Attributes:
        task: what is to be learnt, and where; as the sample has it, where samples differ.
        seed: of the scenes.
        sample: which sample of observations the scenes are drawn from.
        dataset: root of a directory of RGB-D crops, for tasks that read one.
    """

    task: Task
    seed: int
    sample: int
    dataset: Path | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, 'task', self.task.of_sample(self.sample))

    def open(self) -> World:
        """The world itself.

        Raises:
            InputError: the task needs a dataset that is not there, or cannot be read.
        """
        return make_world(self.task, self.seed, self.sample, self.dataset)


See = Callable[[Sequence[Observation]], Scene]
"""Makes feature vectors of observations."""


class PerceivedWorld:
    """A world as feature vectors; a scene that stays is perceived once, a view that comes back is measured once.

    Args:
        world: that is perceived.
        see: how; as our perception does if not given.
    """

    def __init__(self, world: World, see: See | None = None) -> None:
        self._world = world
        # Views are equal if they are the same object; a world keeps those it has shown anyway.
        self._see = see or partial(perceive, measure=lru_cache(maxsize=None)(view_features))
        self._seen: tuple[Observation, ...] = ()
        self._scene: Scene | None = None

    def truth(self, turn: int) -> Mapping[int, str]:
        """Symbol, or 'none', by object id: for the scripted teacher alone."""
        return self._world.truth(turn)

    def change_turns(self, turns: int) -> list[int]:
        """The turns up to `turns` that begin with a scene change."""
        return self._world.change_turns(turns)

    def report(self) -> str:
        """What a user should know of where the observations come from."""
        return self._world.report()

    def observations(self, turn: int) -> tuple[Observation, ...]:
        """What is on the table in a turn."""
        return self._world.scene(turn)

    def scene(self, turn: int) -> Scene:
        """The scene of a turn; the very same one as long as nothing changes."""
        observations = self._world.scene(turn)
        same = len(observations) == len(self._seen) and all(map(operator.is_, observations, self._seen))
        if self._scene is None or not same:
            self._seen, self._scene = observations, self._see(observations)
        return self._scene

    @cached_property
    def test_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """(k, m) features of the held-out observations, and their k symbols."""
        return self._see(self._world.test_observations()).features, self._world.test_labels()

    @cached_property
    def validation_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """(k, m) features of a second draw of held-out observations, and their k symbols: for the greedy oracle.

        Raises:
            InputError: the world has no second draw.
        """
        return self._see(self._world.validation_observations()).features, self._world.validation_labels()


def episode_settings(
    task: Task,
    strategy: str | None = None,
    budget: float | None = None,
    turns: int | None = None,
    change_interval: int | None = None,
    weights_file: str | None = None,
    costs: Costs | None = None,
    amplitude: float = AMPLITUDE,
    length_scale: float | None = None,
    tune_every: int = 0,
) -> EpisodeSettings:
    """Settings of an episode; what is not given comes from the task, and the weights from `config/weights`.

    A strategy that another package contributes gets the weights of the file, or none: whether it can use them is for it
    to say.

    Raises:
        InputError: a value out of range, an unknown strategy, or a weights file that cannot be used.
    """
    name = task.episode.strategy if strategy is None else strategy
    shipped = shipped_file(name)
    if weights_file and name in STRATEGIES and shipped is None:
        raise SettingsError(f'strategy {name} uses no weights, but the weights file {weights_file} is given')
    path = Path(weights_file).expanduser() if weights_file else shipped
    weights = {} if path is None else read_weights(path).values
    return EpisodeSettings(
        symbols=task.symbols,
        budget=task.episode.budget if budget is None else budget,
        turns=task.episode.turns if turns is None else turns,
        strategy=name,
        weights=weights,
        change_interval=task.scenes.change_interval if change_interval is None else change_interval,
        costs=task.episode.costs if costs is None else costs,
        amplitude=amplitude,
        length_scale=length_scale,
        tune_every=tune_every,
    )


def accuracy(probabilities: NDArray[np.float64], labels: Sequence[str], symbols: Sequence[str]) -> float:
    """Share of observations whose most probable symbol is the true one.

    Args:
        probabilities: (k, |Y|) q_y(x).
        labels: the k true symbols.
        symbols: the |Y| symbols in the order of the columns.

    Returns:
        A number in [0, 1]; where several symbols are the most probable, the true one among them counts as the share
        that guessing among them would get, so that a learner that knows nothing is at chance.
    """
    truth = np.array([symbols.index(label) for label in labels])
    probabilities = np.asarray(probabilities)
    largest = probabilities == probabilities.max(axis=1, keepdims=True)
    tied = largest.sum(axis=1)[largest[np.arange(len(truth)), truth]]
    # In fractions: thirds would add up to one number or another, by the order of the observations.
    hits = sum(Fraction(int(count), ties) for ties, count in enumerate(np.bincount(tied)) if count)
    return float(Fraction(hits) / len(truth))


@dataclass(frozen=True)
class EpisodeResult:
    """How an episode went.

    Attributes:
        choice, settings: what was played.
        queries: every query, in order.
        accuracy: on the held-out observations, after each turn.
        test_size: number of held-out observations.
        kernel: of the learner's models after the last turn.
    """

    choice: WorldChoice
    settings: EpisodeSettings
    queries: tuple[QueryRecord, ...]
    accuracy: tuple[float, ...]
    test_size: int
    kernel: Kernel

    @property
    def spent(self) -> float:
        """What the queries took from the budget."""
        return float(sum(record.cost for record in self.queries))

    @property
    def final_accuracy(self) -> float:
        """Accuracy after the last turn."""
        return self.accuracy[-1]


class Evaluation:
    """Follows an episode turn by turn and measures, on held-out observations, a learner that was told the same.

    Args:
        choice: the world of the episode.
        settings: of the episode.
        world: that world, if it is open already: episodes that share it draw and measure every view once.
    """

    def __init__(self, choice: WorldChoice, settings: EpisodeSettings, world: PerceivedWorld | None = None) -> None:
        self.choice = choice
        self.settings = settings
        self.world = PerceivedWorld(choice.open()) if world is None else world
        self._knowledge = new_knowledge(settings)
        self._features, self._labels = self.world.test_set
        self._queries: list[QueryRecord] = []
        self._accuracy: list[float] = []
        self._measured_version = -1

    @property
    def turn(self) -> int:
        """The last turn that was followed."""
        return len(self._accuracy)

    def next_turn(self, record: QueryRecord | None, knowledge: Knowledge | None = None) -> float:
        """Accuracy after one more turn.

        Args:
            record: what was asked and told in it, None if nothing was asked.
            knowledge: what the learner knows after it, where that is at hand, the same object at every turn; else the
                evaluation learns the same.
        """
        if record is not None:
            self._queries.append(record)
        if knowledge is None:
            self._follow(record)
        else:
            self._knowledge = knowledge
        if self._knowledge.model_version == self._measured_version:
            self._accuracy.append(self._accuracy[-1])
        else:
            probabilities = self._knowledge.predict_proba(self._features)
            self._accuracy.append(accuracy(probabilities, self._labels, self.settings.symbols))
            self._measured_version = self._knowledge.model_version
        return self._accuracy[-1]

    def correct(self, queries: Sequence[QueryRecord]) -> None:
        """Take in what was said later about turns that were followed already.

        If anything else is known of them now, accuracy is measured anew in every turn, as if it had been said at once.

        Args:
            queries: what came of all queries so far; those of turns to come are passed over.
        """
        followed = [record for record in queries if record.turn <= self.turn]
        if followed == self._queries:
            return
        turns, by_turn = self.turn, {record.turn: record for record in followed}
        self._knowledge = new_knowledge(self.settings)
        self._queries, self._accuracy, self._measured_version = [], [], -1
        for turn in range(1, turns + 1):
            self.next_turn(by_turn.get(turn))

    def result(self) -> EpisodeResult:
        """The episode so far."""
        return EpisodeResult(
            self.choice,
            self.settings,
            tuple(self._queries),
            tuple(self._accuracy),
            len(self._labels),
            self._knowledge.kernel,
        )

    def _follow(self, record: QueryRecord | None) -> None:
        scene = self.world.scene(self.turn + 1)
        self._knowledge.observe(scene)
        if record is not None:
            self._knowledge.learn(record, scene)
        if self.settings.tunes_after(self.turn + 1):
            self._knowledge.tune()


TurnWatcher = Callable[[int, QueryRecord | None, float], None]
"""Called after each turn with its number, what was asked and told in it, and the accuracy then."""


def run_episode(
    choice: WorldChoice,
    settings: EpisodeSettings,
    teacher: Teacher,
    watch: TurnWatcher | None = None,
    world: PerceivedWorld | None = None,
    strategy: Strategy | None = None,
) -> EpisodeResult:
    """Play an episode in one process: what the three nodes do, without ROS.

    Args:
        choice: the world; its seed is the learner's too.
        settings: of the episode.
        teacher: who answers.
        watch: called after each turn.
        world: the world of the choice, if it is open already.
        strategy: who decides in the place of the strategy that the settings name.
    """
    evaluation = Evaluation(choice, settings, world)
    play(evaluation, teacher, watch, strategy)
    return evaluation.result()


def play(
    evaluation: Evaluation, teacher: Teacher, watch: TurnWatcher | None = None, strategy: Strategy | None = None
) -> None:
    """Play the episode that an evaluation is about to follow, see `run_episode`."""
    episode = Episode(evaluation.settings, generator(evaluation.choice.seed, 'learner'), strategy=strategy)
    for decision, record in turns(episode, evaluation.world, teacher):
        accuracy_now = evaluation.next_turn(record, episode.knowledge)
        if watch is not None:
            watch(decision.turn, record, accuracy_now)


def turns(episode: Episode, world: PerceivedWorld, teacher: Teacher) -> Iterator[tuple[Decision, QueryRecord | None]]:
    """Play an episode turn by turn.

    Yields:
        What was decided in each turn, and what came of it, None if nothing was asked.
    """
    for turn in range(1, episode.settings.turns + 1):
        decision = episode.ask(world.scene(turn))
        record = None
        if decision.query is not None:
            record = episode.tell(teacher.answer(decision.query, world.truth(turn)))
        episode.tune()
        yield decision, record
