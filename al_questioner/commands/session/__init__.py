"""The `session` executable: the log of a learner's session, shown, checked, repaired and exported."""
