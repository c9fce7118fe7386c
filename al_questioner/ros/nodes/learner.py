"""The learner node: an Episode between the topics of the robot and of the teacher."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from al_questioner.concepts import compile_models
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
from al_questioner.event_log.events import SceneObserved
from al_questioner.event_log.state_documents import episode_members, noise_text, state_members
from al_questioner.event_log.storage import SqliteStorage, StorageFactory
from al_questioner.messages import documents
from al_questioner.messages.clouds import cloud_of_decision, scene_of_cloud
from al_questioner.messages.documents import Document
from al_questioner.messages.markers import markers
from al_questioner.messages.stamps import nanoseconds, stamp_members
from al_questioner.questioning import Receipt, make_strategy, read_plain_answer, respelt
from al_questioner.questioning.answer_acknowledgement import acknowledgement
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.ros import qos
from al_questioner.ros.concepts_keeper import ConceptsKeeper
from al_questioner.ros.learner_episode import (
    concepts_files,
    durable_episode_of,
    known_concepts,
    notes_on_known,
    settings_of,
)
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.one_shot_timer import OneShotTimer
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.retransmitter import PATIENT, Retransmitter
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, CONCEPTS, learner_settings
from al_questioner.ros.stale_scenes import StaleScenes
from al_questioner.ros.turn_stamps import TurnStamps
from al_questioner.ros.types import CLOUD_TYPES, MARKER_TYPES, header, text
from al_questioner.ros.worlds import declare_world, world_members
from al_questioner.terminal.menu import make_picker

SECONDS_OF_A_RIVAL = 60.0
"""Seconds for which a node warns of another learner after it was heard."""
SECONDS_FOR_ANSWER = 60.0
"""Seconds without an answer after which the node warns."""
SECONDS_FOR_OBJECTS = 10.0
"""Seconds without a scene after which the node warns."""
LONGEST_BACK_OFF = 8
"""Times the answer timeout: for so long the learner waits at most before the turn goes on without an answer."""


class LearnerNode(QuestionerNode):
    """Asks for a scene, decides, asks the teacher, learns, and goes on to the next turn.

    Everything that touches the episode happens on the worker's thread, message by message.

    Args:
        yields: end the node's context when the episode is over and another learner begins one on the same topics.
        storage: writes the session, if there is one.
        node_arguments: of the node.
    """

    def __init__(self, yields: bool = False, storage: StorageFactory = SqliteStorage, **node_arguments: Any) -> None:
        super().__init__('learner', **node_arguments)
        self._yields = yields
        self._is_over = self._has_failed = False
        self._rival_at = -math.inf
        world = declare_world(self)
        file = declare(self, [CONCEPTS])
        known = known_concepts(file)
        others = [each for each in learner_settings(world.task, known) if each.name not in file]
        self._given = file | declare(self, others)
        self._settings = settings_of(world.task, self._given, known)
        # What cannot be used is to be said before anything is published, and before a log is begun.
        strategy = make_strategy(self._settings.strategy, self._settings.weights, make_picker())
        reject_unknown(self, ALL_NAMES)
        self._world = world_members(world)
        concepts = self.advertise(String, 'concepts', qos.LATCHED)
        self._keeper = ConceptsKeeper(
            concepts_files(self._given),
            lambda document: concepts.publish(text(document)),
            lambda reason: self.get_logger().error(reason),
        )
        self._durable = durable_episode_of(self._settings, strategy, world, self._given, storage)
        self.episode_id = self._durable.started.episode_id
        self._stamps = TurnStamps()
        self._patience = OneShotTimer(self.after, self._go_on_without)
        self._stale = StaleScenes()
        self._awaits_scene = False
        self._last_turn_start = 0.0
        self._view_noise = noise_text({})
        self._implausible: dict[str, str] = {}

        self._publish_episode = self.document_publisher('episode')
        self._publish_turn = self.document_publisher('turn')
        # What the course of the episode hangs on is said until it is served, the last state for as long as it is true.
        self._request = Retransmitter(self.after, self._publish_turn, PATIENT)
        self._question = Retransmitter(self.after, self.document_publisher('query'), PATIENT)
        self._state = Retransmitter(self.after, self.document_publisher('learner_state'), PATIENT)
        self._publish_ack = self.document_publisher('answer_ack', qos.EVENTS)
        self._decision = self.advertise(PointCloud2, 'decision', qos.EVENTS)
        self._markers = self.advertise(MarkerArray, 'scene_markers', qos.LATCHED)
        self.on_message(PointCloud2, 'objects', self._perceive, qos.LATCHED)
        self.on_message(String, 'answer', self._hear, qos.EVENTS)
        self.on_document('turn', self._hear_turn)
        self.set_status('preparing the models; where they have to be compiled first, that takes some ten seconds')
        self.submit(compile_models)
        if self._given['wait_for_recorder']:
            self.await_recorder('episode', 'turn', 'query', 'answer_ack', 'decision', 'learner_state')
        self.submit(self._start)

    def _start(self) -> None:
        """Begin the first turn, or go on where the session ended."""
        self.set_status('going through what the session holds')
        self._durable.start()
        observed, decision = self._durable.observed, self._durable.decision
        if observed is None or decision is None:
            known, doubtful = notes_on_known(self._settings)
            if known:
                self.get_logger().info(known)
            if doubtful:
                self.get_logger().warning(doubtful)
            self._begin_turn()
            self._keep_concepts()
            return
        self.get_logger().info(
            f'going on with {self.episode_id}, in turn {observed.turn}, from {self._given["session"]}'
        )
        if self._durable.started.semantics != SEMANTICS:
            self.get_logger().warning(
                'another version of the method began this session: its questions so far are taken as they were asked'
            )
        self._stamps = TurnStamps(observed.stamp)
        self._announce(observed.scene)
        if not self._durable.episode.awaits_answer:
            self._end_turn()
            return
        # Word for word as before: perception, if it is new too, shows what the question is about.
        self._publish_turn({'turn': observed.turn, 'stamp': stamp_members(observed.stamp), 'world': self._world})
        self._put(observed, decision)
        self._show(observed, self._beliefs())
        self._keep_concepts()

    def _keep_concepts(self) -> None:
        """Publish and write what is known, if it has changed."""
        episode = self._durable.episode
        if episode.concepts.feature_names:
            version = (
                episode.concepts.model_version,
                len(episode.records),
                episode.answers.last,
                len(episode.answers.late),
            )
            self._keeper.keep(version, self._durable.knowledge)

    def _begin_turn(self) -> None:
        """Ask perception for the scene of the next turn."""
        if self._has_failed:
            return
        stamp = self._stamps.begin(self._now())
        self._last_turn_start = time.monotonic()
        self._awaits_scene = True
        self._stale.begin_turn()
        self._state.stop()
        turn = self._durable.episode.turn + 1
        self.set_status(f'turn {turn}: waiting for objects', SECONDS_FOR_OBJECTS, awaited='objects')
        self._request.send({'turn': turn, 'stamp': stamp_members(stamp), 'world': self._world})

    def _perceive(self, cloud: PointCloud2) -> None:
        """Decide, once the scene of this turn is there: see `TurnStamps`."""
        if not self._awaits_scene or self._has_failed:
            return
        now, stamp = self._now(), nanoseconds(cloud.header.stamp)
        if not self._stamps.is_of_turn(stamp, now):
            self._stale.pass_over(stamp, self._stamps.last, now)
            return
        scene = scene_of_cloud(cloud, self._durable.episode.concepts.feature_names)
        observed = SceneObserved(self._durable.episode.turn + 1, self._stamps.last, cloud.header.frame_id, scene)
        decision = self._durable.ask(observed)
        self._tell_of_sensors(scene)
        self._awaits_scene = False
        self._request.stop()
        if decision.turn == 1:
            self._announce(scene)
        self._put(observed, decision)
        if self._durable.episode.awaits_answer:
            self._show(observed, self._beliefs())
        else:
            self._end_turn()

    def _tell_of_sensors(self, scene: Scene) -> None:
        """Take note of the noise for /diagnostics, and say once of each feature what it read that cannot be."""
        episode = self._durable.episode
        self._view_noise = noise_text(episode.view_noise)
        for object_id, feature, value in episode.concepts.implausible_readings(scene):
            if feature not in self._implausible:
                self._implausible[feature] = f'{value:g} of object {object_id}'
                self.get_logger().warning(
                    f'{feature} of object {object_id} reads {value:g}, far from all else it ever read: it is not'
                    ' counted'
                )

    def measurements(self) -> Mapping[str, str]:
        """Return what is known of the sensors, for /diagnostics."""
        implausible = {f'implausible {feature}': what for feature, what in dict(self._implausible).items()}
        return {'view noise': self._view_noise, **implausible}

    def _put(self, observed: SceneObserved, decision: Decision) -> None:
        """Publish a decision, and the question that waits, again if nobody answered it in the turn before."""
        pending = self._durable.episode.pending
        if pending is not None:
            self._question.send({**documents.query_members(pending), 'world': self._world})
            self.get_logger().info(f'turn {decision.turn}: {pending.text}')
            self._await_answer(pending, decision.turn)
        head = header(observed.stamp, observed.frame_id)
        self._decision.publish(cloud_of_decision(decision, self._settings.symbols, head, CLOUD_TYPES, observed.scene))

    def _await_answer(self, query: Query, turn: int) -> None:
        """Wait for the answer, but not for ever if so configured, and the longer the longer nobody has answered."""
        timeout, missed = float(self._given['answer_timeout']), self._durable.episode.unanswered_turns
        # Once a turn has passed without an answer, that is the concern.
        patience = math.inf if missed else SECONDS_FOR_ANSWER
        self.set_status(f'turn {turn}: waiting for the answer to {query.query_id}', expected_within=patience)
        if timeout:
            self._patience.set(timeout * min(2**missed, LONGEST_BACK_OFF))

    def _go_on_without(self) -> None:
        """Let the turn pass without its answer."""
        query = self._durable.episode.awaited
        if query is not None:
            self.get_logger().info(
                f'turn {self._durable.episode.turn}: going on without the answer to {query.query_id}'
            )
            self._durable.time_out()
            self._end_turn()

    def _now(self) -> int:
        """Return the time of the clock, real or simulated, in nanoseconds."""
        return int(self.get_clock().now().nanoseconds)

    def _announce(self, scene: Scene) -> None:
        """Publish what the episode is about, as soon as the features are known."""
        self._publish_episode(
            episode_members(self._durable.started, scene.feature_names, self._durable.episode.tuned_turns)
        )

    def _hear(self, message: String) -> None:
        """Take an answer, or the correction of one, and say whether it was taken: not before it is on the disk."""
        if not self._durable.is_ready:
            return
        answer, episode = None, self._durable.episode
        waited = episode.awaits_answer
        try:
            answer = self._read_answer(message.data)
            taken = self._durable.take(answer)
        except InputError as error:
            self._durable.note_rejected(message.data, str(error))
            self._publish_ack(acknowledgement(answer, None, str(error)))
            raise
        self._publish_ack(acknowledgement(answer, taken.receipt, taken.reason))
        if taken.receipt is Receipt.LATE:
            self.reject('answer', taken.reason)
            # It is kept all the same, for how far its teacher can be relied on.
            self._tell_state()
        if taken.receipt is not Receipt.ACCEPTED:
            return
        told = _spoken(answer.outcome.value if answer.content is None else answer.content)
        now = '' if answer.replaces is None else 'now '
        self.get_logger().info(f'{answer.query_id}: {answer.teacher_id} {now}says {told}')
        if waited and not episode.awaits_answer:
            self._end_turn()
        else:
            self._tell_state()

    def _read_answer(self, content: str) -> Answer:
        if content.lstrip().startswith('{'):
            document = documents.read('answer', content)
            if document['episode_id'] != self.episode_id:
                raise AnswerError(f'the answer belongs to episode {document["episode_id"]}, this is {self.episode_id}')
            known = (*self._settings.symbols, *self._durable.episode.concepts.groups)
            return respelt(documents.answer_of(document), known)
        if self._durable.episode.pending is None:
            raise AnswerError('no query is pending')
        return read_plain_answer(content, self._durable.episode.pending)

    def _end_turn(self) -> None:
        """Tell what is known now, and begin the next turn unless this was the last."""
        self._question.stop()
        self._patience.clear()
        episode = self._durable.episode
        if episode.done:
            self._tell_state()
            self._is_over = True
            self.set_status('the episode is over')
            self.get_logger().info(
                f'the episode is over: {episode.spent:g} of {self._settings.budget:g} spent;'
                ' corrections are still taken; start a learner again for another episode'
            )
            self._keep_concepts()
            return
        observed = self._durable.observed
        if observed is None:
            return
        beliefs = self._beliefs()
        self._state.send(state_members(self._durable.episode, beliefs))
        pause = float(self._given['turn_period']) - (time.monotonic() - self._last_turn_start)
        if pause > 0:
            self.after(pause, self._begin_turn)
        else:
            self._begin_turn()
        # Only now, while perception looks: markers take longer to write than all documents together.
        self._show(observed, beliefs)
        self._keep_concepts()

    def _tell_state(self) -> None:
        """Publish what is known now, outside of the course of the turns."""
        observed = self._durable.observed
        if observed is not None:
            beliefs = self._beliefs()
            self._show(observed, beliefs)
            self._state.send(state_members(self._durable.episode, beliefs))
            self._keep_concepts()

    def _beliefs(self) -> NDArray[np.float64]:
        """Return (n, |Y|) q_y(x) of the present scene."""
        episode = self._durable.episode
        return episode.concepts.predict_proba(episode.scene.features)

    def _show(self, observed: SceneObserved, beliefs: NDArray[np.float64]) -> None:
        """Publish the scene, the beliefs and the pending query for people who watch."""
        pending = self._durable.episode.pending
        asked, question = (pending.action.object_id, pending.text) if pending else (None, '')
        head, symbols = header(observed.stamp, observed.frame_id), self._settings.symbols
        self._markers.publish(markers(observed.scene, beliefs, symbols, asked, head, MARKER_TYPES, question))

    def health_warning(self) -> str:
        """Warn that nobody answers, or that another learner uses the same topics, which confuses everybody."""
        return self._rival() or self._absence()

    def _absence(self) -> str:
        missed = self._durable.episode.unanswered_turns if self._durable.is_ready else 0
        return f'nobody has answered for {missed} turn{"" if missed == 1 else "s"}' if missed else ''

    def _rival(self) -> str:
        if time.monotonic() > self._rival_at + SECONDS_OF_A_RIVAL:
            return ''
        return 'another learner publishes turn, too: end one of the two, or give it a namespace of its own'

    def _hear_turn(self, document: Document) -> None:
        """Notice another learner on the same topics; make room for it if this episode is over."""
        if document['episode_id'] == self.episode_id:
            return
        if not self._is_over:
            self._rival_at = time.monotonic()
        elif self._yields:
            self.get_logger().info(f'this episode is over, and {document["episode_id"]} begins: ending')
            self.context.try_shutdown()

    def _failed(self, error: Exception) -> None:
        # An episode that cannot go on asks for nothing.
        if isinstance(error, EpisodeError):
            self._has_failed = True
            self._request.stop()
            self._question.stop()
            self._patience.clear()
        super()._failed(error)

    def destroy_node(self) -> None:
        """Close the log, once the worker has stopped."""
        super().destroy_node()
        self._durable.close()


def _spoken(content: Content) -> str:
    return (', '.join(map(str, content)) or NO_SYMBOL) if isinstance(content, tuple) else str(content)


def main(arguments: Sequence[str], storage: StorageFactory = SqliteStorage) -> int:
    """Run the node."""
    spin_node(partial(LearnerNode, yields=True, storage=storage), arguments)
    return 0
