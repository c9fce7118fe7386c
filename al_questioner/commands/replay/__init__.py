"""The `replay` executable: plays a bag, shows its scenes to a learner, or checks it."""
