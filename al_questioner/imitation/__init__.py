"""Imitating an expert questioner: demonstrations, and inverse reinforcement learning of the decision weights."""
