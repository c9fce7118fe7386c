"""The events of an episode: their encoding, the durable log, replaying it, and the episode that is written down."""
