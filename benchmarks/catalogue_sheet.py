"""One rendered view of every kind of thing in a catalogue, in every state, with the depth image beside it.

python benchmarks/catalogue_sheet.py --task prepare_lunch --out docs/figures/prepare_lunch.png
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt

from al_questioner.domain import random_stream
from al_questioner.simulation import load_task
from al_questioner.simulation.kitchen.pool import ObjectInstance, ViewSpec, observe
from al_questioner.simulation.kitchen.things.catalogue import CATALOGUES
from al_questioner.simulation.kitchen.things.vessels import Look
from al_questioner.simulation.simulated_world import describe

COLUMNS = 9


def main() -> None:
    """Draw the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--task', default='prepare_lunch')
    parser.add_argument('--only', help='only this symbol, or none for clutter')
    parser.add_argument('--out', type=Path, required=True)
    given = parser.parse_args()
    task = load_task(given.task)
    kinds = [k for k in CATALOGUES[task.appearance.catalogue or 'pack_lunchbox'] if given.only in (None, k.symbol)]
    rng = random_stream(1, 'catalogue_sheet')
    view_specs = []
    for kind in kinds:
        thing = ObjectInstance(kind, Look(size=1.0, hue_deg=0.0, tone=1.0, variant=float(rng.random())), 1.0, 0, (0,))
        view_specs += [ViewSpec(f'{kind.name}/{state}', thing, state, 0) for state in range(len(kind.states))]
    mpl.use('Agg')
    rows = -(-len(view_specs) // COLUMNS)
    figure, grid = plt.subplots(rows, COLUMNS, figsize=(1.5 * COLUMNS, 1.3 * rows), layout='constrained', squeeze=False)
    for axes in grid.flat:
        axes.set_axis_off()
    for axes, view_spec in zip(grid.flat, view_specs, strict=False):
        view = observe(view_spec, task, 1, 1).view
        depth = np.clip((1300 - view.depth.astype(float)) / 500, 0, 1) * (view.depth > 0)
        grey = (255 * np.repeat(depth[..., None], 3, axis=2)).astype(np.uint8)
        axes.imshow(np.hstack([cv2.cvtColor(view.color, cv2.COLOR_BGR2RGB), grey]))
        axes.set_title(describe(view_spec), fontsize=8)
    given.out.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(given.out, dpi=110)


if __name__ == '__main__':
    main()
