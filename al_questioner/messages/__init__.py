"""Domain objects as JSON documents, point clouds and images, for whichever message classes the caller hands in."""
