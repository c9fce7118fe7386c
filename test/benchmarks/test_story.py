"""The story of three days: taught, killed, put to use by new processes, taught more, and put together."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from al_questioner.concepts.merging import joined_knowledge, settled
from al_questioner.concepts.recognition import recognise
from al_questioner.domain import NO_SYMBOL, Knowledge
from al_questioner.event_log.log import read_log
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.questioning.review import taught_learner
from al_questioner.simulation import PerceivedWorld, WorldSpec, load_task
from shared.checkout import ROOT

pytest.importorskip('rclpy')

SCRIPT = ROOT / 'benchmarks' / 'story.py'
TASK = load_task('kitchen_table')


def check_that_nothing_was_lost(folder: Path) -> None:
    """Check that all answers that were acknowledged before the kill are in the log, and in both files."""
    contents = read_log(folder / 'monday')
    assert contents.damage is None
    session = summarise_session(folder / 'monday', contents)
    monday = read_concepts(folder / 'monday.json')
    assert monday == session.knowledge
    assert {query.query_id for query in session.queries.values()} == {f'q{n}' for n in range(1, 22)}
    for known in (monday, read_concepts(folder / 'monday' / 'concepts.json')):
        assert known.teachers['anna'].answered == 20
        assert known.examples == monday.examples


def check_beliefs(told: dict[str, Any], folder: Path) -> None:
    """Check that what was published follows from the files, to the last bit."""
    worlds = {sample: PerceivedWorld(WorldSpec(TASK, sample, sample).open()) for sample in (0, 1)}
    learners = {
        name: taught_learner(read_concepts(folder / name)) for name in told['examples'] if name != 'robot_2.json'
    }
    assert len(told['documents']) == 5
    for name, sample, number, document in told['documents']:
        scene, _ = worlds[sample].new_table(number)
        assert [each['object_id'] for each in document['things']] == list(scene.object_ids)
        published = [list(each['probabilities'].values()) for each in document['things']]
        assert published == recognise(learners[name], scene.features).tolist()


def check_wishes(told: dict[str, Any]) -> None:
    """Check that the most probable thing is told, and that the new symbol can be asked for once it was taught."""
    (_, snack), (_, unknown), (_, taught) = told['wishes']
    assert unknown['reason'] == "'main_dish' is nothing that was taught; known: snack, fruit, beverage"
    in_view = {name: document for name, _, number, document in told['documents'][:2] if number == 0}
    for name, found in (('monday.json', snack), ('tuesday.json', taught)):
        symbol, things = found['symbol'], in_view[name]['things']
        most = max(things, key=lambda each: each['probabilities'][symbol])
        assert (found['object_id'], found['position']) == (most['object_id'], most['position'])
        assert found['probability'] == most['probabilities'][symbol] >= in_view[name]['threshold']


def check_merging(told: dict[str, Any], folder: Path) -> None:
    """Check that what both files hold of Monday counts once, and that to merge the same again changes nothing."""
    counts = told['examples']
    assert counts['corrected.json'] == counts['monday.json'] - len(told['removed']) < counts['monday.json']
    assert counts['both.json'] == counts['tuesday.json'] + counts['robot_2.json'] - counts['corrected.json']
    both, tuesday = (read_concepts(folder / name) for name in ('both.json', 'tuesday.json'))
    again, contradictions = settled(joined_knowledge([('both', both), ('tuesday', tuesday)]), 'newest', {})
    assert contradictions == []
    assert labels(again) == labels(both)
    assert set(labels(tuesday)) <= set(labels(both))


def labels(known: Knowledge) -> list[tuple[tuple[float, ...], str]]:
    return [(known.views[label.view].features, label.label) for _, label in known.examples]


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_what_was_taught_is_put_to_use(tmp_path: Path) -> None:
    """Each part works, and a robot that is switched off, goes on, or hears of another one still knows nothing."""
    folder, out = tmp_path / 'story', tmp_path / 'told.json'
    command = [sys.executable, str(SCRIPT), '--folder', str(folder), '--tables', '1', '--json', str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=800, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    told = json.loads(out.read_text())
    check_that_nothing_was_lost(folder)
    check_beliefs(told, folder)
    check_wishes(told)
    check_merging(told, folder)
    by = {(name, sample): counts for name, sample, counts in told['recognised']}
    before, after = by['monday.json', 0], by['tuesday.json', 0]
    assert before['of_new_right'] == 0 < after['of_new_right']
    assert before['right'] < after['right']
    # The kinds of things of the other kitchen were taught to the other robot alone.
    assert by['tuesday.json', 1]['of_symbol_right'] < by['both.json', 1]['of_symbol_right']


def test_what_is_recognised_is_counted() -> None:
    """The page tells numbers that mean something else."""
    from story import Recognised, count_right

    truth = {1: 'snack', 2: NO_SYMBOL, 3: 'main_dish', 4: 'main_dish', 5: NO_SYMBOL}
    said = {1: 'snack', 2: NO_SYMBOL, 3: 'snack', 4: 'main_dish', 5: NO_SYMBOL}
    things = [{'object_id': thing, 'best': name, 'known': thing != 5} for thing, name in said.items()]
    counted = count_right({'things': things}, truth)
    assert counted == Recognised(things=5, right=3, wrong=1, of_symbol=3, of_symbol_right=2, of_new=2, of_new_right=1)
    assert counted.plus(counted).right == 6
