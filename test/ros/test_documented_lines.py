"""Every `ros2` line of README and docs: who must be able to run it, and that they are.

The genuine tools are not on PyPI. Their options are those of ros2cli 0.32 and launch 3.4, which Jazzy has; a user with
a ROS installation runs the lines that are marked as theirs. A new line in the documentation is to be added here.
"""

from __future__ import annotations

import contextlib
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from rclpy.context import Context

from al_questioner.bags import read_bag
from al_questioner.bags.playback import Playback
from al_questioner.commands.replay.arguments import parse as parse_replay
from al_questioner.commands.train_weights.arguments import parser as training_parser
from al_questioner.domain import DEFAULT_CLASSIFIERS, Knowledge
from al_questioner.messages.concepts_file import write_concepts
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recogniser import RecogniserNode
from al_questioner.ros.nodes.recorder import RecorderNode
from al_questioner.ros.nodes.replayer import ReplayNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.simulation import PerceivedWorld, load_task
from shared.checkout import ROOT
from shared.durable_sessions import play_turns, start_durable
from shared.lunches import WORLD_SPEC

DOCUMENTS = (ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').rglob('*.md')))
DEADLINE = 90.0

NODE = 'ours: a node that stays up'
ENDS = 'ours: ends by itself'
GENUINE = 'the genuine tools: to be run in a ROS installation'
ELSEWHERE = 'ours: needs a package of the user, as test_plug_ins.py has it'
PATTERN = 'no command: a letter stands for what is meant'

LINES = {
    'ros2 launch al_questioner demo.launch.py': GENUINE,
    'ros2 launch al_questioner demo.launch.py --show-args': GENUINE,
    'ros2 launch al_questioner demo.launch.py perception:=none teacher:=none use_sim_time:=true': GENUINE,
    'ros2 launch al_questioner demo.launch.py recognise:=true show:=foxglove': GENUINE,
    'ros2 launch al_questioner demo.launch.py recognise:=true show:=rviz': GENUINE,
    'ros2 launch al_questioner demo.launch.py task:=prepare_lunch strategy:=dt_task_env bag:=my_bag': GENUINE,
    'ros2 run al_questioner X': PATTERN,
    'ros2 run al_questioner learner --ros-args -p concepts:=monday.json -p save_concepts:=tuesday.json': NODE,
    'ros2 run al_questioner learner --ros-args -p save_concepts:=monday.json': NODE,
    'ros2 run al_questioner learner --ros-args -p session:=my_session': NODE,
    'ros2 run al_questioner learner --ros-args -p strategy:=dt_task_env -p weights_file:=my_weights.yaml': NODE,
    'ros2 run al_questioner learner --ros-args -p strategy:=human -p wait_for_recorder:=true': NODE,
    'ros2 run al_questioner learner --ros-args -p strategy:=smallest_margin': ELSEWHERE,
    'ros2 run al_questioner learner --ros-args -p task:=/path/to/table.yaml -p budget:=20.0 -p turns:=60': NODE,
    'ros2 run al_questioner learner --ros-args -p task:=kitchen_table -p budget:=25 -p turns:=40': NODE,
    'ros2 run al_questioner learner --ros-args -p task:=prepare_lunch -p seed:=7 -p strategy:=human -p budget:=15.0'
    ' -p turns:=30 -p wait_for_recorder:=true': NODE,
    'ros2 run al_questioner learner --ros-args -r __ns:=/second -p task:=prepare_lunch -p seed:=0'
    ' -p strategy:=farthest_fsq -p budget:=12.0 -p turns:=30': NODE,
    'ros2 run al_questioner perception --ros-args -p task:=kitchen_table': NODE,
    'ros2 run al_questioner perception --ros-args -p task:=prepare_lunch -p seed:=7': NODE,
    'ros2 run al_questioner recognise': NODE,
    'ros2 run al_questioner recognise --ros-args -p concepts:=monday.json': NODE,
    'ros2 run al_questioner recognise --ros-args -p session:=monday -p threshold:=0.7': NODE,
    'ros2 run al_questioner record --repair my_demonstration': ENDS,
    'ros2 run al_questioner record --ros-args -p bag:=demonstration_1': NODE,
    'ros2 run al_questioner record --ros-args -p bag:=my_demonstration': NODE,
    'ros2 run al_questioner record --ros-args -p bag:=my_way_1 -p until_done:=true': NODE,
    'ros2 run al_questioner replay expert_0': NODE,
    'ros2 run al_questioner replay expert_0 --as-perception --ros-args -r __ns:=/second': NODE,
    'ros2 run al_questioner replay expert_0 --start-paused --ros-args -r __ns:=/past': NODE,
    'ros2 run al_questioner replay demonstration_1': NODE,
    'ros2 run al_questioner teacher --ros-args -p mode:=terminal': NODE,
    'ros2 run al_questioner teacher --ros-args -p task:=kitchen_table': NODE,
    'ros2 run al_questioner teacher --ros-args -p task:=prepare_lunch -p seed:=7': NODE,
    'ros2 run al_questioner teacher --ros-args -r __ns:=/second -p task:=prepare_lunch -p seed:=0': NODE,
    'ros2 run al_questioner train_weights expert_0 expert_1 expert_2 --amplitude 100 --kernel-shape grouped'
    ' --class-balance 0.5 --out my_weights.yaml': ENDS,
    'ros2 run al_questioner train_weights demonstration_* --method choice --out my_weights.yaml': ENDS,
    'ros2 run rviz2 rviz2 -d config/rviz/al_questioner.rviz': GENUINE,
    'ros2 run tf2_ros static_transform_publisher --frame-id world --child-frame-id table': GENUINE,
    'ros2 topic echo --full-length --field data target_info': GENUINE,
    'ros2 topic echo --once --full-length --field data query': GENUINE,
    'ros2 topic pub --once answer std_msgs/msg/String "data: \'snack\'"': GENUINE,
    'ros2 topic pub --once want std_msgs/msg/String "data: \'snack\'"': GENUINE,
}

ALWAYS_NODES = {'learner': LearnerNode, 'perception': PerceptionNode, 'recognise': RecogniserNode}

LONGEST_TRAINING = 900.0
"""Seconds after which learning weights has failed."""

OPTIONS = {
    'run rviz2 rviz2': {'-d', '--display-config', '-f', '--fixed-frame', '--fullscreen'},
    'run tf2_ros static_transform_publisher': {'--frame-id', '--child-frame-id', '--x', '--y', '--z'},
    'topic echo': {'--once', '--full-length', '--field', '--csv', '--timeout', '--no-arr', '--flow-style'},
    'topic pub': {'--once', '--rate', '--times', '--wait-matching-subscriptions', '--keep-alive', '--qos-reliability'},
    'launch': {'--show-args', '--print', '--debug', '--noninteractive', '--launch-prefix'},
}
"""Of the genuine tools, those that a line may use. `topic echo` asks for best effort with any `--qos-` option."""

OWN_LINES = [line for line, who in LINES.items() if who in (NODE, ENDS)]


def documented() -> Iterator[tuple[str, str]]:
    """Every command that begins with ros2, or is fed to one that does, and where it stands."""
    for path in DOCUMENTS:
        text = path.read_text(encoding='utf-8').replace('\\\n', ' ')
        blocks = re.findall(r'^```bash\n(.*?)^```', text, flags=re.DOTALL | re.MULTILINE)
        prose = re.sub(r'^```.*?^```', '', text, flags=re.DOTALL | re.MULTILINE)
        # A name such as `ros2 launch` is no line.
        inline = [code for code in re.findall(r'`(ros2 [^`]+)`', prose) if len(code.split()) > 3]
        for line in [*(line for block in blocks for line in block.splitlines()), *inline]:
            command = re.sub(r'\s+#\s.*', '', line).rsplit(' | ', 1)[-1].removesuffix(' &').strip()
            if command.startswith('ros2 '):
                yield ' '.join(command.split()), path.name


def test_every_documented_line_is_listed_and_every_listed_one_documented() -> None:
    """Otherwise a line that nobody has ever run would be what people copy first."""
    found = dict(documented())
    assert {line: place for line, place in found.items() if line not in LINES} == {}
    assert [line for line in LINES if line not in found] == []


@pytest.mark.parametrize('line', [line for line, who in LINES.items() if who == GENUINE])
def test_the_genuine_tools_have_the_options_that_a_line_uses(line: str) -> None:
    """Otherwise it would end in the tool's usage, or show nothing."""
    words = shlex.split(line)[1:]
    verb = next(verb for verb in OPTIONS if words[: len(verb.split())] == verb.split())
    assert {word for word in words if word.startswith('-')} <= OPTIONS[verb]
    if verb == 'launch':
        source = (ROOT / 'launch' / words[2]).read_text()
        for word in words[3:]:
            assert word.startswith('-') or f"'{word.split(':=')[0]}'" in source
    elif verb == 'topic pub':
        assert words[-2] == 'std_msgs/msg/String'


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with what the documentation says that the user has by then."""
    shutil.copytree(ROOT / 'bags' / 'expert_0', tmp_path / 'demonstration_1')
    shutil.copytree(ROOT / 'bags' / 'expert_0', tmp_path / 'my_demonstration')
    (tmp_path / 'bags').symlink_to(ROOT / 'bags')
    shutil.copy(ROOT / 'config' / 'weights' / 'dt_task_env.yaml', tmp_path / 'my_weights.yaml')
    known = Knowledge(load_task('prepare_lunch').symbols, ('size_height',), DEFAULT_CLASSIFIERS)
    write_concepts(tmp_path / 'monday.json', known)
    with contextlib.closing(start_durable(tmp_path / 'monday')) as session:
        play_turns(session, PerceivedWorld(WORLD_SPEC.open()), 2)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def as_here(line: str) -> str:
    """A line with what it writes not there yet, and a file in the place of one that only stands for any."""
    for name in ('demonstration_1', 'my_demonstration'):
        if f'bag:={name}' in line:
            shutil.rmtree(name)
    return line.replace('/path/to/table.yaml', f'{ROOT}/docs/examples/blobs.yaml')


def arguments_of(line: str) -> tuple[str, list[str], list[str]]:
    """Executable, its own arguments, and those of ROS."""
    _, _, _, executable, *rest = shlex.split(as_here(line))
    at = rest.index('--ros-args') if '--ros-args' in rest else len(rest)
    return executable, rest[:at], rest[at:]


def make_node(executable: str, own: list[str], **arguments: Any) -> QuestionerNode | None:
    """The node of an executable; None for one that is none, whose arguments are parsed alone."""
    if executable in ALWAYS_NODES:
        return ALWAYS_NODES[executable](**arguments)
    if executable == 'teacher':
        return TeacherNode(lambda session, ended: ended.wait(), **arguments)
    if executable == 'record' and not own:
        return RecorderNode(**arguments)
    if executable == 'replay':
        given = parse_replay(own)
        bag = read_bag(given.bag)
        return ReplayNode(bag, Playback(bag.messages, given.rate), 5.0, given.clock, **arguments)
    if executable == 'train_weights':
        training_parser().parse_args(own)
    return None


@pytest.mark.usefixtures('workplace')
@pytest.mark.parametrize('line', OWN_LINES)
def test_our_lines_are_taken_as_they_stand(line: str) -> None:
    """A parameter that was renamed would live on in the documentation."""
    executable, own, ros = arguments_of(line)
    context = Context()
    context.init(args=ros, domain_id=1 + os.getpid() % 100)
    try:
        node = make_node(executable, own, context=context)
        if node is not None:
            node.destroy_node()
    finally:
        context.try_shutdown()


@pytest.mark.slow
@pytest.mark.usefixtures('workplace')
@pytest.mark.parametrize('line', OWN_LINES)
@pytest.mark.timeout(1200)
def test_our_lines_run_as_they_stand(line: str, processes: Any) -> None:
    """A line that is accepted must not end at once either."""
    command = as_here(line).replace('ros2 run al_questioner', f'exec {shlex.quote(sys.executable)} -m al_questioner')
    process = processes.start('line', ['sh', '-c', command])
    if LINES[line] == ENDS:
        # Weights are learnt for a minute and more, on a busy machine for several.
        assert process.wait(LONGEST_TRAINING if ' train_weights ' in line else DEADLINE) == 0, processes.log('line')
        return
    end = time.monotonic() + DEADLINE
    while not re.search(r'is up|recording to|messages, |scenes of ', processes.log('line')):
        assert process.poll() in (None, 0), processes.log('line')
        assert time.monotonic() < end, processes.log('line')
        time.sleep(0.05)
