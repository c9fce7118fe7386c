"""Reading a dataset's directory: names, what is passed over, and the content of a crop."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from al_questioner.domain import Camera, InputError
from al_questioner.world.recorded.files import CropError, CropFiles, index_crops, read_view

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
    """A quarter of the data would be left out, as a Mac writes names in another form of Unicode."""
    tree.add(folder)
    tree.add('apple')
    index = index_crops(tree.root, ['apple', 'Früchte'])
    assert (index.absent, index.skipped) == ((), ())
    assert [crop.category for crop in index.crops['Früchte']] == ['Früchte']


def test_a_folder_of_the_very_name_comes_first_and_of_two_others_neither_is_guessed(tree: Tree) -> None:
    """The crops of one category would be taken for those of another."""
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
    (tree.root / 'apple' / 'apple_2').mkdir()
    (tree.root / 'apple' / 'apple_x').mkdir()
    (tree.root / 'apple' / 'pear_1').mkdir()
    (crop.stem.parent / 'Thumbs.db').write_text('')
    (crop.stem.parent / 'apple_1_1_1.png').write_text('')
    (crop.stem.parent / 'apple_7_1_1_crop.png').write_text('')
    (crop.stem.parent / 'apple_1_crop.png').write_text('')
    (crop.stem.parent / '.DS_Store').write_text('')
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


def test_root_that_does_not_exist_is_refused(tree: Tree) -> None:
    with pytest.raises(InputError, match=r'nowhere: does not exist$'):
        index_crops(tree.root / 'nowhere', ['apple'])


def test_root_that_is_a_file_is_refused(tree: Tree) -> None:
    (tree.root / 'file').write_text('')
    with pytest.raises(InputError, match=r'file: not a directory$'):
        index_crops(tree.root / 'file', ['apple'])


def test_root_without_any_wanted_crop_is_refused(tree: Tree) -> None:
    tree.add('stapler')
    with pytest.raises(
        InputError, match=r'no complete crop of any of apple, pear; each crop is expected as CATEGORY/CATEGORY_N/'
    ):
        index_crops(tree.root, ['apple', 'pear'])


def test_root_with_half_crops_only_says_so(tree: Tree) -> None:
    tree.part(tree.add('apple'), 'loc.txt').unlink()
    with pytest.raises(InputError, match=r'no complete crop of any of apple; 2 .*incomplete: no _loc.txt; each crop'):
        index_crops(tree.root, ['apple'])


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


def _cut_short(tree: Tree, crop: CropFiles) -> None:
    path = tree.part(crop, 'crop.png')
    path.write_bytes(path.read_bytes()[:-20])


def _of_billions_of_pixels(tree: Tree, crop: CropFiles) -> None:
    path = tree.part(crop, 'crop.png')
    header = b'IHDR' + b'\0\1\0\0' * 2 + path.read_bytes()[24:29]
    path.write_bytes(path.read_bytes()[:12] + header + zlib.crc32(header).to_bytes(4, 'big') + path.read_bytes()[33:])


@pytest.mark.parametrize('tail', [b'\n', b'\0' * 1000, b'trailing IEND\xaeB`\x82', b'\x89PNG\r\n\x1a\n'])
def test_bytes_after_the_end_of_an_image_do_not_matter(tree: Tree, tail: bytes) -> None:
    """Cameras and tools append what they like; the views of such a dataset would all be passed over."""
    crop = tree.add('apple')
    before = read_view(crop, CAMERA)
    for name in ('crop.png', 'depthcrop.png', 'maskcrop.png'):
        path = tree.part(crop, name)
        path.write_bytes(path.read_bytes() + tail)
    view = read_view(crop, CAMERA)
    assert np.array_equal(view.color, before.color)
    assert np.array_equal(view.depth, before.depth)
    assert np.array_equal(view.mask, before.mask)


DAMAGES: dict[str, tuple[Callable[[Tree, CropFiles], object], str]] = {
    'cut short': (_cut_short, 'crop.png: not a complete PNG image'),
    'cut short in its last chunk, with a tail': (
        lambda tree, crop: tree.part(crop, 'crop.png').write_bytes(
            tree.part(crop, 'crop.png').read_bytes()[:-6] + b'.'
        ),
        'crop.png: not a complete PNG image',
    ),
    'billions of pixels': (_of_billions_of_pixels, r'crop.png: cannot be decoded \('),
    'empty file': (
        lambda tree, crop: tree.part(crop, 'crop.png').write_bytes(b''),
        'crop.png: not a complete PNG image',
    ),
    'no image': (
        lambda tree, crop: tree.part(crop, 'maskcrop.png').write_text('hello'),
        'maskcrop.png: not a complete PNG image',
    ),
    'gone meanwhile': (lambda tree, crop: tree.part(crop, 'depthcrop.png').unlink(), 'depthcrop.png: cannot be read'),
    'depth of 8 bits': (
        lambda tree, crop: tree.write(crop, 'depthcrop', np.ones((24, 20), np.uint8)),
        'depthcrop.png: is uint8, expected uint16 millimetres',
    ),
    'smaller mask': (
        lambda tree, crop: tree.write(crop, 'maskcrop', np.ones((10, 20), np.uint8)),
        r'maskcrop.png: has shape \(10, 20\), but the colour image \(24, 20\)',
    ),
    'colour depth image': (
        lambda tree, crop: tree.write(crop, 'depthcrop', np.ones((24, 20, 3), np.uint16)),
        'depthcrop.png: has shape',
    ),
    'empty mask': (
        lambda tree, crop: tree.write(crop, 'maskcrop', np.zeros((24, 20), np.uint8)),
        'maskcrop.png: marks no pixel',
    ),
    'no depth on the object': (
        lambda tree, crop: tree.write(crop, 'depthcrop', np.zeros((24, 20), np.uint16)),
        'depthcrop.png: has no reading on the object',
    ),
    'location of one number': (
        lambda tree, crop: tree.part(crop, 'loc.txt').write_text('12'),
        'loc.txt: expected the column and row',
    ),
    'location of words': (
        lambda tree, crop: tree.part(crop, 'loc.txt').write_text('a,b'),
        'loc.txt: expected the column and row',
    ),
    'location of bytes': (
        lambda tree, crop: tree.part(crop, 'loc.txt').write_bytes(b'\xff\xfe'),
        'loc.txt: expected the column and row',
    ),
}


@pytest.mark.parametrize('damage', DAMAGES)
def test_damaged_crop_is_refused_with_its_file_and_reason(tree: Tree, damage: str) -> None:
    crop = tree.add('apple')
    inflict, message = DAMAGES[damage]
    inflict(tree, crop)
    with pytest.raises(CropError, match=message) as caught:
        read_view(crop, CAMERA)
    assert caught.value.skipped.path.parent == crop.stem.parent
    assert '\n' not in str(caught.value)
