"""Experiments of the paper: their plan, runs, statistics, figures and reports."""
