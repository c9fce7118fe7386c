"""Interface of a person who teaches at a terminal: the screen, and the meaning of keys and lines."""
