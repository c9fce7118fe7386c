"""Errors that input and episodes raise; the text of each is one line."""

from __future__ import annotations


class InputError(ValueError):
    """Input that cannot be used; its text is one line that says what and where."""


class SceneError(InputError):
    """A scene that cannot be learnt from: empty, of inconsistent shape, or not finite."""


class SettingsError(InputError):
    """A setting outside its range, or an unknown name."""


class AnswerError(InputError):
    """An answer that does not fit the pending query."""


class EpisodeError(RuntimeError):
    """An episode that did not reach its end although the input was correct; its text is one line."""
