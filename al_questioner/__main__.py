"""`python -m al_questioner EXECUTABLE ...`: what `ros2 run al_questioner EXECUTABLE ...` is on a ROS install."""

import sys

from al_questioner.cli import main

if __name__ == '__main__':
    sys.exit(main())
