"""World of real objects: RGB-D crops in the layout of the University of Washington RGB-D Object Dataset."""
