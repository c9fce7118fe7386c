"""The whole graph keeps its promises, whatever happens to it: see docs/explanation/graph_in_a_bottle.md."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from shared.bottle import soak
from shared.bottle.bottle import run
from shared.bottle.failing import explain
from shared.bottle.mutations import MUTATIONS, seeds_to_find
from shared.bottle.shrinking import shrink

SEEDS, SEEDS_A_TEST = 200, 25
FOUND_SEEDS = (174, 220, 410, 483, 488, 630, 777, 798, 820, 1006, 1099, 1559, 40315, 40765, 41546)
"""Seeds that have failed once, for whatever reason: what is found is added here."""
QUICK = 30
"""Seeds within which a fault is found that is tried with every change."""
QUICKLY_FOUND = (
    'acknowledges an answer before it is written',
    'forgets the check for duplicates',
    'does not stop the repetition of a question',
    'takes a late answer for one to the present query',
)


@pytest.mark.parametrize('first', range(0, SEEDS, SEEDS_A_TEST))
def test_every_promise_is_kept_under_every_fault(first: int) -> None:
    """Deaths, losses, clocks that jump, full disks, people who err: no answer is lost, none counts twice or is guessed.

    A seed that fails prints the course of events, with the fewest faults that it takes.
    """
    failed = next((outcome for outcome in map(run, range(first, first + SEEDS_A_TEST)) if outcome.violation), None)
    assert failed is None, explain(failed)


def test_what_was_found_once_does_not_come_back() -> None:
    failed = next((outcome for outcome in map(run, FOUND_SEEDS) if outcome.violation), None)
    assert failed is None, explain(failed)


def test_a_seed_is_one_course_of_events() -> None:
    """Otherwise a failure could not be played again, and a chart would tell of another run."""
    for seed in (3, 15):
        charted, again, silent = run(seed, is_charted=True), run(seed, is_charted=True), run(seed)
        assert charted == again
        assert (charted.faults, charted.steps, charted.seconds) == (silent.faults, silent.steps, silent.seconds)


def test_without_faults_an_episode_ends_by_itself() -> None:
    outcome = run(5, frozenset())
    assert outcome.violation == ''
    assert outcome.faults == ()
    assert outcome.lives == 1


@pytest.mark.parametrize('what', QUICKLY_FOUND)
def test_a_fault_in_the_code_is_found(what: str) -> None:
    """A bottle in which nothing can break would prove nothing."""
    seeds, found = seeds_to_find(MUTATIONS[what], QUICK)
    assert 0 < seeds <= QUICK
    assert found


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize('what', sorted(set(MUTATIONS) - set(QUICKLY_FOUND)))
def test_each_fault_in_the_code_is_found(what: str) -> None:
    seeds, _ = seeds_to_find(MUTATIONS[what], 1000)
    assert 0 < seeds <= 1000


def test_a_failing_seed_is_told_as_a_chart_of_few_faults() -> None:
    """Otherwise somebody would have to read a thousand lines to see what went wrong."""
    what = 'forgets the check for duplicates'
    seeds, _ = seeds_to_find(MUTATIONS[what], QUICK)
    with MUTATIONS[what]():
        failed = run(seeds - 1)
        text = explain(failed)
    assert f'seed {seeds - 1}: a: ' in text
    assert 'counts twice' in text
    assert text.count('DIES') <= 2
    assert ' -> a/learner' in text


@given(st.sets(st.integers(0, 30), max_size=4), st.integers(5, 40))
def test_the_fewest_faults_are_found(needed: set[int], n: int) -> None:
    """All that a failure takes is kept, and nothing else."""
    needed = {one for one in needed if one < n}
    names = [f'kind{i % 3} {i}' for i in range(n)]
    wanted = {names[i] for i in needed}
    assert set(shrink(names, lambda some: wanted <= set(some))) == wanted


def test_a_soak_goes_on_where_it_ended(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a night's work would be lost with the machine."""
    state = tmp_path / 'soak.json'
    assert soak.main(['2', '--processes', '1', '--state', str(state)]) == 0
    assert json.loads(state.read_text()) == {'code': soak.digest_of_code(), 'first': 0, 'done': 2, 'failed': []}
    assert soak.main(['3', '--processes', '1', '--state', str(state)]) == 0
    assert '2 were played before by this code' in capsys.readouterr().out.splitlines()[-1]
    assert json.loads(state.read_text())['done'] == 3
    state.write_text(state.read_text().replace(soak.digest_of_code(), 'another code'))
    assert soak.main(['1', '--processes', '1', '--state', str(state)]) == 0
    assert '1 seeds in' in capsys.readouterr().out.splitlines()[-1]
