"""From demonstrations to weights, and all that a reader should know of how they came about."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from al_questioner import __version__
from al_questioner.domain import Classifiers, InputError
from al_questioner.imitation.assessment import Agreement, agreement
from al_questioner.imitation.choice_likelihood import fit_choices, fit_temperature
from al_questioner.imitation.demonstration import Demonstration, all_steps
from al_questioner.imitation.identifiability import Identifiability, identify
from al_questioner.imitation.max_entropy_irl import Iteration, Matching, match_features
from al_questioner.imitation.settings import TrainingSettings
from al_questioner.questioning import FeatureSet
from al_questioner.support.arrays import Array
from al_questioner.support.text import number_of


@dataclass(frozen=True, eq=False)
class Training:
    """Learnt weights.

    Attributes:
        weights: (F,), absolute values adding up to 1.
        scale: what they are to be multiplied by to be those of the softmax policy that was trained.
        free: what the demonstrations tell nothing about.
        validation: number of demonstrations that were held out.
        agreement: with the demonstrations, validation ones included; its log-likelihood is of the softmax whose scale
            suits them best.
        gap_before, gap_after: (F,) expert's minus learner's feature counts in units of the features' scale: of
            rollouts of the softmax policy over the training demonstrations (maxent), or expected at each of the
            expert's steps (choice); before training all weights are 0.
        matching: the iterations of maxent.
        classifiers: those of the learners in the demonstrations, each once.
    """

    feature_set: FeatureSet
    weights: Array
    scale: float
    settings: TrainingSettings
    free: Identifiability
    validation: int
    agreement: Agreement
    gap_before: Array
    gap_after: Array
    matching: Matching | None
    classifiers: tuple[Classifiers, ...]

    def by_feature(self, values: Array, digits: int = 6) -> dict[str, float]:
        """Numbers by the features' names, rounded for people."""
        return {n: round(float(v), digits) + 0.0 for n, v in zip(self.feature_set.names, values, strict=True)}


def train(
    demonstrations: Sequence[Demonstration],
    settings: TrainingSettings,
    watch: Callable[[int, Iteration], None] | None = None,
) -> Training:
    """Learn the weights from demonstrations of the same task, for maxent of simulated worlds.

    Each iteration of maxent is told to `watch`.

    Raises:
        InputError: demonstrations that do not fit together, or that the method cannot use.
    """
    check_alike(demonstrations)
    free = identify(demonstrations)
    matching, held_out = None, 0
    if settings.method == 'maxent':
        held_out = settings.held_out_of(len(demonstrations))
        split = len(demonstrations) - held_out
        matching = match_features(demonstrations[:split], demonstrations[split:], settings.matching, free, watch)
        found = matching.weights
        gap_before, gap_after = matching.iterations[0].gap, matching.gap
    else:
        found = fit_choices(demonstrations, ridge=settings.ridge)
        ends = (np.zeros(len(free.scale)), found)
        gap_before, gap_after = (expected_gap(w, demonstrations, free.scale) for w in ends)
    found = free.project(found)
    total = float(np.abs(found).sum())
    if total == 0:
        raise InputError('the demonstrations tell nothing about any weight')
    suiting = fit_temperature(found / total, list(all_steps(demonstrations)))
    agreed = agreement(found / total * suiting, demonstrations)
    gaps, feature_set = (gap_before, gap_after), demonstrations[0].feature_set
    classifiers = tuple(dict.fromkeys(demonstration.settings.classifiers for demonstration in demonstrations))
    return Training(feature_set, found / total, total, settings, free, held_out, agreed, *gaps, matching, classifiers)


def expected_gap(weights: Array, demonstrations: Sequence[Demonstration], scale: Array) -> Array:
    """Return the (F,) chosen minus expected features at the expert's steps, mean, in units of the features' scale.

    The weights, (F,), are those of the softmax; for the scale, (F,), see `feature_scale`.
    """
    gaps = []
    for step in all_steps(demonstrations):
        utilities = step.features @ weights
        probabilities = np.exp(utilities - utilities.max())
        gaps.append(-(probabilities / probabilities.sum()) @ step.contrasts)
    return np.asarray(np.divide(np.mean(gaps, axis=0), scale, out=np.zeros_like(scale), where=scale > 0))


def check_alike(demonstrations: Sequence[Demonstration]) -> None:
    """See that demonstrations can be learnt from together.

    Raises:
        InputError: there is none, or one is of another task, or has other features, than the first.
    """
    if not demonstrations:
        raise InputError('no demonstration was given')
    first = demonstrations[0]
    for other in demonstrations[1:]:
        if other.feature_set is not first.feature_set:
            raise InputError(f'{other.name} shows other features than {first.name}')
        if other.task_name != first.task_name:
            raise InputError(f'{other.name} is of task {other.task_name}, {first.name} of {first.task_name}')
        if other.settings.symbols != first.settings.symbols:
            theirs, ours = ', '.join(other.settings.symbols), ', '.join(first.settings.symbols)
            raise InputError(f'{other.name} is about {theirs}, {first.name} about {ours}')
        if other.feature_names != first.feature_names:
            counts = len(other.feature_names), len(first.feature_names)
            raise InputError(
                f'{other.name} was recorded with other features ({counts[0]}) than {first.name} ({counts[1]})'
            )


def validation_text(training: Training, matching: Matching) -> str:
    """Say whether the weights hold for demonstrations that they were not learnt from; a warning is in colour."""
    if not training.validation:
        return 'no demonstration was held out, so nothing tells whether the weights hold for others'
    gaps = matching.validation_gaps
    found = (
        f'validation gap {gaps["before"]:.2f} before, {gaps["after"]:.2f} after,'
        f' {gaps["smallest"]:.2f} where it was smallest, up to iteration {matching.kept + 1}'
    )
    if not matching.validation_failed:
        return found
    return (
        f'{found}\n[yellow]WARNING: the validation gap has not stayed so small: the weights may not hold for other'
        ' demonstrations than those that they were learnt from; give more of them, or more --rollouts[/yellow]'
    )


def weights_document(training: Training, count: int, bags: Sequence[Mapping[str, str]]) -> dict[str, Any]:
    """Return the content of a weights file: the weights, and where they come from.

    That is the number of demonstrations, and `name` and `sha256` of each bag.
    """
    settings, matching = training.settings, training.matching
    source = f'{number_of(count, "recorded demonstration")} of an expert, with '
    source += ' and '.join(map(str, training.classifiers))
    method = 'maximum entropy inverse reinforcement learning' if matching else "likelihood of the expert's choices"
    details: dict[str, Any] = {'method': settings.method, 'version': __version__, 'bags': [dict(bag) for bag in bags]}
    if matching:
        details['settings'] = {
            **{k: v for k, v in dataclasses.asdict(settings.matching).items() if k != 'jobs'},
            'validation': training.validation,
        }
        details['iterations'] = len(matching.iterations)
        details['kept_iteration'] = matching.kept + 1
        details['validation_gap'] = {name: round(gap, 4) for name, gap in matching.validation_gaps.items()}
    else:
        details['settings'] = {'ridge': settings.ridge}
    details['settings']['classifiers'] = [each._asdict() for each in training.classifiers]
    return {
        'provenance': f'Learnt by train_weights from {source}: {method}. {training.free.describe().capitalize()}.',
        'weights': training.by_feature(training.weights),
        'training': {
            **details,
            'softmax_scale': float(f'{training.scale:.6g}'),
            'unidentified': list(training.free.unidentified),
            'gap_before': training.by_feature(training.gap_before, 4),
            'gap_after': training.by_feature(training.gap_after, 4),
            'agreement': {k: round(v, 4) for k, v in dataclasses.asdict(training.agreement).items()},
        },
    }
