"""The examples of the page on Python must run as they stand: they are the first thing that people copy."""

from __future__ import annotations

import re

import numpy as np

from al_questioner.domain import DEFAULT_CLASSIFIERS, Knowledge, Lesson, Origin, Scene, SeenView, ViewLabel
from al_questioner.messages.concepts_file import write_concepts
from shared.checkout import ROOT

PAGE = (ROOT / 'docs' / 'how_to' / 'use_it_in_python.md').read_text(encoding='utf-8')
SNIPPETS = re.findall(r'```python\n(.*?)```', PAGE, flags=re.DOTALL)


def test_concept_models_snippet_runs() -> None:
    """Otherwise the classifiers' contract would be misquoted."""
    rng = np.random.default_rng(1)
    given = {'features': rng.normal(size=(6, 3)), 'labels': ['snack', 'fruit', 'none'] * 2}
    scene = rng.normal(size=(5, 3))
    exec(SNIPPETS[0], {**given, 'scene': scene})


def test_episode_snippets_ask_learn_recognise_and_go_on(capsys, tmp_path, monkeypatch) -> None:
    """Otherwise the loop that people build on would not run."""
    known: dict[str, object] = {}
    exec(SNIPPETS[1], known)
    asked = capsys.readouterr().out.splitlines()
    assert len(asked) == len(set(asked)) == 5
    assert all(line.endswith('?') for line in asked)
    exec(SNIPPETS[2], known)
    recognised = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert len(recognised) == 3
    assert all(name in ('cup', 'plate', 'none') and 0 <= float(p) <= 1 for name, p in recognised)
    monkeypatch.chdir(tmp_path)
    before = known['episode']
    exec(SNIPPETS[3], known)
    things = known['things']
    np.testing.assert_array_equal(
        known['episode'].concepts.predict_proba(things), before.concepts.predict_proba(things)
    )


def test_own_data_snippets_compare_strategies_and_classify(capsys, tmp_path, monkeypatch) -> None:
    """Otherwise nobody could try strategies on a table of theirs."""
    monkeypatch.chdir(tmp_path)
    known: dict[str, object] = {}
    exec(SNIPPETS[4], known)
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert {'value_per_cost', 'random_fsq'} <= {line[0] for line in lines if line}
    assert lines[-1][0] == 'value_per_cost'
    assert all(path.is_file() for path in known['paths'])
    exec(SNIPPETS[5], known)
    assert 0.5 < float(capsys.readouterr().out.splitlines()[-1]) <= 1


def test_the_tutorial_on_own_data_runs(capsys, tmp_path, monkeypatch) -> None:
    """Its figures took long, so here it has a split or two; what it prints must still be of the same form."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / 'docs' / 'tutorial' / 'own_data.md').read_text(encoding='utf-8')
    blocks = re.findall(r'```python\n(.*?)```\n\n```\n(.*?)```', text, flags=re.DOTALL)
    assert len(blocks) == 4
    known: dict[str, object] = {}
    for code, shown in blocks:
        quick = code.replace('repeats=40', 'repeats=1').replace('ShuffleSplit(40', 'ShuffleSplit(2')
        exec(quick, known)
        printed = [line.split() for line in capsys.readouterr().out.splitlines()]
        expected = [line.split() for line in shown.splitlines()]
        assert len(printed) == len(expected)
        assert [line[:1] for line in printed[2:]] == [line[:1] for line in expected[2:]]
    assert (tmp_path / 'out' / 'digits' / 'learning_curves_digits.png').is_file()


def test_the_snippet_that_puts_to_use_what_was_taught_runs(capsys, tmp_path, monkeypatch) -> None:
    """Otherwise those without ROS could not ask for anything."""
    monkeypatch.chdir(tmp_path)
    names, rng = ('colour_red', 'size_height'), np.random.default_rng(1)
    views = tuple(SeenView(n, n, tuple(rng.normal(size=2).astype(np.float32).tolist())) for n in (1, 2))
    labels = (ViewLabel(1, 'snack'), ViewLabel(2, 'fruit'))
    lesson = Lesson('day', 1, seen=views, labels=labels)
    origins = (Origin('day', ('snack', 'fruit')),)
    known = Knowledge(('snack', 'fruit'), names, DEFAULT_CLASSIFIERS, lessons=(lesson,), origins=origins)
    write_concepts(tmp_path / 'monday.json', known)
    scene = Scene((7,), np.zeros((1, 3)), [views[0].features], names)
    page = (ROOT / 'docs' / 'how_to' / 'recognise_and_fetch.md').read_text(encoding='utf-8')
    [snippet] = re.findall(r'```python\n(.*?)```', page, flags=re.DOTALL)
    exec(snippet, {'scene': scene})
    assert 'object 7' in capsys.readouterr().out.lower()
