"""The page that tells what was reproduced, written from the tables."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.claims import Verdict, verdicts
from al_questioner.experiments.figures import strategies_with_bands
from al_questioner.experiments.findings import find, others_than
from al_questioner.experiments.plan import PAPER_METHOD, PAPER_STRATEGIES, Condition
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import (
    LEAST_FOR_INTERVAL,
    Comparison,
    compare,
    exceeds,
    mean_and_deviation,
)
from al_questioner.experiments.studies import Study
from al_questioner.questioning import Weights
from al_questioner.support.text import number_of

PAPER_SAMPLES = 5

Table = tuple[Sequence[str], Sequence[Sequence[str]]]
"""Head and rows of a table."""

ABOUT_CLAIMS = """\
A claim about significance counts as reproduced if one-tailed Mann-Whitney U tests of the accuracies at the end of the
time (the test of the paper), Holm-corrected for the comparisons with the paper's strategies in that condition (the
paper corrects nothing), are below .05 for all that it names. Superiority is the probability that a sample of
dt_task_env is above one of the other. Where the paper gives no number, the bound in brackets is ours. Of the lunchbox
it shows C1 alone and says that its results are replicated there, so there are rows for the other conditions."""

ABOUT_ACCURACIES = """\
Mean and standard deviation over the samples; in brackets the mean number of queries."""

ABOUT_CEILINGS = """\
`all_labels` and `greedy_oracle` know the truth: one is told every label as it comes into sight, and the relevant
features, for nothing; the other spreads its budget over the scenes and takes each time the label that leads to the
highest accuracy at once, on a second draw of held-out views. Neither is an upper bound: fewer labels, well chosen or
lucky, can be more accurate than all, and who looks ahead than who is greedy."""

ABOUT_TESTS = """\
One-tailed tests that it is more accurate: Mann-Whitney U, Holm-corrected within each condition over all strategies of
this table, and, since all strategies share samples, scenes and seeds, the paired Wilcoxon signed-rank test,
uncorrected. Superiority is the probability that a sample of it is above one of the other, with a 95 % bootstrap
interval."""

ABOUT_NO_INTERVAL = f"""\
There is no interval here: fewer than {LEAST_FOR_INTERVAL} samples cannot tell how much they vary."""

ABOUT_STUDIES = """\
One thing at a time is changed. [difficulty.md](difficulty.md) tells what was tried to make the simulated tables neither
too easy nor hopeless, [imitation.md](../explanation/imitation.md) the paces of the scripted expert and the settings of
the training."""


@dataclass(frozen=True, eq=False)
class Page:
    """Subject of a page.

    Attributes:
        command: that produced it.
        results: of the comparison.
        change_intervals: turns between scene changes, by task.
        figures: pictures to show.
        weights: of the decision-theoretic strategies.
        studies: with the results of their variants, by label.
        varied: what is not as the tasks and the strategies have it, in words; empty for nothing.
        compared: strategy that is tested against the others; None where there are only ceilings.
    """

    command: str
    results: Results
    change_intervals: Mapping[str, int]
    figures: Sequence[Path]
    weights: Mapping[str, Weights]
    studies: Sequence[tuple[Study, Mapping[str, Results]]] = field(default=())
    varied: str = ''
    compared: str | None = PAPER_METHOD


def report(page: Page, folder: Path) -> str:
    """Write the page in Markdown, with links from the folder in which it will lie."""
    results, compared = page.results, page.compared
    findings = find(results, compared)
    found = list(verdicts(results, page.change_intervals))
    counted = _count_claims(results, page.change_intervals)
    is_reproduction = bool(found) and compared == PAPER_METHOD
    parts = [
        '# Reproduction' if is_reproduction else f'# {_title(results, compared)}',
        ' '.join(filter(None, [findings.rank, counted if is_reproduction else ''])),
        findings.against_controls,
        f'**Varied throughout: {page.varied}.**' if page.varied else '',
        *(_conclusions(found) if is_reproduction else ()),
        *(['## Where others are more accurate', findings.where] if findings.where else []),
    ]
    if found:
        parts += ['## What the paper claims']
        parts += [] if is_reproduction else [counted, *_conclusions(found)]
        parts += _claims(results, page.change_intervals)
    if page.weights:
        parts += ['## The weights', _weights(page.weights)]
        parts += [f'`{name}`: {weights.provenance}' for name, weights in page.weights.items() if weights.provenance]
    parts += ['## Accuracy at the end of the time', ABOUT_ACCURACIES]
    parts += [_about_ceilings(results)]
    parts += [_table(*accuracy_table(results, task)) for task in results.tasks]
    if compared in results.strategies and others_than(compared, results):
        few = len(results.samples) < LEAST_FOR_INTERVAL
        about = f'{ABOUT_TESTS} {ABOUT_NO_INTERVAL}' if few else ABOUT_TESTS
        parts += [f'## {compared} against each other strategy', about]
        parts += [_table(*comparison_table(results, task, compared)) for task in results.tasks]
    parts += ['## Figures', _about_bands(results, compared)]
    parts += [f'![{path.stem.replace("_", " ")}]({_relative(path, folder)})' for path in page.figures]
    if page.studies:
        parts += ['## What the paper does not tell', ABOUT_STUDIES]
        for study, variants in page.studies:
            parts += [f'### {study.title}', study.about, *_study(study, results, variants, compared)]
    parts += ['## How this page was made']
    parts += [f'Written by `{page.command}`; every result on this page is computed from its tables.']
    return '\n\n'.join(part for part in parts if part) + '\n'


def _title(results: Results, compared: str | None) -> str:
    """Return the title of a page that does not reproduce the paper: who was played, beside how many."""
    if compared is None or compared not in results.strategies:
        return f'Accuracy of {", ".join(results.strategies)}'
    others = others_than(compared, results)
    if not others:
        return f'Accuracy of {compared}'
    return f'{compared} against {others[0] if len(others) == 1 else f"{len(others)} other strategies"}'


def _about_bands(results: Results, compared: str | None) -> str:
    """Say what the bands in the learning curves are, and of which strategies; nothing if there are none."""
    named = strategies_with_bands(results, compared)
    if len(results.samples) == 1 or not named:
        return ''
    whose = dict.fromkeys("the paper's strategies" if name in PAPER_STRATEGIES else name for name in named)
    return f'The bands in the learning curves are the mean and one standard error, of {" and ".join(whose)}.'


def _relative(path: Path, folder: Path) -> str:
    try:
        return path.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return path.as_posix()


def _about_ceilings(results: Results) -> str:
    """Say what the ceilings are, and on how many samples they were played; nothing if they were not."""
    samples = {row.cell.sample for row in results.episodes if row.cell.strategy in CEILINGS}
    if not samples:
        return ''
    fewer = len(samples) < len(results.samples)
    played = f' They were played on the first {number_of(len(samples), "sample")} alone.' if fewer else ''
    return f'{ABOUT_CEILINGS}{played}'


def _conclusions(found: Iterable[Verdict]) -> Iterator[str]:
    """List the claims of the paper that hold, and those that do not, each with where."""
    wheres: dict[bool | None, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for verdict in found:
        where, _, claim = verdict.claim.partition(': ')
        wheres[verdict.reproduced][claim].append(where)
    for reproduced, word in ((True, 'hold'), (False, 'do not hold')):
        if wheres[reproduced]:
            claims = (f'- {"; ".join(where)}: {claim}' for claim, where in wheres[reproduced].items())
            yield '\n'.join([f'These claims of the paper {word}:', '', *claims])


def _count_claims(results: Results, change_intervals: Mapping[str, int]) -> str:
    """Count the claims of the paper that hold."""
    counts = []
    for samples in dict.fromkeys((results.samples[:PAPER_SAMPLES], results.samples)):
        found = list(verdicts(results.of_samples(samples), change_intervals))
        if not found:
            continue
        held = [verdict for verdict in found if verdict.reproduced]
        sure = sum(verdict.by_construction for verdict in held)
        counts.append(
            f'{len(held)} of {len(found)} are reproduced on {_count(samples).lower()} ({sure} of them by construction)'
        )
    return f"Of the paper's claims, {', '.join(counts)}." if counts else ''


def _claims(results: Results, change_intervals: Mapping[str, int]) -> list[str]:
    """Write the claims, tested on as many samples as the paper had, and, if there are more, on all."""
    first = results.samples[:PAPER_SAMPLES]
    parts = [ABOUT_CLAIMS]
    for samples in dict.fromkeys((first, results.samples)):
        rows = [(v.claim, v.found, v.tests, _word(v)) for v in verdicts(results.of_samples(samples), change_intervals)]
        if rows:
            parts += [f'### {_count(samples)}', _table(('claim', 'found', 'tests', 'verdict'), rows)]
    return parts


def _word(verdict: Verdict) -> str:
    if verdict.reproduced is None:
        return 'cannot be tested on so few samples'
    word = 'reproduced' if verdict.reproduced else '**not reproduced**'
    return f'{word} (by construction)' if verdict.by_construction else word


def _count(samples: Sequence[int]) -> str:
    return 'One sample' if len(samples) == 1 else number_of(len(samples), 'sample')


def _weights(weights: Mapping[str, Weights]) -> str:
    names = list(dict.fromkeys(feature for found in weights.values() for feature in found.values))
    rows = [
        (f'`{strategy}`', *(f'{found.values[name]:.3f}' if name in found.values else '' for name in names))
        for strategy, found in weights.items()
    ]
    return _table(('', *(name.replace('_', ' ') for name in names)), rows)


def accuracy_table(results: Results, task: str) -> Table:
    """Return the accuracies at the end, a row for each strategy and a column for each condition."""
    conditions = results.conditions(task)
    rows = []
    for strategy in results.strategies:
        cells = [_mean_and_deviation(results, task, condition, strategy) for condition in conditions]
        rows.append((f'`{strategy}`', *cells))
    return (f'{task}, {_count(results.samples).lower()}', *map(results.name_of, conditions)), rows


def _mean_and_deviation(results: Results, task: str, condition: Condition, strategy: str) -> str:
    group = results.group(task, condition, strategy)
    if not group:
        return ''
    values = np.array([row.final_accuracy for row in group])
    asked = '' if strategy == 'all_labels' else f' ({np.mean([row.queries for row in group]):.0f})'
    return f'{mean_and_deviation(values)}{asked}'


def comparison_table(results: Results, task: str, strategy: str) -> Table:
    """Return the tests of a strategy against each other one but ceilings, a row for each and each condition."""
    rows: list[tuple[str, ...]] = []
    for condition in results.conditions(task):
        accuracies = results.final_accuracies(task, condition)
        if not len(accuracies.get(strategy, ())):
            continue
        others = {name: values for name, values in accuracies.items() if name != strategy and name not in CEILINGS}
        rows += [
            (
                results.name_of(condition),
                f'`{c.other}`',
                f'{c.mean - c.other_mean:+.3f}',
                _short(c.p),
                _short(c.p_holm),
                _superiority(c),
                _short(c.p_paired),
            )
            for c in compare(accuracies[strategy], others)
        ]
    return (task, 'against', 'difference', 'p', 'Holm', 'superiority', 'paired p'), rows


def _superiority(comparison: Comparison) -> str:
    if comparison.interval is None:
        return f'{comparison.superiority:.2f}'
    low, high = comparison.interval
    return f'{comparison.superiority:.2f} [{low:.2f}, {high:.2f}]'


def _short(p: float) -> str:
    return '< .0001' if p < 0.0001 else f'{p:.4f}'


def _study(study: Study, comparison: Results, found: Mapping[str, Results], compared: str | None) -> list[str]:
    """Write a table of each cell with a column for each variant, or, of a single strategy, one with a row for each."""
    plan = next(iter(study.plans.values()))
    own = comparison.of_samples(plan.samples)
    cells = [(task, condition) for task in plan.tasks for condition in plan.conditions]
    about, columns = _count(plan.samples), dict(found)
    if any(own.group(*cell, strategy) for cell in cells for strategy in plan.strategies):
        about, columns = f'{about}; "{study.own}" is the comparison above.', {study.own: own, **found}
    if len(plan.strategies) == 1:
        (strategy,) = plan.strategies
        rows = [
            (label, *(_mean_and_deviation(results, *cell, strategy) for cell in cells))
            for label, results in columns.items()
        ]
        head = (f'`{strategy}`', *(f'{task}, {own.name_of(condition)}' for task, condition in cells))
        if compared in (None, strategy) or not any(own.group(*cell, compared) for cell in cells):
            return [about, _table(head, rows)]
        rows.append((f'beside it: `{compared}`', *(_mean_and_deviation(own, *cell, compared) for cell in cells)))
        return [about, _table(head, rows), _better_variants(strategy, compared, own, columns, cells)]
    tables = []
    for task, condition in cells:
        rows = [
            (f'`{name}`', *(_mean_and_deviation(results, task, condition, name) for results in columns.values()))
            for name in plan.strategies
        ]
        tables.append(_table((f'{task}, {own.name_of(condition)}', *columns), rows))
    return [about, *tables]


def _better_variants(
    strategy: str,
    compared: str,
    own: Results,
    columns: Mapping[str, Results],
    cells: Sequence[tuple[str, Condition]],
) -> str:
    """Name the variants of a strategy that are more accurate, in the mean, than the compared one."""
    found = []
    for task, condition in cells:
        ours = own.mean_accuracy(task, condition, compared)
        means = {label: results.mean_accuracy(task, condition, strategy) for label, results in columns.items()}
        known = {label: mean for label, mean in means.items() if mean is not None}
        better = [label for label, mean in known.items() if ours is not None and exceeds(mean, ours)]
        if better:
            found.append(f'{task}, {own.name_of(condition)}: {"; ".join(better)}')
    listed = '\n'.join(f'- {line}' for line in found)
    return f'More accurate than {compared}, in the mean:\n\n{listed}' if found else ''


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)
