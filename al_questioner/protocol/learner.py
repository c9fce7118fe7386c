"""Machine of the learner, between the robot's perception and its teachers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import (
    NO_SYMBOL,
    Answer,
    AnswerError,
    Content,
    Decision,
    EpisodeError,
    InputError,
    Query,
    Scene,
)
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import SceneObserved
from al_questioner.event_log.state_documents import episode_members, noise_text, state_members
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import stamp_members
from al_questioner.protocol.concepts_keeper import ConceptsKeeper
from al_questioner.protocol.effects import ClearTimer, Effects, End, Level, Publish, Refuse, Report, Say, SetTimer
from al_questioner.protocol.events import Event, Now
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.retransmitter import PATIENT, Retransmitter
from al_questioner.protocol.stale_scenes import StaleScenes
from al_questioner.protocol.topics import BeliefsShown, DecisionMade, Look
from al_questioner.protocol.turn_stamps import TurnStamps
from al_questioner.questioning import Receipt, read_plain_answer, respelt
from al_questioner.questioning.answer_acknowledgement import acknowledgement
from al_questioner.questioning.semantics import SEMANTICS

SECONDS_OF_A_RIVAL = 60.0
"""Seconds for which a node warns of another learner after it was heard."""
SECONDS_FOR_ANSWER = 60.0
"""Seconds without an answer after which the node warns."""
SECONDS_FOR_OBJECTS = 10.0
"""Seconds without a scene after which the node warns."""
LONGEST_BACK_OFF = 8
"""Times the answer timeout: for so long the learner waits at most before the turn goes on without an answer."""
NEXT_TURN, ANSWER_TIMEOUT = 'next turn', 'answer timeout'
"""Timers: when the next turn begins, and when a turn goes on without its answer."""


@dataclass(frozen=True)
class LearnerOptions:
    """Options of a learner, apart from what it asks.

    Attributes:
        turn_period: least seconds from turn to turn.
        answer_timeout: seconds after which a turn goes on without its answer; 0 for never.
        yields: whether the process ends when the episode is over and another learner begins one on the same topics.
        concepts_files: files to which what is known is written.
        notes: what people are told of the concepts that the episode begins with: what is known, and what is doubtful.
        origin: where a session that goes on comes from, for the log of the node.
    """

    turn_period: float = 0.0
    answer_timeout: float = 0.0
    yields: bool = False
    concepts_files: Sequence[Path] = ()
    notes: tuple[str, str] = ('', '')
    origin: str = ''


class LearnerMachine(Machine):
    """Asks for a scene, decides, asks the teacher, learns, and goes on to the next turn.

    Args:
        durable: the episode, not yet started.
        world: the simulated world, as documents have it; None for another one.
        options: how it behaves.
    """

    publishes = ('episode', 'turn', 'query', 'learner_state', 'answer_ack', 'decision', 'scene_markers', 'concepts')

    def __init__(self, durable: DurableEpisode, world: Document | None, options: LearnerOptions) -> None:
        super().__init__(durable.started.episode_id)
        self._durable = durable
        self._world = world
        self._options = options
        self._symbols = durable.started.settings.symbols
        self._is_over = self._has_failed = False
        self._rival_at = -math.inf
        self._keeper = ConceptsKeeper(options.concepts_files)
        self._stamps = TurnStamps()
        self._stale = StaleScenes()
        self._awaits_scene = False
        self._last_turn_start = 0.0
        self._view_noise = noise_text({})
        self._implausible: dict[str, str] = {}
        # What the course of the episode hangs on is said until it is served, the last state for as long as it is true.
        self._request = Retransmitter(self, 'turn', PATIENT)
        self._question = Retransmitter(self, 'query', PATIENT)
        self._state = Retransmitter(self, 'learner_state', PATIENT)
        self.on('objects', self._perceive)
        self.on('answer', self._hear)
        self.on_document('turn', self._hear_turn)
        self.on_timer(NEXT_TURN, self._begin_turn)
        self.on_timer(ANSWER_TIMEOUT, self._go_on_without)

    @property
    def is_ready(self) -> bool:
        """True once it takes answers."""
        return self._durable.is_ready

    @property
    def has_failed(self) -> bool:
        """True once its episode cannot go on."""
        return self._has_failed

    def handle(self, event: Event, now: Now) -> Effects:
        """See `Machine.handle`; an episode that cannot go on asks for nothing.

        Raises:
            EpisodeError: the episode cannot go on.
        """
        try:
            yield from super().handle(event, now)
        except EpisodeError:
            self._has_failed = True
            yield from self._request.stop()
            yield from self._question.stop()
            yield ClearTimer(ANSWER_TIMEOUT)
            raise

    def start(self) -> Effects:
        """Begin the first turn, or go on where the session ended."""
        yield Report('going through what the session holds')
        self._durable.start()
        observed, decision = self._durable.observed, self._durable.decision
        if observed is None or decision is None:
            known, doubtful = self._options.notes
            if known:
                yield Say(known)
            if doubtful:
                yield Say(doubtful, Level.WARNING)
            yield from self._begin_turn()
            yield from self._keep_concepts()
            return
        yield Say(f'going on with {self.episode_id}, in turn {observed.turn}, from {self._options.origin}')
        if self._durable.started.semantics != SEMANTICS:
            yield Say(
                'another version of the method began this session: its questions so far are taken as they were asked',
                Level.WARNING,
            )
        self._stamps = TurnStamps(self._durable.stamps)
        yield self._announcement(observed.scene)
        if not self._durable.episode.awaits_answer:
            yield from self._end_turn()
            return
        # Word for word as before: perception, if it is new too, shows what the question is about.
        yield self._request_of(observed.turn, observed.stamp)
        yield from self._put(observed, decision)
        yield self._shown(observed, self._beliefs())
        yield from self._keep_concepts()

    def _keep_concepts(self) -> Effects:
        """Publish and write what is known, if it has changed."""
        episode = self._durable.episode
        if episode.concepts.feature_names:
            version = (
                episode.concepts.model_version,
                len(episode.records),
                episode.answers.last,
                len(episode.answers.late),
            )
            yield from self._keeper.keep(version, self._durable.knowledge)

    def _begin_turn(self) -> Effects:
        """Ask perception for the scene of the next turn."""
        if self._has_failed:
            return
        stamp = self._stamps.begin(self.now.clock)
        self._last_turn_start = self.now.steady
        self._awaits_scene = True
        self._stale.begin_turn(self.now.steady)
        yield from self._state.stop()
        turn = self._durable.episode.turn + 1
        yield Report(f'turn {turn}: waiting for objects', SECONDS_FOR_OBJECTS, awaited='objects')
        yield from self._request.send(self._request_of(turn, stamp))

    def _request_of(self, turn: int, stamp: int) -> Publish:
        return self.document('turn', {'turn': turn, 'stamp': stamp_members(stamp), 'world': self._world})

    def _perceive(self, look: Look) -> Effects:
        """Decide, once the scene of this turn is there: see `TurnStamps`."""
        if not self._awaits_scene or self._has_failed:
            return
        if not self._stamps.is_of_turn(look.stamp, self.now.clock):
            self._stale.pass_over(look.stamp, self._stamps.last, self.now)
            return
        scene = look.read(self._durable.episode.concepts.feature_names)
        observed = SceneObserved(self._durable.episode.turn + 1, self._stamps.last, look.frame_id, scene)
        decision = self._durable.ask(observed)
        yield from self._tell_of_sensors(scene)
        self._awaits_scene = False
        yield from self._request.stop()
        if decision.turn == 1:
            yield self._announcement(scene)
        yield from self._put(observed, decision)
        if self._durable.episode.awaits_answer:
            yield self._shown(observed, self._beliefs())
        else:
            yield from self._end_turn()

    def _tell_of_sensors(self, scene: Scene) -> Effects:
        """Take note of the noise for /diagnostics, and say once of each feature what it read that cannot be."""
        episode = self._durable.episode
        self._view_noise = noise_text(episode.view_noise)
        for object_id, feature, value in episode.concepts.implausible_readings(scene):
            if feature not in self._implausible:
                self._implausible[feature] = f'{value:g} of object {object_id}'
                yield Say(
                    f'{feature} of object {object_id} reads {value:g}, far from all else it ever read: it is not'
                    ' counted',
                    Level.WARNING,
                )

    def measurements(self) -> Mapping[str, str]:
        """Return what is known of the sensors."""
        implausible = {f'implausible {feature}': what for feature, what in dict(self._implausible).items()}
        return {'view noise': self._view_noise, **implausible}

    def _put(self, observed: SceneObserved, decision: Decision) -> Effects:
        """Publish a decision, and the question that waits, again if nobody answered it in the turn before."""
        pending = self._durable.episode.pending
        if pending is not None:
            members = {**documents.query_members(pending), 'world': self._world}
            yield from self._question.send(self.document('query', members))
            yield Say(f'turn {decision.turn}: {pending.text}')
            yield from self._await_answer(pending, decision.turn)
        made = DecisionMade(decision, self._symbols, observed.scene, observed.stamp, observed.frame_id)
        yield Publish('decision', made)

    def _await_answer(self, query: Query, turn: int) -> Effects:
        """Wait for the answer, but not for ever if so configured, and the longer the longer nobody has answered."""
        timeout, missed = self._options.answer_timeout, self._durable.episode.unanswered_turns
        # Once a turn has passed without an answer, that is the concern.
        patience = math.inf if missed else SECONDS_FOR_ANSWER
        yield Report(f'turn {turn}: waiting for the answer to {query.query_id}', expected_within=patience)
        if timeout:
            yield SetTimer(ANSWER_TIMEOUT, timeout * min(2**missed, LONGEST_BACK_OFF))

    def _go_on_without(self) -> Effects:
        """Let the turn pass without its answer."""
        query = self._durable.episode.awaited
        if query is not None:
            yield Say(f'turn {self._durable.episode.turn}: going on without the answer to {query.query_id}')
            self._durable.time_out()
            yield from self._end_turn()

    def _announcement(self, scene: Scene) -> Publish:
        """Return what the episode is about, as soon as the features are known."""
        members = episode_members(self._durable.started, scene.feature_names, self._durable.episode.tuned_turns)
        return self.document('episode', members)

    def _hear(self, text: str) -> Effects:
        """Take an answer, or the correction of one, and say whether it was taken: not before it is on the disk."""
        if not self._durable.is_ready:
            return
        answer, episode = None, self._durable.episode
        waited = episode.awaits_answer
        try:
            answer = self._read_answer(text)
            taken = self._durable.take(answer)
        except InputError as error:
            self._durable.note_rejected(text, str(error), self.now.steady)
            yield self._receipt_of(answer, None, str(error))
            raise
        yield self._receipt_of(answer, taken.receipt, taken.reason)
        if taken.receipt is Receipt.LATE:
            yield Refuse('answer', taken.reason)
            # It is kept all the same, for how far its teacher can be relied on.
            yield from self._tell_state()
        if taken.receipt is not Receipt.ACCEPTED:
            return
        told = _spoken(answer.outcome.value if answer.content is None else answer.content)
        now = '' if answer.replaces is None else 'now '
        yield Say(f'{answer.query_id}: {answer.teacher_id} {now}says {told}')
        if waited and not episode.awaits_answer:
            yield from self._end_turn()
        else:
            yield from self._tell_state()

    def _receipt_of(self, answer: Answer | None, receipt: Receipt | None, reason: str) -> Publish:
        return self.document('answer_ack', acknowledgement(answer, receipt, reason))

    def _read_answer(self, content: str) -> Answer:
        if content.lstrip().startswith('{'):
            document = documents.read('answer', content)
            if document['episode_id'] != self.episode_id:
                raise AnswerError(f'the answer belongs to episode {document["episode_id"]}, this is {self.episode_id}')
            known = (*self._symbols, *self._durable.episode.concepts.groups)
            return respelt(documents.answer_of(document), known)
        if self._durable.episode.pending is None:
            raise AnswerError('no query is pending')
        return read_plain_answer(content, self._durable.episode.pending)

    def _end_turn(self) -> Effects:
        """Tell what is known now, and begin the next turn unless this was the last."""
        yield from self._question.stop()
        yield ClearTimer(ANSWER_TIMEOUT)
        episode = self._durable.episode
        if episode.done:
            yield from self._tell_state()
            self._is_over = True
            yield Report('the episode is over')
            yield Say(
                f'the episode is over: {episode.spent:g} of {self._durable.started.settings.budget:g} spent;'
                ' corrections are still taken; start a learner again for another episode'
            )
            yield from self._keep_concepts()
            return
        observed = self._durable.observed
        if observed is None:
            return
        beliefs = self._beliefs()
        yield from self._state.send(self._state_of(beliefs))
        pause = self._options.turn_period - (self.now.steady - self._last_turn_start)
        if pause > 0:
            yield SetTimer(NEXT_TURN, pause)
        else:
            yield from self._begin_turn()
        # Only now, while perception looks: markers take longer to write than all documents together.
        yield self._shown(observed, beliefs)
        yield from self._keep_concepts()

    def _tell_state(self) -> Effects:
        """Publish what is known now, outside of the course of the turns."""
        observed = self._durable.observed
        # A scene that could not be written is known to this process alone: a learner that goes on has not seen it.
        if observed is not None and not self._has_failed:
            beliefs = self._beliefs()
            yield self._shown(observed, beliefs)
            yield from self._state.send(self._state_of(beliefs))
            yield from self._keep_concepts()

    def _state_of(self, beliefs: NDArray[np.float64]) -> Publish:
        return self.document('learner_state', state_members(self._durable.episode, beliefs))

    def _beliefs(self) -> NDArray[np.float64]:
        """Return (n, |Y|) q_y(x) of the present scene."""
        episode = self._durable.episode
        return episode.concepts.predict_proba(episode.scene.features)

    def _shown(self, observed: SceneObserved, beliefs: NDArray[np.float64]) -> Publish:
        """Return the scene, the beliefs and the pending query for people who watch."""
        pending = self._durable.episode.pending
        asked, question = (pending.action.object_id, pending.text) if pending else (None, '')
        shown = BeliefsShown(observed.scene, beliefs, self._symbols, asked, question, observed.stamp, observed.frame_id)
        return Publish('scene_markers', shown)

    def warning(self, now: Now) -> str:
        """Warn of another learner on the same topics, of nobody who answers, and of files that lag behind."""
        warnings = []
        if now.steady <= self._rival_at + SECONDS_OF_A_RIVAL:
            warnings.append(
                'another learner publishes turn, too: end one of the two, or give it a namespace of its own'
            )
        missed = self._durable.episode.unanswered_turns if self._durable.is_ready else 0
        if missed:
            warnings.append(f'nobody has answered for {missed} turn{"" if missed == 1 else "s"}')
        if self._keeper.warning:
            warnings.append(self._keeper.warning)
        return '; '.join(warnings)

    def _hear_turn(self, document: Document) -> Effects:
        """Notice another learner on the same topics; make room for it if this episode is over."""
        if document['episode_id'] == self.episode_id:
            return
        if not self._is_over:
            self._rival_at = self.now.steady
        elif self._options.yields:
            yield Say(f'this episode is over, and {document["episode_id"]} begins: ending')
            yield End()

    def close(self) -> None:
        """Close the log."""
        self._durable.close()


def _spoken(content: Content) -> str:
    return (', '.join(map(str, content)) or NO_SYMBOL) if isinstance(content, tuple) else str(content)
