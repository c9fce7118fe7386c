"""How a solid looks to an RGB-D camera: shape, surface, light, projection, and what the depth sensor makes of it."""
