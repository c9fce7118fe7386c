"""A world of real things: RGB-D crops in the layout of the University of Washington RGB-D Object Dataset."""
