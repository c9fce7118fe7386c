"""A learner that is killed when it writes its session.

    python killed_learner.py POINT --ros-args ...

runs the learner node with the arguments of the executable; at the write point of this number it kills itself.
"""

from __future__ import annotations

import sys
from functools import partial

from storages import WatchedStorage, killer

# First, as it says how many threads linear algebra has.
from al_questioner import __main__  # noqa: F401
from al_questioner.ros.nodes import learner

if __name__ == '__main__':
    sys.exit(learner.main(sys.argv[2:], partial(WatchedStorage, reached=killer(int(sys.argv[1])))))
