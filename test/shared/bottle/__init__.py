"""A whole graph in one process, on a clock of its own, under every fault at once: one seed, one course of events."""
