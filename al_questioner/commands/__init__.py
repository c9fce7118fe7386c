"""The command lines of the executables, and what those do that are no nodes."""
