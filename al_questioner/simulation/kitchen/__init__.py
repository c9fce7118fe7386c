"""The procedural kitchen table: what lies on it, where, how it is drawn, and what its sensors read."""
