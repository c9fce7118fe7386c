"""Each message of an episode written and read once more, as the nodes do it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from measuring import Seconds
from rclpy.serialization import deserialize_message, serialize_message
from turn_parts.offline import PlayedEpisode
from turn_parts.recording import opened
from turn_parts.topics import TYPES

from al_questioner.domain import EpisodeSettings
from al_questioner.messages import documents
from al_questioner.messages.clouds import cloud_of_decision, cloud_of_scene, decision_of_cloud, scene_of_cloud
from al_questioner.messages.markers import markers
from al_questioner.ros.types import CLOUD_TYPES, MARKER_TYPES, header, text

Write = Callable[[], Any]
Read = Callable[[Any], Any]


@dataclass(frozen=True, eq=False)
class Encoding:
    """The messages of one topic; each array has one entry per message, in seconds where not said otherwise.

    Attributes:
        octets: bytes on the wire.
        writing: from what the node holds to the message, documents included.
        reading: the inverse, with all checks.
        packing: what ROS does to turn the message into bytes.
        unpacking: the inverse.
    """

    octets: Seconds
    writing: Seconds
    reading: Seconds
    packing: Seconds
    unpacking: Seconds


def measure_encoding(
    played: PlayedEpisode, heard: Mapping[str, list[bytes]], settings: EpisodeSettings
) -> dict[str, Encoding]:
    """Write and read each message of an episode: documents as they were heard, clouds and markers from what was played.

    Returns:
        By topic; `scene_image` is only packed and unpacked, since drawing it is no encoding.
    """
    jobs: dict[str, list[tuple[Write, Read]]] = {topic: [] for topic in TYPES}
    stamp = header(1, 'table')
    for turn in played.turns:
        scene, decision, query = turn.scene, turn.decision, turn.decision.query
        jobs['objects'].append((lambda scene=scene: cloud_of_scene(scene, stamp, CLOUD_TYPES), scene_of_cloud))
        jobs['decision'].append(
            (
                lambda decision=decision, scene=scene: cloud_of_decision(
                    decision, settings.symbols, stamp, CLOUD_TYPES, scene
                ),
                lambda cloud, number=decision.turn: decision_of_cloud(cloud, settings.symbols, number),
            )
        )
        asked = query.action.object_id if query else None
        for pending in (asked, None) if query else (None,):
            jobs['scene_markers'].append((_markers_writer(turn.scene, turn.beliefs, settings, pending), lambda _: None))
    for kind in ('turn', 'query', 'answer', 'answer_ack', 'learner_state'):
        for message in opened(heard, kind):
            jobs[kind].append((_document_writer(kind, documents.read(kind, message.data)), _document_reader(kind)))
    for picture in opened(heard, 'scene_image'):
        jobs['scene_image'].append((lambda picture=picture: picture, lambda _: None))
    return {topic: _measure(topic, of_topic) for topic, of_topic in jobs.items() if of_topic}


def _markers_writer(scene: Any, beliefs: Any, settings: EpisodeSettings, pending: int | None) -> Write:
    return lambda: markers(scene, beliefs, settings.symbols, pending, header(1, 'table'), MARKER_TYPES)


def _document_writer(kind: str, document: documents.Document) -> Write:
    """Writes a document from the domain's objects, where the nodes hold such."""
    episode_id = document['episode_id']
    members = {name: value for name, value in document.items() if name not in ('schema', 'episode_id')}
    query = documents.query_of(document) if kind == 'query' else None
    answer = documents.answer_of(document) if kind == 'answer' else None
    records = [documents.record_of(record) for record in members.get('queries', ())]

    def write() -> Any:
        content = members
        if query is not None:
            content = {**documents.query_members(query), 'world': members['world']}
        elif answer is not None:
            content = documents.answer_members(answer)
        elif kind == 'learner_state':
            content = {**members, 'queries': [documents.record_members(record) for record in records]}
        return text(documents.write(kind, episode_id, content))

    return write


def _document_reader(kind: str) -> Read:
    def read(message: Any) -> Any:
        document = documents.read(kind, message.data)
        if kind == 'query':
            return documents.query_of(document)
        if kind == 'answer':
            return documents.answer_of(document)
        return [documents.record_of(record) for record in document.get('queries', ())]

    return read


def _measure(topic: str, jobs: list[tuple[Write, Read]]) -> Encoding:
    octets, *times = (np.empty(len(jobs)) for _ in range(5))
    for i in range(-1, len(jobs)):  # the first counts the second time only, once everything is loaded
        write, read = jobs[max(i, 0)]
        ticks = [time.perf_counter()]
        message = write()
        ticks.append(time.perf_counter())
        packed = serialize_message(message)
        ticks.append(time.perf_counter())
        unpacked = deserialize_message(packed, TYPES[topic])
        ticks.append(time.perf_counter())
        read(unpacked)
        ticks.append(time.perf_counter())
        if i >= 0:
            octets[i] = len(packed)
            for array, seconds in zip(times, np.diff(ticks), strict=True):
                array[i] = seconds
    writing, packing, unpacking, reading = times
    return Encoding(octets, writing, reading, packing, unpacking)
