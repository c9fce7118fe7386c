"""Settings of an episode."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

from al_questioner.domain.errors import SettingsError
from al_questioner.domain.names import listed
from al_questioner.domain.query import NO_SYMBOL, Outcome, QueryKind
from al_questioner.domain.setting import Setting

if TYPE_CHECKING:
    from al_questioner.domain.knowledge import Knowledge

LARGEST_TURN = 10_000
"""Largest number of turns: each `learner_state` holds all queries so far, and must stay a message of a sane size."""
WEIGHT = Setting('weight', 0.0, 'of a decision feature, or a constant', '', -1e9, 1e9)
"""Sums of weighted features stay finite."""

BUDGET = Setting('budget', 25.0, 'query budget', 'cost of a label query', lower=0)
TURNS = Setting('turns', 40, 'length of the episode', 'turns', 1, LARGEST_TURN)
CHANGE_INTERVAL = Setting('change_interval', 10, 'expected time between scene changes', 'turns', lower=1)
AMPLITUDE = Setting('amplitude', 100.0, "variance of the Gaussian processes' kernel", '', 1e-3, 1e3)
"""Amplitude of a learner (docs/explanation/method.md, Beliefs).

Beyond the limits all things look alike, or none do, and numbers overflow.
"""
_OF_LENGTH_SCALE = 'of the kernel, 0.001 or more; 0: root of the number of features'
LENGTH_SCALE: Setting[float | None] = Setting('length_scale', None, _OF_LENGTH_SCALE, 'standard deviations', 1e-3, 1e3)
KERNEL_SHAPE = Setting(
    'kernel_shape',
    'grouped',
    'kernel of the classifiers: grouped: large groups of features and large differences count less; rbf: all alike',
    choices=('grouped', 'rbf'),
)
CLASS_BALANCE = Setting(
    'class_balance', 0.5, 'share of the effect of the counts of examples that is removed from the beliefs', '', 0, 1
)
CARRY_LABELS = Setting(
    'carry_labels', False, 'a label counts for all views of an object: for perception that keeps ids as looks change'
)
COSTS: Mapping[str, Setting[float]] = {
    'label': Setting('cost_label', 1.0, 'cost of a label query', 'budget', lower=0),
    'demonstration': Setting('cost_demonstration', 2.0, 'cost of a demonstration query', 'budget', lower=0),
    'feature_subset': Setting('cost_feature_subset', 2.0, 'cost of a feature subset query', 'budget', lower=0),
    'unknown': Setting(
        'charge_unknown', 1.0, 'share of its cost that a query is charged if the teacher does not know', '', 0, 1
    ),
    'skip': Setting('charge_skip', 1.0, 'share that is charged if the teacher skips the query', '', 0, 1),
    'unanswered': Setting('charge_unanswered', 0.0, 'share that is charged if it is withdrawn unanswered', '', 0, 1),
}
"""Declarations of the costs, by the names of the attributes of `Costs`; that of the relevance query is apart."""
NEVER: Final = 'never'
"""The word for the cost of a question that cannot be asked."""
COST_RELEVANCE: Setting[float | str] = Setting(
    'cost_relevance', NEVER, 'cost of a relevance query; never: it is not asked', 'budget', lower=0, word=NEVER
)

AUTO: Final = 'auto'
"""The view tolerance that is found from the looks themselves."""

ViewTolerance = float | Literal['auto']
"""Difference up to which two looks at a thing are the same view: see `questioning.Episode`."""
_OF_SAME_VIEW = 'change up to which an object is the same view; auto: what the noise of the sensors explains'
SAME_VIEW = Setting('view_tolerance', AUTO, _OF_SAME_VIEW, 'standard deviations', lower=0, word=AUTO)


@dataclass(frozen=True)
class Costs:
    """Prices of queries, as parts of the budget; asking nothing is free (section 4.2 of the paper).

    Attributes:
        relevance: price of a relevance query; None if it cannot be asked, as in the paper.
        unknown: share of the price that is charged, 0 to 1, if the teacher does not know.
        skip: share if the teacher skips the question.
        unanswered: share if it is withdrawn since nobody has answered.
    """

    label: float = COSTS['label'].default
    demonstration: float = COSTS['demonstration'].default
    feature_subset: float = COSTS['feature_subset'].default
    unknown: float = COSTS['unknown'].default
    skip: float = COSTS['skip'].default
    unanswered: float = COSTS['unanswered'].default
    relevance: float | None = None

    def price(self, kind: QueryKind) -> float:
        """Price of a query of this kind; infinite if it cannot be asked."""
        if kind is QueryKind.NO_QUERY:
            return 0.0
        price = getattr(self, kind.value)
        return math.inf if price is None else float(price)

    def charged_fraction(self, outcome: Outcome) -> float:
        """Share of the price that is charged in the end."""
        return 1.0 if outcome is Outcome.ANSWERED else float(getattr(self, outcome.value))


def price_of(given: float | str) -> float | None:
    """Return the price that a setting states: a number, or None for `NEVER`."""
    return None if given == NEVER else float(given)


class Classifiers(NamedTuple):
    """Settings of the classifiers that decide what weights, learnt with them, are worth elsewhere."""

    amplitude: float = AMPLITUDE.default
    kernel_shape: str = KERNEL_SHAPE.default
    class_balance: float = CLASS_BALANCE.default

    def __str__(self) -> str:
        return f'amplitude {self.amplitude:g}, kernel {self.kernel_shape}, class balance {self.class_balance:g}'

    def check(self, length_scale: float | None = None) -> None:
        """Refuse values out of range, and such a length scale of the kernel.

        Raises:
            SettingsError: a value outside its range.
        """
        for setting in (AMPLITUDE, CLASS_BALANCE):
            setting.check(getattr(self, setting.name))
        if self.kernel_shape not in KERNEL_SHAPE.choices:
            known = ', '.join(KERNEL_SHAPE.choices)
            raise SettingsError(f'unknown kernel_shape {self.kernel_shape!r}; known: {known}')
        if length_scale is not None:
            LENGTH_SCALE.check(length_scale)


DEFAULT_CLASSIFIERS = Classifiers()
CLASSIFIERS: Mapping[str, Setting[Any]] = {each.name: each for each in (AMPLITUDE, KERNEL_SHAPE, CLASS_BALANCE)}
"""Declarations of the settings of the classifiers, by the names of the attributes of `Classifiers`."""


@dataclass(frozen=True)
class EpisodeSettings:
    """Settings of an episode, fixed before it begins.

    Attributes:
        symbols: the concepts to ground, at least two. Any names will do here; of those of a task, which people are to
            say, more is asked, see `names.check_names`.
        budget: query budget, in the unit of `costs`; 0 or more.
        turns: number of turns, 1 or more.
        weights: weights and constants of the strategy, by the names that it declares.
        change_interval: turns between scene changes as the robot expects them: the window of the non-query time.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel in standard deviations of a feature; None for the square root of
            the number of features in use.
        kernel_shape: how the kernel treats groups of features and large differences: `grouped` or `rbf`.
        class_balance: how much of the effect of the counts of examples is removed from the beliefs, 0 to 1.
        concepts: what is known before the first turn; None if nothing is. `symbols` may have more symbols.
        carry_labels: whether a label counts for all views of an object, by its id.

    Raises:
        SettingsError: a value outside its range.
    """

    symbols: tuple[str, ...]
    budget: float
    turns: int
    strategy: str
    weights: Mapping[str, float] = field(default_factory=dict)
    change_interval: int = CHANGE_INTERVAL.default
    costs: Costs = Costs()
    amplitude: float = AMPLITUDE.default
    length_scale: float | None = LENGTH_SCALE.default
    kernel_shape: str = KERNEL_SHAPE.default
    class_balance: float = CLASS_BALANCE.default
    concepts: Knowledge | None = None
    carry_labels: bool = CARRY_LABELS.default

    def __post_init__(self) -> None:
        symbols = listed(self.symbols)
        if symbols is None:
            raise SettingsError(f'symbols must be a list of names, not {self.symbols!r}')
        object.__setattr__(self, 'symbols', symbols)
        if len(self.symbols) < 2 or len(set(self.symbols)) < len(self.symbols):
            raise SettingsError(f'symbols must be at least two distinct names, not {list(self.symbols)}')
        if not all(symbol.strip() for symbol in self.symbols):
            raise SettingsError(f'a symbol must not be blank, as one of {list(self.symbols)} is')
        if NO_SYMBOL in self.symbols:
            raise SettingsError(f'{NO_SYMBOL!r} cannot be a symbol: it stands for things that belong to no symbol')
        BUDGET.check(self.budget)
        for number_of_turns in (TURNS, CHANGE_INTERVAL):
            # Their upper limits are for nodes and commands; a program may give more, and so may an old log.
            replace(number_of_turns, upper=math.inf).check(getattr(self, number_of_turns.name))
        self.classifiers.check(self.length_scale)
        missing = [] if self.concepts is None else [name for name in self.concepts.symbols if name not in self.symbols]
        if missing:
            raise SettingsError(f'symbols must hold those of the concepts that are known; {missing[0]!r} is missing')
        for name, price in COSTS.items():
            price.check(getattr(self.costs, name), f'costs.{name}')
        if self.costs.relevance is not None:
            if not isinstance(self.costs.relevance, int | float):
                raise SettingsError(f'costs.relevance must be a number or None, not {self.costs.relevance!r}')
            COST_RELEVANCE.check(self.costs.relevance, 'costs.relevance')
        for name, weight in self.weights.items():
            WEIGHT.check(weight, f'the weight of {name}')

    @property
    def classifiers(self) -> Classifiers:
        """Settings of the classifiers."""
        return Classifiers(self.amplitude, self.kernel_shape, self.class_balance)
