"""Tools for every part of the package that know nothing of robots: files, configuration, arguments, text, pictures."""
