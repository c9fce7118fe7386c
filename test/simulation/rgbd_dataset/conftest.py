"""Small directories in the layout of the University of Washington RGB-D Object Dataset."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from al_questioner.simulation.rgbd_dataset.files import CropFiles


class Tree:
    """A dataset's directory that a test fills, and damages."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def add(self, category: str, instance: int = 1, frame: int = 1, video: int = 1) -> CropFiles:
        """Write the four files of one view: a plain rectangle of a colour of its own, 0.7 m away."""
        folder = self.root / category / f'{category}_{instance}'
        folder.mkdir(parents=True, exist_ok=True)
        crop = CropFiles(category, instance, video, frame, folder / f'{category}_{instance}_{video}_{frame}')
        shade = sum(map(ord, category)) * 31 + 40 * instance + frame
        mask = np.zeros((24, 20), dtype=np.uint8)
        mask[2:22, 2:18] = 255
        self.write(crop, 'crop', np.full((24, 20, 3), [shade % 256, shade * 7 % 256, shade * 13 % 256], dtype=np.uint8))
        self.write(crop, 'depthcrop', np.full((24, 20), 700, dtype=np.uint16))
        self.write(crop, 'maskcrop', mask)
        self.part(crop, 'loc.txt').write_text(f'{100 + frame},{200 + instance}\n')
        return crop

    def add_category(self, category: str, objects: int, views: int) -> list[CropFiles]:
        """Write a category with these numbers of objects and of views of each."""
        return [self.add(category, n, frame) for n in range(1, objects + 1) for frame in range(1, views + 1)]

    @staticmethod
    def part(crop: CropFiles, name: str) -> Path:
        """Path of one of the four files of a crop."""
        return crop.stem.with_name(f'{crop.stem.name}_{name}')

    def write(self, crop: CropFiles, name: str, image: np.ndarray) -> None:
        """Replace an image of a crop."""
        self.part(crop, f'{name}.png').write_bytes(cv2.imencode('.png', image)[1].tobytes())


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    return Tree(tmp_path)
