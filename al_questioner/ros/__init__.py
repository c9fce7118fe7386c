"""The only folder that knows ROS: what all nodes need, and in `nodes` one node a file."""
