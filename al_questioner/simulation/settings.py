"""The settings of an episode: what the user gives, else what the task says."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from al_questioner.domain import (
    AMPLITUDE,
    CARRY_LABELS,
    CLASS_BALANCE,
    KERNEL_SHAPE,
    LENGTH_SCALE,
    Costs,
    EpisodeSettings,
    Knowledge,
    SettingsError,
)
from al_questioner.domain.names import check_names
from al_questioner.questioning import STRATEGIES, make_strategy, read_weights, shipped_file
from al_questioner.simulation.task import Task


def episode_settings(
    task: Task,
    strategy: str | None = None,
    budget: float | None = None,
    turns: int | None = None,
    change_interval: int | None = None,
    weights_file: str | None = None,
    costs: Costs | None = None,
    amplitude: float = AMPLITUDE.default,
    length_scale: float | None = LENGTH_SCALE.default,
    kernel_shape: str = KERNEL_SHAPE.default,
    class_balance: float = CLASS_BALANCE.default,
    concepts: Knowledge | None = None,
    carry_labels: bool = CARRY_LABELS.default,
) -> EpisodeSettings:
    """Settings of an episode; what is not given comes from the task, and the weights from `config/weights`.

    The symbols are those of the concepts that are known already, then those of the task that are new.

    A strategy that another package contributes gets the weights of the file, or none.

    Raises:
        InputError: a value out of range, an unknown strategy, or a weights file that it cannot use.
    """
    name = task.episode.strategy if strategy is None else strategy
    shipped = shipped_file(name)
    if weights_file and name in STRATEGIES and shipped is None:
        raise SettingsError(f'strategy {name} uses no weights, but the weights file {weights_file} is given')
    path = Path(weights_file).expanduser() if weights_file else shipped
    weights: Mapping[str, float] = {}
    if path is not None:
        weights = read_weights(path).values
        try:
            make_strategy(name, weights)
        except SettingsError as error:
            raise SettingsError(f'{path}: {error}') from error
    symbols = task.symbols
    if concepts is not None:
        symbols = tuple(dict.fromkeys((*concepts.symbols, *task.symbols)))
        check_names(symbols, 'symbol')
    return EpisodeSettings(
        symbols=symbols,
        budget=task.episode.budget if budget is None else budget,
        turns=task.episode.turns if turns is None else turns,
        strategy=name,
        weights=weights,
        change_interval=task.scenes.change_interval if change_interval is None else change_interval,
        costs=task.episode.costs if costs is None else costs,
        amplitude=amplitude,
        length_scale=length_scale,
        kernel_shape=kernel_shape,
        class_balance=class_balance,
        concepts=concepts,
        carry_labels=carry_labels,
    )
