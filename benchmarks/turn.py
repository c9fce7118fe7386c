"""Time of the parts of a turn: offline, in the encoding of its messages, and through three ROS processes.

python benchmarks/turn.py --task prepare_lunch --strategy dt_task_env --turns 150 --budget 500
python benchmarks/turn.py --offline        # without ROS: the first table alone
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from measuring import median_and_spread, print_table
from numpy.typing import ArrayLike
from turn_parts.accounts import remainders, sent_away, transport_seconds, waited_for
from turn_parts.offline import GRAPH_STAGES, OFFLINE_STAGES, PlayedEpisode, play_timed

from al_questioner.domain import EpisodeError, EpisodeSettings, InputError
from al_questioner.simulation import ScriptedTeacher, WorldSpec, episode_settings, load_task, run_episode

PATIENCE = 60.0
"""Seconds without progress after which the graph is given up."""

REMAINS = 'transport: what remains'
ALONE = 'transport by round trips'

Figures = dict[str, Any]


def parser() -> argparse.ArgumentParser:
    """The arguments."""
    result = argparse.ArgumentParser(description=(__doc__ or '').splitlines()[0])
    result.add_argument('--task', default='prepare_lunch', help='a name in config/tasks (%(default)s)')
    result.add_argument('--strategy', default='dt_task_env', help='(%(default)s)')
    result.add_argument('--turns', type=int, default=150, help='length of the episode (%(default)s)')
    result.add_argument('--budget', type=float, default=500.0, help='query budget (%(default)s)')
    result.add_argument('--seed', type=int, default=0, help='of everything drawn at random (%(default)s)')
    result.add_argument('--repeats', type=int, default=3, help='episodes of each kind (%(default)s)')
    result.add_argument('--round-trips', type=int, default=200, help='of each message (%(default)s)')
    result.add_argument('--offline', action='store_true', help='without ROS: the first table alone')
    result.add_argument('--json', type=Path, metavar='FILE', help='write the figures as JSON')
    return result


def main() -> int:
    """Measure, and print the tables."""
    given = parser().parse_args()
    try:
        figures = measure(given)
    except (InputError, EpisodeError) as error:
        print(error, file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    if given.json is not None:
        given.json.write_text(json.dumps(figures, indent=1) + '\n', encoding='utf-8')
    return 0


def measure(given: argparse.Namespace) -> Figures:
    """All figures, in milliseconds where not said otherwise.

    Raises:
        InputError: an unusable argument, or ROS is missing though it is needed.
        EpisodeError: a process ended early, or the graph asked other questions than the offline episode.
    """
    if min(given.repeats, given.round_trips) < 1:
        raise InputError('--repeats and --round-trips must be 1 or more')
    if not given.offline:
        isolate()
        need_ros()
        if given.turns < 3:
            raise InputError('--turns must be 3 or more for the graph: its first and last turn are not timed')
    world_spec = WorldSpec(load_task(given.task), given.seed, given.seed)
    settings = episode_settings(world_spec.task, given.strategy, given.budget, given.turns)
    print(f'{os.cpu_count()} cores; load average at the start: {os.getloadavg()[0]:.1f}\n')
    start = time.perf_counter()
    expected = run_episode(world_spec, settings, teacher_of(world_spec))
    plain = time.perf_counter() - start
    played = [play_timed(world_spec, settings, teacher_of(world_spec)) for _ in range(given.repeats)]
    if any(episode.records != expected.queries for episode in played):
        raise EpisodeError('the timed episode asked other questions than run_episode')
    figures = {'arguments': {name: str(value) for name, value in vars(given).items()}}
    figures['offline'] = report_offline(played, settings, plain)
    if not given.offline:
        figures.update(measure_graph(given, world_spec, settings, played))
    return figures


def isolate() -> None:
    """Keep all topics on this machine and away from other graphs; before anything of ROS is imported."""
    os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'


def need_ros() -> None:
    """Raise an InputError unless ROS can be imported."""
    try:
        import rclpy  # noqa: F401
        import visualization_msgs.msg  # noqa: F401
    except ImportError as error:
        raise InputError(f'ROS 2 cannot be imported ({error}): use --offline') from error


def teacher_of(world_spec: WorldSpec) -> ScriptedTeacher:
    """A teacher who never errs, as the teacher node by default."""
    return ScriptedTeacher(world_spec.task.symbols, world_spec.task.relevant_groups, world_spec.seed)


def report_offline(played: Sequence[PlayedEpisode], settings: EpisodeSettings, plain: float) -> Figures:
    """Print and return the first table: the episode in one process."""
    totals = [episode.offline_total for episode in played]
    total, total_spread = median_and_spread(totals)
    making = float(np.median([episode.making for episode in played]))
    asked = len(played[0].records)
    rows, figures = [], {}
    for stage in OFFLINE_STAGES:
        seconds = np.array([episode.seconds.get(stage, np.zeros(settings.turns)) for episode in played])
        of_episode = float(np.median(seconds.sum(axis=1)))
        rows.append([stage, *typical(seconds), f'{of_episode:.3f}', f'{of_episode / total:.1%}'])
        figures[stage] = dict(zip(('median', 'spread'), in_ms(seconds), strict=True), total_s=of_episode)
    whole = np.concatenate([episode.per_turn(OFFLINE_STAGES) for episode in played])
    rows += [
        ['making the world, once', '', '', f'{making:.3f}', f'{making / total:.1%}'],
        [],
        ['the whole episode', *typical(whole), f'{total:.3f}', '100.0%'],
    ]
    print_table(
        f'Offline: {settings.turns} turns, {asked} queries, {settings.strategy}; {len(played)} episodes',
        ('', 'median ms a turn', 'spread', 's an episode', 'share'),
        rows,
    )
    print(f'run_episode without a stopwatch: {plain:.3f} s, the first to run in this process.')
    print(f'The {len(played)} totals spread over {total_spread:.3f} s; spread is the width of the middle half.\n')
    return {'stages': figures, 'making_s': making, 'total_s': total, 'run_episode_s': plain, 'queries': asked}


def measure_graph(
    given: argparse.Namespace, world_spec: WorldSpec, settings: EpisodeSettings, played: Sequence[PlayedEpisode]
) -> Figures:
    """Measure what needs ROS, and print it.

    Raises:
        EpisodeError: a process ended early, or the graph asked other questions than the offline episode.
    """
    from turn_parts.echo import measure_hops
    from turn_parts.encoding import measure_encoding
    from turn_parts.recording import opened, play_graph

    from al_questioner.ros.worlds import new_episode_id

    episodes = []
    with tempfile.TemporaryDirectory() as folder:
        for i in range(given.repeats):
            world = {'task': given.task, 'seed': world_spec.seed, 'sample': world_spec.sample}
            learner = {
                'strategy': settings.strategy,
                'budget': settings.budget,
                'turns': settings.turns,
                'episode_id': new_episode_id(world_spec),
            }
            parameters = {'perception': world, 'teacher': world, 'learner': {**world, **learner}}
            episode = play_graph(f'turn_{os.getpid()}_{i}', parameters, Path(folder), PATIENCE)
            if episode.records != played[0].records:
                raise EpisodeError('the graph did not ask and hear what the offline episode did')
            episodes.append(episode)
    print(f'The graph asked the same {len(played[0].records)} queries as the offline episode, with the same answers.\n')
    heard = episodes[0].heard
    encodings = measure_encoding(played[0], heard, settings)
    figures = {'encoding': report_encoding(encodings, settings.turns)}
    middles = {topic: opened({topic: [median_sized(heard[topic])]}, topic)[0] for topic in encodings}
    hops = measure_hops(f'echo_{os.getpid()}', middles, given.round_trips)
    figures['graph'] = report_graph(played, episodes, encodings, hops)
    figures['hops'] = report_hops(hops, figures['graph'])
    return figures


def median_sized(messages: Sequence[bytes]) -> bytes:
    """The message of middle size."""
    return sorted(messages, key=len)[len(messages) // 2]


def report_encoding(encodings: Mapping[str, Any], turns: int) -> Figures:
    """Print and return the second table: the messages."""
    rows, figures = [], {}
    for topic, encoding in encodings.items():
        parts = (encoding.writing, encoding.reading, encoding.packing, encoding.unpacking)
        medians = [in_ms(seconds)[0] for seconds in parts]
        size, largest = int(np.median(encoding.octets)), int(encoding.octets.max())
        rows.append(
            [topic, f'{len(encoding.octets) / turns:.2f}', f'{size}', f'{largest}', *(f'{ms:.3f}' for ms in medians)]
        )
        names = ('writing', 'reading', 'packing', 'unpacking')
        figures[topic] = dict(zip(names, medians, strict=True), octets=size, messages=len(encoding.octets))
    print_table(
        'Messages: median bytes and ms each',
        ('topic', 'a turn', 'bytes', 'most', 'write', 'read', 'ROS packs', 'unpacks'),
        rows,
    )
    print('write and read: between the domain and the ROS message, JSON and its checks included.')
    print('packs and unpacks: between the ROS message and bytes; the next tables count that as transport.\n')
    return figures


def report_graph(
    played: Sequence[PlayedEpisode], episodes: Sequence[Any], encodings: Mapping[str, Any], hops: Mapping[str, Any]
) -> Figures:
    """Print and return the third table: a turn of the graph, and what of it is transport."""
    stage_seconds: dict[str, list[float]] = {stage: [] for stage in GRAPH_STAGES}
    walls, encoding, rest, alone = [], [], [], []
    for i, episode in enumerate(episodes):
        turns, seconds = episode.settled_walls()
        offline = played[i % len(played)]
        rows = np.array(turns, dtype=int) - 1
        asked = [offline.turns[row].record is not None for row in rows]
        encoded, remains = remainders(seconds, offline.per_turn(GRAPH_STAGES)[rows], asked, encodings)
        for stage in GRAPH_STAGES:
            stage_seconds[stage] += list(offline.per_turn((stage,))[rows])
        walls += list(seconds)
        encoding += list(encoded)
        rest += list(remains)
        alone += [transport_seconds(hops, turn_asked) for turn_asked in asked]
    parts = {**stage_seconds, 'encoding': encoding, REMAINS: rest}
    lines = {**parts, 'a turn of the graph': walls, ALONE: alone}
    mean = {name: 1e3 * float(np.mean(of)) for name, of in lines.items()}
    whole = mean['a turn of the graph']
    cells = {name: [name, *typical(of), f'{mean[name]:.2f}', f'{mean[name] / whole:.1%}'] for name, of in lines.items()}
    waiting = 1e3 * float(np.mean([episode.waiting for episode in episodes]))
    waiting_cells = ['all threads wait for a core', '', '', f'{waiting:.2f}', f'{waiting / whole:.1%}']
    print_table(
        f'Graph: three processes, {len(walls)} turns of {len(episodes)} episodes, without the first turn of each',
        ('', 'median ms a turn', 'spread', 'mean ms', 'share'),
        [*(cells[name] for name in parts), [], cells['a turn of the graph'], [], cells[ALONE], waiting_cells],
    )
    starting = float(np.median([episode.starting for episode in episodes]))
    of_episode = float(np.median([episode.whole for episode in episodes]))
    offline_ms = sum(mean[stage] for stage in GRAPH_STAGES)
    print(f'A turn takes {whole / offline_ms:.2f} times as long as offline. An episode takes {of_episode:.3f} s,')
    print(f'{starting:.3f} s of it before the second turn: three Python processes start, make the world, and discover')
    print('each other. The means add up, the medians do not.')
    print('What remains holds packing and unpacking, the middleware, the wake-ups of executors and workers, cold')
    print('caches, and waiting: for a core, and for what the learner writes beside the turn, decision and markers.')
    print('It is a difference of times measured one after the other: on a busy machine it says little.\n')
    return {
        'parts': {
            name: dict(zip(('median', 'spread'), in_ms(of), strict=True), mean=mean[name]) for name, of in lines.items()
        },
        'waiting_for_a_core': waiting,
        'starting_s': starting,
        'episode_s': of_episode,
        'turns_heard': len(walls),
    }


def report_hops(hops: Mapping[str, Any], graph: Figures) -> Figures:
    """Print and return the fourth table: transport measured by itself."""
    rows, figures = [], {}
    for topic, hop in hops.items():
        rows.append([topic, *typical(hop.there), *typical(hop.publishing), role(topic)])
        figures[topic] = {'there': in_ms(hop.there)[0], 'publishing': in_ms(hop.publishing)[0]}
    print_table(
        'Transport alone: half a round trip of such a message, to an idle process',
        ('topic', 'median ms', 'spread', 'publish', 'spread', 'the turn'),
        rows,
    )
    remains, alone = (graph['parts'][name]['median'] for name in (REMAINS, ALONE))
    print(f'The median turn needs {alone:.2f} ms of this; in the median {remains:.2f} ms of its wall time remain,')
    print(f'{remains / alone:.2f} x that. Meanwhile the threads of the nodes, also those that no turn waits for, wait')
    print(f'{graph["waiting_for_a_core"]:.2f} ms a turn for a core.')
    return figures


def role(topic: str) -> str:
    """Return what a turn has to do with the messages of a topic."""
    if topic in waited_for(True):
        return 'waits for it'
    return 'sends it' if topic in {*sent_away(True), *sent_away(False)} else 'goes on'


def in_ms(seconds: ArrayLike) -> tuple[float, float]:
    """Median and spread in milliseconds."""
    median, spread = median_and_spread(seconds)
    return 1e3 * median, 1e3 * spread


def typical(seconds: ArrayLike) -> list[str]:
    """The two cells of median and spread in milliseconds."""
    return [f'{value:.3f}' for value in in_ms(seconds)]


if __name__ == '__main__':
    sys.exit(main())
