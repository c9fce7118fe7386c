"""An offline episode and its evaluation: the numbers that every comparison of strategies rests on."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from al_questioner.domain import (
    AMPLITUDE,
    DECISION_FEATURES,
    VALUE_FEATURES,
    Answer,
    Costs,
    EpisodeSettings,
    Query,
    QueryKind,
    SettingsError,
    View,
    generator,
)
from al_questioner.perception import perceive, view_features
from al_questioner.questioning import STRATEGIES, Episode
from al_questioner.simulation import (
    EpisodeResult,
    Evaluation,
    PerceivedWorld,
    ScriptedTeacher,
    WorldChoice,
    accuracy,
    episode_settings,
    load_task,
    run_episode,
)

TASK = load_task('prepare_lunch')
CHOICE = WorldChoice(TASK, 4, 4)
SYMBOLS = ('a', 'b')


def teacher(**rates: float | bool) -> ScriptedTeacher:
    return ScriptedTeacher(TASK.symbols, TASK.relevant_groups, 4, **rates)


@pytest.mark.parametrize(
    ('probabilities', 'expected'),
    [
        ([[0.9, 0.1], [0.2, 0.3]], 1.0),
        ([[0.1, 0.9], [0.3, 0.2]], 0.0),
        ([[0.5, 0.5], [0.5, 0.5]], 0.5),
        ([[0.9, 0.1], [0.4, 0.4]], 0.75),
    ],
)
def test_accuracy_of_hand_made_cases(probabilities: list[list[float]], expected: float) -> None:
    """Every reported figure would be another one; a learner that knows nothing must be at chance."""
    assert accuracy(np.array(probabilities), ['a', 'b'], SYMBOLS) == expected


@pytest.mark.parametrize('symbols', [3, 5, 7])
def test_an_accuracy_is_one_number_whatever_the_order(symbols: int) -> None:
    """Two strategies that are equally accurate would be told apart by the order of the observations."""
    rng, names = np.random.default_rng(0), tuple('abcdefg'[:symbols])
    hits = np.array([True] * 10 + [False] * 27)
    found = set()
    for _ in range(200):
        certain = np.where(np.arange(symbols) == 0, 0.9, 0.1)
        probabilities = np.where(rng.permutation(hits)[:, None], certain, 0.5)
        found.add(accuracy(probabilities, ['a'] * 37, names))
    assert found == {float(Fraction(10 * symbols + 27, 37 * symbols))}


def repeats(result: EpisodeResult) -> int:
    """How many things were shown that had been named as they look, while others of the symbol were there."""
    world, known, count = PerceivedWorld(result.choice.open()), set(), 0
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
    """Demonstrations would be paid for and tell nothing; and a teacher that is started anew must know as much."""

    class StartedAnew:
        def answer(self, query: Query, truth: Mapping[int, str]) -> Answer:
            return teacher().answer(query, truth)

    choice = WorldChoice(load_task(task), 4, 4)
    settings = episode_settings(choice.task, 'rarest_demo', budget=100, turns=40)
    once = run_episode(choice, settings, teacher())
    assert repeats(once) == 0
    assert repeats(run_episode(choice, settings, teacher(repeat_shown=True))) > 0
    assert run_episode(choice, settings, StartedAnew()) == once


def test_what_is_said_later_is_measured_as_if_it_had_been_said_at_once() -> None:
    """The demo would show an episode in which late answers and corrections never came."""
    settings = episode_settings(TASK, 'random_fsq', budget=8, turns=8)
    whole = run_episode(CHOICE, settings, teacher())
    early, late = whole.queries[:2], whole.queries[2]
    evaluation = Evaluation(CHOICE, settings)
    for turn in range(1, late.turn + 1):
        evaluation.next_turn(next((record for record in early if record.turn == turn), None))
    evaluation.correct(whole.queries)
    assert evaluation.result().queries == whole.queries[:3]
    assert evaluation.result().accuracy == whole.accuracy[: late.turn]
    before = evaluation.result()
    evaluation.correct(whole.queries)
    assert evaluation.result() == before


@pytest.mark.parametrize('tune_every', [0, 3])
@pytest.mark.parametrize('strategy', ['dt_task', 'u_sampling', 'farthest_fsq'])
def test_evaluation_believes_what_the_learner_believes(strategy: str, tune_every: int) -> None:
    """Accuracy would be that of other models than the robot has."""
    settings = episode_settings(TASK, strategy, budget=8, turns=12, tune_every=tune_every)
    evaluation = Evaluation(CHOICE, settings)
    features, labels = evaluation.world.test_set
    episode = Episode(settings, generator(4, 'learner'))
    for turn in range(1, 13):
        decision = episode.ask(evaluation.world.scene(turn))
        record = None
        if decision.query is not None:
            record = episode.tell(teacher().answer(decision.query, evaluation.world.truth(turn)))
        episode.tune()
        measured = evaluation.next_turn(record)
        assert measured == accuracy(episode.knowledge.predict_proba(features), labels, TASK.symbols)
    assert evaluation.result().kernel == episode.knowledge.kernel


def test_playing_tunes_at_the_turns_that_are_due() -> None:
    """The option would have no effect on what is asked, or also where it is off."""
    plain, often, never_due = (
        run_episode(CHOICE, episode_settings(TASK, 'u_sampling_fsq', 8, 12, tune_every=every), teacher())
        for every in (0, 2, 13)
    )
    assert plain.queries == never_due.queries
    assert plain.accuracy == never_due.accuracy
    assert plain.kernel == never_due.kernel
    assert often.accuracy != plain.accuracy
    assert often.kernel.amplitude != plain.kernel.amplitude == AMPLITUDE


def test_episodes_on_an_open_world_are_those_on_a_new_one() -> None:
    """A study whose strategies share a world would report episodes that nobody can play alone."""
    world = PerceivedWorld(CHOICE.open())
    for strategy in ('farthest_fsq', 'u_sampling', 'farthest_fsq'):
        settings = episode_settings(TASK, strategy, budget=7, turns=11)
        shared, alone = (run_episode(CHOICE, settings, teacher(), world=w) for w in (world, None))
        assert shared.queries == alone.queries
        assert shared.accuracy == alone.accuracy


@pytest.mark.parametrize('strategy', [name for name in STRATEGIES if name != 'human'])
def test_same_seed_same_episode_within_its_limits(strategy: str) -> None:
    """A result could not be repeated, or would owe itself to queries that nobody granted."""
    settings = episode_settings(TASK, strategy, budget=7, turns=11)
    once, again = (run_episode(CHOICE, settings, teacher()) for _ in range(2))
    assert once.queries == again.queries
    assert once.accuracy == again.accuracy
    assert once.spent <= 7
    assert len(once.accuracy) == 11
    assert len({record.turn for record in once.queries}) == len(once.queries)


def test_other_seeds_give_other_episodes() -> None:
    """All samples of a study would be one."""
    settings = episode_settings(TASK, 'random_fsq', budget=7, turns=11)
    other = WorldChoice(TASK, 5, 5)
    assert run_episode(CHOICE, settings, teacher()).queries != run_episode(other, settings, teacher()).queries


def test_scene_that_stays_is_perceived_once() -> None:
    """Every turn would cost a perception of the whole table."""
    world = PerceivedWorld(CHOICE.open())
    change = world.change_turns(40)[0]
    assert world.scene(1) is world.scene(change - 1)
    assert world.scene(change) is not world.scene(1)
    assert world.scene(1).features.tobytes() == perceive(world.observations(1)).features.tobytes()


def test_view_that_comes_back_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scenes draw on a pool: half of what a long episode measures it has measured before."""
    measured: list[View] = []

    def counting(view: View) -> NDArray[np.float32]:
        measured.append(view)
        return view_features(view)

    monkeypatch.setattr('al_questioner.simulation.episodes.view_features', counting)
    world = PerceivedWorld(CHOICE.open())
    turns = [1, *world.change_turns(150)]
    seen = [observation.view for turn in turns for observation in world.observations(turn)]
    for turn in turns:
        world.scene(turn)
    assert len(measured) == len(set(seen)) < len(seen)


def test_a_teacher_who_never_knows_teaches_nothing() -> None:
    """Unknown answers would be learnt as labels."""
    result = run_episode(CHOICE, episode_settings(TASK, 'random_fsq', 6, 8), teacher(unknown_rate=1.0))
    assert {record.symbol for record in result.queries if record.kind.value == 'label'} == {None}
    assert result.final_accuracy == pytest.approx(1 / len(TASK.symbols))


def test_settings_come_from_the_task_unless_given() -> None:
    """An episode would be played with other limits than the task's or the user's."""
    settings = episode_settings(TASK)
    assert (settings.budget, settings.turns) == (TASK.episode.budget, TASK.episode.turns)
    assert settings.change_interval == TASK.scenes.change_interval
    assert episode_settings(TASK, budget=0).budget == 0
    assert set(episode_settings(TASK, 'dt_iros').weights) == {'discriminability', 'class_uniformity'}


def test_weights_for_a_strategy_without_any_are_refused() -> None:
    """A user would believe that the weights had an effect."""
    with pytest.raises(SettingsError, match='uses no weights'):
        episode_settings(TASK, 'random_fsq', weights_file='mine.yaml')


def settings(**changes: object) -> EpisodeSettings:
    return EpisodeSettings(**{'symbols': SYMBOLS, 'budget': 1.0, 'turns': 1, 'strategy': 'random_fsq', **changes})


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'budget': -1.0}, 'budget must be a finite number of 0 or more, not -1'),
        ({'budget': float('nan')}, 'budget'),
        ({'budget': float('inf')}, 'budget'),
        ({'turns': 0}, 'turns must be 1 or more, not 0'),
        ({'change_interval': 0}, 'change_interval'),
        ({'symbols': ('a',)}, 'at least two'),
        ({'symbols': ('a', 'a')}, 'distinct'),
        ({'symbols': ('a', 'none')}, 'none'),
        ({'budget': 1e308}, r'budget must lie in \[0, 1e\+12\], not 1e\+308'),
        ({'costs': Costs(demonstration=1e200)}, r'the cost of a demonstration query must lie in \[0, 1e\+12\]'),
        ({'amplitude': 0.0}, 'amplitude'),
        ({'amplitude': 1e200}, r'amplitude must lie in \[0.001, 1000\], not 1e\+200'),
        ({'length_scale': 1e200}, r'length_scale must lie in \[0.001, 1000\], not 1e\+200'),
        ({'length_scale': 1e-200}, r'length_scale must lie in \[0.001, 1000\], not 1e-200'),
        ({'length_scale': 0.0}, 'length_scale'),
        ({'length_scale': float('nan')}, 'length_scale'),
        ({'weights': {'gain': -1e200}}, r'the weight of gain must lie in \[-1e\+09, 1e\+09\]'),
        ({'tune_every': -1}, 'tune_every must be 0 or more, not -1'),
        ({'weights': {'beauty': 1.0}}, 'unknown decision feature'),
        ({'weights': {'remaining_time': float('nan')}}, 'not finite'),
    ],
)
def test_settings_out_of_range_are_refused(changes: dict[str, object], reason: str) -> None:
    """An episode would be played under limits that make no sense."""
    with pytest.raises(SettingsError, match=reason):
        settings(**changes)


@pytest.mark.parametrize(
    'changes',
    [
        {'length_scale': 1e-3, 'amplitude': 1e3, 'tune_every': 2},
        {'length_scale': 1e3, 'amplitude': 1e3, 'tune_every': 2},
        {'length_scale': 1e3, 'amplitude': 1e-3, 'tune_every': 2},
        {'budget': 1e12, 'costs': Costs(1e12, 1.0, 0.0)},
        {'strategy': 'dt_task_env', 'weights': dict.fromkeys(DECISION_FEATURES, 1e9)},
        {'weights': dict.fromkeys(VALUE_FEATURES, -1e9)},
    ],
)
@pytest.mark.filterwarnings('error')
def test_settings_at_the_ends_of_their_ranges_can_be_played(changes: dict[str, object]) -> None:
    """What the ranges allow would end an episode, or learn nothing but overflows."""
    changes = {'symbols': TASK.symbols, 'strategy': 'value_per_cost', 'budget': 4.0, 'turns': 5, **changes}
    played = run_episode(CHOICE, settings(**changes), teacher())
    assert len(played.accuracy) == 5
