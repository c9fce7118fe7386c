"""The behaviour of each node, as a state machine without input or output: messages and timers in, effects out."""
