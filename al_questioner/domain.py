"""The words that every part of the package uses.

Plain frozen dataclasses and the errors they raise. Nothing here knows how a thing is computed, drawn, sent or stored.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.floating]

NO_SYMBOL = 'none'
"""The answer that a thing belongs to no symbol, or that no thing here belongs to the symbol."""


class InputError(ValueError):
    """Input that cannot be used; its text is one line that says what and where."""


class SceneError(InputError):
    """A scene that cannot be learnt from: empty, of inconsistent shape, or not finite."""


class SettingsError(InputError):
    """A setting outside its range, or an unknown name."""


class AnswerError(InputError):
    """An answer that does not fit the question that is pending."""


class LateAnswerError(AnswerError):
    """An answer to a query that another answer has settled before."""


class EpisodeError(RuntimeError):
    """An episode that did not reach its end, through no fault of the input; its text is one line."""


class QueryKind(str, Enum):
    """The communicative actions of section 2.1 of the paper."""

    LABEL = 'label'
    DEMONSTRATION = 'demonstration'
    FEATURE_SUBSET = 'feature_subset'
    NO_QUERY = 'no_query'


class Outcome(str, Enum):
    """What became of a query; that it was left unanswered is nothing that a teacher says."""

    ANSWERED = 'answered'
    UNKNOWN = 'unknown'
    SKIP = 'skip'
    UNANSWERED = 'unanswered'


SAYABLE_OUTCOMES = (Outcome.ANSWERED, Outcome.UNKNOWN, Outcome.SKIP)
"""What an answer can be."""


@dataclass(frozen=True)
class Camera:
    """Pinhole intrinsics of the full frame, in pixels."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True, eq=False)
class View:
    """One object as an RGB-D camera sees it: a crop of the frame.

    Attributes:
        color: (h, w, 3) uint8, blue-green-red as in OpenCV.
        depth: (h, w) uint16 millimetres, 0 where the sensor has no reading.
        mask: (h, w) bool, true on the object.
        camera: intrinsics of the full frame.
        origin: (column, row) of the crop's top left pixel in the frame, 0-based.
    """

    color: NDArray[np.uint8]
    depth: NDArray[np.uint16]
    mask: NDArray[np.bool_]
    camera: Camera
    origin: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Observation:
    """One object as the robot perceives it at one moment: a view, and the readings of its other sensors.

    Attributes:
        object_id: identifies the object as long as it stays in the scene.
        position: (x, y, z) metres in the table's frame.
        view: the RGB-D crop.
        sensors: reading by name; a name starts with its feature group (`weight_kg`, `base_x`, `arms_left_1`).
    """

    object_id: int
    position: tuple[float, float, float]
    view: View
    sensors: Mapping[str, float]


def group_of(feature_name: str) -> str:
    """The group a person would name for a feature: the part of its name before the first underscore."""
    return feature_name.split('_', 1)[0]


@dataclass(frozen=True, eq=False)
class Scene:
    """The objects seen this turn, as feature vectors; one observation per object.

    Attributes:
        object_ids: one distinct non-negative id per object.
        positions: (n, 3) float32, metres in the table's frame.
        features: (n, m) float32, not standardised.
        feature_names: m distinct names; the group of a feature is `group_of` its name.

    Raises:
        SceneError: no object, no feature, a shape that does not fit, a repeated id or name, or a value that is not
            finite.
    """

    object_ids: tuple[int, ...]
    positions: NDArray[np.float32]
    features: NDArray[np.float32]
    feature_names: tuple[str, ...]

    def __post_init__(self) -> None:
        n, m = len(self.object_ids), len(self.feature_names)
        if n == 0:
            raise SceneError('the scene is empty: it holds no object')
        if m == 0:
            raise SceneError('the scene has no features')
        if self.features.shape != (n, m):
            raise SceneError(f'features have shape {self.features.shape}, expected {(n, m)}')
        if self.positions.shape != (n, 3):
            raise SceneError(f'positions have shape {self.positions.shape}, expected {(n, 3)}')
        if len(set(self.object_ids)) < n:
            raise SceneError('an object id occurs twice in the scene')
        if min(self.object_ids) < 0:
            raise SceneError('an object id is negative')
        if len(set(self.feature_names)) < m:
            raise SceneError('a feature name occurs twice in the scene')
        finite = np.isfinite(self.features)
        if not finite.all():
            row, column = np.argwhere(~finite)[0]
            raise SceneError(
                f'feature {self.feature_names[column]} of object {self.object_ids[row]} is not finite'
                f' ({self.features[row, column]})'
            )
        if not np.isfinite(self.positions).all():
            row = int(np.argwhere(~np.isfinite(self.positions))[0][0])
            raise SceneError(f'the position of object {self.object_ids[row]} is not finite')

    def __len__(self) -> int:
        return len(self.object_ids)

    def equals(self, other: Scene) -> bool:
        """Whether another scene is the same to the last bit."""
        return (
            self.object_ids == other.object_ids
            and self.feature_names == other.feature_names
            and self.features.tobytes() == other.features.tobytes()
            and self.positions.tobytes() == other.positions.tobytes()
        )

    def index_of(self, object_id: int) -> int:
        """Row of an object.

        Raises:
            KeyError: the object is not in the scene.
        """
        try:
            return self.object_ids.index(object_id)
        except ValueError:
            raise KeyError(object_id) from None


@dataclass(frozen=True)
class Action:
    """A candidate of a turn: LQ(x) names an object, DQ(y) a symbol, FSQ and NQ neither."""

    kind: QueryKind
    object_id: int | None = None
    symbol: str | None = None


@dataclass(frozen=True)
class Query:
    """A question that was put to the teacher.

    Attributes:
        query_id: unique within the episode.
        turn: 1-based turn in which it was asked.
        action: what is asked.
        choices: answers that count: symbols, object ids as text, or feature groups.
        cost: what it takes from the budget.
        budget_left: budget after this query.
        turns_left: turns after this one.
        model_version: how often the models had been fitted when it was asked.
        text: the question in plain English.
    """

    query_id: str
    turn: int
    action: Action
    choices: tuple[str, ...]
    cost: float
    budget_left: float
    turns_left: int
    model_version: int
    text: str


Content = str | int | tuple[str, ...] | None


@dataclass(frozen=True)
class Answer:
    """What a teacher said.

    `content` is a symbol or `NO_SYMBOL` for a label query; an object id or `NO_SYMBOL` for a demonstration query;
    feature groups for a feature subset query; None unless the outcome is `ANSWERED`. `replaces` is None, or the
    `answer_id` of an answer to the same query that was accepted before and was wrong: this is what is said now.
    """

    query_id: str
    answer_id: str
    teacher_id: str
    outcome: Outcome
    content: Content = None
    replaces: str | None = None


@dataclass(frozen=True)
class QueryRecord:
    """One query of an episode and what came of it: a line of `queries` in the episode's JSON.

    `turn` is that of the question; `answered_in` is the turn during which its answer came if that was a later one.
    """

    turn: int
    kind: QueryKind
    object_id: int | None
    symbol: str | None
    cost: float
    outcome: Outcome
    groups: tuple[str, ...] = ()
    answered_in: int | None = None


@dataclass(frozen=True, eq=False)
class Decision:
    """What the questioner weighed in a turn, and what it chose.

    Attributes:
        turn: 1-based.
        candidates: C actions.
        features: (C, 7) expected decision features in the order of `DECISION_FEATURES`; NaN where the strategy
            computed none.
        utilities: (C,) the strategy's value of each candidate; NaN for a candidate that the strategy never considers.
        chosen: index into `candidates`.
        query: the question, or None if nothing is asked this turn.
    """

    turn: int
    candidates: tuple[Action, ...]
    features: NDArray[np.float64]
    utilities: NDArray[np.float64]
    chosen: int
    query: Query | None


DECISION_FEATURES = (
    'discriminability',
    'class_uniformity',
    'instance_variation',
    'prediction_margin',
    'budget_consumption',
    'remaining_time',
    'non_query_time',
)
"""The seven decision features of the paper, in the order of every weight vector and every decision."""

VALUE_FEATURES = ('novelty', 'need', 'chance', 'price', 'ahead', 'silence')
"""The features of what a question is worth, see `questioning.value`, in the order of every weight vector of theirs."""

WEIGHED = (*DECISION_FEATURES, *VALUE_FEATURES)
"""All that a weights file may name; each strategy says which of them it uses."""


@dataclass(frozen=True)
class Costs:
    """What a query takes from the budget; asking nothing is free (section 4.2 of the paper).

    Attributes:
        label: price of a label query.
        demonstration: price of a demonstration query.
        feature_subset: price of a feature subset query.
        unknown: share of the price that is charged, 0 to 1, if the teacher does not know.
        skip: share if the teacher skips the question.
        unanswered: share if it is withdrawn since nobody has answered.
    """

    label: float = 1.0
    demonstration: float = 2.0
    feature_subset: float = 2.0
    unknown: float = 1.0
    skip: float = 1.0
    unanswered: float = 0.0

    def of(self, kind: QueryKind) -> float:
        """Price of a query of this kind."""
        return 0.0 if kind is QueryKind.NO_QUERY else float(getattr(self, kind.value))

    def share(self, outcome: Outcome) -> float:
        """Share of the price that is charged in the end."""
        return 1.0 if outcome is Outcome.ANSWERED else float(getattr(self, outcome.value))


@dataclass(frozen=True)
class EpisodeSettings:
    """What is given to the learner before it asks.

    Attributes:
        symbols: the concepts to ground, at least two.
        budget: query budget, in the unit of `costs`; 0 or more.
        turns: number of turns, 1 or more.
        strategy: name of a questioning strategy.
        weights: weight by decision feature, for the strategies that use them.
        change_interval: turns between scene changes as the robot expects them: the window of the non-query time.
        costs: price of each kind of query.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel in standard deviations of a feature; None for the square root of
            the number of features in use.
        tune_every: turns from one re-optimisation of amplitude and length scale to the next; 0 for never.

    Raises:
        SettingsError: a value outside its range.
    """

    symbols: tuple[str, ...]
    budget: float
    turns: int
    strategy: str
    weights: Mapping[str, float] = field(default_factory=dict)
    change_interval: int = 10
    costs: Costs = Costs()
    amplitude: float = 4.0
    length_scale: float | None = None
    tune_every: int = 0

    def __post_init__(self) -> None:
        if len(self.symbols) < 2 or len(set(self.symbols)) < len(self.symbols):
            raise SettingsError(f'symbols must be at least two distinct names, not {list(self.symbols)}')
        if NO_SYMBOL in self.symbols:
            raise SettingsError(f'{NO_SYMBOL!r} cannot be a symbol: it stands for things that belong to no symbol')
        if not (np.isfinite(self.budget) and self.budget >= 0):
            raise SettingsError(f'budget must be a finite number of 0 or more, not {self.budget}')
        if self.turns < 1:
            raise SettingsError(f'turns must be 1 or more, not {self.turns}')
        if self.change_interval < 1:
            raise SettingsError(f'change_interval must be 1 or more, not {self.change_interval}')
        for kind in ('label', 'demonstration', 'feature_subset'):
            cost = getattr(self.costs, kind)
            if not (np.isfinite(cost) and cost >= 0):
                raise SettingsError(f'the cost of a {kind} query must be a number of 0 or more, not {cost}')
        for outcome in Outcome:
            share = self.costs.share(outcome)
            if not 0.0 <= share <= 1.0:
                raise SettingsError(f'the share charged for outcome {outcome.value} must be in [0, 1], not {share}')
        if not (np.isfinite(self.amplitude) and self.amplitude > 0):
            raise SettingsError(f'amplitude must be a number above 0, not {self.amplitude}')
        if self.length_scale is not None and not (np.isfinite(self.length_scale) and self.length_scale > 0):
            raise SettingsError(f'length_scale must be a number above 0, not {self.length_scale}')
        if self.tune_every < 0:
            raise SettingsError(f'tune_every must be 0 or more, not {self.tune_every}')
        for name, weight in self.weights.items():
            if name not in WEIGHED:
                raise SettingsError(f'unknown decision feature {name!r}; known: {", ".join(WEIGHED)}')
            if not np.isfinite(weight):
                raise SettingsError(f'the weight of {name} is not finite ({weight})')

    def tunes_after(self, turn: int) -> bool:
        """Whether amplitude and length scale are re-optimised at the end of this turn."""
        return self.tune_every > 0 and turn > 0 and turn % self.tune_every == 0


def generator(seed: int, stream: str) -> np.random.Generator:
    """An independent random stream for one part of an episode, the same in every process for the same seed.

    Raises:
        SettingsError: a negative seed.
    """
    if seed < 0:
        raise SettingsError(f'seed must be 0 or more, not {seed}')
    return np.random.default_rng([seed, zlib.crc32(stream.encode())])
