"""The parameters of every node, with their defaults, ranges and units."""

from __future__ import annotations

from al_questioner.domain import AMPLITUDE, AMPLITUDE_RANGE, AUTO, LENGTH_SCALE_RANGE
from al_questioner.messages.schemas import LARGEST_TURN
from al_questioner.questioning import STRATEGIES
from al_questioner.ros.setting import Setting
from al_questioner.simulation import Task, load_task
from al_questioner.support.arguments import REPEAT_SHOWN_HELP

DEFAULT_TASK = 'kitchen_table'
WORLD_SETTINGS = (
    Setting('task', DEFAULT_TASK, 'a name in config/tasks, or the path of a YAML file'),
    Setting('dataset', '', 'root of a directory of RGB-D crops, for tasks that read one'),
    Setting('seed', 0, 'seed of everything that is drawn at random', lower=0),
    Setting(
        'sample', 0, 'sample of observations that the scenes are drawn from; unless set, that of the seed', lower=0
    ),
)
"""What perception, learner and teacher must agree on to speak of the same world."""

WAIT_FOR_RECORDER = Setting('wait_for_recorder', False, 'do nothing before a node named recorder listens')

PERCEPTION_SETTINGS = (Setting('frame_id', 'table', 'frame of the objects and of the picture'), WAIT_FOR_RECORDER)

TEACHER_MODES = ('scripted', 'terminal')
TEACHER_SETTINGS = (
    Setting('mode', 'scripted', "who answers: scripted, or terminal: a person at this process's terminal"),
    Setting('teacher_id', '', "name under which the answers are given; empty: scripted, or the person's login name"),
    Setting('wrong_rate', 0.0, 'share of wrong answers', lower=0.0, upper=1.0),
    Setting('unknown_rate', 0.0, 'share of queries answered by "I do not know"', lower=0.0, upper=1.0),
    Setting('repeat_shown', False, REPEAT_SHOWN_HELP),
    Setting('delay', 0.0, 'time the teacher takes to answer', unit='s', lower=0.0, upper=3600.0),
    WAIT_FOR_RECORDER,
)


def learner_settings(task: Task) -> tuple[Setting, ...]:
    """The learner's parameters, with the task's values as defaults."""
    costs = task.episode.costs
    return (
        Setting(
            'strategy',
            task.episode.strategy,
            f'questioning strategy: {", ".join(sorted(STRATEGIES))}, or one that an installed package contributes',
        ),
        Setting('weights_file', '', 'YAML file with weights of the decision features; empty: those of the strategy'),
        Setting('budget', task.episode.budget, 'query budget', unit='cost of a label query', lower=0.0),
        Setting('turns', task.episode.turns, 'length of the episode', unit='turns', lower=1, upper=LARGEST_TURN),
        Setting(
            'change_interval', task.scenes.change_interval, 'expected time between scene changes', 'turns', lower=1
        ),
        Setting('cost_label', costs.label, 'cost of a label query', unit='budget', lower=0.0),
        Setting('cost_demonstration', costs.demonstration, 'cost of a demonstration query', unit='budget', lower=0.0),
        Setting(
            'cost_feature_subset', costs.feature_subset, 'cost of a feature subset query', unit='budget', lower=0.0
        ),
        Setting(
            'charge_unknown',
            costs.unknown,
            'share of its cost that a query is charged if the teacher does not know',
            '',
            0,
            1,
        ),
        Setting('charge_skip', costs.skip, 'share that is charged if the teacher skips the query', '', 0, 1),
        Setting('charge_unanswered', costs.unanswered, 'share that is charged if it is withdrawn unanswered', '', 0, 1),
        Setting(
            'answer_timeout',
            120.0,
            'time after which a turn goes on without its answer, doubled each time; 0: never',
            unit='s',
            lower=0.0,
            upper=86400.0,
        ),
        Setting('amplitude', AMPLITUDE, "variance of the Gaussian processes' kernel", '', *AMPLITUDE_RANGE),
        Setting(
            'length_scale',
            0.0,
            f'of the kernel, {LENGTH_SCALE_RANGE[0]:g} or more; 0: root of the number of features',
            unit='standard deviations',
            lower=0.0,
            upper=LENGTH_SCALE_RANGE[1],
        ),
        Setting(
            'tune_every',
            0,
            'time between re-optimisations of amplitude and length scale; 0: never',
            'turns',
            lower=0,
            upper=LARGEST_TURN,
        ),
        Setting(
            'view_tolerance',
            AUTO,
            'change up to which an object is the same view; auto: what the noise of the sensors explains',
            'standard deviations',
            lower=0.0,
            word=AUTO,
        ),
        Setting(
            'turn_period',
            0.0,
            'least time from turn to turn; 0: as fast as they can go',
            unit='s',
            lower=0.0,
            upper=3600.0,
        ),
        Setting('episode_id', '', 'of the episode in all documents; empty: one that is not used again'),
        Setting('session', '', 'folder of the log that the episode is written to and goes on from; empty: none'),
        WAIT_FOR_RECORDER,
    )


RECORDER_SETTINGS = (
    Setting('bag', '', 'directory of the new bag; empty: al_questioner_ and the date and time'),
    Setting('storage', 'mcap', 'format of the file: mcap or sqlite3'),
    Setting('namespace_in_bag', '', 'under which the bag names the topics of this namespace; empty: their own'),
    Setting('until_done', False, 'end by itself when the learner says that its episode is over'),
)


def all_names() -> frozenset[str]:
    """Every parameter of every node: a file for all nodes sets parameters that a single one does not have."""
    learner = learner_settings(load_task(DEFAULT_TASK))
    settings = (*WORLD_SETTINGS, *PERCEPTION_SETTINGS, *TEACHER_SETTINGS, *RECORDER_SETTINGS, *learner)
    return frozenset(setting.name for setting in settings)
