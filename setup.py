"""Where the files beside the Python package go; everything else is declared in setup.cfg."""

from collections import defaultdict
from pathlib import Path

from setuptools import setup

NAME = 'al_questioner'
SHARE = f'share/{NAME}'
SHARED = ('.cfg', '.db3', '.json', '.mcap', '.md', '.py', '.rviz', '.yaml')


def data_files() -> list[tuple[str, list[str]]]:
    """What ROS tools look for under the install prefix, alike for pip and colcon."""
    files = defaultdict(list)
    files['share/ament_index/resource_index/packages'].append(f'resource/{NAME}')
    files[SHARE].append('package.xml')
    for folder in ('bags', 'config', 'docs/examples', 'launch'):
        for path in sorted(Path(folder).rglob('*')):
            if path.suffix in SHARED and 'build' not in path.parts:
                files[f'{SHARE}/{path.parent.as_posix().removeprefix("docs/")}'].append(path.as_posix())
    # Not entry points: pip would put names as generic as `demo` into the environment's bin folder.
    files[f'lib/{NAME}'] += sorted(path.as_posix() for path in Path('scripts').iterdir())
    return sorted(files.items())


# colcon cannot read python_requires from setup.cfg.
setup(python_requires='>=3.10', data_files=data_files())
