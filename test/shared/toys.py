"""Scenes, settings and a teacher for the tests of questions."""

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner
from al_questioner.concepts.kernel import GROUPED
from al_questioner.domain import NO_SYMBOL, Answer, EpisodeSettings, Outcome, QueryKind, random_stream
from al_questioner.questioning import make_strategy, new_concept_learner
from al_questioner.questioning.strategies.choice import ask_nothing
from shared import scenes

SYMBOLS = ('main_dish', 'snack', 'fruit')
NAMES = ('colour_red', 'colour_green', 'size_height', 'noise_max', 'noise_min')
WEIGHTS = {
    'dt_iros': {'discriminability': 0.74, 'class_uniformity': 0.26},
    'dt_task': {
        'discriminability': 0.45,
        'class_uniformity': 0.17,
        'instance_variation': 0.33,
        'prediction_margin': 0.05,
    },
    'dt_task_env': {
        'discriminability': 0.08,
        'class_uniformity': 0.21,
        'instance_variation': 0.02,
        'prediction_margin': 0.01,
        'budget_consumption': -0.26,
        'non_query_time': -0.42,
    },
    'value_per_cost': {'gain': 1, 'chance': 1, 'price': -1, 'ahead': 1e6, 'silence': -10},
}


class ToyWorld:
    """Random scenes of things of a symbol or of none, which change now and then, and a teacher who knows them."""

    def __init__(self, seed, n_objects=6, change_interval=4, unknown_rate=0.0):
        self.rng = random_stream(seed, 'toy')
        self.n_objects, self.change_interval, self.unknown_rate = n_objects, change_interval, unknown_rate
        self.scenes = 0
        self.truth = {}

    def scene(self, turn):
        if (turn - 1) % self.change_interval == 0:
            self.scenes += 1
            kinds = self.rng.integers(0, len(SYMBOLS) + 1, size=self.n_objects)
            features = self.rng.normal(size=(self.n_objects, len(NAMES)))
            features[:, :3] += 2 * np.eye(4)[kinds][:, :3]
            ids = tuple(100 * self.scenes + i for i in range(self.n_objects))
            self.truth = {i: (*SYMBOLS, NO_SYMBOL)[kind] for i, kind in zip(ids, kinds, strict=True)}
            self.current = make_scene(features, ids)
        return self.current

    def answer(self, query):
        if self.rng.random() < self.unknown_rate:
            return reply(query, None, Outcome.UNKNOWN)
        if query.action.kind is QueryKind.LABEL:
            return reply(query, self.truth[query.action.object_id])
        if query.action.kind is QueryKind.FEATURE_SUBSET:
            return reply(query, ('colour', 'size'))
        if query.action.kind is QueryKind.RELEVANCE:
            return reply(query, tuple(i for i, symbol in self.truth.items() if symbol != NO_SYMBOL))
        shown = [object_id for object_id, symbol in self.truth.items() if symbol == query.action.symbol]
        return reply(query, shown[0] if shown else NO_SYMBOL)


def make_scene(features, object_ids=None, names=NAMES):
    return scenes.make_scene(features, object_ids, names)


def reply(query, content, outcome=Outcome.ANSWERED, query_id=None):
    return Answer(query.query_id if query_id is None else query_id, 'a1', 'toy', outcome, content)


def make_settings(strategy, budget=12.0, turns=20, **others):
    return EpisodeSettings(
        symbols=SYMBOLS,
        budget=budget,
        turns=turns,
        strategy=strategy,
        weights=WEIGHTS.get(strategy, {}),
        **{'change_interval': 4, **others},
    )


def make_context(labels=(), scene=None, concepts=None, symbols=SYMBOLS, **changes):
    """Turn 3 of 20 in a scene of six objects, of which the first ones carry the labels given."""
    scene = make_scene(np.random.default_rng(0).normal(size=(6, 5))) if scene is None else scene
    if concepts is None:
        concepts = ConceptLearner(symbols, 100.0, shape=GROUPED, class_balance=0.5)
        concepts.observe(scene)
        for row, label in enumerate(labels):
            concepts.label(scene.object_ids[row], scene.features[row], label, 1)
    return scenes.make_context(scene, concepts, **changes)


class Asks:
    """A strategy that asks for the first of these actions that is a candidate, else for nothing."""

    selector = None

    def __init__(self, *actions):
        self.actions = actions

    def choose(self, context, rng):
        choice = ask_nothing(context)
        found = [context.candidates.index(action) for action in self.actions if action in context.candidates]
        return type(choice)(found[0], choice.utilities) if found else choice


def play(episode, world, watch=None):
    """Play an episode to its end; its decisions."""
    decisions = []
    while not episode.done:
        scene = world.scene(episode.turn + 1)
        decision = episode.ask(scene)
        decisions.append(decision)
        if watch:
            watch(episode, scene, decision)
        if decision.query:
            episode.tell(world.answer(decision.query))
    return decisions


def learnt(settings, scenes, records, tuned_turns=()):
    """Return the state of a learner that had these records from the beginning, tuned at the end of some turns."""
    selector = make_strategy(settings.strategy, settings.weights).selector
    concepts, by_turn = new_concept_learner(settings, selector), {record.turn: record for record in records}
    for turn, scene in enumerate(scenes, start=1):
        concepts.observe(scene)
        if turn in by_turn:
            concepts.learn(by_turn[turn], scene)
        if turn in tuned_turns:
            concepts.repeat_tuning()
    return concepts


@pytest.fixture
def toy():
    """The helpers above."""

    class Toy:
        symbols, weights, world, asks = SYMBOLS, WEIGHTS, ToyWorld, Asks
        scene, reply, settings = map(staticmethod, (make_scene, reply, make_settings))
        context, play, learnt = map(staticmethod, (make_context, play, learnt))

    return Toy
