"""A table, a person's session, and questions to put to them."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import pytest

from al_questioner.domain import Action, Answer, Outcome, Query, QueryKind, QueryRecord, Scene
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import EpisodeProgress, Picture, ViewState
from al_questioner.terminal.commands import WISHES

SYMBOLS = ('main_dish', 'snack', 'fruit', 'beverage')
GROUPS = ('colour', 'size', 'shape', 'texture', 'location', 'base', 'arms', 'hands', 'noise', 'weight')


def scene_of(places: dict[int, tuple[float, float]]) -> Scene:
    """Objects at these places of the table, in metres."""
    positions = np.array([(x, y, 0.0) for x, y in places.values()], np.float32).reshape(-1, 3)
    return Scene(tuple(places), positions, np.zeros((len(places), 1), np.float32), ('colour_hue',))


def many_objects(count: int) -> Scene:
    """Return this number of objects all over the table."""
    rng = np.random.default_rng(0)
    return scene_of({i: (float(x), float(y)) for i, (x, y) in enumerate(rng.random((count, 2)))})


def picture_of(height: int = 692, width: int = 1280) -> Picture:
    """A picture with a bright middle, by default of the size that perception draws."""
    picture = np.zeros((height, width, 3), np.uint8)
    picture[height // 4 : 3 * height // 4, width // 4 : 3 * width // 4] = (250, 120, 20)
    return picture


def label(number: int = 1, object_id: int = 7, symbols: tuple[str, ...] = SYMBOLS, text: str = '') -> Query:
    """Return a label query."""
    action = Action(QueryKind.LABEL, object_id)
    return Query(f'q{number}', number, action, symbols, 1, 4, 5, 1, text or f'What is object {object_id}?')


def demonstration(number: int = 1, ids: tuple[int, ...] = (1, 7, 12)) -> Query:
    """Return a demonstration query."""
    action = Action(QueryKind.DEMONSTRATION, symbol='snack')
    return Query(f'q{number}', number, action, tuple(map(str, ids)), 2, 4, 5, 1, 'Can you show me a snack?')


def feature_subset(number: int = 1, groups: tuple[str, ...] = GROUPS) -> Query:
    """Return a feature subset query."""
    text = 'Which properties matter for telling main dish, snack, fruit and beverage apart?'
    return Query(f'q{number}', number, Action(QueryKind.FEATURE_SUBSET), groups, 2, 4, 5, 1, text)


def relevance(number: int = 1, ids: tuple[int, ...] = (1, 7, 12)) -> Query:
    """Return a relevance query."""
    text = 'Which of these things matter?'
    return Query(f'q{number}', number, Action(QueryKind.RELEVANCE), tuple(map(str, ids)), 4, 4, 5, 1, text)


QUERIES = {
    'label': label,
    'demonstration': demonstration,
    'feature_subset': feature_subset,
    'relevance': relevance,
}


def record(turn: int, object_id: int = 3, symbol: str = 'fruit') -> QueryRecord:
    """An answered label query."""
    return QueryRecord(turn, QueryKind.LABEL, object_id, symbol, 1.0, Outcome.ANSWERED)


@dataclass
class Person:
    """A session on a small table, and what it sent.

    Attributes:
        sent: episode and answer, in order.
        session: of this person.
    """

    sent: list[tuple[str, Answer]] = field(default_factory=list)

    def __post_init__(self) -> None:
        numbers = iter(range(1, 1000))
        self.dialogue = TeacherDialogue(
            'anna', lambda *sent: self.sent.append(sent), lambda: f'a{next(numbers)}', other_words=WISHES
        )
        self.dialogue.enter('episode')
        self.dialogue.look(scene_of({1: (0.1, 0.1), 7: (1.2, 0.4), 12: (0.6, 0.7)}), 1)
        self.dialogue.see(picture_of(), 1)
        self.progress(0)

    def progress(
        self, turn: int, *records: QueryRecord, done: bool = False, last: tuple[Query, Answer] | None = None
    ) -> None:
        """The learner's state after a turn."""
        self.dialogue.follow(EpisodeProgress(turn, 8, 6.0, float(len(records)), done, records, last))

    def asked(self, query: Query) -> ViewState:
        """Return what is shown once this is asked."""
        self.dialogue.ask(query)
        return self.dialogue.view_state()

    def answered(self, query: Query, word: str = 'fruit') -> ViewState:
        """Return what is shown once this is asked, answered, and the answer taken."""
        self.asked(query)
        self.dialogue.say(word)
        return self.taken()

    def taken(self, accepted: bool = True, reason: str = '') -> ViewState:
        """Return what is shown once the learner has said whether it takes the last answer."""
        self.dialogue.acknowledge(self.sent[-1][1].answer_id, accepted, reason)
        return self.dialogue.view_state()


@pytest.fixture
def person() -> Person:
    return Person()


@pytest.fixture(scope='session')
def made() -> SimpleNamespace:
    """The helpers above, for test modules that get their `person` as a fixture too."""
    helpers = (Person, demonstration, feature_subset, label, many_objects, picture_of, record, relevance, scene_of)
    return SimpleNamespace(QUERIES=QUERIES, **{helper.__name__: helper for helper in helpers})
