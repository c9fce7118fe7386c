"""Results of one strategy in words: where it is the most accurate, and where others are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.claims import BASELINES, SIGNIFICANT
from al_questioner.experiments.plan import CONTROLS, PAPER_METHOD, PAPER_STRATEGIES, Condition
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import best_of, compare, control_test, exceeds, p_text
from al_questioner.support.arrays import Array
from al_questioner.support.text import number_of

ABOUT_CELLS = """\
A cell is a task with a budget and a time."""

ABOUT_BEST_CONTROLS = """\
The best control of each cell (one-tailed Mann-Whitney U tests, Holm-corrected for the number of controls):"""


@dataclass(frozen=True)
class Findings:
    """Findings about one strategy, in Markdown.

    Attributes:
        rank: in how many cells it is the most accurate; empty if it stands beside none.
        against_controls: in how many cells a simple rule is more accurate, or why that cannot be said.
        where: which controls and other strategies are more accurate, in which cells; empty if none is.
    """

    rank: str
    against_controls: str
    where: str


def find(results: Results, compared: str | None) -> Findings:
    """Find where a strategy is more accurate than the others, and where it is not; None where only ceilings are."""
    if compared is None:
        return Findings('', 'Only ceilings were played: nothing is tested.', '')
    if compared not in results.strategies:
        return Findings('', f'No episode of {compared} was finished: nothing is tested.', '')
    if not others_than(compared, results):
        return Findings('', f'No other strategy was played beside {compared}: nothing is tested.', '')
    against_controls, controls = _against_controls(results, compared)
    found = (controls, _better_strategies(results, compared))
    return Findings(_rank(results, compared), against_controls, '\n\n'.join(part for part in found if part))


def others_than(compared: str, results: Results) -> list[str]:
    """Return the strategies that one is tested against: all others but ceilings."""
    return [name for name in results.strategies if name != compared and name not in CEILINGS]


def _cells(results: Results, compared: str) -> Iterator[tuple[str, Condition, dict[str, Array]]]:
    """Yield task, condition and accuracies, those of ceilings left out, of the cells that it has samples in."""
    for task in results.tasks:
        for condition in results.conditions(task):
            found = results.final_accuracies(task, condition)
            accuracies = {name: values for name, values in found.items() if name not in CEILINGS}
            if len(accuracies.get(compared, ())):
                yield task, condition, accuracies


def _rank(results: Results, compared: str) -> str:
    """Say in how many cells the strategy is the most accurate.

    The paper's method stands beside the paper's other strategies, if some are there, and else as any other beside all.
    """
    among_papers_own = compared == PAPER_METHOD and any(name in BASELINES for name in results.strategies)
    cells, first, sure = 0, 0, 0
    for _, _, accuracies in _cells(results, compared):
        ours = accuracies.pop(compared)
        others = {name: each for name, each in accuracies.items() if not among_papers_own or name in BASELINES}
        if not others:
            continue
        cells += 1
        first += not exceeds(max(values.mean() for values in others.values()), ours.mean())
        sure += all(each.p_holm < SIGNIFICANT for each in compare(ours, others))
    if not cells:
        return ''
    among = "Of the paper's own strategies" if among_papers_own else 'Of the strategies that were played'
    return (
        f'**{among}, {compared} is the most accurate, in the mean, in {first} of {number_of(cells, "cell")}**,'
        f' significantly above each of the others in {sure or "none"}. {ABOUT_CELLS}'
    )


def _against_controls(results: Results, compared: str) -> tuple[str, str]:
    """Say what is against the strategy: a simple rule that is better. Then list where."""
    beaten, played, cells, sure = [], set(), 0, 0
    for task, condition, accuracies in _cells(results, compared):
        controls = {name: accuracies[name] for name in CONTROLS if name in accuracies and name != compared}
        if not controls:
            continue
        cells += 1
        played |= set(controls)
        ours, means = float(accuracies[compared].mean()), {name: float(each.mean()) for name, each in controls.items()}
        best = best_of(means)
        if exceeds(means[best], ours):
            rivals = [values for name, values in controls.items() if name != best]
            p = control_test(controls[best], rivals, accuracies[compared])
            sure += p < SIGNIFICANT
            where = f'{task}, {results.name_of(condition)}'
            beaten.append(f'{where}: {best} {means[best]:.3f}, {compared} {ours:.3f} ({p_text(p)})')
    if not cells:
        controls_elsewhere = any(name in CONTROLS for name in others_than(compared, results))
        place = f'in the same cell as {compared}' if controls_elsewhere else f'beside {compared}'
        return f'No control was played {place}.', ''
    other = 'other ' if compared in CONTROLS else ''
    if not beaten:
        a_control = 'another control' if other else 'a control'
        none = f'no {other}control is' if cells == 1 else f'is {a_control}'
        where = 'the only cell' if cells == 1 else f'none of the {cells} cells'
        return f'In {where} {none} more accurate, in the mean, than {compared}.', ''
    finding = (
        f'**{"Another" if other else "A"} simple control is more accurate, in the mean, than {compared} in'
        f' {len(beaten)} of {number_of(cells, "cell")}**, significantly in {sure or "none"}.'
        f' {_about_controls([name for name in CONTROLS if name in played], other)}'
    )
    return finding, '\n\n'.join([ABOUT_BEST_CONTROLS, _listed(beaten)])


def _about_controls(played: list[str], other: str) -> str:
    """Say what the controls are, of which `other` says that the compared strategy is one, too."""
    if len(played) == 1:
        return f'The {other}control, {played[0]}, follows one rule.'
    return f'The {other}controls, {", ".join(played)}, follow one rule each.'


def _better_strategies(results: Results, compared: str) -> str:
    """List the strategies other than controls that are more accurate, and where."""
    lines, names = [], set()
    for task, condition, accuracies in _cells(results, compared):
        better = _more_accurate(accuracies, compared)
        if better:
            names |= set(better)
            found = ', '.join(f'{name} {mean:.3f}' for name, mean in better.items())
            lines.append(f'{task}, {results.name_of(condition)}: {found}')
    if not lines:
        return ''
    whose = 'Other strategies of the paper' if names <= set(PAPER_STRATEGIES) else 'Other strategies'
    return f'{whose} are more accurate than it in these cells:\n\n{_listed(lines)}'


def _more_accurate(accuracies: Mapping[str, Array], compared: str) -> dict[str, float]:
    """Return the mean accuracies of the strategies other than controls that are above that of the compared one."""
    means = {name: float(values.mean()) for name, values in accuracies.items() if name not in CONTROLS}
    ours = float(accuracies[compared].mean())
    return {name: mean for name, mean in means.items() if name != compared and exceeds(mean, ours)}


def _listed(lines: list[str]) -> str:
    return '\n'.join(f'- {line}' for line in lines)
