"""The `experiment` executable: plays, tests and draws comparisons."""
