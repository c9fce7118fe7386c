"""The examples of the page on Python must run as they stand: they are the first thing that people copy."""

from __future__ import annotations

import re

import numpy as np

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


def test_own_data_snippet_compares_strategies(capsys) -> None:
    """Otherwise nobody could try strategies on a table of theirs."""
    exec(SNIPPETS[4], {})
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [name for name, _ in rows] == ['value_per_cost', 'random_fsq']
    assert all(0.5 < float(accuracy) <= 1 for _, accuracy in rows)
