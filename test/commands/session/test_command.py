"""The executable that shows, checks, repairs and exports a session."""

from __future__ import annotations

import csv
import dataclasses
import itertools
import json
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from al_questioner.bags import from_session, read_episodes
from al_questioner.cli import main
from al_questioner.domain import Answer, EpisodeSettings, Outcome, Scene, random_stream
from al_questioner.event_log import log as session_log
from al_questioner.event_log.encoding import Encoder, decoded
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.storage import DATABASE
from al_questioner.imitation.bags import decisions_anew, read_demonstrations
from al_questioner.questioning import (
    FEATURE_SETS,
    Choice,
    Episode,
    FeatureRecorder,
    Receipt,
    TurnContext,
    make_strategy,
    read_plain_answer,
)
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings
from shared.durable_sessions import (
    TASK,
    TEACHER,
    WITH_RELEVANCE,
    WORLD,
    answer,
    ask,
    ask_what_matters,
    durable_of,
    play_turns,
    start_durable,
)
from shared.little_room import little_room

EPISODE = ['--task', 'prepare_lunch', '--strategy', 'dt_iros', '--budget', '6', '--turns', '7', '--seed', '4']
BEGUN = EpisodeStarted('e1', episode_settings(TASK, 'dt_iros', 6.0, 7), 4, 1e-3, WORLD, '1')


@pytest.fixture(scope='module')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


def write_session(
    folder: Path, world: PerceivedWorld, corrected: bool = False, started: EpisodeStarted = BEGUN
) -> None:
    """A whole session, in which the first answer may be corrected, and another teacher be late."""
    durable = durable_of(started, SessionLog(folder))
    durable.start()
    while not durable.episode.done:
        if ask(durable, world).query is not None:
            durable.take(answer(durable, world))
    if corrected:
        assert durable.take(Answer('q1', 'b1', 'bert', Outcome.SKIP)).receipt is Receipt.LATE
        durable.take(Answer('q1', 'c1', 'scripted', Outcome.UNKNOWN, replaces='q1/scripted'))
        durable.note_rejected('pudding', 'it does not answer', 0.0)
    durable.close()


@pytest.mark.parametrize(('away', 'comes_back'), [({2, 3}, True), ({2, 3, 4, 5, 6, 7}, False)])
def test_a_teacher_who_was_away_leaves_a_session_like_any_other(
    tmp_path: Path, world: PerceivedWorld, away: set[int], comes_back: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """A session with turns that passed unanswered can be continued, exported, checked and trained from."""
    log, durable = tmp_path / 'log', None
    while durable is None or not durable.episode.done:
        # Another process in every turn.
        durable = durable_of(BEGUN, SessionLog(log))
        durable.start()
        if not durable.episode.awaits_answer and durable.episode.turns_left:
            ask(durable, world)
        elif durable.episode.turn in away:
            durable.time_out()
        elif durable.episode.pending is not None:
            durable.take(answer(durable, world))
        durable.close()
    asked = durable.episode.records
    assert any(record.answered_in == 4 for record in asked) == comes_back
    assert any(record.outcome is Outcome.UNANSWERED for record in asked) != comes_back
    assert main(['session', str(log), '--bag', str(tmp_path / 'bag'), '--json', str(tmp_path / 'json')]) == 0
    assert ('unanswered, withdrawn' in capsys.readouterr().out) != comes_back
    (recorded,) = read_episodes(tmp_path / 'bag')
    assert recorded.records == asked
    assert first_divergence(recorded.started, recorded.events) is None
    (demonstration,) = read_demonstrations([tmp_path / 'bag'])
    assert len(demonstration.steps) < demonstration.turns == BEGUN.settings.turns
    assert [q['outcome'] for q in json.loads((tmp_path / 'json').read_text())['queries']] == [
        record.outcome.value for record in asked
    ]


def test_the_json_of_a_session_is_that_of_the_demo(tmp_path: Path, world: PerceivedWorld) -> None:
    """Sessions with people can be compared with episodes that were played."""
    write_session(tmp_path / 'log', world)
    played = tmp_path / 'demo.json'
    arguments = [*EPISODE, '--offline', '--out', str(tmp_path), '--json', str(played)]
    assert main(['demo', *arguments]) == 0
    exported = tmp_path / 'session.json'
    assert main(['session', str(tmp_path / 'log'), '--json', str(exported)]) == 0
    ours, theirs = json.loads(exported.read_text()), json.loads(played.read_text())
    common = ours.keys() & theirs.keys() - {'version'}
    assert {'accuracy', 'final_accuracy', 'queries', 'spent', 'task', 'kernel', 'weights'} <= common
    assert {name: ours[name] for name in common} == {name: theirs[name] for name in common}


def test_all_that_was_said_is_shown_and_exported(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """All that a person said can be found again."""
    write_session(tmp_path / 'log', world, corrected=True)
    assert main(['session', str(tmp_path / 'log'), '--csv', str(tmp_path / 'csv')]) == 0
    shown = capsys.readouterr().out
    assert '1 correction, 1 late, 1 refused' in shown
    assert 'taken, then replaced by c1' in shown
    assert 'whole, ' in shown
    with (tmp_path / 'csv' / 'answers.csv').open() as file:
        rows = list(csv.DictReader(file))
    assert [row['status'] for row in rows[-3:]] == ['late', 'taken', 'refused: it does not answer']
    assert (rows[-2]['query_id'], rows[-2]['outcome'], rows[-2]['replaces']) == ('q1', 'unknown', 'q1/scripted')
    assert (rows[-3]['object_id'], rows[-3]['symbol']) == (rows[0]['object_id'], rows[0]['symbol'])
    with (tmp_path / 'csv' / 'turns.csv').open() as file:
        turns = list(csv.DictReader(file))
    assert len(turns) == 7
    assert turns[0]['outcome'] == 'unknown'


def test_a_session_as_a_bag_leads_to_the_same_decisions(tmp_path: Path, world: PerceivedWorld) -> None:
    """Sessions with people can be replayed, shown in Foxglove and learnt from."""
    write_session(tmp_path / 'log', world)
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) == 0
    (episode,) = read_episodes(tmp_path / 'bag')
    assert (episode.started.episode_id, episode.started.settings, len(episode.turns)) == ('e1', BEGUN.settings, 7)
    assert first_divergence(episode.started, episode.events) is None
    (demonstration,) = read_demonstrations([tmp_path / 'bag'])
    assert len(demonstration.steps) == 7
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) == 2, 'a bag is never overwritten'


def test_nothing_is_left_of_a_bag_that_does_not_fit_on_the_disk(
    tmp_path: Path, world: PerceivedWorld, refusal: Callable[..., str]
) -> None:
    """Otherwise half a bag would be taken for the session, and be in the way of the next try."""
    write_session(tmp_path / 'log', world)
    with little_room(40_000):
        error = refusal('session', tmp_path / 'log', '--bag', tmp_path / 'bag')
    assert 'bag: cannot be written (File too large)' in error
    assert [path.name for path in tmp_path.iterdir()] == ['log']


@pytest.mark.parametrize('fault', [OSError(28, 'No space left on device'), KeyboardInterrupt()])
def test_nothing_is_left_of_a_bag_whose_writing_ends_in_between(
    tmp_path: Path, world: PerceivedWorld, monkeypatch: pytest.MonkeyPatch, fault: BaseException
) -> None:
    """Otherwise the part that was written is finished like a whole bag, and nobody could tell that it is none."""
    write_session(tmp_path / 'log', world)
    left = iter(range(5))
    whole = from_session.state_members

    def state_members(*arguments: Any) -> Any:
        if next(left, None) is None:
            raise fault
        return whole(*arguments)

    monkeypatch.setattr(from_session, 'state_members', state_members)
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) in (2, 130)
    assert [path.name for path in tmp_path.iterdir()] == ['log']


def test_names_that_tasks_may_not_have_any_more_stay_readable(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Answers that were given before such a name was refused are not lost."""
    symbols = ('Cup', 'cup', '7', 'skip', 'None', ' a,b ', 'Fru\u0308chte')
    settings = EpisodeSettings(symbols, 20.0, 9, 'random_fsq')
    started = EpisodeStarted('e1', settings, 1, 1e-3, None, '1')
    durable = durable_of(started, SessionLog(tmp_path / 'log'))
    durable.start()
    for turn, symbol in enumerate(('', *symbols, 'none'), 1):
        ids = [10 * turn + 1, 10 * turn + 2]
        features = np.random.default_rng(turn).random((2, 3), dtype=np.float32)
        scene = Scene(ids, np.zeros((2, 3), np.float32), features, ['bbox[0,1]_w', 'bbox[0,1]_h', 'size_m'])
        query = durable.ask(SceneObserved(turn, turn * 10**9, 'table', scene)).query
        assert query is not None
        durable.take(read_plain_answer(symbol or 'size,bbox[0,1]', query))
    durable.close()
    paths = [str(tmp_path / name) for name in ('json', 'csv', 'bag')]
    assert main(['session', str(tmp_path / 'log'), '--json', paths[0], '--csv', paths[1], '--bag', paths[2]]) == 0
    assert "│ 'skip'" in capsys.readouterr().out
    queries = json.loads(Path(paths[0]).read_text())['queries']
    assert [query['symbol'] for query in queries] == [None, *symbols, 'none']
    assert queries[0]['groups'] == ['size', 'bbox[0,1]']
    with (Path(paths[1]) / 'answers.csv').open() as file:
        contents = [row['content'] for row in csv.DictReader(file)]
    assert contents == ['size,"bbox[0,1]"', *symbols, 'none']
    (recorded,) = read_episodes(Path(paths[2]))
    assert recorded.started.settings.symbols == symbols
    assert first_divergence(recorded.started, recorded.events) is None


@pytest.mark.parametrize('corrected', [False, True])
def test_a_clock_that_was_put_back_hides_nothing_of_a_session(
    tmp_path: Path, world: PerceivedWorld, monkeypatch: pytest.MonkeyPatch, corrected: bool
) -> None:
    """Otherwise only a part of the bag, which has the times of the log, would be checked and learnt from."""
    ticks = itertools.count()

    def put_back() -> int:
        tick = next(ticks)
        return (10**9 + tick - (3600 if tick > 9 else 0)) * 10**9

    monkeypatch.setattr(session_log.time, 'time_ns', put_back)
    write_session(tmp_path / 'log', world, corrected)
    assert next(ticks) > 18
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) == 0
    (episode,) = read_episodes(tmp_path / 'bag')
    assert len(episode.turns) == 7
    assert first_divergence(episode.started, episode.events) is None


@pytest.mark.parametrize('name', FEATURE_SETS)
def test_what_was_corrected_later_is_replayed_as_it_was_known(
    tmp_path: Path, world: PerceivedWorld, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise weights would be learnt from choices beside features of what nobody knew when they were made."""
    seen_live: list[np.ndarray] = []

    class Watched(FeatureRecorder):
        def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
            choice = super().choose(context, rng)
            assert choice.features is not None
            seen_live.append(choice.features)
            return choice

    feature_set, settings = FEATURE_SETS[name], BEGUN.settings
    watched = Watched(make_strategy(settings.strategy, settings.weights), feature_set)
    live = Episode(settings, random_stream(BEGUN.seed, 'learner'), BEGUN.view_tolerance, watched)
    durable = durable_of(BEGUN, SessionLog(tmp_path / 'log'))
    durable.start()

    def take(answer: Answer) -> None:
        durable.take(answer)
        live.tell(answer)

    taken: list[Answer] = []
    for turn in range(1, settings.turns + 1):
        query = durable.ask(SceneObserved(turn, turn * 10**9, 'table', world.scene(turn))).query
        assert live.ask(world.scene(turn)).query == query
        if turn == 3:
            take(Answer('q1', 'c1', 'anna', Outcome.UNKNOWN, replaces=taken[0].answer_id))
        if turn == 5:
            # A person may be wrong in the correction, too.
            take(dataclasses.replace(taken[0], answer_id='c2', replaces='c1'))
        if query is not None:
            taken.append(TEACHER.answer(query, world.truth(turn)))
            take(taken[-1])
        if turn == 5:
            # After the turn, and for good.
            take(Answer('q2', 'c3', 'anna', Outcome.SKIP, replaces=taken[1].answer_id))
    durable.close()
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) == 0
    assert main(['replay', str(tmp_path / 'bag'), '--check']) == 0
    assert '7 decisions, all as recorded' in capsys.readouterr().out
    (recorded,) = read_episodes(tmp_path / 'bag')
    assert recorded.records == live.records
    replayed = [decision.features for decision in decisions_anew(recorded, feature_set)]
    assert len(replayed) == len(seen_live)
    for ours, theirs in zip(replayed, seen_live, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def damage(folder: Path, number: int) -> None:
    with sqlite3.connect(folder / DATABASE) as database:
        database.execute("UPDATE events SET content = X'00' WHERE number = ?", (number,))
    database.close()


def test_a_damaged_session_is_named_repaired_and_gone_on_with(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise damage would go unseen, or cost what is before it."""
    folder = tmp_path / 'log'
    write_session(folder, world)
    damage(folder, 9)
    exported = tmp_path / 'session.json'
    assert main(['session', str(folder), '--json', str(exported)]) == 1
    assert 'DAMAGED: event 9 is damaged' in capsys.readouterr().out
    part = json.loads(exported.read_text())
    assert 0 < len(part['accuracy']) == part['turns_over'] < 7
    assert 'event 9' in part['damage']
    assert main(['session', str(folder), '--repair']) == 1
    assert f'{folder}: repaired' in capsys.readouterr().out
    assert main(['session', str(folder), '--repair']) == 0
    assert 'nothing to repair' in capsys.readouterr().out
    write_again = durable_of(BEGUN, SessionLog(folder))
    write_again.start()
    assert write_again.episode.turn >= part['turns_over']
    write_again.close()


def test_a_session_that_leads_elsewhere_is_named(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise a log that this version does not reproduce would be shown as if it did."""
    write_session(tmp_path / 'log', world)
    found, _ = decoded(read_log(tmp_path / 'log'))
    others = dataclasses.replace(BEGUN.settings, strategy='rarest_demo', weights={})
    encoder = Encoder()
    with SessionLog(tmp_path / 'other') as log:
        for event in [dataclasses.replace(BEGUN, settings=others), *found[1:]]:
            log.append(encoder.encode(event))
    assert main(['session', str(tmp_path / 'other'), '--json', str(tmp_path / 'x.json')]) == 1
    assert 'does not follow from those before' in capsys.readouterr().out
    assert json.loads((tmp_path / 'x.json').read_text())['turns_over'] < 7


def test_accuracy_is_not_made_up(tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise a robot with perception of its own would be judged by a world that it never saw."""
    for name, given, reason in (
        ('none', None, 'the world was not simulated'),
        ('other', {**WORLD, 'seed': 5}, 'the scene of turn 1 is not that of the simulated world'),
        ('gone', {**WORLD, 'task': 'my_table'}, "unknown task 'my_table'"),
    ):
        write_session(tmp_path / name, world, started=dataclasses.replace(BEGUN, world=given))
        assert main(['session', str(tmp_path / name), '--json', str(tmp_path / 'x.json')]) == 0
        document = json.loads((tmp_path / 'x.json').read_text())
        assert (document['accuracy'], document['final_accuracy']) == ([], None)
        assert reason in document['no_accuracy_because']


def test_a_word_that_nobody_could_say_is_no_crash(tmp_path: Path, world: PerceivedWorld) -> None:
    """A task that lacks a symbol of the simulated table would end the export in a traceback."""
    durable = durable_of(
        dataclasses.replace(BEGUN, settings=dataclasses.replace(BEGUN.settings, symbols=TASK.symbols[1:])),
        SessionLog(tmp_path / 's'),
    )
    durable.start()
    ask(durable, world)
    durable.close()
    assert main(['session', str(tmp_path / 's'), '--json', str(tmp_path / 'x.json')]) == 0
    reason = json.loads((tmp_path / 'x.json').read_text())['no_accuracy_because']
    assert reason == f'the world has things of {TASK.symbols[0]}, which nobody could say'


@pytest.mark.parametrize('options', [[], ['--repair']])
def test_nothing_usable_ends_with_status_2_and_one_line(
    tmp_path: Path, options: list[str], refusal: Callable[..., str]
) -> None:
    """Otherwise a mistyped folder, or a log of which nothing is left, would end in a traceback."""
    (tmp_path / 'damaged').mkdir()
    (tmp_path / 'damaged' / DATABASE).write_bytes(b'nonsense' * 1000)
    SessionLog(tmp_path / 'empty').close()
    for name, reason in (
        ('nowhere', 'nowhere: does not exist'),
        ('damaged', 'nothing usable is in the session log (event 1 cannot be read'),
        ('empty', 'nothing usable is in the session log (no episode was begun)'),
    ):
        assert reason in refusal('session', tmp_path / name, *options)


def test_an_episode_in_which_nothing_could_be_chosen_is_no_demonstration(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise training would end with a traceback where nobody ever answered, or there was no budget."""
    started = dataclasses.replace(
        BEGUN, settings=dataclasses.replace(BEGUN.settings, strategy='farthest_fsq', weights={}, budget=0.0)
    )
    write_session(tmp_path / 'log', world, started=started)
    assert main(['session', str(tmp_path / 'log'), '--bag', str(tmp_path / 'bag')]) == 0
    assert main(['train_weights', str(tmp_path / 'bag'), '--out', str(tmp_path / 'w.yaml')]) == 2
    assert 'in no turn was there anything to choose' in capsys.readouterr().err


def test_what_was_said_to_matter_is_exported(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise nobody could work with it but in Python."""
    durable = start_durable(tmp_path / 'log', ask_what_matters, settings=WITH_RELEVANCE)
    ask(durable, world)
    first = answer(durable, world)
    durable.take(dataclasses.replace(first, content=(3, 1)))
    durable.take(dataclasses.replace(first, answer_id='late', teacher_id='bert', content=()))
    durable.close()
    command = ['session', str(tmp_path / 'log'), '--json', str(tmp_path / 'x.json'), '--csv', str(tmp_path / 'csv')]
    assert main(command) == 0
    assert 'Which of these things matter?' in ' '.join(capsys.readouterr().out.split())
    document = json.loads((tmp_path / 'x.json').read_text())
    assert document['queries'] == [
        {
            'turn': 1, 'kind': 'relevance', 'object_id': None, 'symbol': None, 'cost': 4.0, 'outcome': 'answered',
            'groups': [], 'objects': [3, 1],
        }
    ]  # fmt: skip
    assert document['costs']['relevance'] == 4.0
    said = list(csv.DictReader((tmp_path / 'csv' / 'answers.csv').open()))
    assert [(row['kind'], row['content'], row['status']) for row in said] == [
        ('relevance', '3,1', 'taken'), ('relevance', 'none', 'late'),
    ]  # fmt: skip
    (turn,) = csv.DictReader((tmp_path / 'csv' / 'turns.csv').open())
    assert (turn['kind'], turn['groups'], turn['relevant'], turn['outcome']) == ('relevance', '', '3,1', 'answered')
    assert int(turn['objects']) > 2


def test_a_bag_in_which_it_was_asked_what_matters_is_checked_and_learnt_from(
    tmp_path: Path, world: PerceivedWorld, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise a person's demonstration would be lost as soon as they used the question."""
    durable = start_durable(tmp_path / 'log', ask_what_matters, settings=WITH_RELEVANCE)
    play_turns(durable, world, WITH_RELEVANCE.turns)
    durable.close()
    bag, weights = tmp_path / 'bag', tmp_path / 'weights.yaml'
    assert main(['session', str(tmp_path / 'log'), '--bag', str(bag)]) == 0
    assert main(['replay', str(bag), '--check']) == 0
    assert main(['train_weights', str(bag), '--method', 'choice', '--out', str(weights)]) == 0
    assert weights.is_file()
    assert '6 turns' in ' '.join(capsys.readouterr().out.split())
