"""One learning episode as a graph: perception, learner, the scripted teacher, and a recorder if there is to be a bag.

    ros2 launch al_questioner demo.launch.py strategy:=dt_task_env bag:=my_bag
    ros2 launch al_questioner demo.launch.py perception:=none teacher:=none    # on a robot, taught by a person
    ros2 launch al_questioner demo.launch.py recognise:=true show:=rviz    # with what each thing is taken for, in RViz

A person who wants to teach answers on the topic `answer`, or runs the teacher in a terminal, which launch does not
give: see docs/how_to/answer_questions.md.
"""

from __future__ import annotations

import sys
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.events.process import ProcessExited
from launch_ros.actions import Node

from al_questioner.protocol.topics import TOPICS
from al_questioner.ros.settings import LEARNER_SETTINGS, WORLD_SETTINGS
from al_questioner.simulation.world_spec import TASK

PACKAGE = 'al_questioner'
FILE_NAME = 'demo.launch.py'
TRUTH = {'true': True, '1': True, 'false': False, '0': False}

WORLD_ARGUMENTS = ('dataset', 'seed')
LEARNER_ARGUMENTS = ('strategy', 'budget', 'turns', 'turn_period', 'session', 'concepts', 'save_concepts')
SETTINGS = {setting.name: setting for setting in (*WORLD_SETTINGS, *LEARNER_SETTINGS)}
CHOICES = {
    'perception': (('simulated', 'none'), 'who shows objects: the simulated table, or none of these nodes'),
    'teacher': (('scripted', 'none'), 'who answers: the script, or none of these nodes'),
}
SHOWN = {'none': '', 'rviz': 'rviz2', 'foxglove': 'foxglove_bridge'}
"""Package of what shows the table; each has an executable of its own name."""
TRANSFORM = ('--frame-id', 'world', '--child-frame-id', 'table')


def given(context: LaunchContext, arguments: tuple[str, ...]) -> dict[str, str | int | float | bool]:
    """The parameters that the user set on the command line; all others keep their value in the parameter file.

    Raises:
        ValueError: a value that is no number where one is expected.
    """
    parameters = {}
    for name in arguments:
        text, kind = context.launch_configurations[name], type(SETTINGS[name].default)
        if text:
            try:
                parameters[name] = kind(text)
            except ValueError:
                raise ValueError(f'launch argument {name} must be of type {kind.__name__}, not {text!r}') from None
    return parameters


def one_of(context: LaunchContext, name: str, values: tuple[str, ...]) -> str:
    """The value of an argument that has few.

    Raises:
        ValueError: another value.
    """
    value = context.launch_configurations[name]
    if value.lower() not in values:
        raise ValueError(f'launch argument {name} must be one of {", ".join(values)}, not {value!r}')
    return value.lower()


def parameter_files(context: LaunchContext) -> list[str]:
    """The file that the user names, or the one that ships for the task, if there is one.

    Raises:
        ValueError: the user's file does not exist.
    """
    chosen, task = (context.launch_configurations[name] for name in ('params_file', 'task'))
    if chosen:
        if not Path(chosen).expanduser().is_file():
            raise ValueError(f'launch argument params_file: {chosen!r} is no file')
        return [str(Path(chosen).expanduser())]
    shipped = Path(get_package_share_directory(PACKAGE), 'config', 'params', f'{task}.yaml')
    return [str(shipped)] if shipped.is_file() and '/' not in task else []


def is_installed(package: str) -> bool:
    """Return whether ROS finds a package."""
    try:
        get_package_share_directory(package)
    except PackageNotFoundError:
        return False
    return True


def viewers(context: LaunchContext, namespace: str) -> list[Node]:
    """Return the nodes that show the table, and tell the place of the simulated one in the world.

    Raises:
        ValueError: it is not installed.
    """
    name = one_of(context, 'show', tuple(SHOWN))
    package = SHOWN[name]
    if not package:
        return []
    if not is_installed(package):
        raise ValueError(f'launch argument show: the package {package} is not installed')
    options = {}
    if name == 'rviz':
        file = Path(get_package_share_directory(PACKAGE), 'config', 'rviz', f'{PACKAGE}.rviz')
        # The file has absolute names; these follow the namespace.
        names = [(f'/{topic}', topic) for topic in TOPICS if not topic.startswith('/')]
        options = {'namespace': namespace, 'arguments': ['-d', str(file)], 'remappings': names}
    found = [Node(package=package, executable=package, name=package, output='screen', **options)]
    if one_of(context, 'perception', CHOICES['perception'][0]) == 'simulated' and is_installed('tf2_ros'):
        executable = 'static_transform_publisher'
        found.append(Node(package='tf2_ros', executable=executable, name='table_in_world', arguments=[*TRANSFORM]))
    return found


def nodes(context: LaunchContext) -> list[Node]:
    """The nodes; they stay up after the episode, until Ctrl-C, or until the learner ends if it is to end them."""
    # Name and namespace are both given: only then do these parameters prevail over a file's entries for a single node.
    namespace, bag = (context.launch_configurations[name] for name in ('namespace', 'bag'))
    files = parameter_files(context)
    common = {'task': context.launch_configurations['task'], **given(context, WORLD_ARGUMENTS)}
    if context.launch_configurations['use_sim_time']:
        common['use_sim_time'] = TRUTH[one_of(context, 'use_sim_time', tuple(TRUTH))]
    if bag:
        common['wait_for_recorder'] = True
    ends_all = TRUTH[one_of(context, 'end_with_learner', tuple(TRUTH))]

    def end(event: ProcessExited, context: LaunchContext) -> Shutdown | None:
        """Have `ros2 launch` end with another status than 0 if the learner failed, now or when the user ends it."""
        reason = f'the learner has ended with status {event.returncode}'
        if event.returncode and not context.is_shutdown:
            context.asyncio_loop.call_exception_handler({'message': reason})
        return Shutdown(reason=reason) if ends_all else None

    def node(executable: str, parameters: dict[str, str | int | float | bool], **options: object) -> Node:
        return Node(
            package=PACKAGE,
            executable=executable,
            namespace=namespace,
            parameters=[*files, parameters],
            output='screen',
            **{'name': executable, **options},
        )

    # Recorder and recogniser have the world of nobody, but may share the others' clock.
    clock = {name: common[name] for name in ('use_sim_time',) if name in common}
    recognises = TRUTH[one_of(context, 'recognise', tuple(TRUTH))]
    # Whatever the learner begins with, or is written down: it is the learner that is followed.
    follower = {'concepts': '', 'session': '', **clock}
    simulated = [name for name in CHOICES if one_of(context, name, CHOICES[name][0]) != 'none']
    return [
        *([node('record', {'bag': bag, **clock}, name='recorder')] if bag else []),
        *(node(name, common) for name in simulated),
        node('learner', {**common, **given(context, LEARNER_ARGUMENTS)}, on_exit=end),
        *([node('recognise', follower, name='recogniser')] if recognises else []),
        *viewers(context, namespace),
    ]


def _names_this_file(before: str | None, word: str) -> bool:
    """Return whether a word of a command line, given the one before it, stands for this very file."""
    path = Path(word)
    return path.name == FILE_NAME and (before == 'al_questioner' or path.resolve() == Path(__file__).resolve())


def generate_launch_description() -> LaunchDescription:
    """Return what `ros2 launch al_questioner demo.launch.py` starts."""
    # Who includes this file has a robot to run, whose end is not for the learner to say.
    is_included = not any(map(_names_this_file, [None, *sys.argv], sys.argv))
    parameters = [SETTINGS[name] for name in (*WORLD_ARGUMENTS, *LEARNER_ARGUMENTS)]
    optional = {'use_sim_time': 'whether time comes from /clock', **{each.name: each.explained for each in parameters}}
    texts = {
        'task': (TASK.default, f'{TASK.description}; config/params/TASK.yaml is used if there is one'),
        'namespace': ('', 'namespace of the graph, within that of who includes this file; for several robots'),
        'params_file': ('', "parameter file in the place of the task's; empty: config/params/TASK.yaml"),
        'bag': ('', 'where a recorder beside the nodes writes a new bag; empty: no recorder'),
        'end_with_learner': (
            'false' if is_included else 'true',
            'whether all ends when the learner does; by default not where another launch file includes this one',
        ),
        'recognise': ('false', 'whether a recogniser tells what each thing is taken for, by what the learner knows'),
        'show': ('none', f'what shows the table, with the files in config: {" or ".join(SHOWN)}'),
        **{name: (values[0], f'{text}: {" or ".join(values)}') for name, (values, text) in CHOICES.items()},
        **{name: ('', f'{text}; unless set, that of the parameter file') for name, text in optional.items()},
    }
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=description)
                for name, (default, description) in texts.items()
            ),
            OpaqueFunction(function=nodes),
        ]
    )
