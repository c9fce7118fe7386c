"""The `concepts` executable: what learners know, shown, merged, changed and exported."""
