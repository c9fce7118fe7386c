"""The only room that knows ROS: quality of service, parameters, and one thin node a file."""
