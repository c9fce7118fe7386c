"""Reader of a directory in the layout of the University of Washington RGB-D Object Dataset.

    ROOT/CATEGORY/CATEGORY_N/CATEGORY_N_V_F_{crop,depthcrop,maskcrop}.png and CATEGORY_N_V_F_loc.txt

N numbers the physical objects of a category, V the videos of an object, F the frames of a video. The depth crop is
uint16 millimetres, the mask above 0 on the object, and the text holds the 1-based `column,row` of the crop's top left
pixel in its frame (Lai, Bo, Ren and Fox, A Large-Scale Hierarchical Multi-View RGB-D Object Dataset, ICRA 2011).
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Camera, InputError, View
from al_questioner.domain.names import meant
from al_questioner.domain.spelling import composed

_SUFFIXES = ('_crop.png', '_depthcrop.png', '_maskcrop.png', '_loc.txt')
LAYOUT = (
    'each crop is expected as CATEGORY/CATEGORY_N/CATEGORY_N_V_F_crop.png with _depthcrop.png, _maskcrop.png, _loc.txt'
)
_STEM = re.compile(r'(?P<category>.+)_(?P<instance>\d+)_(?P<video>\d+)_(?P<frame>\d+)')
_PNG_START = b'\x89PNG\r\n\x1a\n'
_AROUND_CHUNK = 12
"""Number of bytes of a PNG chunk beside its data: the length and kind before, the checksum after."""


@dataclass(frozen=True)
class Skipped:
    """A file, or a crop by its common stem, that cannot be used, and why."""

    path: Path
    reason: str

    def __str__(self) -> str:
        return f'{self.path}: {self.reason}'


@dataclass(frozen=True, order=True)
class CropFiles:
    """One view of one physical object; `stem` is the common part of the paths of its four files."""

    category: str
    instance: int
    video: int
    frame: int
    stem: Path

    @property
    def thing(self) -> tuple[str, int]:
        """Category and number of the physical object."""
        return self.category, self.instance


@dataclass(frozen=True)
class CropIndex:
    """Content of a directory for the wanted categories; only names have been read.

    Attributes:
        root: the folder that holds the categories' folders.
        crops: complete crops by category, sorted, for each wanted category that has any.
        absent: wanted categories without a folder, or without a complete crop.
        skipped: files that are ignored.
    """

    root: Path
    crops: dict[str, tuple[CropFiles, ...]]
    absent: tuple[str, ...]
    skipped: tuple[Skipped, ...]


class CropError(InputError):
    """A crop that cannot be used; `skipped` holds the file at fault and the reason."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f'{path}: {reason}')
        self.skipped = Skipped(path, reason)


def index_crops(root: Path, categories: Iterable[str]) -> CropIndex:
    """List the crops of some categories by their files' names.

    A crop counts if all of its four files are there. The location is required as well: every crop of the original has
    one, so its absence marks a damaged copy, and an invented place in the frame would be worse than one view less.

    Args:
        root: the dataset, or the folder that holds it as `rgbd-dataset`, its name in the original archive.
        categories: names of the wanted categories.

    Raises:
        InputError: no such directory, or no complete crop of any wanted category.
    """
    wanted = tuple(categories)
    if not root.is_dir():
        raise InputError(f'dataset {root}: {"not a directory" if root.exists() else "does not exist"}')
    skipped: list[Skipped] = []
    folders = _folders(root, wanted, skipped)
    if not folders and (root / 'rgbd-dataset').is_dir():
        root = root / 'rgbd-dataset'
        folders = _folders(root, wanted, skipped)
    crops: dict[str, tuple[CropFiles, ...]] = {}
    for category, folder in folders.items():
        found = _index_category(category, folder, skipped)
        if found:
            crops[category] = tuple(sorted(found))
    if not crops:
        missing = f'; {len(skipped)} files were skipped, the first: {skipped[0]}' if skipped else ''
        raise InputError(f'dataset {root}: no complete crop of any of {", ".join(wanted)}{missing}; {LAYOUT}')
    absent = tuple(category for category in wanted if category not in crops)
    return CropIndex(root, crops, absent, tuple(skipped))


def _folders(root: Path, wanted: Sequence[str], skipped: list[Skipped]) -> dict[str, Path]:
    """Return the folder of each category that has one: of exactly its name, or of a name that people take for the same.

    Some systems write names in decomposed Unicode, and some ignore case.
    """
    names = [name for name in _names(root, skipped) if (root / name).is_dir()]
    others = [name for name in names if name not in wanted]
    folders: dict[str, Path] = {}
    for category in wanted:
        found = [category] if category in names else meant(category, others)
        if len(found) == 1:
            folders[category] = root / found[0]
        else:
            skipped += [Skipped(root / name, f'not the only folder that may be {category}') for name in found]
    return folders


def _index_category(category: str, folder: Path, skipped: list[Skipped]) -> list[CropFiles]:
    found: list[CropFiles] = []
    for name in _names(folder, skipped):
        path = folder / name
        prefix, _, number = composed(name).rpartition('_')
        if not path.is_dir() or prefix != composed(folder.name) or not number.isdecimal():
            skipped.append(Skipped(path, f'not a folder named {folder.name}_N'))
            continue
        complete = _index_object(category, path, skipped)
        if not complete:
            skipped.append(Skipped(path, 'holds no complete crop'))
        found += complete
    return found


def _index_object(category: str, folder: Path, skipped: list[Skipped]) -> list[CropFiles]:
    suffixes_of: dict[str, list[str]] = {}
    for name in _names(folder, skipped):
        suffix = next((suffix for suffix in _SUFFIXES if name.endswith(suffix)), None)
        if suffix is None:
            skipped.append(Skipped(folder / name, 'not a file of the dataset'))
        else:
            suffixes_of.setdefault(name.removesuffix(suffix), []).append(suffix)
    complete = []
    for stem, suffixes in suffixes_of.items():
        match = _STEM.fullmatch(stem)
        missing = [suffix for suffix in _SUFFIXES if suffix not in suffixes]
        if match is None:
            skipped.append(Skipped(folder / stem, 'not named CATEGORY_N_V_F'))
        elif composed(f'{match["category"]}_{match["instance"]}') != composed(folder.name):
            skipped.append(Skipped(folder / stem, f'belongs to another object than its folder {folder.name}'))
        elif missing:
            skipped.append(Skipped(folder / stem, f'incomplete: no {", ".join(missing)}'))
        else:
            instance, video, frame = (int(match[name]) for name in ('instance', 'video', 'frame'))
            complete.append(CropFiles(category, instance, video, frame, folder / stem))
    return complete


def _names(folder: Path, skipped: list[Skipped]) -> list[str]:
    """Return the names in a folder, sorted, without the hidden files that operating systems leave."""
    try:
        with os.scandir(folder) as entries:
            return sorted(entry.name for entry in entries if not entry.name.startswith('.'))
    except OSError as error:
        skipped.append(Skipped(folder, f'cannot be listed ({error.strerror})'))
        return []


def read_view(crop: CropFiles, camera: Camera) -> View:
    """Read the four files of a crop.

    Raises:
        CropError: a file that is missing, damaged or of the wrong kind, images of different sizes, an empty mask,
            or no depth reading on the object.
    """
    paths = [crop.stem.with_name(crop.stem.name + suffix) for suffix in _SUFFIXES]
    color_path, depth_path, mask_path, location_path = paths
    color = _read_png(color_path, cv2.IMREAD_COLOR, np.uint8)
    depth = _read_png(depth_path, cv2.IMREAD_UNCHANGED, np.uint16, 'millimetres')
    mask = _read_png(mask_path, cv2.IMREAD_GRAYSCALE, np.uint8) > 0
    for path, image in ((depth_path, depth), (mask_path, mask)):
        if image.shape != color.shape[:2]:
            raise CropError(path, f'has shape {image.shape}, but the colour image {color.shape[:2]}')
    if not mask.any():
        raise CropError(mask_path, 'marks no pixel as the object')
    if not depth[mask].any():
        raise CropError(depth_path, 'has no reading on the object')
    return View(color, depth, mask, camera, _read_location(location_path))


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise CropError(path, f'cannot be read ({error.strerror})') from error


def _read_png(path: Path, flags: int, dtype: type[np.unsignedinteger], unit: str = 'levels') -> NDArray[Any]:
    content = _whole_png(_read_bytes(path))
    # For a truncated file, OpenCV would print an error of its own, or return a part of the image.
    try:
        image = cv2.imdecode(np.frombuffer(content, np.uint8), flags) if content else None
    except cv2.error as error:
        raise CropError(path, f'cannot be decoded ({error.err})') from error
    if image is None:
        raise CropError(path, 'not a complete PNG image')
    if image.dtype != dtype:
        raise CropError(path, f'is {image.dtype}, expected {np.dtype(dtype)} {unit}')
    return image


def _whole_png(content: bytes) -> bytes:
    """Return the image without data that cameras and tools append to it; empty if it is truncated."""
    at = len(_PNG_START) if content.startswith(_PNG_START) else len(content)
    while at + _AROUND_CHUNK <= len(content):
        kind = content[at + 4 : at + 8]
        at += _AROUND_CHUNK + int.from_bytes(content[at : at + 4], 'big')
        if kind == b'IEND' and at <= len(content):
            return content[:at]
    return b''


def _read_location(path: Path) -> tuple[int, int]:
    try:
        column, row = (int(number) for number in _read_bytes(path).decode('ascii').split(','))
    except ValueError as error:
        raise CropError(path, 'expected the column and row of the crop, such as 195,219') from error
    return column - 1, row - 1
