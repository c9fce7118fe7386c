"""The menu of a person who asks: what it shows, and what a line of input means."""

from __future__ import annotations

import contextlib
import io
import os
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import Action, Costs, EpisodeError, InputError, Outcome, QueryKind, QueryRecord, random_stream
from al_questioner.questioning import Episode, Human, TurnContext
from al_questioner.terminal.menu import HELP_TABLE, Lines, chosen_candidate, menu, pick_from_menu
from shared.toys import toy as toy

SYMBOLS = ('main_dish', 'snack', 'soup')
SUBSET_ASKED = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2, Outcome.ANSWERED)


def context_of(toy: Any, **changes: Any) -> TurnContext:
    scene = toy.scene(np.random.default_rng(0).normal(size=(7, 5)), range(20, 27))
    concepts = ConceptLearner(SYMBOLS, 4.0)
    concepts.observe(scene)
    concepts.label(21, scene.features[1], 'snack', 1)
    return toy.context(**{'scene': scene, 'concepts': concepts, 'spent': 1.0, **changes})


@pytest.mark.parametrize(
    ('line', 'action'),
    [
        ('22', Action(QueryKind.LABEL, object_id=22)),
        (' #26 \n', Action(QueryKind.LABEL, object_id=26)),
        ('snack', Action(QueryKind.DEMONSTRATION, symbol='snack')),
        ('M', Action(QueryKind.DEMONSTRATION, symbol='main_dish')),
        ('f', Action(QueryKind.FEATURE_SUBSET)),
        ('', Action(QueryKind.NO_QUERY)),
        ('nothing', Action(QueryKind.NO_QUERY)),
    ],
)
def test_a_line_names_a_candidate(toy: Any, line: str, action: Action) -> None:
    """The robot would ask something else than the expert said."""
    context = context_of(toy)
    assert context.candidates[chosen_candidate(line, context)] == action


@pytest.mark.parametrize(
    ('line', 'changes', 'reason'),
    [
        ('99', {}, 'no such object'),
        ('s', {}, 'snack or soup'),
        ('drink', {}, 'is no question: '),
        ('hello', {}, 'is no question: '),
        ('hlep', {}, 'did you mean help'),
        ('snakc', {}, 'did you mean snack'),
        ('featuers', {}, 'did you mean features'),
        ('9' * 5000, {}, 'no such object'),
        ('snack', {'spent': 19.0}, 'the budget does not pay'),
        ('22', {'spent': 20.0}, 'the budget does not pay'),
        ('f', {'history': (SUBSET_ASKED,)}, 'asked before'),
        ('snack', {'scene': 'empty'}, 'nothing is in view'),
        ('22', {'scene': 'empty'}, 'no such object'),
        ('f', {'scene': 'one group'}, 'only one possible answer'),
        ('main', {'scene': 'named'}, 'named otherwise'),
        ('21', {'scene': 'named'}, 'its only possible answer is known'),
    ],
)
def test_a_line_that_names_none_is_explained(toy: Any, line: str, changes: dict[str, Any], reason: str) -> None:
    """The expert would not know what is wrong, or spend what is not there."""
    scenes = {
        'empty': toy.scene(np.empty((0, 5))),
        'one group': toy.scene(np.zeros((1, 5)), names=[f'colour_{i}' for i in range(5)]),
        'named': toy.scene(context_of(toy).scene.features[1:2], [21]),
    }
    if 'scene' in changes:
        changes = {'scene': scenes[changes['scene']]}
    with pytest.raises(InputError, match=reason):
        chosen_candidate(line, context_of(toy, **changes))


@pytest.mark.parametrize(
    ('symbols', 'line', 'action'),
    [
        (('20', '21'), '21', Action(QueryKind.DEMONSTRATION, symbol='21')),
        (('20', '21'), '22', Action(QueryKind.LABEL, object_id=22)),
        (('f', 'g'), 'f', Action(QueryKind.DEMONSTRATION, symbol='f')),
        (('f', 'g'), 'features', Action(QueryKind.FEATURE_SUBSET)),
        (('n', 'nothing'), 'n', Action(QueryKind.DEMONSTRATION, symbol='n')),
        (('n', 'nothing'), 'nothing', Action(QueryKind.DEMONSTRATION, symbol='nothing')),
        (('Cup', 'cup'), 'cup', Action(QueryKind.DEMONSTRATION, symbol='cup')),
        (('cup', 'cupboard'), 'cup', Action(QueryKind.DEMONSTRATION, symbol='cup')),
        (('Früchte', 'cup'), 'Fru\u0308chte', Action(QueryKind.DEMONSTRATION, symbol='Früchte')),
        (('main_dish', 'cup'), 'main d', Action(QueryKind.DEMONSTRATION, symbol='main_dish')),
        (('cup', 'plate'), '#２２', Action(QueryKind.LABEL, object_id=22)),
        (('cup', 'plate'), '0022', Action(QueryKind.LABEL, object_id=22)),
    ],
)
def test_what_is_exactly_a_symbol_is_that_symbol(toy: Any, symbols: tuple[str, ...], line: str, action: Action) -> None:
    """A symbol that the menu lists could not be asked for, or another question would be paid for."""
    context = toy.context(scene=context_of(toy).scene, symbols=symbols)
    assert context.candidates[chosen_candidate(line, context)] == action


@given(line=st.text(max_size=30))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_line_is_a_candidate_or_explained(toy: Any, line: str) -> None:
    """A slip of the finger would end the demonstration."""
    context = context_of(toy)
    with contextlib.suppress(InputError):
        assert 0 <= chosen_candidate(line, context) < len(context.candidates)


def test_lines_are_read_as_they_come() -> None:
    """A choice would be lost where two were typed ahead, or where a line comes in pieces."""
    source, sink = os.pipe()
    lines = Lines(source)
    os.write(sink, b'7\nsna')
    assert lines.readline() == '7\n'
    os.write(sink, b'ck\nf')
    assert lines.readline() == 'snack\n'
    os.close(sink)
    assert lines.readline() == 'f'
    assert lines.readline() == ''
    os.close(source)
    assert lines.readline() == ''


def test_wrong_input_is_asked_again_and_the_end_is_told(toy: Any) -> None:
    """A typing error would be a choice, or a closed terminal a frozen robot."""
    context, screen = context_of(toy), io.StringIO()
    index = pick_from_menu(context, io.StringIO('99\nwhat?\n23\n'), screen)
    assert context.candidates[index].object_id == 23
    assert screen.getvalue().count('ask> ') == 3
    assert 'no such object' in screen.getvalue()
    with pytest.raises(EpisodeError, match='input has ended'):
        pick_from_menu(context, io.StringIO('99\n'), screen)


def test_help_is_the_table_of_inputs(toy: Any) -> None:
    """An expert would guess what can be typed; but what a symbol begins with means that symbol."""
    context, screen = context_of(toy), io.StringIO()
    index = pick_from_menu(context, io.StringIO('h\nHelp\n23\n'), screen)
    assert context.candidates[index].object_id == 23
    assert screen.getvalue().count(HELP_TABLE) == 2
    assert 'no question' not in screen.getvalue()
    hot = toy.context(scene=context.scene, symbols=('hot', 'cold'))
    found = pick_from_menu(hot, io.StringIO('h\n'), io.StringIO())
    assert hot.candidates[found] == Action(QueryKind.DEMONSTRATION, symbol='hot')


def test_the_menu_tells_what_there_is_to_choose(toy: Any) -> None:
    """The expert would choose without knowing prices, beliefs, or what is left."""
    shown = menu(context_of(toy))
    assert max(map(len, shown.splitlines())) <= 80
    for part in ('Turn 3 of 20', 'budget left: 19 of 20', 'cost 1', 'cost 2', '21*', '22 ', 'snack: 1', 'soup: 0'):
        assert part in shown
    assert ': f' in shown
    poor = menu(context_of(toy, spent=19.0))
    assert 'Show me one' not in poor
    assert 'What is it?' in poor
    assert 'What is it?' not in menu(context_of(toy, spent=20.0))


def test_the_menu_of_a_scene_without_things(toy: Any) -> None:
    """The person would wait for a list, or look for what costs and tells nothing."""
    shown = menu(context_of(toy, scene=toy.scene(np.empty((0, 5)))))
    assert 'Nothing is in view' in shown
    assert 'What is it' not in shown
    assert 'Show me' not in shown


def test_a_person_plays_an_episode(toy: Any) -> None:
    """The whole way: menu, choice, question, answer, next turn."""
    lines = io.StringIO('f\n100\nsnack\n\n105\n')
    picks = Human(lambda context: pick_from_menu(context, lines, io.StringIO()))
    episode = Episode(toy.settings('random_fsq', 20.0, 5), random_stream(0, 'learner'), strategy=picks)
    world = toy.world(0)
    kinds = []
    for turn in range(1, 6):
        decision = episode.ask(world.scene(turn) if turn < 5 else world.current)
        kinds.append(decision.candidates[decision.chosen].kind.value)
        if decision.query is not None:
            episode.tell(world.answer(decision.query))
    assert kinds == ['feature_subset', 'label', 'demonstration', 'no_query', 'label']


def test_the_relevance_query_is_chosen_where_it_has_a_cost(toy: Any) -> None:
    """The expert could not demonstrate it; or a letter would change its meaning for those who do not use it."""
    plain, costly = context_of(toy), context_of(toy, costs=Costs(relevance=4.0))
    for line in ('r', 'relevance', 'R'):
        assert costly.candidates[chosen_candidate(line, costly)] == Action(QueryKind.RELEVANCE)
        with pytest.raises(InputError, match='is no question'):
            chosen_candidate(line, plain)
    assert 'Which of these things matter? (cost 4): r' in menu(costly)
    assert 'matter? (cost 4)' not in menu(plain)
    with pytest.raises(InputError, match='the budget does not pay'):
        chosen_candidate('r', context_of(toy, costs=Costs(relevance=4.0), spent=17.0))
    costly.concepts.judge_scene(costly.scene, (22,), 1)
    judged = context_of(toy, costs=Costs(relevance=4.0), concepts=costly.concepts)
    with pytest.raises(InputError, match='its only possible answer is known'):
        chosen_candidate('r', judged)
    assert 'matter? (cost 4)' not in menu(judged)
    screen = io.StringIO()
    pick_from_menu(context_of(toy, costs=Costs(relevance=4.0)), io.StringIO('h\nr\n'), screen)
    assert 'asks which of these things matter' in screen.getvalue()
