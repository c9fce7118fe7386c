"""Options that come from declared settings."""

from __future__ import annotations

import pytest

from al_questioner.domain import InputError, Setting
from al_questioner.support.arguments import Parser, add_option

TURNS = Setting('most_turns', 40, 'length', 'turns', 1, 100)


def parser() -> Parser:
    result = Parser(prog='command')
    add_option(result, TURNS)
    add_option(result, Setting('budget', 25.0, 'query budget', lower=0), "the task's")
    add_option(result, Setting('repeat', False, 'ask again'))
    return result


def test_an_option_has_the_default_and_the_help_of_its_setting() -> None:
    """Otherwise the command would do something else than the node, or describe it otherwise."""
    given = parser().parse_args([])
    assert (given.most_turns, given.budget, given.repeat) == (40, None, False)
    told = ' '.join(parser().format_help().split())
    assert '--most-turns MOST_TURNS length [turns] (40)' in told
    assert "query budget (the task's)" in told
    assert '--repeat ask again' in told


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['--most-turns', '101'], 'argument --most-turns: must be at least 1 and at most 100, not 101'),
        (['--most-turns', 'many'], "argument --most-turns: invalid int value: 'many'"),
        (['--budget', 'inf'], r'argument --budget: must be at least 0 and at most 1e\+12, not inf'),
        (['--repeat', 'yes'], 'unrecognized arguments: yes'),
    ],
)
def test_an_option_has_the_type_and_the_range_of_its_setting(arguments: list[str], reason: str) -> None:
    """Otherwise the node would refuse later what the command takes."""
    with pytest.raises(InputError, match=reason):
        parser().parse_args(arguments)


COST = Setting('cost', 'never', 'cost; never: it is not asked', 'budget', lower=0, word='never')


@pytest.mark.parametrize(('arguments', 'cost'), [([], None), (['--cost', 'never'], 'never'), (['--cost', '2'], 2.0)])
def test_an_option_takes_a_number_or_the_word_of_its_setting(arguments: list[str], cost: object) -> None:
    """Otherwise what a node can be told could not be told to a command."""
    result = Parser(prog='command')
    add_option(result, COST, "the task's")
    assert result.parse_args(arguments).cost == cost


@pytest.mark.parametrize(
    ('text', 'reason'),
    [('off', 'must be a number or never, not off'), ('-1', 'must be at least 0'), ('nan', 'at least 0')],
)
def test_another_word_is_refused(text: str, reason: str) -> None:
    result = Parser(prog='command')
    add_option(result, COST)
    with pytest.raises(InputError, match=f'argument --cost: {reason}|{reason}'):
        result.parse_args(['--cost', text])
