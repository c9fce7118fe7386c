"""A learner that is killed when it writes its session.

    python killed_learner.py POINT --ros-args ...

runs the learner node with the arguments of the executable; at the write point of this number it kills itself.
"""

from __future__ import annotations

import sys
from functools import partial

from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.running import spin_nodes
from storages import WatchedStorage, killer


def main() -> int:
    storage = partial(WatchedStorage, reached=killer(int(sys.argv[1])))
    return spin_nodes([partial(LearnerNode, yields=True, storage=storage)], sys.argv[2:])


if __name__ == '__main__':
    sys.exit(main())
