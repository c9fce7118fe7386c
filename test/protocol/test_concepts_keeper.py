"""Knowledge is told whenever it has changed, and once."""

from __future__ import annotations

from pathlib import Path

from al_questioner.domain import Classifiers, Knowledge
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.protocol.concepts_keeper import ConceptsKeeper
from al_questioner.protocol.effects import Effect, Level, Publish, Say, WriteFile
from al_questioner.protocol.machine import Machine
from al_questioner.support.files import write_text
from shared.machine_driver import Driver

KNOWLEDGE = Knowledge(('snack', 'fruit'), ('colour_red',), Classifiers())


def write(effect: Effect) -> None:
    """Write the files."""
    if isinstance(effect, WriteFile):
        write_text(effect.path, effect.text)


def test_each_change_is_told_once(tmp_path: Path) -> None:
    """A learner whose state is published often would write all that it knows each time."""
    asked: list[int] = []
    keeper, driver = ConceptsKeeper([tmp_path / 'concepts.json']), Driver(Machine(), write)

    def knowledge() -> Knowledge:
        asked.append(1)
        return KNOWLEDGE

    for version in (1, 1, 2, 2, 1):
        driver.perform(keeper.keep((version,), knowledge))
    assert len(asked) == len(driver.effects(Publish)) == len(driver.effects(WriteFile)) == 3
    assert read_concepts(tmp_path / 'concepts.json') == KNOWLEDGE


def test_a_file_that_cannot_be_written_is_no_reason_to_be_silent(tmp_path: Path) -> None:
    """A full disk would stop the recogniser, too, and the other file."""
    (tmp_path / 'file').write_text('', encoding='utf-8')
    paths = [tmp_path / 'file' / 'concepts.json', tmp_path / 'other.json']
    keeper, driver = ConceptsKeeper(paths), Driver(Machine(), write)
    driver.perform(keeper.keep((1,), lambda: KNOWLEDGE))
    assert driver.effects(Publish) == [Publish('concepts', concepts_text(KNOWLEDGE))]
    assert read_concepts(paths[1]) == KNOWLEDGE
    (complaint,) = driver.effects(Say)
    assert complaint.level is Level.ERROR
    assert str(paths[0].parent) in complaint.text
    assert keeper.warning == complaint.text


def test_what_could_not_be_written_is_warned_of_until_it_is(tmp_path: Path) -> None:
    """Otherwise a file that lags behind would be named once in the log, and never again."""
    folder = tmp_path / 'file'
    folder.write_text('', encoding='utf-8')
    keeper, driver = ConceptsKeeper([folder / 'one.json', folder / 'two.json']), Driver(Machine(), write)
    assert keeper.warning == ''
    for version in (1, 1, 2):
        driver.perform(keeper.keep((version,), lambda: KNOWLEDGE))
        assert keeper.warning == '; '.join(said.text for said in driver.effects(Say)[-2:])
    folder.unlink()
    folder.mkdir()
    driver.perform(keeper.keep((2,), lambda: KNOWLEDGE))
    assert keeper.warning != ''
    driver.perform(keeper.keep((3,), lambda: KNOWLEDGE))
    assert keeper.warning == ''
