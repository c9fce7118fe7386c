"""The command line of `record`; no ROS is needed to refuse it, or to show its help."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from al_questioner.domain import InputError
from al_questioner.ros.node_arguments import read_node_arguments
from al_questioner.ros.settings import RECORDER_SETTINGS
from al_questioner.support.configuration import named_bag

RECORD = """Records the topics of learning episodes into a bag, or makes one whole whose recording was killed.

usage: record --ros-args -p bag:=PATH ...
       record --repair BAG"""


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments: `repair` is the bag to repair, or None; `ros` holds the recorder's ROS arguments."""
    if arguments and arguments[0] == '--repair':
        if len(arguments) != 2:
            raise InputError(f'--repair takes one bag, not {len(arguments) - 1}')
        return argparse.Namespace(repair=named_bag(arguments[1]))
    return argparse.Namespace(repair=None, ros=read_node_arguments(arguments, RECORD, RECORDER_SETTINGS))
