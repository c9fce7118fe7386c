"""One learning episode to watch: live progress, a summary, pictures, and everything as JSON."""
