"""A machine that recognises what a learner was taught, and finds what somebody wants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from al_questioner.concepts.recognition import recognise
from al_questioner.domain import THRESHOLD, Knowledge, Scene, SceneError
from al_questioner.messages import documents
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.effects import Level, Publish, Report, Say
from al_questioner.protocol.recogniser import Known, RecogniserMachine
from al_questioner.protocol.topics import Look, Place
from al_questioner.questioning.review import taught_learner
from al_questioner.simulation import episode_settings
from shared.lunches import TASK, taught
from shared.machine_driver import Driver

LUNCH = taught()
NOTHING = replace(LUNCH.knowledge, lessons=(replace(LUNCH.knowledge.lessons[0], labels=(), groups=()),))


class Robot(Driver):
    """Somebody who shows things to a recogniser, and wants some of them."""

    def shows(self, scene: Scene, second: int) -> None:
        """Show things that a camera saw."""
        self.hear('objects', Look(second * SECOND, 'camera', lambda _: scene))

    def wants(self, text: str) -> dict[str, Any]:
        """Say what is wanted, and hear the answer."""
        self.hear('want', text)
        return self.published('target_info')[-1]


def recogniser(
    known: Knowledge | None = LUNCH.knowledge, threshold: float = THRESHOLD.default, fault: str = ''
) -> Robot:
    robot = Robot(RecogniserMachine(threshold, None if known is None else Known(known, 'known.json', fault)))
    robot.start()
    return robot


def probabilities(document: dict[str, Any]) -> list[list[float]]:
    return [list(each['probabilities'].values()) for each in document['things']]


def test_what_is_recognised_is_told_in_every_form_and_to_programs_first() -> None:
    """Otherwise a robot would wait for the drawing of markers."""
    robot = recogniser()
    robot.shows(LUNCH.scene, 11)
    said = [effect.topic for effect in robot.effects(Publish)]
    assert said == ['recognised', 'recognition', 'detections', 'recognised_markers']
    (document,) = robot.published('recognition')
    assert probabilities(document) == recognise(taught_learner(LUNCH.knowledge), LUNCH.scene.features).tolist()
    assert (document['stamp']['sec'], document['frame_id'], document['episode_id']) == (11, 'camera', 'lunch')
    (shown,) = robot.published('recognised')
    assert (shown.stamp, shown.frame_id, len(shown.recognition.things)) == (11 * SECOND, 'camera', len(LUNCH.scene))
    assert robot.status == 'recognising'


def test_the_place_of_a_wanted_thing_is_told_before_the_reason() -> None:
    """Otherwise those who hear the answer would look for a place that is not there yet."""
    expected = recognise(taught_learner(LUNCH.knowledge), LUNCH.scene.features)[:, LUNCH.symbols.index('snack')]
    robot = recogniser(threshold=float(expected.max()))
    robot.shows(LUNCH.scene, 11)
    answer = robot.wants('the Snack')
    row = int(expected.argmax())
    assert (answer['symbol'], answer['object_id']) == ('snack', LUNCH.scene.object_ids[row])
    assert answer['runner_up']['probability'] == np.sort(expected)[-2]
    assert [effect.topic for effect in robot.effects(Publish)][-2:] == ['target', 'target_info']
    assert robot.published('target') == [Place(tuple(LUNCH.scene.positions[row].tolist()), 11 * SECOND, 'camera')]


def test_nothing_is_fetched_without_a_reason() -> None:
    """Otherwise a manipulation stack would wait for a target that never comes, or fetch another thing."""
    robot = recogniser(threshold=1.0)
    assert robot.wants('snack')['reason'] == 'no objects have been seen yet'
    assert robot.refusals == []
    assert 'did you mean snack?' in robot.wants('snak')['reason']
    ((topic, reason),) = robot.refusals
    assert topic == 'want'
    assert reason.startswith("'snak' is nothing that was taught")
    robot.shows(LUNCH.scene, 11)
    answer = robot.wants('snack')
    assert 'nothing in view is snack with a probability of 1 or more' in answer['reason']
    assert (answer['object_id'], answer['stamp']['sec'], answer['frame_id']) == (None, 11, 'camera')
    assert answer['runner_up']['object_id'] in LUNCH.scene.object_ids
    robot.shows(Scene((), np.empty((0, 3)), LUNCH.scene.features[:0], LUNCH.scene.feature_names), 12)
    assert robot.published('recognition')[-1]['things'] == []
    assert robot.wants('snack')['reason'] == 'there is nothing in view'
    assert robot.published('target') == []


def test_unusable_scenes_are_refused_and_the_next_one_is_recognised() -> None:
    """Otherwise one bad frame of a camera would end the node."""
    robot, scene = recogniser(), LUNCH.scene

    def unreadable(_: Sequence[str]) -> Scene:
        raise SceneError('a reading is not finite')

    robot.hear('objects', Look(SECOND, 'camera', unreadable))
    robot.shows(Scene(scene.object_ids, scene.positions, scene.features, ('weight_g', *scene.feature_names[1:])), 13)
    reason = f'the concepts are of other features: they lack weight_g and have {scene.feature_names[0]}'
    assert robot.refusals == [('objects', 'a reading is not finite'), ('objects', reason)]
    assert robot.wants('snack')['reason'] == reason
    assert robot.published('recognition') == []
    robot.shows(scene, 14)
    assert len(robot.published('recognition')[-1]['things']) == len(scene)
    assert robot.machine.counts()['clouds recognised'] == 1


def test_unusable_concepts_are_refused_and_the_next_ones_are_taken() -> None:
    """Otherwise garbage on a topic would cost the robot all that it knows."""
    robot = recogniser(None)
    assert robot.effects(Report) == [Report('waiting for what a learner knows', awaited='concepts')]
    robot.shows(LUNCH.scene, 11)
    robot.hear('concepts', '{')
    assert 'not valid JSON' in robot.refusals[-1][1]
    robot.hear('concepts', concepts_text(LUNCH.knowledge))
    # What was seen before is recognised as soon as it can be.
    (document,) = robot.published('recognition')
    assert (document['stamp']['sec'], document['examples']) == (11, len(LUNCH.knowledge.examples))
    robot.hear('concepts', concepts_text(LUNCH.knowledge).replace('concepts/1', 'concepts/7'))
    assert 'of another version (al_questioner/concepts/7)' in robot.refusals[-1][1]
    robot.shows(LUNCH.scene, 12)
    assert probabilities(robot.published('recognition')[-1]) == probabilities(document)


def test_the_names_go_with_the_learner_that_knew_them() -> None:
    """A learner that begins with nothing would stand beside things that are named, for all who come later."""
    robot = recogniser(None)
    robot.shows(LUNCH.scene, 11)
    robot.hear('concepts', concepts_text(LUNCH.knowledge))
    assert robot.published('recognition')[-1]['things']
    robot.hear('concepts', concepts_text(NOTHING))
    last = robot.published('recognition')[-1]
    assert (last['things'], last['examples'], last['stamp']['sec']) == ([], 0, 11)
    assert robot.published('recognised')[-1].recognition.things == ()
    assert robot.wants('snack')['reason'] == 'nothing has been taught yet'
    assert robot.refusals == []
    assert robot.status == 'nothing has been taught yet'
    robot.hear('concepts', concepts_text(LUNCH.knowledge))
    assert robot.published('recognition')[-1]['things']


def test_concepts_of_other_features_than_the_things_are_taken_all_the_same() -> None:
    """Otherwise the things of the right camera would not be recognised, because of another one's."""
    robot = recogniser(None)
    names = tuple(f'other_{i}' for i in range(len(LUNCH.scene.feature_names)))
    robot.shows(replace(LUNCH.scene, feature_names=names), 11)
    robot.hear('concepts', concepts_text(LUNCH.knowledge))
    ((topic, reason),) = robot.refusals
    assert topic == 'objects'
    assert reason.startswith('the concepts are of other features')
    robot.shows(LUNCH.scene, 12)
    assert robot.published('recognition')[-1]['stamp']['sec'] == 12


def test_knowledge_without_examples_is_no_error() -> None:
    """Otherwise a file that a learner wrote before its first answer would end the node."""
    robot = recogniser(Knowledge(TASK.symbols, ('size_height',), episode_settings(TASK).classifiers))
    assert robot.status == 'nothing has been taught yet'
    robot.shows(LUNCH.scene, 11)
    assert robot.published('recognition') == []


def test_a_damaged_log_is_told_of_and_put_to_use() -> None:
    """Otherwise nobody would know why the robot has forgotten its last lessons."""
    robot = recogniser(fault='line 9 is damaged')
    assert robot.effects(Say) == [
        Say('known.json: line 9 is damaged; what comes before it is taken', Level.WARNING),
    ]
    assert robot.effects(Report) == [
        Report('learning what known.json holds'),
        Report('waiting for objects', awaited='objects'),
    ]


def test_every_document_is_a_valid_one() -> None:
    """Otherwise programs that check what they read would refuse it."""
    robot = recogniser()
    robot.shows(LUNCH.scene, 11)
    robot.hear('want', 'snack')
    robot.hear('want', 'nothing of the kind')
    told = [each for each in robot.effects(Publish) if each.topic in ('recognition', 'target_info')]
    assert len(told) == 3
    for each in told:
        documents.read(each.topic, each.content)
