"""The environment of the programs that `make` runs."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

from shared.checkout import ROOT

OF_ROS = {
    'AMENT_PREFIX_PATH': '/opt/ros/jazzy',
    'LD_LIBRARY_PATH': '/opt/ros/jazzy/lib',
    'PYTHONPATH': '/opt/ros/jazzy/lib/python3.12/site-packages',
    'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp',
}


@pytest.mark.skipif(shutil.which('make') is None, reason='make is not installed')
def test_a_ros_that_is_set_up_does_not_mix_with_that_of_the_environment() -> None:
    """Otherwise `make demo` would load half of its libraries from either."""
    command = ['make', '--silent', '--eval', 'show:; @env', 'show']
    printed = subprocess.check_output(command, cwd=ROOT, env=os.environ | OF_ROS, text=True)
    seen = dict(line.split('=', 1) for line in printed.splitlines() if '=' in line)
    assert 'PATH' in seen
    assert not OF_ROS.keys() & seen.keys()
