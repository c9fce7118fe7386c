"""The questioning strategies, one a file, with what they share and weigh; the registry finds them by name."""
