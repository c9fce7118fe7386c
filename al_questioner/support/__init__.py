"""What every part may use and that knows nothing of robots: files, configuration, arguments, text, pictures."""
