"""Machine of the recogniser: tells what the things in view are taken for, and where the wanted one is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from al_questioner.domain import InputError, Knowledge, Recognition, Scene
from al_questioner.messages.concepts_file import concepts_of_text
from al_questioner.messages.recognition import finding_members, recognition_members
from al_questioner.protocol.effects import Effects, Level, Publish, Refuse, Report, Say
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import Look, Place, RecognitionShown
from al_questioner.questioning import SceneRecogniser

NO_EPISODE = 'none'
"""The `episode_id` of documents as long as nothing is known that comes from an episode."""


class Seen(NamedTuple):
    """Newest scene that could be read, with the stamp in nanoseconds and the frame of its cloud."""

    stamp: int
    frame_id: str
    scene: Scene


class Known(NamedTuple):
    """Knowledge of a file or a session.

    Attributes:
        source: its path, as it was given.
        fault: what is wrong with the log of a session, and where; empty if nothing is.
    """

    knowledge: Knowledge
    source: str
    fault: str = ''


class RecogniserMachine(Machine):
    """Recognises the things of every cloud, and finds what somebody wants.

    Args:
        threshold: smallest probability with which a thing is named, 0 to 1.
        known: what is known for good; None if it listens to what a learner knows.

    Attributes:
        recogniser: what it knows, and what it sees.

    Raises:
        SettingsError: a threshold out of range.
    """

    publishes = ('recognised', 'recognised_markers', 'recognition', 'detections', 'target', 'target_info')

    def __init__(self, threshold: float, known: Known | None = None) -> None:
        super().__init__(NO_EPISODE)
        self.recogniser = SceneRecogniser(threshold)
        self._known = known
        self._seen: Seen | None = None
        self._clouds = 0
        if known is None:
            self.on('concepts', lambda text: self._learn(concepts_of_text(text)))
        self.on('objects', self._look)
        self.on('want', self._find)

    def start(self) -> Effects:
        """Learn what is known already, which for a large file takes seconds."""
        if self._known is None:
            yield Report('waiting for what a learner knows', awaited='concepts')
            return
        knowledge, source, fault = self._known
        if fault:
            yield Say(f'{source}: {fault}; what comes before it is taken', Level.WARNING)
        yield Report(f'learning what {source} holds')
        yield from self._learn(knowledge)

    def counts(self) -> Mapping[str, int]:
        """Return what it has recognised, and by how much."""
        recognition = self.recogniser.recognition
        told = (
            {} if recognition is None else {'things in view': len(recognition.things), 'examples': recognition.examples}
        )
        return {'clouds recognised': self._clouds, **told}

    def _learn(self, knowledge: Knowledge) -> Effects:
        """Learn what is known, and see the last things with other eyes."""
        self.episode_id = knowledge.origins[-1].episode if knowledge.origins else NO_EPISODE
        before = self.recogniser.recognition
        try:
            self.recogniser.follow(knowledge)
        finally:
            if self.recogniser.concepts is None:
                yield Report('nothing has been taught yet')
                if before is not None and self._seen is not None:
                    # Another learner has begun: what is latched are names that nobody knows any more.
                    yield from self._show(replace(before, examples=0, things=()), self._seen)
        if self.recogniser.concepts is None:
            return
        if self._seen is None:
            yield Report('waiting for objects', awaited='objects')
        else:
            try:
                yield from self._recognise(self._seen)
            except InputError as error:
                # The concepts are taken: it is the things that they are not of.
                yield Refuse('objects', str(error))

    def _look(self, look: Look) -> Effects:
        self._seen = Seen(look.stamp, look.frame_id, look.read(self.recogniser.feature_names))
        yield from self._recognise(self._seen)

    def _recognise(self, seen: Seen) -> Effects:
        """Recognise the things in view, and publish what they are taken for."""
        recognition = self.recogniser.look(seen.scene)
        if recognition is None:
            return
        yield from self._show(recognition, seen)
        self._clouds += 1
        yield Report('recognising')

    def _show(self, recognition: Recognition, seen: Seen) -> Effects:
        """Publish what things are taken for, in each of its forms."""
        shown = RecognitionShown(recognition, seen.stamp, seen.frame_id)
        # The forms for programs first: markers take longest to write.
        yield Publish('recognised', shown)
        yield self.document('recognition', recognition_members(recognition, seen.stamp, seen.frame_id))
        yield Publish('detections', shown)
        yield Publish('recognised_markers', shown)

    def _find(self, wish: str) -> Effects:
        """Publish where the most probable thing is of what is wanted, or why there is none."""
        finding, seen = self.recogniser.find(wish), self._seen
        where = () if seen is None else (seen.stamp, seen.frame_id)
        if finding.target is not None and seen is not None:
            yield Publish('target', Place(finding.target.position, seen.stamp, seen.frame_id))
        yield self.document('target_info', finding_members(finding, *where))
        if finding.symbol is None and self.recogniser.concepts is not None:
            raise InputError(finding.reason)
