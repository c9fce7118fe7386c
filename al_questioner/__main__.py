"""`python -m al_questioner EXECUTABLE ...`: what `ros2 run al_questioner EXECUTABLE ...` is on a ROS install."""

from al_questioner.support import interrupts

# Before anything that takes a while to import.
if __name__ == '__main__':
    interrupts.install()

import os
import sys

# The matrices are small, and several nodes share the cores: threads of linear algebra that spin while they wait for
# each other would cost far more than they bring. It must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

from al_questioner.cli import main

if __name__ == '__main__':
    sys.exit(main())
