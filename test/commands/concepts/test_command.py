"""The executable that shows, merges, changes and exports what learners know."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest

from al_questioner.cli import main
from al_questioner.domain import Knowledge, random_stream
from al_questioner.messages.concepts_file import read_concepts, write_concepts
from al_questioner.questioning import Episode
from shared.toys import ToyWorld, make_settings, play


def taught(name: str, seed: int, **changes: Any) -> Knowledge:
    """Return what an episode in a world of toys taught."""
    episode = Episode(make_settings('farthest_fsq', 8.0, 10, **changes), random_stream(seed, 'learner'))
    play(episode, ToyWorld(seed))
    return episode.knowledge(name, {turn: turn * 10**9 for turn in range(1, 11)})


@pytest.fixture
def monday(tmp_path: Path) -> Path:
    path = tmp_path / 'monday.json'
    write_concepts(path, taught('monday', 1))
    return path


@pytest.fixture
def tuesday(tmp_path: Path) -> Path:
    path = tmp_path / 'tuesday.json'
    write_concepts(path, taught('tuesday', 2))
    return path


def relabelled(path: Path, out: Path, episode: str) -> Path:
    """Write a file of another episode, in which another teacher called the first example something else."""
    document = json.loads(path.read_text().replace('"monday"', f'"{episode}"').replace('toy', 'bob'))
    labels = [lesson['labels'][0] for lesson in document['lessons'] if 'labels' in lesson]
    labels[0]['label'] = 'fruit' if labels[0]['label'] != 'fruit' else 'snack'
    out.write_text(json.dumps(document))
    return out


def test_it_shows_what_is_known(monday: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nobody can tell what a file is about."""
    assert main(['concepts', str(monday), '--examples']) == 0
    shown, known = capsys.readouterr().out, read_concepts(monday)
    for word in ('snack', 'none of these', 'toy', 'monday', 'farthest_fsq', 'colour, size relevant'):
        assert word in shown
    assert shown.count('1970-01-01T00:00:0') >= len(known.examples)


def test_it_tells_that_a_change_is_not_kept(monday: Path, tuesday: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A person takes what is shown for what is in the file."""
    nothing, before = 'nothing is written: --out FILE keeps this', monday.read_bytes()
    for arguments, is_told in (([], False), (['--add', 'tool'], True), ([str(tuesday)], True)):
        assert main(['concepts', str(monday), *arguments]) == 0
        assert (nothing in capsys.readouterr().out) is is_told
    assert main(['concepts', str(monday), '--add', 'tool', '--out', str(tuesday)]) == 0
    assert nothing not in capsys.readouterr().out
    assert monday.read_bytes() == before


def test_it_tells_which_labels_were_carried(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A person looks for who said it of this view, and nobody did."""
    path, table = tmp_path / 'c.json', tmp_path / 'c.csv'
    episode = Episode(make_settings('u_sampling', 3.0, 3, carry_labels=True), random_stream(1, 'learner'), 1e-3)
    world = ToyWorld(1)
    first = world.scene(1)
    looks = [dataclasses.replace(first, features=first.features * scale) for scale in (1, -2)]
    for look in looks:
        query = episode.ask(look).query
        assert query is not None
        episode.tell(world.answer(query))
    write_concepts(path, episode.knowledge('monday'))
    assert main(['concepts', str(path), '--examples', '--csv', str(table)]) == 0
    shown, known = capsys.readouterr().out, read_concepts(path)
    carried = [label.carried_from for _, label in known.examples if label.carried_from is not None]
    assert carried
    assert all(f'carried from {view}' in shown for view in carried)
    rows = list(csv.DictReader(table.open()))
    assert [row['kind'] for row in rows].count('carried') == len(carried)
    assert {row['teacher'] for row in rows} == {'toy'}


def test_two_days_are_merged(monday: Path, tuesday: Path, tmp_path: Path) -> None:
    """Two days of teaching stay in two files."""
    out = tmp_path / 'both.json'
    assert main(['concepts', str(monday), str(tuesday), '--out', str(out)]) == 0
    found, first, second = map(read_concepts, (out, monday, tuesday))
    assert len(found.examples) == len(first.examples) + len(second.examples)
    assert found.teachers['toy'].answered == first.teachers['toy'].answered + second.teachers['toy'].answered
    assert found.statistics is not None
    assert found.statistics.count == len(found.views)
    # A file may be replaced by what it becomes.
    assert main(['concepts', str(out), str(monday), '--out', str(out)]) == 0
    assert read_concepts(out) == found


def test_a_file_adds_nothing_to_the_one_that_went_on_from_it(monday: Path, tmp_path: Path) -> None:
    """The first day counts twice, or its views get lost."""
    later, out = tmp_path / 'later.json', tmp_path / 'out.json'
    write_concepts(later, taught('later', 2, concepts=read_concepts(monday)))
    for files in ((monday, later), (later, monday)):
        assert main(['concepts', *map(str, files), '--out', str(out)]) == 0
        assert out.read_text() == later.read_text()


@pytest.mark.parametrize('settlement', ['newest', 'reliable'])
def test_contradictions_are_settled_as_asked(
    monday: Path, tmp_path: Path, settlement: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two teachers who disagree are mixed unseen."""
    other, out = relabelled(monday, tmp_path / 'other.json', 'other'), tmp_path / 'out.json'
    both = ['concepts', str(monday), str(other)]
    assert main(both) == 0
    assert 'was called' in capsys.readouterr().out
    assert main([*both, '--out', str(out)]) == 2
    assert '1 view was called several things, first: view' in capsys.readouterr().err
    assert not out.exists()
    assert main([*both, '--settle', settlement, '--out', str(out)]) == 0
    assert 'is kept' in capsys.readouterr().out
    assert len(read_concepts(out).examples) == len(read_concepts(monday).examples)


def test_changes_are_made_in_their_order(monday: Path, tmp_path: Path) -> None:
    """Somebody edits JSON by hand."""
    out, before = tmp_path / 'out.json', read_concepts(monday)
    view = before.examples[0][1].view
    changes = ['--remove', str(view), '--rename', 'snack=nibble', '--drop', 'fruit', '--add', 'tool']
    assert main(['concepts', str(monday), *changes, '--out', str(out)]) == 0
    found = read_concepts(out)
    assert found.symbols == ('main_dish', 'nibble', 'tool')
    assert [label.view for _, label in found.examples] == [label.view for _, label in before.examples[1:]]
    assert found.statistics is not None


def test_examples_become_a_table(monday: Path, tmp_path: Path) -> None:
    """The examples cannot be used elsewhere."""
    table = tmp_path / 'examples.csv'
    assert main(['concepts', str(monday), '--csv', str(table)]) == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    known = read_concepts(monday)
    assert [row['label'] for row in rows] == [label.label for _, label in known.examples]
    lesson, label = known.examples[0]
    assert (rows[0]['teacher'], rows[0]['episode'], rows[0]['turn']) == ('toy', 'monday', str(lesson.turn))
    assert float(rows[0]['colour_red']) == pytest.approx(known.views[label.view].features[0], rel=1e-7)


def test_what_cannot_be_used_changes_nothing(monday: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A mistake destroys a file."""
    text = monday.read_text()
    newer, damaged, letter, other = (tmp_path / name for name in ('newer.json', 'damaged', 'letter.txt', 'other.json'))
    newer.write_text(text.replace('concepts/1', 'concepts/2'))
    damaged.write_text(text[: len(text) // 2])
    letter.write_text('Dear robot')
    other.write_text(text.replace('size_height', 'size_width'))
    for arguments, said in (
        ([str(newer), '--out', str(monday)], 'newer.json: of another version'),
        ([str(damaged), '--out', str(monday)], 'damaged: concepts: not valid JSON'),
        ([str(monday), str(other), '--out', str(monday)], 'other.json: the concepts are of other features'),
        ([str(monday), '--out', str(letter)], '--out would overwrite'),
        ([str(monday), '--remove', '999', '--out', str(monday)], 'view 999 is no example'),
        ([str(monday), '--remove', 'snak', '--out', str(monday)], "no example of 'snak'"),
        ([str(monday), '--csv', str(monday)], 'a concepts file'),
        ([str(monday), '--rename', 'snack', '--out', str(monday)], 'must be OLD=NEW'),
        ([str(monday), '--drop', 'snak', '--out', str(monday)], 'did you mean snack?'),
        ([str(monday), '--add', 'none', '--out', str(monday)], "'none' cannot be a symbol"),
        ([str(tmp_path / 'nothing')], 'nothing cannot be read'),
    ):
        assert main(['concepts', *arguments]) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count('\n') == 1
    assert (monday.read_text(), letter.read_text()) == (text, 'Dear robot')


def test_all_examples_of_a_label_are_removed(monday: Path, tmp_path: Path) -> None:
    """Somebody who teaches a new word would have to remember which of sixty things it is about."""
    before, out = read_concepts(monday), tmp_path / 'out.json'
    assert main(['concepts', str(monday), '--remove', 'snack', '--out', str(out)]) == 0
    after = read_concepts(out)
    assert before.counts['snack'] > 0
    assert after.counts == {**before.counts, 'snack': 0}
    assert len(after.views) == len(before.views)
