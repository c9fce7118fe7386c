"""Knowledge that outlives its episode: another one goes on from there as if both had been one."""

import dataclasses

import numpy as np
import pytest

from al_questioner.domain import (
    AUTO,
    NO_SYMBOL,
    Action,
    Answer,
    InputError,
    Outcome,
    QueryKind,
    SettingsError,
    random_stream,
)
from al_questioner.messages.concepts_file import concepts_of_text
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.questioning import Episode
from al_questioner.questioning.review import KnowledgeFollower, doubtful_labels, reviewed, taught_learner
from shared.toys import SYMBOLS, Asks, ToyWorld, make_scene, make_settings, play, reply

TURNS = 20


def begin(settings, seed=1, view_tolerance=AUTO, strategy=None):
    """Return a new episode of these settings."""
    return Episode(settings, random_stream(seed, 'learner'), view_tolerance, strategy)


def asked_and_told(world, episode):
    """Play an episode to its end; its scenes, and the answer to each turn, None if nothing was asked."""
    said = {}

    class Noting:
        def scene(self, turn):
            return world.scene(turn)

        def answer(self, query):
            said[query.turn] = (query.action, world.answer(query))
            return said[query.turn][1]

    scenes = []
    play(episode, Noting(), lambda _episode, scene, _decision: scenes.append(scene))
    return scenes, said


class SecondDay(ToyWorld):
    """Other things, whose ids are none of the first day's."""

    def __init__(self, seed, **others):
        super().__init__(seed, **others)
        self.scenes = 1000


class AsTold:
    """A strategy that asks, turn by turn, what was asked before."""

    selector = None

    def __init__(self, actions, selector=None):
        self.actions, self.selector = actions, selector

    def choose(self, context, rng):
        action = self.actions.get(context.turn)
        return Asks(*([] if action is None else [action])).choose(context, rng)


@pytest.mark.parametrize(
    ('strategy', 'view_tolerance'),
    [('u_sampling', AUTO), ('farthest_fsq', 1e-3), ('value_per_cost', AUTO), ('rarest_demo', AUTO)],
)
def test_two_days_are_as_one(strategy, view_tolerance):
    """Beliefs after a second episode, begun with the knowledge of the first, differ in the last digits."""
    first = begin(make_settings(strategy), 1, view_tolerance)
    scenes, said = asked_and_told(ToyWorld(3, unknown_rate=0.2), first)
    second = begin(make_settings(strategy, concepts=first.knowledge('day 1')), 2, view_tolerance)
    later_scenes, later_said = asked_and_told(SecondDay(4, unknown_rate=0.2), second)
    assert later_said

    told = {**said, **{turn + TURNS: each for turn, each in later_said.items()}}
    actions = {turn: action for turn, (action, _) in told.items()}
    questioner = AsTold(actions, first.strategy.selector)
    whole = begin(make_settings(strategy, 100.0, 2 * TURNS), 1, view_tolerance, questioner)
    for scene in (*scenes, *later_scenes):
        decision = whole.ask(scene)
        assert (decision.query is None) == (decision.turn not in told)
        if decision.query is not None:
            answer = told[decision.turn][1]
            whole.tell(dataclasses.replace(answer, query_id=decision.query.query_id))

    looks = np.concatenate([scene.features for scene in (*scenes, *later_scenes)])
    assert np.array_equal(second.concepts.predict_proba(looks), whole.concepts.predict_proba(looks))
    for scene in scenes:
        assert np.array_equal(second.concepts.is_unnameable(scene), whole.concepts.is_unnameable(scene))
    last = later_scenes[-1]
    assert np.array_equal(second.concepts.look_ahead(last), whole.concepts.look_ahead(last))
    assert second.concepts.model_version == whole.concepts.model_version
    assert second.concepts.seen.features.tobytes() == whole.concepts.seen.features.tobytes()
    assert second.teachers == whole.teachers
    again = whole.knowledge('both')
    both = second.knowledge('day 2')
    assert [each.seen for each in both.lessons] == [each.seen for each in again.lessons]
    assert [label for _, label in both.examples] == [label for _, label in again.examples]
    assert both.statistics == again.statistics
    read = concepts_of_text(concepts_text(both))
    assert read == both
    assert np.array_equal(taught_learner(read).predict_proba(looks), whole.concepts.predict_proba(looks))
    assert reviewed(read) == both


def test_a_relevance_query_is_kept():
    """The things that matter, and those that were left out, would be forgotten overnight."""
    settings = make_settings('u_sampling', costs=dataclasses.replace(make_settings('u_sampling').costs, relevance=2.0))
    first = begin(settings, strategy=Asks(Action(QueryKind.RELEVANCE)))
    world = ToyWorld(5)
    decision = first.ask(world.scene(1))
    first.tell(world.answer(decision.query))
    knowledge = first.knowledge('day 1')
    lesson = knowledge.lessons[0]
    assert [each.matters for each in lesson.judgements] == [symbol != NO_SYMBOL for symbol in world.truth.values()]
    second = begin(dataclasses.replace(settings, concepts=knowledge))
    second.ask(world.scene(1))
    assert second.concepts.matters(world.current).tolist() == first.concepts.matters(world.current).tolist()
    assert second.concepts.labels_of(world.current) == first.concepts.labels_of(world.current)


@pytest.mark.parametrize('first_day_ends', [1, 2, 3])
def test_what_was_left_out_and_matters_after_all_is_kept(first_day_ends):
    """A thing that was forgotten once stays an example of none in what is kept, or the last digits differ."""
    settings = make_settings('u_sampling', costs=dataclasses.replace(make_settings('u_sampling').costs, relevance=1.0))
    scene, relevance = ToyWorld(5, change_interval=100).scene(1), Action(QueryKind.RELEVANCE)
    forgotten, named, *_ = scene.object_ids
    told = {
        1: (relevance, (named,)),
        2: (Action(QueryKind.LABEL, named), 'snack'),
        3: (relevance, (forgotten, named)),
    }

    def teach(turns, known=None):
        episode = begin(
            dataclasses.replace(settings, concepts=known),
            strategy=AsTold({here: told[turn][0] for here, turn in enumerate(turns, 1)}),
        )
        for turn in turns:
            episode.tell(reply(episode.ask(scene).query, told[turn][1]))
        return episode

    whole = teach((1, 2, 3))
    second = teach(range(first_day_ends + 1, 4), teach(range(1, first_day_ends + 1)).knowledge('day 1'))
    if first_day_ends == 3:
        second.ask(scene)
    assert whole.concepts.labels_of(scene)[:2] == (None, 'snack')
    expected = whole.concepts.predict_proba(scene.features)
    for episode in (whole, second):
        knowledge = concepts_of_text(concepts_text(episode.knowledge('day 2')))
        for learner in (episode.concepts, taught_learner(knowledge)):
            assert np.array_equal(learner.predict_proba(scene.features), expected)
            assert learner.matters(scene).tolist() == whole.concepts.matters(scene).tolist()
        assert knowledge.counts == {'main_dish': 0, 'snack': 1, 'fruit': 0, NO_SYMBOL: len(scene) - 2}
        assert reviewed(knowledge) == knowledge
        assert len(doubtful_labels(knowledge)) <= len(scene) - 1


@pytest.mark.parametrize('strategy', ['farthest_fsq', 'value_per_cost', 'expert'])
def test_relevant_features_are_asked_once(strategy):
    """A teacher who said yesterday what counts is asked that again today."""
    first = begin(make_settings('farthest_fsq'))
    play(first, ToyWorld(1))
    second = begin(make_settings(strategy, concepts=first.knowledge('day 1')), 2)
    play(second, SecondDay(2))
    kinds = [record.kind for record in second.records]
    assert kinds
    assert QueryKind.FEATURE_SUBSET not in kinds
    assert second.concepts.features_in_use == ('colour_red', 'colour_green', 'size_height')


def test_labelled_views_stay_labelled():
    """The same thing, unchanged, is asked about again the next day."""
    first = begin(make_settings('u_sampling', 1.0, 1))
    world = ToyWorld(1, change_interval=100)
    play(first, world)
    second = begin(make_settings('u_sampling', concepts=first.knowledge('day 1')))
    second.ask(world.scene(2))
    assert second.concepts.is_labelled(second.scene).sum() == 1


def test_new_symbols_are_learnt_beside_old_ones():
    """A robot could never be taught one more word."""
    first = begin(make_settings('farthest_fsq'))
    play(first, ToyWorld(1))
    more = dataclasses.replace(
        make_settings('farthest_fsq'), symbols=(*SYMBOLS, 'tool'), concepts=first.knowledge('day 1')
    )
    second = begin(more)
    scene = SecondDay(2).scene(1)
    second.ask(scene)
    assert second.concepts.predict_proba(scene.features).shape == (6, 4)
    assert second.positives == {**first.positives, 'tool': 0}


def test_symbols_cannot_get_lost():
    """A learner of other symbols fails somewhere within the lessons."""
    first = begin(make_settings('farthest_fsq'))
    play(first, ToyWorld(1))
    with pytest.raises(SettingsError, match="'fruit' is missing"):
        dataclasses.replace(make_settings('dt_task'), symbols=SYMBOLS[:2], concepts=first.knowledge('day 1'))


def test_corrections_reach_what_is_kept():
    """A wrong answer that was put right is kept wrong."""
    episode = begin(make_settings('random_fsq', 5.0, 5), strategy=Asks(Action(QueryKind.LABEL, 100)))
    world = ToyWorld(1)
    query = episode.ask(world.scene(1)).query
    episode.tell(reply(query, 'snack'))
    episode.tell(Answer(query.query_id, 'a2', 'bob', Outcome.ANSWERED, 'fruit', replaces='a1'))
    episode.take(Answer(query.query_id, 'late', 'eve', Outcome.ANSWERED, 'snack'))
    knowledge = episode.knowledge('day 1', {1: 7})
    (lesson,) = knowledge.lessons
    assert (lesson.teacher, lesson.stamp, [label.label for label in lesson.labels]) == ('bob', 7, ['fruit'])
    assert [(said.teacher, said.label) for said in lesson.hearsay] == [('eve', 'snack')]
    assert (knowledge.teachers['toy'].corrected, knowledge.teachers['eve'].late) == (1, 1)
    assert reviewed(knowledge).reliabilities == knowledge.reliabilities
    assert knowledge.reliabilities['eve'] < 0.9, 'what she said late tells of her'


def test_late_answers_of_the_second_day_count_as_if_at_once():
    """An answer that is corrected makes the learner forget what it knew before."""
    first = begin(make_settings('farthest_fsq'))
    play(first, ToyWorld(1))
    settings = make_settings('farthest_fsq', concepts=first.knowledge('day 1'))
    corrected, right = begin(settings), begin(settings)
    scene = SecondDay(2).scene(1)
    for episode, answers in ((corrected, ('snack', 'fruit')), (right, ('fruit',))):
        query, before = episode.ask(scene).query, None
        for number, label in enumerate(answers):
            episode.tell(Answer(query.query_id, str(number), 'toy', Outcome.ANSWERED, label, replaces=before))
            before = str(number)
    assert np.array_equal(
        corrected.concepts.predict_proba(scene.features), right.concepts.predict_proba(scene.features)
    )


def test_teachers_without_a_label_that_counts_are_reviewed_too():
    """A teacher who only said that they did not know would lose the estimate when the file is looked at."""
    episode = begin(
        make_settings('random_fsq', turns=3), strategy=Asks(*(Action(QueryKind.LABEL, i) for i in range(3)))
    )
    for outcome, content, teacher in (
        (Outcome.ANSWERED, SYMBOLS[0], 'anna'),
        (Outcome.UNKNOWN, None, 'bob'),
        (Outcome.SKIP, None, 'carl'),
    ):
        query = episode.ask(make_scene(np.arange(15.0).reshape(3, 5))).query
        episode.tell(Answer(query.query_id, f'a{query.turn}', teacher, outcome, content))
    knowledge = episode.knowledge('day 1')
    assert sorted(knowledge.reliabilities) == ['anna', 'bob', 'carl']
    assert reviewed(knowledge) == knowledge
    bare = dataclasses.replace(knowledge, reliabilities={}, statistics=None)
    assert reviewed(bare) == knowledge


def test_an_episode_is_kept_once():
    """Two episodes of one id cannot be told apart in what is kept."""
    first = begin(make_settings('farthest_fsq'))
    with pytest.raises(InputError, match='nothing is known yet'):
        first.knowledge('day 1')
    play(first, ToyWorld(1))
    second = begin(make_settings('dt_task', concepts=first.knowledge('day 1')))
    second.ask(SecondDay(2).scene(1))
    with pytest.raises(InputError, match='another id'):
        second.knowledge('day 1')


def test_other_features_are_refused():
    """Concepts of one sensor are taken for those of another."""
    first = begin(make_settings('farthest_fsq'))
    world = ToyWorld(1)
    play(first, world)
    second = begin(make_settings('dt_task', concepts=first.knowledge('day 1')))
    names = ('colour_red', 'colour_green', 'size_width', 'noise_max', 'noise_min')
    with pytest.raises(InputError, match="'size_width', it was 'size_height' before"):
        second.ask(dataclasses.replace(world.current, feature_names=names))


def test_a_wrong_label_is_doubtful():
    """Nobody finds the label that makes the robot call pliers a snack."""
    rng = np.random.default_rng(0)
    episode = begin(make_settings('random_fsq', 100.0, 40), strategy=AsTold({}))
    kinds = np.repeat(np.arange(3), 10)
    features = rng.normal(0, 0.3, size=(30, 5)) + 3 * np.eye(3, 5)[kinds]
    episode.strategy.actions = {turn: Action(QueryKind.LABEL, turn - 1) for turn in range(1, 31)}
    for turn in range(1, 31):
        query = episode.ask(make_scene(features)).query
        told = SYMBOLS[kinds[query.action.object_id]] if turn != 7 else 'fruit'
        episode.tell(reply(query, told))
    (doubt,) = doubtful_labels(episode.knowledge('day 1'))
    assert (doubt.lesson.turn, doubt.label.label, doubt.likely) == (7, 'fruit', 'main_dish')


def test_a_follower_believes_what_the_learner_believes():
    """A recogniser beside a learner drifts away from it, or begins at the beginning with every answer."""
    episode, world, follower = begin(make_settings('farthest_fsq')), ToyWorld(1), KnowledgeFollower()
    followers = set()
    while not episode.done:
        scene = world.scene(episode.turn + 1)
        query = episode.ask(scene).query
        if query is not None:
            episode.tell(world.answer(query))
        learner = follower.follow(episode.knowledge('day 1'))
        followers.add(id(learner))
        assert np.array_equal(learner.predict_proba(scene.features), episode.concepts.predict_proba(scene.features))
    assert len(followers) == 1
    # What is put right later changes what was taught before.
    answer = Answer('q3', 'a2', 'toy', Outcome.ANSWERED, 'none', replaces='a1')
    assert episode.take(answer).record is not None
    learner = follower.follow(episode.knowledge('day 1'))
    assert np.array_equal(learner.predict_proba(scene.features), episode.concepts.predict_proba(scene.features))
