"""Drawing of a solid for an RGB-D camera: shape, surface, light, projection, and the depth sensor."""
