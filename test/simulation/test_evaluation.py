"""Evaluation of a learner: the numbers that every comparison of strategies rests on."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from al_questioner.domain import random_stream
from al_questioner.questioning import Episode
from al_questioner.simulation import Evaluation, accuracy, episode_settings, run_episode
from shared.lunches import TASK, WORLD_SPEC, teacher

SYMBOLS = ('a', 'b')


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
    """Every reported figure rests on them; a learner that knows nothing is at chance."""
    assert accuracy(np.array(probabilities), ['a', 'b'], SYMBOLS) == expected


@pytest.mark.parametrize('symbols', [3, 5, 7])
def test_an_accuracy_is_one_number_whatever_the_order(symbols: int) -> None:
    """Otherwise two strategies that are equally accurate would be told apart by the order of the observations."""
    rng, names = np.random.default_rng(0), tuple('abcdefg'[:symbols])
    hits = np.array([True] * 10 + [False] * 27)
    found = set()
    for _ in range(200):
        certain = np.where(np.arange(symbols) == 0, 0.9, 0.1)
        probabilities = np.where(rng.permutation(hits)[:, None], certain, 0.5)
        found.add(accuracy(probabilities, ['a'] * 37, names))
    assert found == {float(Fraction(10 * symbols + 27, 37 * symbols))}


def test_what_is_said_later_is_measured_as_if_it_had_been_said_at_once() -> None:
    """Otherwise the demo would show an episode in which late answers and corrections never came."""
    settings = episode_settings(TASK, 'random_fsq', budget=8, turns=8)
    whole = run_episode(WORLD_SPEC, settings, teacher())
    early, late = whole.queries[:2], whole.queries[2]
    evaluation = Evaluation(WORLD_SPEC, settings, None)
    for turn in range(1, late.turn + 1):
        evaluation.next_turn(next((record for record in early if record.turn == turn), None))
    evaluation.correct(whole.queries)
    assert evaluation.result().queries == whole.queries[:3]
    assert evaluation.result().accuracy == whole.accuracy[: late.turn]
    before = evaluation.result()
    evaluation.correct(whole.queries)
    assert evaluation.result() == before


@pytest.mark.parametrize('tuned_turns', [(), (3, 6, 12)])
@pytest.mark.parametrize('strategy', ['dt_task', 'u_sampling', 'farthest_fsq'])
def test_evaluation_believes_what_the_learner_believes(strategy: str, tuned_turns: tuple[int, ...]) -> None:
    """Otherwise accuracy would be that of other models than the robot has."""
    settings = episode_settings(TASK, strategy, budget=8, turns=12)
    episode = Episode(settings, random_stream(4, 'learner'))
    evaluation = Evaluation(WORLD_SPEC, settings, episode.strategy.selector, tuned_turns=tuned_turns)
    features, labels = evaluation.world.test_set
    for turn in range(1, 13):
        decision = episode.ask(evaluation.world.scene(turn))
        record = None
        if decision.query is not None:
            record = episode.tell(teacher().answer(decision.query, evaluation.world.truth(turn)))
        if turn in tuned_turns:
            episode.repeat_tuning()
        measured = evaluation.next_turn(record)
        assert measured == accuracy(episode.concepts.predict_proba(features), labels, TASK.symbols)
    assert evaluation.result().kernel == episode.concepts.kernel
