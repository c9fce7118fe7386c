"""The session log: what was appended is there, whatever happened, and damage is never taken for content."""

from __future__ import annotations

import json
import resource
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy

from al_questioner.domain import Action, Answer, Costs, EpisodeSettings, Outcome, Query, QueryKind, Scene
from al_questioner.event_log.encoding import Encoder, decoded
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeStarted,
    InputRejected,
    KernelTuned,
    LateAnswerKept,
    SceneObserved,
)
from al_questioner.event_log.log import LogContents, LogWriteError, SessionLog, SessionLogError, read_log, repair_log
from al_questioner.event_log.storage import DATABASE, HEAD
from shared.storages import UnwaitedStorage, WatchedStorage

ENTRIES = [('scene' if i % 3 == 0 else 'answer', bytes([i]) * (10 + 997 * i % 6000)) for i in range(24)]


def contents_of(folder: Path) -> list[tuple[str, bytes]]:
    return [(event.kind, event.content) for event in read_log(folder).events]


def write(folder: Path, entries: list[tuple[str, bytes]] = ENTRIES, close: bool = True) -> SessionLog:
    log = SessionLog(folder)
    for entry in entries:
        log.append(entry)
    if close:
        log.close()
    return log


def killed_after_writing(folder: Path) -> None:
    """A log whose writer was killed: everything is in the journal yet."""
    running = write(folder.with_name('running'), close=False)
    shutil.copytree(running.folder, folder)
    running.close()


@pytest.mark.parametrize('make', [write, killed_after_writing])
def test_what_was_appended_is_there(tmp_path: Path, make) -> None:
    """Otherwise an acknowledged answer would be gone."""
    make(tmp_path / 'log')
    assert contents_of(tmp_path / 'log') == ENTRIES
    with SessionLog(tmp_path / 'log') as log:
        assert [(event.kind, event.content) for event in log.events] == ENTRIES
        log.append(('tune', b'a'), ('tune', b'b'))
    assert contents_of(tmp_path / 'log') == [*ENTRIES, ('tune', b'a'), ('tune', b'b')]
    assert read_log(tmp_path / 'log').damage is None


def test_reading_changes_nothing_and_disturbs_no_writer(tmp_path: Path) -> None:
    """A reader neither damages a session nor stops the robot."""
    log = write(tmp_path, close=False)
    assert contents_of(tmp_path) == ENTRIES
    log.append(('tune', b'a'))
    assert len(contents_of(tmp_path)) == 25
    log.close()
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    read_log(tmp_path)
    assert before == {path.name: path.read_bytes() for path in tmp_path.iterdir()}


def test_one_process_at_a_time(tmp_path: Path) -> None:
    """Otherwise two learners would write one episode."""
    with SessionLog(tmp_path), pytest.raises(SessionLogError, match='another process is using this session'):
        SessionLog(tmp_path)
    SessionLog(tmp_path).close()


def test_no_log(tmp_path: Path) -> None:
    """Otherwise a mistyped folder would be taken for an empty session."""
    for folder, reason in (
        (tmp_path, 'there is no session log in it'),
        (tmp_path / 'nowhere', 'nowhere: does not exist$'),
        (Path(__file__), 'test_log.py: not a folder$'),
    ):
        with pytest.raises(SessionLogError, match=reason):
            read_log(folder)
    assert list(tmp_path.iterdir()) == []
    (tmp_path / 'file').write_text('')
    with pytest.raises(ValueError, match='file cannot be made a folder'):
        SessionLog(tmp_path / 'file')


@pytest.mark.parametrize('point', ['begun', 'written', 'committed', 'noted'])
def test_an_append_is_there_or_not_wherever_it_ends(tmp_path: Path, point: str) -> None:
    """Otherwise a crash would leave half of a turn."""
    write(tmp_path / 'log', ENTRIES[:5])
    copies = []

    def crash(reached: str) -> None:
        if reached == point:
            copies.append(shutil.copytree(tmp_path / 'log', tmp_path / 'crashed'))

    with SessionLog(tmp_path / 'log', partial(WatchedStorage, reached=crash)) as log:
        log.append(*ENTRIES[5:7])
    contents = read_log(copies[0])
    assert contents.damage is None
    assert len(contents.events) == (7 if point in ('committed', 'noted') else 5)
    with SessionLog(copies[0]) as again:
        again.append(ENTRIES[0])


def check_damage(folder: Path, original: list[tuple[str, bytes]]) -> LogContents | None:
    """Damage must be named, and what is read must be what was written; None if there is nothing to read."""
    try:
        contents = read_log(folder)
    except SessionLogError:
        return None
    found = [(event.kind, event.content) for event in contents.events]
    assert found == original[: len(found)]
    if contents.damage is None:
        assert found == original
    else:
        with pytest.raises(SessionLogError, match='--repair` keeps what is before the damage'):
            SessionLog(folder)
    return contents


@pytest.mark.parametrize('number', [30, pytest.param(150, marks=pytest.mark.slow)])
@pytest.mark.parametrize('make', [write, killed_after_writing])
def test_flipped_bytes_are_found(tmp_path: Path, make, number: int) -> None:
    """Otherwise a damaged disk would teach the robot what nobody said."""
    make(tmp_path / 'log')
    names = [name for name in (DATABASE, f'{DATABASE}-wal', HEAD) if (tmp_path / 'log' / name).exists()]
    partial = 0
    for name in names:
        whole = (tmp_path / 'log' / name).read_bytes()
        for offset in np.linspace(0, len(whole) - 1, number).astype(int):
            damaged = bytearray(whole)
            damaged[offset] ^= 0x55
            (tmp_path / 'log' / name).write_bytes(damaged)
            contents = check_damage(tmp_path / 'log', ENTRIES)
            partial += contents is not None and contents.damage is not None and len(contents.events) > 0
        (tmp_path / 'log' / name).write_bytes(whole)
    assert partial > number * 2 / 3, 'most damage leaves what is before it'


@pytest.mark.parametrize('number', [15, pytest.param(60, marks=pytest.mark.slow)])
@pytest.mark.parametrize('make', [write, killed_after_writing])
def test_lost_ends_are_found(tmp_path: Path, make, number: int) -> None:
    """Otherwise the last answers would be gone and nobody would know."""
    make(tmp_path / 'log')
    for name in (DATABASE, f'{DATABASE}-wal'):
        file = tmp_path / 'log' / name
        if not file.exists():
            continue
        whole = file.read_bytes()
        for length in np.linspace(0, len(whole) - 1, number).astype(int):
            file.write_bytes(whole[:length])
            contents = check_damage(tmp_path / 'log', ENTRIES)
            assert contents is None or contents.damage is not None or len(contents.events) == len(ENTRIES)
        file.unlink()
        contents = check_damage(tmp_path / 'log', ENTRIES)
        assert contents is None or contents.damage is not None
        file.write_bytes(whole)
    (tmp_path / 'log' / HEAD).unlink()
    assert 'session.head is missing' in str(read_log(tmp_path / 'log').damage)


def damage(folder: Path) -> int:
    """Alter an event in the middle; its number."""
    content = ENTRIES[15][1]
    whole = (folder / DATABASE).read_bytes()
    assert content[:500] in whole
    (folder / DATABASE).write_bytes(whole.replace(content[:500], content[:499] + b'?'))
    return 16


def test_a_repair_keeps_what_is_before_the_damage(tmp_path: Path) -> None:
    """Otherwise a session of hours would be lost for one byte."""
    write(tmp_path)
    number = damage(tmp_path)
    broken = (tmp_path / DATABASE).read_bytes()
    assert f'event {number} is damaged' in str(repair_log(tmp_path).damage)
    assert contents_of(tmp_path) == ENTRIES[: number - 1]
    assert (tmp_path / f'broken-{DATABASE}').read_bytes() == broken
    with SessionLog(tmp_path) as log:
        log.append(('tune', b''))
    assert repair_log(tmp_path).damage is None


def test_an_interrupted_repair_is_repeated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise a second crash would lose what the first one left."""
    killed_after_writing(tmp_path / 'log')
    (tmp_path / 'log' / HEAD).write_bytes(b'damaged')
    for name in ('rename', 'replace'):
        for count in range(5):
            folder = shutil.copytree(tmp_path / 'log', tmp_path / f'{name}-{count}')
            original, calls = getattr(Path, name), []

            def fail(path, target, original=original, calls=calls, count=count):
                if len(calls) == count:
                    raise OSError(5, 'power failure')
                calls.append(path)
                return original(path, target)

            with monkeypatch.context() as patch:
                patch.setattr(Path, name, fail)
                try:
                    repair_log(folder)
                except SessionLogError:
                    assert read_log(folder).damage
                    assert contents_of(folder) == ENTRIES
            repair_log(folder)
            assert contents_of(folder) == ENTRIES
            assert read_log(folder).damage is None


def test_a_repair_overwrites_no_broken_log(tmp_path: Path) -> None:
    """The broken log stays, since a later tool may still read more of it."""
    write(tmp_path)
    damage(tmp_path)
    (tmp_path / f'broken-{DATABASE}').write_bytes(b'')
    with pytest.raises(SessionLogError, match='exists already; move it away'):
        repair_log(tmp_path)


def test_nothing_to_repair_from(tmp_path: Path) -> None:
    """Otherwise an empty log would look like a repaired one."""
    write(tmp_path)
    (tmp_path / DATABASE).write_bytes(b'nonsense' * 100)
    with pytest.raises(SessionLogError, match='nothing can be recovered'):
        repair_log(tmp_path)


def test_a_full_disk_loses_nothing_and_ends_the_log(tmp_path: Path) -> None:
    """No answer is acknowledged that was not written, and no earlier one is lost."""
    program = (
        'import resource, signal, sys; from pathlib import Path\n'
        'from al_questioner.event_log.log import SessionLog, LogWriteError\n'
        'log = SessionLog(Path(sys.argv[1])); signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n'
        'resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))\n'
        'try:\n'
        '    for i in range(1000): log.append(("answer", b"x" * 3000)); print(i + 1)\n'
        'except LogWriteError as error: print(error)\n'
        'try: log.append(("answer", b""))\n'
        'except LogWriteError as error: print(error)\n'
    )
    done = subprocess.run(
        [sys.executable, '-c', program, str(tmp_path)], capture_output=True, text=True, check=True, timeout=60
    )
    *counts, first, second = done.stdout.splitlines()
    assert 'the session log cannot be written' in first
    assert first == second
    assert 5 < int(counts[-1]) == len(read_log(tmp_path).events)
    assert read_log(tmp_path).damage is None
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY


def test_a_log_that_became_read_only_says_so(tmp_path: Path) -> None:
    """Otherwise an answer would be acknowledged that nobody has."""
    with SessionLog(tmp_path) as log:
        log.append(ENTRIES[0])
        log._storage._database.execute('PRAGMA query_only=1')
        with pytest.raises(LogWriteError, match='readonly database'):
            log.append(ENTRIES[1])
    assert contents_of(tmp_path) == ENTRIES[:1]


FLOATS = st_numpy.arrays(
    np.float32,
    st.tuples(st.integers(1, 5), st.just(4)),
    elements=st.floats(width=32, allow_nan=False, allow_infinity=False),
)
SCENES = FLOATS.map(lambda table: Scene(tuple(range(len(table))), table[:, :3], table, ('a', 'b', 'c', 'd')))
WORDS = st.text(max_size=8)
WORLDS = st.none() | st.just({'task': 'x'})
NAMED = st.text(min_size=1, max_size=8)
IDS = st.lists(st.integers(0, 2**32 - 2), max_size=3).map(tuple)
ANSWERS = st.builds(
    Answer,
    *(NAMED, NAMED, NAMED),
    st.sampled_from(Outcome),
    st.none() | NAMED | st.integers(0, 2**32 - 2) | st.lists(NAMED, max_size=3).map(tuple) | IDS,
    st.none() | NAMED,
)
AMOUNTS = st.floats(0, 1e9)
QUERIES = st.builds(
    Query,
    NAMED,
    st.integers(1, 10_000),
    st.builds(Action, st.sampled_from(QueryKind), st.none() | st.integers(0, 99), st.none() | NAMED),
    st.lists(NAMED).map(tuple),
    *(AMOUNTS, AMOUNTS, st.integers(0, 99), st.integers(0, 99), WORDS),
)
SETTINGS = st.builds(
    EpisodeSettings,
    symbols=st.just(('a', 'b')),
    budget=AMOUNTS,
    turns=st.integers(1, 99),
    strategy=NAMED,
    weights=st.dictionaries(st.sampled_from(['discriminability', 'class_uniformity']), st.floats(-9, 9)),
    costs=st.builds(Costs, AMOUNTS, AMOUNTS, AMOUNTS, relevance=st.none() | AMOUNTS),
    length_scale=st.none() | st.floats(0.1, 9),
)
EVENTS = st.one_of(
    st.builds(EpisodeStarted, NAMED, SETTINGS, st.integers(0, 2**63), AMOUNTS, WORLDS, WORDS),
    st.builds(SceneObserved, st.integers(1, 99), st.integers(0, 2**62), WORDS, SCENES),
    st.builds(ActionChosen, st.integers(1, 99), st.builds(Action, st.sampled_from(QueryKind)), st.none() | QUERIES),
    st.builds(AnswerAccepted, ANSWERS),
    st.builds(LateAnswerKept, ANSWERS, WORDS),
    st.builds(InputRejected, WORDS, WORDS, st.integers(1, 10**9)),
    st.builds(KernelTuned, st.integers(1, 99), st.integers(0, 99)),
)


@settings(max_examples=60, deadline=None)
@given(events=st.lists(st.tuples(EVENTS, st.booleans()), max_size=8))
def test_events_come_back_to_the_last_bit(tmp_path_factory: pytest.TempPathFactory, events) -> None:
    """Otherwise a resumed learner would see other numbers than the first one did."""
    twice = [event for event, again in events for _ in range(1 + again)]
    folder = tmp_path_factory.mktemp('log')
    encoder = Encoder()
    with SessionLog(folder, UnwaitedStorage) as log:
        for event in twice:
            log.append(encoder.encode(event))
    found, fault = decoded(read_log(folder))
    assert fault is None
    assert len(found) == len(twice)
    for event, original in zip(found, twice, strict=True):
        if isinstance(original, SceneObserved):
            assert isinstance(event, SceneObserved)
            assert event.scene.equals(original.scene)
            assert (event.turn, event.stamp, event.frame_id) == (original.turn, original.stamp, original.frame_id)
        else:
            assert event == original


def test_an_episode_without_the_relevance_query_is_written_as_ever() -> None:
    """Otherwise a learner could not go on with a log of an earlier version: its parameters would differ."""
    started = EpisodeStarted('e', EpisodeSettings(('a', 'b'), 1.0, 1, 'u_sampling'), 1, 1e-3, None, '')
    _, content = Encoder().encode(started)
    assert json.loads(content)['costs'] == {
        'label': 1.0, 'demonstration': 2.0, 'feature_subset': 2.0, 'unknown': 1.0, 'skip': 1.0, 'unanswered': 0.0,
    }  # fmt: skip


def test_a_scene_that_stays_is_stored_once(tmp_path: Path) -> None:
    """Otherwise a session with a camera at rest would fill the disk."""
    table = np.ones((30, 60), dtype=np.float32)
    scene = Scene(tuple(range(30)), table[:, :3], table, tuple(f'f_{i}' for i in range(60)))
    encoder = Encoder()
    first, second = (encoder.encode(SceneObserved(turn, turn, 'table', scene))[1] for turn in (1, 2))
    assert len(second) < 100 < len(first)


@pytest.mark.parametrize(
    ('kind', 'content', 'reason'),
    [
        ('scene', b'{"turn":1,"stamp":1,"frame_id":"","scene":null}', 'there is none'),
        ('scene', b'nonsense', 'Expecting value'),
        ('answer', b'{}', "'query_id'"),
        ('dream', b'{}', "unknown kind 'dream'"),
    ],
)
def test_an_event_of_another_version_is_named(tmp_path: Path, kind: str, content: bytes, reason: str) -> None:
    """Otherwise a log of a later version would end in a traceback."""
    write(tmp_path, [('refused', b'{"text":"","reason":""}'), (kind, content)])
    found, fault = decoded(read_log(tmp_path))
    assert len(found) == 1
    assert f'event 2 ({kind}) cannot be understood' in str(fault)
    assert reason in str(fault)


BEGIN = """
import resource, sys
from pathlib import Path
from al_questioner.event_log.log import SessionLog
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
SessionLog(Path(sys.argv[1]))
"""


@pytest.mark.parametrize('room', [0, 50, 100, 5000, 30_000])
def test_a_session_that_there_was_no_room_for_begins_once_there_is(tmp_path: Path, room: int) -> None:
    """Otherwise the folder would be refused as damaged for ever, with nothing in it that a repair could keep."""
    done = subprocess.run(
        [sys.executable, '-c', BEGIN, str(tmp_path / 'log'), str(room)], capture_output=True, text=True, check=False
    )
    assert 'the session log cannot be used' in done.stderr
    write(tmp_path / 'log')
    assert contents_of(tmp_path / 'log') == ENTRIES


def test_an_empty_head_is_no_log_alone_and_damage_beside_events(tmp_path: Path) -> None:
    """A killed process leaves an empty head alone; beside events it means that the last ones are lost."""
    (tmp_path / 'new').mkdir()
    (tmp_path / 'new' / HEAD).write_bytes(b'')
    with pytest.raises(SessionLogError, match='there is no session log in it'):
        read_log(tmp_path / 'new')
    killed_after_writing(tmp_path / 'log')
    (tmp_path / 'log' / HEAD).write_bytes(b'')
    assert f'{HEAD} is damaged' in str(read_log(tmp_path / 'log').damage)
    with pytest.raises(SessionLogError, match='--repair` keeps what is before the damage'):
        SessionLog(tmp_path / 'log')
