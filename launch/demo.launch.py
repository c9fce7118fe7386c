"""One learning episode as a graph of three nodes: perception, learner and the scripted teacher.

A person who wants to teach answers on the topic `answer`, see docs/interfaces.md.
"""

from __future__ import annotations

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch_ros.actions import Node

PACKAGE = 'al_questioner'

WORLD_ARGUMENTS = {
    'dataset': (str, 'root of a directory of RGB-D crops, for tasks that read one'),
    'seed': (int, 'seed of everything that is drawn at random, 0 or more'),
}
LEARNER_ARGUMENTS = {
    'strategy': (str, 'questioning strategy'),
    'budget': (float, 'query budget, in the cost of a label query, 0 or more'),
    'turns': (int, 'length of the episode in turns, 1 or more'),
    'turn_period': (float, 'least time from turn to turn in seconds; 0: as fast as the nodes can go'),
    'session': (str, 'folder of the log that the episode is written to and goes on from'),
}


def given(context: LaunchContext, arguments: dict[str, tuple[type, str]]) -> dict[str, str | int | float]:
    """The parameters that the user set on the command line; all others keep their value in the parameter file.

    Raises:
        ValueError: a value that is no number where one is expected.
    """
    parameters = {}
    for name, (kind, _) in arguments.items():
        text = context.launch_configurations[name]
        if text:
            try:
                parameters[name] = kind(text)
            except ValueError:
                raise ValueError(f'launch argument {name} must be of type {kind.__name__}, not {text!r}') from None
    return parameters


def nodes(context: LaunchContext) -> list[Node]:
    """The three nodes; they stay up after the episode, until Ctrl-C, or until the learner ends."""
    task = context.launch_configurations['task']
    # Name and namespace are both given: only then do these parameters prevail over a file's entries for a single node.
    namespace = context.launch_configurations['namespace']
    file = Path(get_package_share_directory(PACKAGE), 'config', 'params', f'{task}.yaml')
    files = [str(file)] if file.is_file() and '/' not in task else []
    world = {'task': task, **given(context, WORLD_ARGUMENTS)}
    learner = {**world, **given(context, LEARNER_ARGUMENTS)}

    def node(name: str, parameters: dict[str, str | int | float], **options: object) -> Node:
        return Node(
            package=PACKAGE,
            executable=name,
            name=name,
            namespace=namespace,
            parameters=[*files, parameters],
            output='screen',
            **options,
        )

    return [node('perception', world), node('teacher', world), node('learner', learner, on_exit=Shutdown())]


def generate_launch_description() -> LaunchDescription:
    """What `ros2 launch al_questioner demo.launch.py` starts."""
    optional = WORLD_ARGUMENTS | LEARNER_ARGUMENTS
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                'task',
                default_value='kitchen_table',
                description='a name in config/tasks, whose config/params/TASK.yaml is used, or the path of a YAML file',
            ),
            DeclareLaunchArgument(
                'namespace', default_value='/', description='namespace of the graph, for several robots side by side'
            ),
            *(
                DeclareLaunchArgument(
                    name, default_value='', description=f"{description}; empty: the parameter file's value"
                )
                for name, (_, description) in optional.items()
            ),
            OpaqueFunction(function=nodes),
        ]
    )
