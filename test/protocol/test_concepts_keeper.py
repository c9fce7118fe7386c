"""Knowledge is told whenever it has changed, and once."""

from __future__ import annotations

from pathlib import Path

import pytest
from al_questioner.ros.concepts_keeper import ConceptsKeeper

from al_questioner.domain import Classifiers, Knowledge
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.messages.concepts_text import concepts_text

KNOWLEDGE = Knowledge(('snack', 'fruit'), ('colour_red',), Classifiers())


def test_each_change_is_told_once(tmp_path: Path) -> None:
    """A learner whose state is published often would write all that it knows each time."""
    asked: list[int] = []
    published: list[str] = []
    keeper = ConceptsKeeper([tmp_path / 'concepts.json'], published.append, pytest.fail)

    def knowledge() -> Knowledge:
        asked.append(1)
        return KNOWLEDGE

    for version in (1, 1, 2, 2, 1):
        keeper.keep((version,), knowledge)
    assert len(asked) == len(published) == 3
    assert read_concepts(tmp_path / 'concepts.json') == KNOWLEDGE


def test_a_file_that_cannot_be_written_is_no_reason_to_be_silent(tmp_path: Path) -> None:
    """A full disk would stop the recogniser, too, and the other file."""
    (tmp_path / 'file').write_text('', encoding='utf-8')
    published: list[str] = []
    complaints: list[str] = []
    paths = [tmp_path / 'file' / 'concepts.json', tmp_path / 'other.json']
    ConceptsKeeper(paths, published.append, complaints.append).keep((1,), lambda: KNOWLEDGE)
    assert published == [concepts_text(KNOWLEDGE)]
    assert read_concepts(paths[1]) == KNOWLEDGE
    assert len(complaints) == 1
    assert str(paths[0].parent) in complaints[0]
