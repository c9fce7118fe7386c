#!/bin/sh
# Runs the executable that it is called by: each name in `scripts` is a link to this file.
# pip installs it beside an environment's own interpreter; elsewhere the sourced ROS environment knows the right one.
python=$(dirname -- "$0")/../../bin/python3
[ -x "$python" ] || python=python3
# Without this, a checkout in the working directory would run instead of the installed package.
export PYTHONSAFEPATH=1
exec "$python" -m al_questioner "$(basename -- "$0")" "$@"
