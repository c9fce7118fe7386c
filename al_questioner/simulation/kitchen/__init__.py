"""Procedural kitchen table: its objects, their places, their drawing, and the readings of its sensors."""
