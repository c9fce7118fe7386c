"""Recognition on a table that the robot has not seen."""

import numpy as np
import pytest

from al_questioner.commands.demo.new_table import NewTable, recognise_new_table
from al_questioner.domain import NO_SYMBOL, RecognisedThing, Recognition
from al_questioner.questioning import make_strategy
from al_questioner.simulation import Evaluation, PerceivedWorld, WorldSpec, episode_settings, play
from al_questioner.simulation.world import Table
from shared.durable_sessions import TASK, TEACHER

POSITION = (0.0, 0.0, 0.0)


def thing(object_id: int, best: str, question: str = '') -> RecognisedThing:
    return RecognisedThing(object_id, POSITION, (1.0,), best, question)


def table_of(told: list[RecognisedThing], truth: dict[int, str]) -> NewTable:
    return NewTable(Table((), truth), Recognition(('snack', 'fruit'), 3, 0.5, tuple(told)))


def test_what_is_right_is_counted() -> None:
    """A robot that admits that it does not know would be praised, or one that guesses."""
    found = table_of(
        [
            thing(1, 'snack'),
            thing(2, 'fruit'),
            thing(3, 'snack', 'What is object 3?'),
            thing(4, NO_SYMBOL),
            thing(5, NO_SYMBOL),
        ],
        {1: 'snack', 2: 'snack', 3: 'snack', 4: NO_SYMBOL, 5: 'fruit'},
    )
    assert [each.object_id for each in found.right] == [1, 4]
    assert found.members() == {
        'things': 5,
        'recognised': 2,
        'of_some_symbol': 4,
        'named_rightly': 1,
        'named': 2,
        'not_known': 1,
    }
    assert str(found) == (
        'It recognises 2 of 5 things on a table it has not seen: 1 of the 4 that have a name, 1 of the 1 that have'
        ' none.'
    )


@pytest.mark.parametrize('symbol', ['snack', NO_SYMBOL])
def test_things_of_one_kind_need_no_second_number(symbol: str) -> None:
    """The same would be said twice."""
    found = table_of([thing(1, symbol)], {1: symbol})
    assert str(found) == 'It recognises 1 of 1 things on a table it has not seen.'


def test_the_learner_of_an_episode_recognises_the_new_table() -> None:
    """The line would be of another table, or of another learner."""
    world = PerceivedWorld(WorldSpec(TASK, 4, 4).open())
    evaluation = Evaluation(WorldSpec(TASK, 4, 4), episode_settings(TASK, 'random_fsq', 12.0, 7), None, world)
    play(evaluation, make_strategy('random_fsq', {}), TEACHER)
    found = recognise_new_table(evaluation, world)
    assert [each.object_id for each in found.recognition.things] == list(found.table.symbols)
    assert found.recognition.examples == len(evaluation.concepts.labelled_views)
    sums = [sum(each.probabilities) for each in found.recognition.things]
    np.testing.assert_allclose(sums, 1)
