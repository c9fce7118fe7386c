"""The events of an episode: encoding, durable log, replay, the episode that is written down, and what is told of it."""
