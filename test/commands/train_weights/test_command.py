"""`train_weights`: from bags to a file, the same twice, and each kind of unusable input."""

from __future__ import annotations

import dataclasses
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from al_questioner.bags import BagWriter, Topic, read_bag, read_episodes
from al_questioner.cli import main
from al_questioner.domain import DECISION_FEATURES, DEFAULT_CLASSIFIERS, Classifiers, InputError
from al_questioner.event_log.replay import first_divergence
from al_questioner.imitation.bags import decisions_anew, read_demonstrations
from al_questioner.imitation.demonstration import teacher_of
from al_questioner.imitation.max_entropy_irl import Iteration
from al_questioner.questioning import FEATURE_SETS
from al_questioner.simulation import WorldSpec, episode_settings, load_task, run_episode
from shared.checkout import ROOT

BAGS = [str(ROOT / 'bags' / f'expert_{number}') for number in range(3)]
SHIPPED = yaml.safe_load((ROOT / 'config' / 'weights' / 'dt_task_env.yaml').read_text())


def run(*arguments: object) -> int:
    return main(['train_weights', *map(str, arguments)])


def weights_of(path: Path) -> np.ndarray:
    return np.array([yaml.safe_load(path.read_text())['weights'][name] for name in DECISION_FEATURES])


def test_the_shipped_bags_are_demonstrations_of_the_training_scenario() -> None:
    """The paper's: prepare_lunch, budget 15, 30 turns, a change every 10; every class is asked about."""
    for demonstration in read_demonstrations([Path(bag) for bag in BAGS]):
        settings = demonstration.settings
        assert (demonstration.task_name, settings.budget, settings.turns) == ('prepare_lunch', 15, 30)
        assert demonstration.change_turns == (11, 21)
        assert len(demonstration.steps) == 30
        assert sum(query.cost for query in demonstration.queries) == 15
        assert {query.symbol for query in demonstration.queries} >= set(settings.symbols)
    assert all(sum(f.stat().st_size for f in Path(bag).iterdir()) < 2e6 for bag in BAGS)


@pytest.mark.parametrize('bag', BAGS, ids=lambda bag: Path(bag).name)
def test_the_shipped_bags_replay_to_the_same_decisions(bag: str) -> None:
    """Training learns from decisions that this software makes; another processor may round otherwise."""
    (episode,) = read_episodes(Path(bag))
    divergence = first_divergence(episode.started, episode.events)
    rounding = divergence and re.fullmatch(r'turn \d+: the (features|utilities) differ by up to (\S+)', divergence)
    assert divergence is None or (rounding and float(rounding[2]) < 1e-9)


def test_choices_train_quickly_and_the_same_twice(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise the same demonstrations would give another robot."""
    everything = sorted((ROOT / 'bags').iterdir())
    for name in 'ab':
        assert run(*everything, '--method', 'choice', '--out', tmp_path / f'{name}.yaml') == 0
    assert (tmp_path / 'a.yaml').read_text() == (tmp_path / 'b.yaml').read_text()
    assert (tmp_path / 'a.png').stat().st_size > 10_000
    output = capsys.readouterr().out
    assert 'README.md is passed over' in output
    assert '3 demonstrations, 90 turns' in output
    assert 'not identified: remaining_time' in output
    assert "in the expert's states the best candidate is 49 questions; the expert asked 42" in output


def test_what_the_learner_asks_by_itself_is_told_for_both_classifiers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It asks as much as the expert in the expert's states, and hardly anything where it leads itself."""
    bags = [Path(bag) for bag in BAGS]
    assert run(*bags, '--method', 'choice', '--out', tmp_path / 'w.yaml') == 0
    output = capsys.readouterr().out
    earlier, usual = Classifiers(4.0, 'rbf', 0.0), DEFAULT_CLASSIFIERS
    assert f'3 of 3 demonstrations played with {earlier}; learners have {usual} unless told otherwise' in output
    found = re.search(
        rf'asks (\d+) questions? with {earlier}, .*, and (\d+) questions? with {usual}, as learners', output
    )
    assert found is not None
    weights, asked = yaml.safe_load((tmp_path / 'w.yaml').read_text())['weights'], []
    for classifiers in (earlier, usual):
        asked.append(0)
        for shown in read_demonstrations(bags):
            settings = dataclasses.replace(shown.settings, strategy='dt_task_env', weights=weights)
            settings = dataclasses.replace(settings, **classifiers._asdict())
            asked[-1] += len(run_episode(shown.world_spec, settings, teacher_of(shown.world_spec)).queries)
    assert [int(count) for count in found.groups()] == asked
    assert asked[1] < 21 < asked[0]
    assert f'with these weights it hardly asks (with {usual}, as learners have unless told otherwise)' in output


def test_other_classifiers_see_the_same_choices(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Old demonstrations teach today's learners: the expert's choices stay, and the features are what those see."""
    path, wanted = Path(BAGS[0]), Classifiers(100.0, 'rbf', 0.0)
    (recorded,) = read_demonstrations([path])
    (again,) = read_demonstrations([path], classifiers={'amplitude': wanted.amplitude})
    assert again.settings.classifiers == wanted
    assert dataclasses.replace(again.settings, amplitude=4.0) == recorded.settings
    assert [step.actions for step in again.steps] == [step.actions for step in recorded.steps]
    assert [step.chosen for step in again.steps] == [step.chosen for step in recorded.steps]
    assert again.queries == recorded.queries
    # What does not depend on beliefs is the same: class uniformity is nearly so, as it is expected over them.
    for now, then in zip(again.steps, recorded.steps, strict=True):
        np.testing.assert_allclose(now.features[:, 4:], then.features[:, 4:], atol=1e-6)
    discriminability = [float(np.mean([step.features[:, 0].max() for step in d.steps])) for d in (recorded, again)]
    assert discriminability[1] > discriminability[0] + 0.05, 'labels are trusted more'
    arguments = ['--method', 'choice', '--amplitude', 100, '--kernel-shape', 'grouped', '--class-balance', 0.5]
    assert run(*BAGS, *arguments, '--out', tmp_path / 'w.yaml') == 0
    output = capsys.readouterr().out
    assert 'WARNING: 3 of 3' not in output, 'they are those of learners'
    assert f'with {DEFAULT_CLASSIFIERS}, as it was trained; the expert asked 42' in output
    settings = yaml.safe_load((tmp_path / 'w.yaml').read_text())['training']['settings']
    assert settings['classifiers'] == [DEFAULT_CLASSIFIERS._asdict()]


def test_classifiers_as_recorded_change_nothing(tmp_path: Path) -> None:
    """To name what the bags have anyway gives the same weights as to name nothing."""
    arguments = ['--method', 'choice', '--out']
    assert run(*BAGS, *arguments, tmp_path / 'a.yaml') == 0
    assert run(*BAGS, '--amplitude', 4, '--class-balance', 0, *arguments, tmp_path / 'b.yaml') == 0
    assert (tmp_path / 'a.yaml').read_text() == (tmp_path / 'b.yaml').read_text()


def test_weights_with_which_nothing_is_asked_are_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a gap that is closed on the average of rollouts would hide a learner that never asks."""
    arguments = ['--strategy', 'value_per_cost', '--method', 'choice', '--out', tmp_path / 'w.yaml']
    assert run(*sorted((ROOT / 'bags').glob('expert_*')), *arguments) == 0
    assert 'with these weights it hardly asks' in capsys.readouterr().out


def test_bags_tell_what_was_not_recorded(tmp_path: Path) -> None:
    """The features of value_per_cost are computed from what the expert knew in each turn: playing it again finds it."""
    path, feature_set = Path(BAGS[0]), FEATURE_SETS['value_per_cost']
    (replayed,), (recorded,) = read_demonstrations([path], feature_set), read_demonstrations([path])
    assert all(set(now.actions) <= set(then.actions) for now, then in zip(replayed.steps, recorded.steps, strict=True))
    chosen = [[step.actions[step.chosen] for step in steps] for steps in (replayed.steps, recorded.steps)]
    assert chosen[0] == chosen[1]
    (episode,) = read_episodes(path)
    again = [decision.features for decision in decisions_anew(episode, FEATURE_SETS['dt_task_env'])]
    for ours, turn in zip(again, episode.turns, strict=True):
        np.testing.assert_allclose(ours, turn.decision.features, atol=1e-6)
    assert run(BAGS[0], '--strategy', 'value_per_cost', '--method', 'choice', '--out', tmp_path / 'w.yaml') == 0
    assert set(yaml.safe_load((tmp_path / 'w.yaml').read_text())['weights']) == set(feature_set.names)


def test_the_way_is_told_to_a_pipe_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise minutes would pass without a sign of life in the log of a batch job."""

    def train(demonstrations: object, settings: object, watch: Callable[[int, Iteration], None]) -> None:
        for number in range(1, 13):
            watch(number, Iteration(np.zeros(2), np.array([3.0, 4.0]) / number, np.array([0.0, 1.0])))
        raise InputError('that is enough')

    monkeypatch.setattr('al_questioner.commands.train_weights.command.train', train)
    for bags, validation in ((BAGS[:2], ', validation 1.00'), (BAGS[:1], '')):
        assert run(*bags, '--validation', 1, '--out', tmp_path / 'w.yaml') == 2
        output = capsys.readouterr().out
        assert [line for line in output.splitlines() if line.startswith('iteration')] == [
            f'iteration 5, at most 100: gap 1.00{validation}',
            f'iteration 10, at most 100: gap 0.50{validation}',
        ]
        assert output.startswith('no demonstration is held out') is not bool(validation)


@pytest.mark.slow
def test_rollouts_train_the_same_twice(tmp_path: Path) -> None:
    """The seed determines the result."""
    short = ['--iterations', 2, '--rollouts', 2]
    for name, jobs in (('a', 1), ('b', 2)):
        assert run(BAGS[0], *short, '--jobs', jobs, '--out', tmp_path / f'{name}.yaml') == 0
    assert (tmp_path / 'a.yaml').read_text() == (tmp_path / 'b.yaml').read_text()
    assert run(BAGS[0], *short, '--seed', 1, '--out', tmp_path / 'c.yaml') == 0
    assert not np.array_equal(weights_of(tmp_path / 'a.yaml'), weights_of(tmp_path / 'c.yaml'))


@pytest.mark.slow
@pytest.mark.skipif(
    cv2.__version__ < '5',
    reason='the weights were learnt on tables that OpenCV 5 drew, see docs/explanation/simulation.md',
)
def test_the_shipped_weights_are_learnt_from_the_shipped_bags(tmp_path: Path) -> None:
    """Otherwise nobody could tell where the default questioner comes from."""
    learners = ['--amplitude', 100, '--kernel-shape', 'grouped', '--class-balance', 0.5]
    assert run(*BAGS, *learners, '--out', tmp_path / 'w.yaml') == 0
    found = yaml.safe_load((tmp_path / 'w.yaml').read_text())
    for member in ('bags', 'settings'):
        assert found['training'][member] == SHIPPED['training'][member]
    np.testing.assert_allclose(
        weights_of(tmp_path / 'w.yaml'), [SHIPPED['weights'][name] for name in DECISION_FEATURES], atol=0.01
    )


def no_metadata(bag: Path) -> None:
    (bag / 'metadata.yaml').unlink()


def truncated(bag: Path) -> None:
    (file,) = bag.glob('*.mcap')
    file.write_bytes(file.read_bytes()[:-5000])


@pytest.mark.parametrize(
    ('damage', 'reason'), [(no_metadata, r'metadata\.yaml is missing'), (truncated, r'cannot be read \(')]
)
def test_broken_bags_end_with_status_2_and_one_line(tmp_path: Path, refusal, damage, reason: str) -> None:
    """The line says which bag is broken and what to do; repaired, it trains."""
    bag = tmp_path / 'expert_0'
    shutil.copytree(BAGS[0], bag)
    damage(bag)
    out = tmp_path / 'w.yaml'
    assert re.search(reason, refusal('train_weights', bag, '--method', 'choice', '--out', out))
    assert not out.exists()
    assert not out.with_suffix('.png').exists()
    assert main(['record', '--repair', str(bag)]) == 0
    assert run(bag, '--method', 'choice', '--out', out) == 0


def test_unusable_arguments_end_with_status_2_and_one_line(tmp_path: Path, refusal) -> None:
    """Otherwise a typing error would cost minutes, or a traceback be all that comes of it."""
    empty = tmp_path / 'empty'
    empty.mkdir()
    out, old = tmp_path / 'w.yaml', tmp_path / 'old.bag'
    old.write_bytes(b'#ROSBAG V2.0\n')
    for arguments, reason in (
        ([empty, '--out', out], 'is no bag'),
        ([BAGS[0], '--out', out, '--picture', 'w.xyz'], "must end in .png, .pdf, .svg, not 'w.xyz'"),
        ([tmp_path / 'missing', '--out', out], 'there is no such bag'),
        ([BAGS[0], '--out', out, '--method', 'magic'], 'invalid choice'),
        ([BAGS[0], '--out', out, '--rollouts', '1'], 'must be at least 2'),
        ([BAGS[0], '--out', out, '--iterations', '1'], 'must be at least 2'),
        ([BAGS[0], BAGS[0], '--out', out], 'a bag is named twice'),
        ([BAGS[0], '--out', tmp_path / 'w.png'], 'cannot be the weights and the picture'),
        ([BAGS[0], '--out', out, '--ridge', 'nan'], 'must be at least 0'),
        ([BAGS[0], '--out', out, '--amplitude', 0], 'argument --amplitude: must be at least 0.001'),
        ([BAGS[0], '--out', out, '--kernel-shape', 'matern'], 'argument --kernel-shape: invalid choice'),
        ([BAGS[0], old, '--out', out], 'old.bag: is a bag of ROS 1'),
        (['--out', out], 'required: BAG'),
        ([BAGS[0]], 'required: --out'),
    ):
        assert reason in refusal('train_weights', *arguments)


@pytest.mark.parametrize(
    'again',
    [
        lambda bag, made: shutil.copytree(bag, made),
        lambda bag, made: made.symlink_to(bag),
        lambda bag, made: write_anew(bag, made, 'mcap'),
        lambda bag, made: write_anew(bag, made, 'sqlite3'),
        lambda bag, made: write_anew(bag, made, 'mcap', namespace='/elsewhere', later=3600 * 10**9),
        lambda bag, made: write_anew(bag, made, 'mcap', end=100),
    ],
    ids=['copy', 'link', 'written again', 'other storage', 'other names and times', 'ended earlier'],
)
def test_the_same_episode_twice_is_refused(tmp_path: Path, refusal, again) -> None:
    """Otherwise it would count as two demonstrations, and judge what was learnt from itself."""
    made = tmp_path / 'again'
    again(Path(BAGS[0]), made)
    for bags in ([BAGS[0], made], [made, BAGS[1], BAGS[0]]):
        error = refusal('train_weights', *bags, '--method', 'choice', '--out', tmp_path / 'w.yaml')
        assert 'holds the same episode as' in error or 'a bag is named twice' in error
    assert not (tmp_path / 'w.yaml').exists()


def write_anew(
    bag: Path, made: Path, storage: str, namespace: str = '/r', later: int = 0, end: int | None = None
) -> None:
    """The messages of a bag, or the first of them, in another one."""
    recorded = read_bag(bag)
    names = {topic.name: f'{namespace}/{topic.name.rpartition("/")[2]}' for topic in recorded.topics}
    topics = [dataclasses.replace(topic, name=names[topic.name]) for topic in recorded.topics]
    with BagWriter(made, topics, storage) as writer:
        for message in recorded.messages[:end]:
            writer.write(names[message.topic], message.data, message.stamp + later)


def test_a_recording_that_is_cut_short_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise half of an episode would be taken for the whole of it, by who checks it and by who learns from it."""
    recorded = read_bag(Path(BAGS[0])).messages
    ends = [at for at, message in enumerate(recorded) if message.topic.endswith('/turn')]
    write_anew(Path(BAGS[0]), tmp_path / 'b', 'mcap', end=ends[14])
    (episode,) = read_episodes(tmp_path / 'b')
    played = len(episode.turns)
    assert 10 < played < 30
    assert main(['replay', str(tmp_path / 'b'), '--check']) == 0
    assert f': {played} of 30 turns, all as recorded\n' in capsys.readouterr().out
    assert run(tmp_path / 'b', '--method', 'choice', '--out', tmp_path / 'w.yaml') == 0
    assert f'1 demonstration, {played} of 30 turns\n' in capsys.readouterr().out


def test_what_is_left_out_of_a_bag_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise somebody would believe that both episodes of a bag were learnt from."""
    messages = [*read_bag(Path(BAGS[0])).messages, *read_bag(Path(BAGS[1])).messages]
    topics = {message.topic: Topic(message.topic, message.type, True) for message in messages}
    lost = next(message for message in messages if message.topic.endswith('/decision'))
    with BagWriter(tmp_path / 'b', list(topics.values())) as writer:
        for message in messages:
            if message is not lost:
                writer.write(message.topic, message.data, message.stamp)
    arguments = ['--method', 'choice', '--validation', 0, '--out', tmp_path / 'w.yaml']
    assert run(tmp_path / 'b', *arguments) == 0
    output = capsys.readouterr().out
    assert 'WARNING: ' in output
    assert 'is left out: turn 1 of 30 was recorded without its decision' in output
    assert '1 demonstration, 30 turns' in output


def test_only_weights_are_overwritten_and_by_a_whole_training(tmp_path: Path, refusal) -> None:
    """Otherwise a bag would lose its metadata to a mistyped --out; a broken one cost the weights that are in use."""
    bag = shutil.copytree(BAGS[0], tmp_path / 'bag')
    before = (bag / 'metadata.yaml').read_bytes()
    error = refusal('train_weights', bag, '--method', 'choice', '--out', bag / 'metadata.yaml')
    assert 'metadata.yaml exists and is no weights file' in error
    assert (bag / 'metadata.yaml').read_bytes() == before
    assert not (bag / 'metadata.png').exists()
    (tmp_path / 'w.yaml').write_text('weights: {discriminability: 1.0}')
    assert run(tmp_path, '--out', tmp_path / 'w.yaml') == 2
    assert (tmp_path / 'w.yaml').read_text() == 'weights: {discriminability: 1.0}'
    assert run(bag, '--method', 'choice', '--out', tmp_path / 'w.yaml', '--validation', 0) == 0
    assert len(weights_of(tmp_path / 'w.yaml')) == len(DECISION_FEATURES)


@pytest.mark.parametrize(
    ('budget', 'turns', 'least', 'latest'),
    [(15, 30, 11, 26), (25, 40, 18, 36), pytest.param(500, 150, 100, 150, marks=pytest.mark.slow)],
)
def test_the_shipped_weights_ask_as_the_documentation_says(budget: int, turns: int, least: int, latest: int) -> None:
    """The default questioner does not spend its budget at once, and asks where it may ask as much as it likes."""
    world_spec = WorldSpec(load_task('prepare_lunch'), 1, 1)
    settings = episode_settings(world_spec.task, 'dt_task_env', budget, turns)
    result = run_episode(world_spec, settings, teacher_of(world_spec))
    assert len(result.queries) >= least
    assert result.spent <= budget
    assert max(query.turn for query in result.queries) >= latest
