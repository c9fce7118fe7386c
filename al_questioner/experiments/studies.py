"""Studies of settings that the paper does not give; each varies one setting beside the comparison."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from al_questioner.domain import DECISION_FEATURES, DEFAULT_CLASSIFIERS, Classifiers, SettingsError
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
ALL_CONDITIONS = tuple(PAPER_CONDITIONS.values())
ENDS = (PAPER_CONDITIONS['C1'], PAPER_CONDITIONS['C4'])
"""Most and least constrained condition."""
COMPARED = (*PAPER_STRATEGIES, 'u_sampling_fsq', 'farthest_fsq')
"""Strategies of the paper, and two strong controls."""
TASK = PAPER_TASKS[0]

AMPLITUDES = (4.0, 16.0, 100.0)
KERNELS = (('rbf', 0.0), DEFAULT_CLASSIFIERS[1:])
"""Kernel and class balance: nothing of either, and what learners have by default."""
CHANGE_INTERVALS = (5, 10, 20, 40)
SYNCHRONIES = (0.0, 0.5, 1.0)
WRONG_RATES = (0.0, 0.1)
IROS_UNIFORMITY = (0.0, 0.1, 0.15, 0.2, 0.22, 0.3, 1.0)
TASK_WEIGHTS = ((0, 0.05), (0.05, 0.05), (0.1, 0.05), (0.14, 0.05), (0.2, 0.05), (0.12, 0), (0.12, 0.2))
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
    vectors = [(1 - share, share) for share in IROS_UNIFORMITY]
    about = 'discriminability and class uniformity'
    return _weights(base, samples, 'dt_iros', DtIros.weight_names, vectors, about)


def _weights_task(base: Variation, samples: tuple[int, ...]) -> Study:
    vectors = []
    for uniformity, margin in TASK_WEIGHTS:
        rest = 1 - uniformity - margin
        vectors.append((DISCRIMINABILITY_SHARE * rest, uniformity, (1 - DISCRIMINABILITY_SHARE) * rest, margin))
    about = 'discriminability, class uniformity, instance variation and prediction margin'
    return _weights(base, samples, 'dt_task', DtTask.weight_names, vectors, about)


def _weights(
    base: Variation,
    samples: tuple[int, ...],
    strategy: str,
    features: Sequence[str],
    vectors: Sequence[Sequence[float]],
    about: str,
) -> Study:
    def numbers(weights: Mapping[str, float]) -> str:
        return ' / '.join(f'{weights.get(feature, 0.0):.3g}' for feature in features)

    plans = {}
    for vector in vectors:
        weights = dict(zip(features, vector, strict=True))
        varied = dataclasses.replace(base, weights={**base.weights, strategy: weights})
        plans[numbers(weights)] = _plan(varied, samples, (strategy,))
    return Study(
        strategy.replace('dt', 'weights'),
        f'The weights of {strategy}, set by hand',
        f'Weights of {about}; the paper does not tell its own.',
        numbers(base.weights[strategy]),
        plans,
    )


def _varied(
    base: Variation, samples: tuple[int, ...], setting: str, values: Sequence[Any], own: object, label: str
) -> dict[str, Plan]:
    """Return plans with the values of a setting of the variation that are not its own in the comparison."""
    varied = {value: dataclasses.replace(base, **{setting: value}) for value in values if value != own}
    return {label.format(value): _plan(variation, samples, COMPARED) for value, variation in varied.items()}


def _amplitude(base: Variation, samples: tuple[int, ...]) -> Study:
    own = base.classifiers
    return _classifiers(
        base,
        samples,
        (TASK,),
        'amplitude',
        'The amplitude of the classifiers',
        'The paper does not tell its kernel. All weights are as in the comparison.',
        {f'{amplitude:g}': own._replace(amplitude=amplitude) for amplitude in AMPLITUDES},
        f'{own.amplitude:g}',
    )


def _kernel(base: Variation, samples: tuple[int, ...]) -> Study:
    def words(found: Classifiers) -> str:
        return f'{found.kernel_shape}, class balance {found.class_balance:g}'

    own = base.classifiers
    varied = [own._replace(kernel_shape=shape, class_balance=balance) for shape, balance in KERNELS]
    return _classifiers(
        base,
        samples,
        PAPER_TASKS,
        'kernel',
        'The kernel of the classifiers, and the balance of their classes',
        f'Learners have {words(DEFAULT_CLASSIFIERS)}, unless told otherwise. All weights are as in the comparison.',
        {words(classifiers): classifiers for classifiers in varied},
        words(own),
    )


def _classifiers(
    base: Variation,
    samples: tuple[int, ...],
    tasks: tuple[str, ...],
    name: str,
    title: str,
    about: str,
    variants: Mapping[str, Classifiers],
    own: str,
) -> Study:
    plans = {
        label: _plan(dataclasses.replace(base, classifiers=classifiers), samples, COMPARED, tasks)
        for label, classifiers in variants.items()
        if classifiers != base.classifiers
    }
    return Study(name, title, about, own, plans)


def _change_interval(base: Variation, samples: tuple[int, ...]) -> Study:
    own = base.task(TASK).scenes.change_interval
    return Study(
        'change_interval',
        'Turns between changes of the scene',
        'At test time; dt_task_env was trained with changes every 10 turns. All learners are told how often.',
        f'{own} turns',
        _varied(base, samples, 'change_interval', CHANGE_INTERVALS, own, '{} turns'),
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
    varied = dataclasses.replace(base, repeats=False)
    plan = _plan(varied, samples, ('u_sampling',), PAPER_TASKS, ALL_CONDITIONS)
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
        _varied(base, samples, 'wrong_rate', WRONG_RATES, base.wrong_rate, '{:.0%}'),
    )


def _synchrony(base: Variation, samples: tuple[int, ...]) -> Study:
    own = base.task(TASK).scenes.synchrony
    return Study(
        'synchrony',
        'How synchronously the objects change their states',
        'The probability that an object follows the common clock; with 1 each scene shows all objects in the states of'
        ' one moment, with 0 in states of their own.',
        f'{own:g}',
        _varied(base, samples, 'synchrony', SYNCHRONIES, own, '{:g}'),
    )


def _ablation(base: Variation, samples: tuple[int, ...]) -> Study:
    weights = base.weights['dt_task_env']
    plans = {
        f'without {feature}': _plan(
            dataclasses.replace(base, weights={**base.weights, 'dt_task_env': {**weights, feature: 0.0}}),
            samples,
            ('dt_task_env',),
            conditions=ALL_CONDITIONS,
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
    'amplitude': _amplitude,
    'kernel': _kernel,
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
