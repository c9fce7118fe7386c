"""A story of three days with real processes: teach, keep, recognise, go on, and put together what two robots know.

    python benchmarks/story.py [--folder DIR] [--tables N] [--json FILE]

On Monday somebody answers 20 questions about one table, and does not speak of main dishes yet; then everything is
killed. On Tuesday new processes recognise what is on other tables, and learn what main dishes are from 8 more answers.
A second robot takes over what was taught on Monday and is taught in another kitchen, where there are things of other
kinds. On Wednesday both files are put together. Each command is printed as a person types it, each table with how much
is recognised. The one who answers says the truth, by the rules of the scripted teacher.

Counted are, over all held-out tables of a kitchen: things of which the robot says rightly what they are, a symbol or
none of them, with a probability of the threshold or more; wrong is what it says otherwise, of the rest it says that it
does not know. Last, the same of things of some symbol alone.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import rclpy
from measuring import print_table
from story_parts.robot import Robot

from al_questioner.domain import NO_SYMBOL, EpisodeError, InputError
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.ros.running import TRANSPORTS
from al_questioner.simulation import ScriptedTeacher, WorldSpec, load_task
from al_questioner.support.arguments import NumberWithin
from al_questioner.support.files import write_text

TASK = 'kitchen_table'
NEW_SYMBOL = 'main_dish'
"""Nobody speaks of it on the first day, though such things lie on the table."""
QUESTIONS, MORE_QUESTIONS = 20, 8
BUDGET = 30.0
"""Enough for all of them; the default would end the first day before."""
TEACHER = 'anna'
ROOT = Path(__file__).resolve().parent.parent
NEW_TABLE = ROOT / 'docs' / 'examples' / 'new_table.py'
FIRST_DAY_TASK = f"""\
# As the task kitchen_table, but nobody speaks of {NEW_SYMBOL} yet. Of the same name, as perception compares it.
symbols: [snack, fruit, beverage]
episode: {{budget: 30, turns: 40}}
costs: {{relevance: 4}}
scenes: {{change_interval: 5}}
"""


class Recognised(NamedTuple):
    """Counts of the things on some tables.

    Attributes:
        things: all of them.
        right, wrong: things of which it is said what they are; that is true, or not.
        of_symbol, of_symbol_right: things of some symbol, and those of them that are named rightly.
        of_new, of_new_right: the same of the symbol that was new on the second day.
    """

    things: int = 0
    right: int = 0
    wrong: int = 0
    of_symbol: int = 0
    of_symbol_right: int = 0
    of_new: int = 0
    of_new_right: int = 0

    def plus(self, other: Recognised) -> Recognised:
        """Return the counts of both."""
        return Recognised(*(a + b for a, b in zip(self, other, strict=True)))


class Story:
    """The chapters, each of which leaves files in the folder.

    Args:
        folder: an empty one.
        tables: held-out tables of each kitchen.
        tell: prints a line.

    Attributes:
        told: the numbers, and what was published, for those who check it.
    """

    def __init__(self, folder: Path, tables: int, tell: Callable[[str], None] = print) -> None:
        self._folder, self._tables, self._tell = folder, tables, tell
        self._task = load_task(TASK)
        self.told: dict[str, Any] = {'examples': {}, 'recognised': [], 'documents': []}

    def teach_on_monday(self) -> None:
        """Answer questions at the first table, and kill everything while the next one waits."""
        (self._folder / 'first_day').mkdir()
        (self._folder / 'first_day' / f'{TASK}.yaml').write_text(FIRST_DAY_TASK, encoding='utf-8')
        symbols = tuple(symbol for symbol in self._task.symbols if symbol != NEW_SYMBOL)
        with self._robot('Monday: twenty questions') as robot:
            robot.start('perception', task=TASK)
            robot.start('learner', task=f'first_day/{TASK}.yaml', session='monday')
            self.told['truth'] = self._answer(robot, WorldSpec(self._task, 0, 0), symbols, QUESTIONS)
            robot.kill()
        self._tell('All processes are killed.')

    def recognise_on_tuesday(self) -> None:
        """Keep what was taught from the log of the killed session, and put it to use."""
        self._tell('\n# Tuesday: what was kept')
        self._run('session', 'monday', '--concepts', 'monday.json')
        self._count('monday.json')
        with self._robot('Recognise another table, and ask for something') as robot:
            self._recognise(robot, 'monday.json', 0)
            self._want(robot, 'monday.json', 'snack')
            self._want(robot, 'monday.json', NEW_SYMBOL)

    def take_back(self) -> None:
        """Remove the examples of none that are of the symbol to come."""
        known, truth = read_concepts(self._folder / 'monday.json'), self.told['truth']
        wrong = [
            label.view
            for _, label in known.examples
            if label.label == NO_SYMBOL and truth[known.views[label.view].object_id] == NEW_SYMBOL
        ]
        self.told['removed'] = wrong
        self._tell(f'\n# Some things that were of none on Monday are {NEW_SYMBOL}: their examples are removed')
        removals = [word for view in wrong for word in ('--remove', str(view))]
        self._run('concepts', 'monday.json', *removals, '--out', 'corrected.json')
        self._count('corrected.json')

    def teach_a_new_symbol(self) -> None:
        """Go on with what is known, at new scenes of the same kitchen, with one more symbol."""
        table = {'seed': 1, 'sample': 0}
        with self._robot(f'Eight more questions, and {NEW_SYMBOL} is a word now') as robot:
            robot.start('perception', task=TASK, **table)
            files = {'concepts': 'corrected.json', 'save_concepts': 'tuesday.json'}
            robot.start('learner', task=TASK, **table, **files)
            self._answer(robot, WorldSpec(self._task, 1, 0), self._task.symbols, MORE_QUESTIONS)
            robot.stop()
        self._count('tuesday.json')

    def recognise_the_new_symbol(self) -> None:
        """Recognise the same tables again, and those of a kitchen that this robot was never in."""
        with self._robot('Recognise again') as robot:
            self._recognise(robot, 'tuesday.json', 0)
            self._want(robot, 'tuesday.json', NEW_SYMBOL)
            self._show_tables(robot, 'tuesday.json', 1)

    def teach_a_second_robot(self) -> None:
        """Have a second robot begin with Monday's file, in another kitchen, with the scripted teacher."""
        with self._robot('A second robot goes on from Monday in another kitchen') as robot:
            world = {'task': TASK, 'seed': 1}
            robot.start('perception', **world)
            robot.start('teacher', **world)
            robot.start('learner', **world, concepts='corrected.json', save_concepts='robot_2.json')
            self.told['questions of robot 2'] = len(robot.wait_for_end()['queries'])
            robot.stop()
        self._count('robot_2.json')

    def put_together(self) -> None:
        """Merge what both know, and recognise what is on the tables of both kitchens."""
        self._tell('\n# Wednesday: what both robots know')
        self._run('concepts', 'tuesday.json', 'robot_2.json', '--settle', 'newest', '--out', 'both.json')
        self._count('both.json')
        with self._robot('Recognise in both kitchens') as robot:
            self._recognise(robot, 'both.json', 0)
            self._show_tables(robot, 'both.json', 1)

    def sum_up(self) -> None:
        """Print how much was recognised by what."""
        rows = []
        for name, sample, counts in self.told['recognised']:
            each, examples = Recognised(**counts), self.told['examples'][name]
            of = [f'{each.right} of {each.things}', str(each.wrong)]
            of += [f'{each.of_symbol_right} of {each.of_symbol}', f'{each.of_new_right} of {each.of_new}']
            rows.append([name, str(sample), str(examples), *of])
        columns = ('file', 'kitchen', 'examples', 'right', 'wrong', 'of some symbol', NEW_SYMBOL)
        self._tell('')
        print_table(f'Things recognised on {self._tables} new tables of each kitchen', columns, rows)

    def _robot(self, title: str) -> Robot:
        self._tell(f'\n# {title}')
        return Robot(self._folder, self._tell)

    def _answer(self, robot: Robot, spec: WorldSpec, symbols: tuple[str, ...], count: int) -> Mapping[int, str]:
        """Answer some questions, wait for one more, and return what all things really are that were shown by then."""
        world = spec.open()
        truth: dict[int, str] = {}
        teacher = ScriptedTeacher(symbols, self._task.relevant_groups, spec.seed, teacher_id=TEACHER)
        for number in range(1, count + 2):
            query = robot.query(number)
            truth.update(world.truth(query.turn))
            if number > count:
                self._tell(f'{count} answers are acknowledged. The robot asks: {query.text}')
                break
            said = {
                thing: symbol if symbol in symbols else NO_SYMBOL for thing, symbol in world.truth(query.turn).items()
            }
            robot.tell(teacher.answer(query, said))
        return truth

    def _recognise(self, robot: Robot, name: str, sample: int) -> None:
        """Start a recogniser with a file, and show it the tables of a kitchen."""
        robot.start('recognise', concepts=name)
        self._show_tables(robot, name, sample)

    def _show_tables(self, robot: Robot, name: str, sample: int) -> None:
        world, found = WorldSpec(self._task, sample, sample).open(), Recognised()
        # The first one last: what is asked for is then on the table that one sees without any option.
        for number in reversed(range(self._tables)):
            robot.start_script(NEW_TABLE, '--sample', str(sample), '--number', str(number))
            document = robot.recognition()
            robot.kill(NEW_TABLE.stem)
            found = found.plus(count_right(document, world.new_table(number).symbols))
            self.told['documents'].append((name, sample, number, document))
        self.told['recognised'].append((name, sample, found._asdict()))
        self._tell(
            f'By {name}, on {self._tables} new tables of kitchen {sample}: right {found.right} of {found.things}, wrong'
            f' {found.wrong}; of some symbol {found.of_symbol_right} of {found.of_symbol}'
        )

    def _want(self, robot: Robot, name: str, wish: str) -> None:
        found = robot.want(wish)
        self.told.setdefault('wishes', []).append((name, found))
        self._tell(f'{wish}? {found["text"]}')

    def _run(self, *arguments: str) -> None:
        """Run an executable to its end, and show what it prints.

        Raises:
            EpisodeError: it fails.
        """
        self._tell(f'python -m al_questioner {" ".join(arguments)}')
        command = [sys.executable, '-m', 'al_questioner', *arguments]
        done = subprocess.run(command, cwd=self._folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise EpisodeError(f'{arguments[0]} ended with status {done.returncode}: {done.stderr}')
        self._tell(done.stdout.rstrip())

    def _count(self, name: str) -> None:
        self.told['examples'][name] = len(read_concepts(self._folder / name).examples)


def count_right(document: Mapping[str, Any], truth: Mapping[int, str]) -> Recognised:
    """Return the counts of a table by a `recognition` document and the true symbols, or none, by object id."""
    called = {each['object_id']: each['best'] for each in document['things'] if each['known']}
    right = {thing for thing, name in called.items() if name == truth[thing]}
    of_symbol = {thing for thing, symbol in truth.items() if symbol != NO_SYMBOL}
    of_new = {thing for thing, symbol in truth.items() if symbol == NEW_SYMBOL}
    return Recognised(
        len(truth),
        len(right),
        len(called) - len(right),
        len(of_symbol),
        len(of_symbol & right),
        len(of_new),
        len(of_new & right),
    )


def tell_story(folder: Path, tables: int) -> dict[str, Any]:
    """Play all chapters in a folder, and return what was told.

    Raises:
        EpisodeError: something does not go on.
    """
    story = Story(folder, tables)
    story.teach_on_monday()
    story.recognise_on_tuesday()
    story.take_back()
    story.teach_a_new_symbol()
    story.recognise_the_new_symbol()
    story.teach_a_second_robot()
    story.put_together()
    story.sum_up()
    return story.told


def main() -> int:
    """Tell the story."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--folder', type=Path, help='empty folder for all files; one that is removed, if not given')
    tables = NumberWithin(int, 1, 100)
    parser.add_argument('--tables', type=tables, default=3, help='new tables of each kitchen (%(default)s)')
    parser.add_argument('--json', type=Path, metavar='FILE', help='write what was told, and what was recognised')
    given = parser.parse_args()
    # The processes run elsewhere, and are to be of this checkout.
    os.environ['PYTHONPATH'] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))
    # Away from other graphs; before anything of ROS is initialised.
    os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    os.environ.setdefault(*TRANSPORTS)
    rclpy.init()
    try:
        with contextlib.ExitStack() as stack:
            folder = given.folder or Path(stack.enter_context(tempfile.TemporaryDirectory()))
            folder.mkdir(parents=True, exist_ok=True)
            told = tell_story(folder.resolve(), given.tables)
        if given.json is not None:
            write_text(given.json, json.dumps(told, indent=1) + '\n')
    except (InputError, EpisodeError, OSError) as error:
        print(f'story: {error}', file=sys.stderr)
        return 1
    finally:
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
