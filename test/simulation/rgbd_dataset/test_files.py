"""Reading a dataset's directory: names, what is passed over, and the content of a crop."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from al_questioner.domain import Camera, InputError
from al_questioner.simulation.rgbd_dataset.files import CropError, index_crops, read_view

if TYPE_CHECKING:
    from conftest import Tree

CAMERA = Camera(525.0, 525.0, 319.5, 239.5)


def test_category_with_an_underscore_is_parsed(tree: Tree) -> None:
    crop = tree.add('soda_can', instance=12, video=4, frame=103)
    index = index_crops(tree.root, ['soda_can'])
    assert index.crops == {'soda_can': (crop,)}
    assert crop.thing == ('soda_can', 12)
    assert not index.skipped


def test_category_that_ends_in_a_number_is_parsed(tree: Tree) -> None:
    crop = tree.add('food_2', instance=3, frame=1)
    assert index_crops(tree.root, ['food_2']).crops == {'food_2': (crop,)}


def test_only_wanted_categories_are_listed_and_absent_ones_named(tree: Tree) -> None:
    tree.add_category('apple', objects=2, views=2)
    tree.add_category('stapler', objects=1, views=1)
    (tree.root / 'pear').mkdir()
    index = index_crops(tree.root, ['pear', 'apple', 'peach'])
    assert list(index.crops) == ['apple']
    assert index.absent == ('pear', 'peach')


@pytest.mark.parametrize('folder', ['Fru\u0308chte', 'früchte', 'FRÜCHTE'])
def test_a_folder_whose_name_only_looks_other_is_found(tree: Tree, folder: str) -> None:
    """Otherwise a quarter of the data would be left out, as a Mac writes names in another form of Unicode."""
    tree.add(folder)
    tree.add('apple')
    index = index_crops(tree.root, ['apple', 'Früchte'])
    assert (index.absent, index.skipped) == ((), ())
    assert [crop.category for crop in index.crops['Früchte']] == ['Früchte']


def test_a_folder_of_the_very_name_comes_first_and_of_two_others_neither_is_guessed(tree: Tree) -> None:
    """Otherwise the crops of one category would be taken for those of another."""
    for folder in ('apple', 'Apple', 'Pear', 'PEAR', 'plum'):
        tree.add(folder)
    index = index_crops(tree.root, ['apple', 'pear', 'Plum', 'plum'])
    assert index.crops.keys() == {'apple', 'plum'}
    assert index.absent == ('pear', 'Plum')
    assert [skipped.reason for skipped in index.skipped] == ['not the only folder that may be pear'] * 2


def test_frames_come_in_numeric_order_whatever_the_file_system_says(tree: Tree) -> None:
    for frame in (10, 9, 100, 1):
        tree.add('apple', 1, frame)
    assert [crop.frame for crop in index_crops(tree.root, ['apple']).crops['apple']] == [1, 9, 10, 100]


def test_folder_above_the_dataset_will_do(tree: Tree) -> None:
    type(tree)(tree.root / 'rgbd-dataset').add('apple')
    assert index_crops(tree.root, ['apple']).root == tree.root / 'rgbd-dataset'


@pytest.mark.parametrize('name', ['crop.png', 'depthcrop.png', 'maskcrop.png', 'loc.txt'])
def test_crop_without_one_of_its_files_is_named_and_skipped(tree: Tree, name: str) -> None:
    whole, half = tree.add('apple'), tree.add('apple', 1, 2)
    tree.part(half, name).unlink()
    index = index_crops(tree.root, ['apple'])
    assert index.crops['apple'] == (whole,)
    assert [str(skipped) for skipped in index.skipped] == [f'{half.stem}: incomplete: no _{name}']


def test_stray_files_and_folders_are_named_and_skipped(tree: Tree) -> None:
    crop = tree.add('apple')
    (tree.root / 'apple' / 'README').write_text('hello')
    for folder in ('apple_2', 'apple_x', 'pear_1'):
        (tree.root / 'apple' / folder).mkdir()
    for file in ('Thumbs.db', 'apple_1_1_1.png', 'apple_7_1_1_crop.png', 'apple_1_crop.png', '.DS_Store'):
        (crop.stem.parent / file).write_text('')
    index = index_crops(tree.root, ['apple'])
    assert index.crops['apple'] == (crop,)
    assert {skipped.path.name: skipped.reason for skipped in index.skipped} == {
        'README': 'not a folder named apple_N',
        'apple_2': 'holds no complete crop',
        'apple_x': 'not a folder named apple_N',
        'pear_1': 'not a folder named apple_N',
        'Thumbs.db': 'not a file of the dataset',
        'apple_1_1_1.png': 'not a file of the dataset',
        'apple_1': 'not named CATEGORY_N_V_F',
        'apple_7_1_1': 'belongs to another object than its folder apple_1',
    }


@pytest.mark.parametrize(
    ('name', 'reason'),
    [
        ('nowhere', r'nowhere: does not exist$'),
        ('file', r'file: not a directory$'),
        ('', r'no complete crop of any of peach, pear; each crop is expected as CATEGORY/CATEGORY_N/'),
        ('half', r'no complete crop of any of peach, pear; 2 .*incomplete: no _loc.txt; each crop'),
    ],
)
def test_root_without_any_wanted_crop_is_refused(tree: Tree, name: str, reason: str) -> None:
    (tree.root / 'file').write_text('')
    tree.add('stapler')
    half = type(tree)(tree.root / 'half')
    half.part(half.add('pear'), 'loc.txt').unlink()
    with pytest.raises(InputError, match=reason):
        index_crops(tree.root / name, ['peach', 'pear'])


def test_view_is_what_the_files_hold(tree: Tree) -> None:
    crop = tree.add('apple', instance=3, frame=7)
    view = read_view(crop, CAMERA)
    assert (view.color.shape, view.color.dtype) == ((24, 20, 3), np.uint8)
    assert view.depth.dtype == np.uint16
    assert set(view.depth.ravel().tolist()) == {700}
    assert view.mask.dtype == bool
    assert view.mask.sum() == 20 * 16
    assert view.origin == (106, 202)
    assert view.camera is CAMERA


def test_mask_of_ones_counts_as_well_as_one_of_255(tree: Tree) -> None:
    crop = tree.add('apple')
    tree.write(crop, 'maskcrop', np.ones((24, 20), dtype=np.uint8))
    assert read_view(crop, CAMERA).mask.all()


@pytest.mark.parametrize('tail', [b'\n', b'\0' * 1000, b'trailing IEND\xaeB`\x82', b'\x89PNG\r\n\x1a\n'])
def test_bytes_after_the_end_of_an_image_do_not_matter(tree: Tree, tail: bytes) -> None:
    """Cameras and tools append what they like; the views of such a dataset are read all the same."""
    crop = tree.add('apple')
    before = read_view(crop, CAMERA)
    for name in ('crop.png', 'depthcrop.png', 'maskcrop.png'):
        path = tree.part(crop, name)
        path.write_bytes(path.read_bytes() + tail)
    view = read_view(crop, CAMERA)
    assert np.array_equal(view.color, before.color)
    assert np.array_equal(view.depth, before.depth)
    assert np.array_equal(view.mask, before.mask)


def _of_billions_of_pixels(content: bytes) -> bytes:
    header = b'IHDR' + b'\0\1\0\0' * 2 + content[24:29]
    return content[:12] + header + zlib.crc32(header).to_bytes(4, 'big') + content[33:]


@pytest.mark.parametrize(
    ('name', 'damage', 'reason'),
    [
        ('crop', lambda content: content[:-20], 'not a complete PNG image'),
        # Cut short in its last chunk, with a tail.
        ('crop', lambda content: content[:-6] + b'.', 'not a complete PNG image'),
        ('crop', _of_billions_of_pixels, r'cannot be decoded \('),
        ('crop', b'', 'not a complete PNG image'),
        ('maskcrop', b'hello', 'not a complete PNG image'),
        ('depthcrop', None, 'cannot be read'),
        ('depthcrop', np.ones((24, 20), np.uint8), 'is uint8, expected uint16 millimetres'),
        ('maskcrop', np.ones((10, 20), np.uint8), r'has shape \(10, 20\), but the colour image \(24, 20\)'),
        ('depthcrop', np.ones((24, 20, 3), np.uint16), 'has shape'),
        ('maskcrop', np.zeros((24, 20), np.uint8), 'marks no pixel'),
        ('depthcrop', np.zeros((24, 20), np.uint16), 'has no reading on the object'),
        *(('loc', content, 'expected the column and row') for content in (b'12', b'a,b', b'\xff\xfe')),
    ],
)
def test_damaged_crop_is_refused_with_its_file_and_reason(tree: Tree, name: str, damage: Any, reason: str) -> None:
    crop = tree.add('apple')
    file = f'{name}.txt' if name == 'loc' else f'{name}.png'
    path = tree.part(crop, file)
    if damage is None:
        path.unlink()
    elif isinstance(damage, np.ndarray):
        tree.write(crop, name, damage)
    else:
        path.write_bytes(damage(path.read_bytes()) if callable(damage) else damage)
    with pytest.raises(CropError, match=f'{file}: {reason}') as caught:
        read_view(crop, CAMERA)
    assert caught.value.skipped.path.parent == crop.stem.parent
    assert '\n' not in str(caught.value)
