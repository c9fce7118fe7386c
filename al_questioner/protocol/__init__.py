"""What each node does, as a state machine without input or output: messages and timers in, effects out."""
