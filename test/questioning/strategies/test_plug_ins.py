"""Strategies of other packages: found by name, told apart from our own, and refused in one line if they are broken."""

from __future__ import annotations

import csv
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from al_questioner.cli import main
from al_questioner.domain import QueryKind, SettingsError, random_stream
from al_questioner.messages.documents import read, settings_members, settings_of, write
from al_questioner.questioning import STRATEGIES, Choice, Episode, TurnContext, make_strategy
from al_questioner.questioning.strategies import names as strategy_names
from al_questioner.questioning.strategies.names import SHIPPED, check_strategy, contributions
from al_questioner.simulation import episode_settings
from shared.checkout import ROOT
from shared.lunches import TASK

EXAMPLE = ROOT / 'docs' / 'examples' / 'own_strategy'
MODULE = """
class Weighted:
    selector = None
    def __init__(self, weights): self.weights = weights
    def choose(self, context, rng): raise NotImplementedError
class Another(Weighted): pass
class Declaring(Weighted):
    weight_names = ('margin', 'novelty')
class Vague(Weighted):
    weight_names = 'margin'
class Failing(Weighted):
    def __init__(self, weights): raise ValueError('it needs\\nmore memory')
class Halfway:
    selector = None
    def __init__(self, weights): pass
"""

Contribute = Callable[..., None]


@pytest.fixture
def contribute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Contribute:
    """Puts a package on the path, with a module `contributed_module` and entry points by name."""
    (tmp_path / 'contributed_module.py').write_text(MODULE, encoding='utf-8')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, 'contributed_module', raising=False)

    def add(package: str, **values: str) -> None:
        folder = tmp_path / f'{package}-1.dist-info'
        folder.mkdir()
        (folder / 'METADATA').write_text(f'Metadata-Version: 2.1\nName: {package}\nVersion: 1\n', encoding='utf-8')
        lines = [f'{name} = {value}' for name, value in values.items()]
        text = '\n'.join(['[al_questioner.strategies]', *lines, ''])
        (folder / 'entry_points.txt').write_text(text, encoding='utf-8')

    return add


def refusal(make: Callable[..., object], *arguments: object, **options: object) -> str:
    """Return the reason why something is refused, in one line."""
    with pytest.raises(SettingsError) as error:
        make(*arguments, **options)
    text = str(error.value)
    assert '\n' not in text
    return text


def test_a_contributed_strategy_is_made_by_its_name(contribute: Contribute) -> None:
    """Otherwise nobody could try an idea without editing this package."""
    contribute('pack', mine='contributed_module:Weighted')
    assert list(contributions()) == ['mine']
    strategy = make_strategy('mine', {'discriminability': 2.0})
    assert (type(strategy).__name__, strategy.weights) == ('Weighted', {'discriminability': 2.0})


def test_a_weights_file_reaches_a_contributed_strategy(contribute: Contribute, tmp_path: Path) -> None:
    """Otherwise trained weights would be of use to our own strategies alone."""
    contribute('pack', mine='contributed_module:Weighted')
    path = tmp_path / 'weights.yaml'
    path.write_text('weights: {class_uniformity: 0.5}', encoding='utf-8')
    assert episode_settings(TASK, 'mine', weights_file=str(path)).weights == {'class_uniformity': 0.5}
    assert episode_settings(TASK, 'mine').weights == {}


def test_a_contributed_strategy_declares_weights_of_its_own(contribute: Contribute, tmp_path: Path) -> None:
    """Weights that the paper does not have can be tuned, and are on the topics and in the log."""
    contribute('pack', mine='contributed_module:Declaring')
    path = tmp_path / 'weights.yaml'
    path.write_text('weights: {margin: 0.5}', encoding='utf-8')
    settings = episode_settings(TASK, 'mine', weights_file=str(path))
    assert settings.weights == {'margin': 0.5}
    assert make_strategy('mine', settings.weights).weights == {'margin': 0.5}
    told = {**settings_members(settings), 'feature_names': [], 'seed': 0, 'world': None}
    assert settings_of(read('episode', write('episode', 'e', told))) == settings
    path.write_text('weights: {margin: 0.5, novelyt: 0}', encoding='utf-8')
    text = refusal(episode_settings, TASK, 'mine', weights_file=str(path))
    assert text == f"{path}: strategy mine does not use 'novelyt'; it uses margin, novelty"


def test_our_own_strategies_do_not_wait_for_a_search(monkeypatch: pytest.MonkeyPatch, toy: SimpleNamespace) -> None:
    """Otherwise every start would read the metadata of all installed packages."""
    monkeypatch.setattr(strategy_names, 'contributions', lambda: pytest.fail('searched'))
    for name in STRATEGIES:
        make_strategy(check_strategy(name), toy.weights.get(name, {}), lambda _: 0)


def test_the_names_of_our_own_strategies_are_known_without_them() -> None:
    """Otherwise a task file that names one of ours would be refused."""
    assert tuple(STRATEGIES) == SHIPPED


def test_a_name_of_ours_cannot_be_taken(contribute: Contribute, caplog: pytest.LogCaptureFixture) -> None:
    """Otherwise results under the name of a strategy of the paper would be those of another one."""
    contribute('pack', random_fsq='contributed_module:Weighted', mine='contributed_module:Weighted')
    assert type(make_strategy('random_fsq', {})).__name__ == 'RandomLabel'
    assert type(make_strategy('mine', {})).__name__ == 'Weighted'
    assert 'random_fsq' not in contributions()
    assert 'entry point "random_fsq = contributed_module:Weighted" of package pack is ignored' in caplog.text


def test_of_two_with_one_name_it_is_always_the_same(contribute: Contribute, caplog: pytest.LogCaptureFixture) -> None:
    """Otherwise the processes of one experiment could play different strategies under one name."""
    contribute('first', mine='contributed_module:Weighted')
    contribute('second', mine='contributed_module:Another')
    assert type(make_strategy('mine', {})).__name__ == 'Another'
    assert 'of package first is ignored' in caplog.text


@pytest.mark.parametrize(
    ('value', 'reason'),
    [
        ('no_such_module:Strategy', "cannot be imported (ModuleNotFoundError: No module named 'no_such_module')"),
        ('contributed_module:Absent', 'cannot be imported (AttributeError: '),
        ('contributed_module:Failing', 'makes no strategy (ValueError: it needs more memory)'),
        ('contributed_module:__doc__', "makes no strategy (TypeError: 'NoneType' object is not callable)"),
        ('contributed_module:Halfway', 'makes a Halfway, which is no Strategy'),
        ('contributed_module:Vague', "declares weight_names 'margin', which is no list of names"),
    ],
)
def test_a_broken_strategy_is_refused_in_one_line(contribute: Contribute, value: str, reason: str) -> None:
    """Otherwise a traceback through our code would leave its user to find out whose fault it is."""
    contribute('pack', mine=value)
    assert refusal(make_strategy, 'mine', {}).startswith(f'entry point "mine = {value}" of package pack {reason}')


def test_an_unknown_name_is_answered_with_the_contributed_ones_too(contribute: Contribute) -> None:
    """The message shows that a contributed strategy of another name is installed."""
    contribute('pack', mine='no_such_module:Strategy')
    known = ', '.join((*STRATEGIES, 'mine'))
    assert refusal(make_strategy, 'mien', {}) == f"unknown strategy 'mien'; known: {known}; did you mean mine?"


@pytest.mark.parametrize('command', [['demo', '--offline'], ['experiment', '--task', 'prepare_lunch']])
def test_executables_refuse_a_broken_strategy_before_they_begin(
    command: list[str], contribute: Contribute, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise an experiment would fail episode by episode."""
    contribute('pack', mine='no_such_module:Strategy')
    assert main([*command, '--strategy', 'mine', '--out', str(tmp_path / 'out')]) == 2
    error = capsys.readouterr().err
    assert 'entry point "mine = no_such_module:Strategy" of package pack' in error
    assert error.count('\n') == 1


@pytest.fixture(scope='module')
def installed_example(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """An environment in which the worked example is installed, from a copy so that nothing is left in the checkout."""
    place = tmp_path_factory.mktemp('own_strategy')
    source, target = place / 'source', place / 'target'
    shutil.copytree(EXAMPLE, source)
    pip = (sys.executable, '-m', 'pip', '--disable-pip-version-check', 'install', '--quiet')
    offline = ('--no-deps', '--no-build-isolation', '--no-index')
    run(*pip, *offline, '--target', target, source, environment=dict(os.environ), cwd=place)
    paths = (str(ROOT), str(target), os.environ.get('PYTHONPATH', ''))
    return {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, paths))}


def run(*command: str | Path, environment: dict[str, str], cwd: Path) -> None:
    done = subprocess.run(
        command, cwd=cwd, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=240
    )
    assert done.returncode == 0, f'{command} ended with {done.returncode}\n{done.stdout}{done.stderr}'


@pytest.mark.slow
def test_the_example_plays_a_demo(installed_example: dict[str, str], tmp_path: Path) -> None:
    """Otherwise the first thing that people copy would not run."""
    executable = (sys.executable, '-m', 'al_questioner', 'demo', '--offline', '--task', 'prepare_lunch')
    limits = ('--strategy', 'smallest_margin', '--budget', '6', '--turns', '8')
    files = ('--out', tmp_path / 'out', '--json', tmp_path / 'episode.json')
    run(*executable, *limits, *files, environment=installed_example, cwd=tmp_path)
    episode = json.loads((tmp_path / 'episode.json').read_text())
    assert episode['strategy'] == 'smallest_margin'
    assert [query['kind'] for query in episode['queries']] == ['feature_subset', *['label'] * 4]
    assert len({query['object_id'] for query in episode['queries']}) == 5


@pytest.mark.slow
def test_the_example_is_compared_in_an_experiment(installed_example: dict[str, str], tmp_path: Path) -> None:
    """Otherwise the worker processes would not know a strategy that the first process knows."""
    executable = (sys.executable, '-m', 'al_questioner', 'experiment', '--task', 'prepare_lunch')
    cells = ('--condition', '6/8', '--strategy', 'smallest_margin', 'random_fsq', '--samples', '1', '--jobs', '2')
    run(*executable, *cells, '--out', tmp_path / 'out', environment=installed_example, cwd=tmp_path)
    with (tmp_path / 'out' / 'episodes.csv').open(newline='') as file:
        rows = {row['strategy']: row for row in csv.DictReader(file)}
    assert rows.keys() == {'smallest_margin', 'random_fsq'}
    assert all(0 <= float(row['final_accuracy']) <= 1 and row['queries'] == '5' for row in rows.values())
    assert '`smallest_margin`' in (tmp_path / 'out' / 'report.md').read_text()


def test_the_example_asks_about_the_smallest_margin(toy: SimpleNamespace) -> None:
    """Otherwise people would start from a class that does something else than it says."""
    example = runpy.run_path(str(EXAMPLE / 'smallest_margin.py'))['SmallestMargin']({})
    asked = []

    class Checked:
        selector = None

        def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
            choice = example.choose(context, rng)
            action = context.candidates[choice.index]
            asked.append(action.kind)
            if action.kind is QueryKind.LABEL:
                ranked = [sorted(row / row.sum()) for row in context.probabilities]
                margins = {i: row[-1] - row[-2] for i, row in zip(context.scene.object_ids, ranked, strict=True)}
                unknown = np.array(context.scene.object_ids)[~context.labelled]
                assert action.object_id in unknown
                assert margins[action.object_id] == pytest.approx(min(margins[i] for i in unknown), abs=1e-9)
            return choice

    episode = Episode(toy.settings('random_fsq', budget=30), random_stream(0, 'strategy'), strategy=Checked())
    toy.play(episode, toy.world(0))
    assert asked == [QueryKind.FEATURE_SUBSET, *[QueryKind.LABEL] * 19]


def test_the_example_refuses_weights() -> None:
    """Otherwise a user would believe that the weights had an effect."""
    make = runpy.run_path(str(EXAMPLE / 'smallest_margin.py'))['SmallestMargin']
    with pytest.raises(ValueError, match='uses no weights'):
        make({'discriminability': 1.0})


def test_the_page_shows_the_example_as_it_is() -> None:
    """The code on the page, which people copy, is the code that is tested."""
    page = (ROOT / 'docs' / 'how_to' / 'add_a_strategy.md').read_text(encoding='utf-8')
    for language, name in (('python', 'smallest_margin.py'), ('ini', 'setup.cfg')):
        (shown,) = re.findall(f'```{language}\n(.*?)```', page, flags=re.DOTALL)
        assert shown in (EXAMPLE / name).read_text(encoding='utf-8')
