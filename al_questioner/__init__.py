"""A robot that learns what things are by asking about them, and that asks wisely."""

__version__ = '0.1.0'
