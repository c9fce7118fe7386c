"""Studies of settings that the paper does not give; each varies one setting beside the comparison."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from al_questioner.domain import DECISION_FEATURES, SettingsError
from al_questioner.experiments.plan import (
    PAPER_CONDITIONS,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    SELECTORS,
    Condition,
    Plan,
    Variation,
)
from al_questioner.questioning import DtIros, DtTask

MOST_SAMPLES = 10
ENDS = (PAPER_CONDITIONS['C1'], PAPER_CONDITIONS['C4'])
"""Most and least constrained condition."""
COMPARED = (*PAPER_STRATEGIES, 'u_sampling_fsq', 'farthest_fsq')
"""Strategies of the paper, and two strong controls."""
TASK = PAPER_TASKS[0]

CHANGE_INTERVALS = (5, 10, 20, 40)
SYNCHRONIES = (0.0, 0.5, 1.0)
WRONG_RATES = (0.0, 0.1)
IROS_UNIFORMITY = (0.0, 0.05, 0.1, 0.11, 0.12, 0.15, 0.26, 0.5, 1.0)
TASK_WEIGHTS = ((0, 0.05), (0.05, 0.05), (0.06, 0.05), (0.08, 0.05), (0.1, 0.05), (0.17, 0.05), (0.07, 0), (0.07, 0.2))
"""Weights of class uniformity and prediction margin; discriminability and instance variation share the rest."""
DISCRIMINABILITY_SHARE = 0.45 / (0.45 + 0.33)
"""Share of discriminability in this rest, as in the prototype of the design."""


@dataclass(frozen=True)
class Study:
    """Episodes beside the comparison that differ from it in one setting.

    Attributes:
        name: name of its folder, and for its choice.
        title: title of its section.
        about: the setting that is varied, in words.
        own: value of the setting in the comparison.
        plans: the variants, by their value of the setting.
    """

    name: str
    title: str
    about: str
    own: str
    plans: Mapping[str, Plan]


def make_studies(names: Sequence[str], base: Variation, samples: Sequence[int]) -> list[Study]:
    """Return the studies of these names.

    Args:
        names: keys of `STUDIES`.
        base: the variation of the comparison, with the weights of all strategies that have some.
        samples: samples of the comparison, of which a study takes the first `MOST_SAMPLES`.

    Raises:
        InputError: an unknown name, or one that occurs twice.
    """
    for name in names:
        if name not in STUDIES:
            raise SettingsError(f'unknown study {name!r}; known: {", ".join(STUDIES)}')
    if len(set(names)) < len(names):
        raise SettingsError('a study is named twice')
    return [STUDIES[name](base, tuple(samples[:MOST_SAMPLES])) for name in names]


def _plan(
    variation: Variation,
    samples: tuple[int, ...],
    strategies: tuple[str, ...],
    tasks: tuple[str, ...] = (TASK,),
    conditions: tuple[Condition, ...] = ENDS,
) -> Plan:
    return Plan(tasks, conditions, strategies, samples, variation)


def _weights_iros(base: Variation, samples: tuple[int, ...]) -> Study:
    vectors = [dict(zip(DtIros.weight_names, (1 - share, share), strict=True)) for share in IROS_UNIFORMITY]
    return Study(
        'weights_iros',
        'The weights of dt_iros, set by hand',
        'Weights of discriminability and class uniformity; the paper does not tell its own.',
        _numbers(base.weights['dt_iros'], DtIros.weight_names),
        dict(_with_weights(base, samples, 'dt_iros', vectors, DtIros.weight_names)),
    )


def _weights_task(base: Variation, samples: tuple[int, ...]) -> Study:
    vectors = []
    for uniformity, margin in TASK_WEIGHTS:
        rest = 1 - uniformity - margin
        shared = (DISCRIMINABILITY_SHARE * rest, uniformity, (1 - DISCRIMINABILITY_SHARE) * rest, margin)
        vectors.append(dict(zip(DtTask.weight_names, shared, strict=True)))
    return Study(
        'weights_task',
        'The weights of dt_task, set by hand',
        'Weights of discriminability, class uniformity, instance variation and prediction margin; the paper does not'
        ' tell its own.',
        _numbers(base.weights['dt_task'], DtTask.weight_names),
        dict(_with_weights(base, samples, 'dt_task', vectors, DtTask.weight_names)),
    )


def _with_weights(
    base: Variation,
    samples: tuple[int, ...],
    strategy: str,
    vectors: Sequence[Mapping[str, float]],
    features: Sequence[str],
) -> Iterator[tuple[str, Plan]]:
    for weights in vectors:
        variation = dataclasses.replace(base, weights={**base.weights, strategy: weights})
        yield _numbers(weights, features), _plan(variation, samples, (strategy,))


def _numbers(weights: Mapping[str, float], features: Sequence[str]) -> str:
    return ' / '.join(f'{weights.get(feature, 0.0):.3g}' for feature in features)


def _change_interval(base: Variation, samples: tuple[int, ...]) -> Study:
    own = base.task(TASK).scenes.change_interval
    plans = {
        f'{turns} turns': _plan(dataclasses.replace(base, change_interval=turns), samples, COMPARED)
        for turns in CHANGE_INTERVALS
        if turns != own
    }
    return Study(
        'change_interval',
        'Turns between changes of the scene',
        'At test time; dt_task_env was trained with changes every 10 turns. All learners are told how often.',
        f'{own} turns',
        plans,
    )


def _selector(base: Variation, samples: tuple[int, ...]) -> Study:
    plans = {
        name: _plan(dataclasses.replace(base, selector=name), samples, ('u_sampling',), PAPER_TASKS)
        for name in SELECTORS
        if name != base.selector
    }
    return Study(
        'selector',
        'The feature selector of u_sampling',
        'The paper says "computational feature selection" and no more. Ours keeps what a one-way analysis of variance'
        ' finds significant at .05, at least five features.',
        base.selector,
        plans,
    )


def _repeats(base: Variation, samples: tuple[int, ...]) -> Study:
    plan = _plan(
        dataclasses.replace(base, repeats=False),
        samples,
        ('u_sampling',),
        PAPER_TASKS,
        tuple(PAPER_CONDITIONS.values()),
    )
    return Study(
        'repeats',
        'Whether u_sampling may ask again',
        'About a view that has been labelled. The paper does not say; the controls never do.',
        'asks again',
        {'never asks again': plan},
    )


def _wrong_answers(base: Variation, samples: tuple[int, ...]) -> Study:
    return Study(
        'wrong_answers',
        'A teacher who errs',
        'The share of answers that are wrong, of label, demonstration and feature subset queries alike.',
        f'{base.wrong_rate:.0%}',
        {
            f'{rate:.0%}': _plan(dataclasses.replace(base, wrong_rate=rate), samples, COMPARED)
            for rate in WRONG_RATES
            if rate != base.wrong_rate
        },
    )


def _synchrony(base: Variation, samples: tuple[int, ...]) -> Study:
    own = base.task(TASK).scenes.synchrony
    plans = {
        f'{share:g}': _plan(dataclasses.replace(base, synchrony=share), samples, COMPARED)
        for share in SYNCHRONIES
        if share != own
    }
    return Study(
        'synchrony',
        'How synchronously the objects change their states',
        'The probability that an object follows the common clock; with 1 each scene shows all objects in the states of'
        ' one moment, with 0 in states of their own.',
        f'{own:g}',
        plans,
    )


def _ablation(base: Variation, samples: tuple[int, ...]) -> Study:
    weights = base.weights['dt_task_env']
    plans = {
        f'without {feature}': _plan(
            dataclasses.replace(base, weights={**base.weights, 'dt_task_env': {**weights, feature: 0.0}}),
            samples,
            ('dt_task_env',),
            conditions=tuple(PAPER_CONDITIONS.values()),
        )
        for feature in DECISION_FEATURES
        if weights.get(feature, 0.0) != 0
    }
    without = [feature for feature in DECISION_FEATURES if weights.get(feature, 0.0) == 0]
    unused = f' {", ".join(without)} has no weight to begin with.' if without else ''
    return Study(
        'ablation',
        'dt_task_env without each of its features',
        f'The weight of one feature is 0, the others stay as they were learnt.{unused}',
        'all features',
        plans,
    )


STUDIES: Mapping[str, Callable[[Variation, tuple[int, ...]], Study]] = {
    'weights_iros': _weights_iros,
    'weights_task': _weights_task,
    'change_interval': _change_interval,
    'selector': _selector,
    'repeats': _repeats,
    'wrong_answers': _wrong_answers,
    'synchrony': _synchrony,
    'ablation': _ablation,
}
"""Functions that make each study, by name, from the variation of the comparison and the samples."""
