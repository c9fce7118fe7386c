"""A person who teaches at a terminal: what is shown, what keys and lines mean, and what was said."""

from al_questioner.terminal.dialogue import TeacherDialogue
from al_questioner.terminal.view_state import EpisodeProgress, PastAnswer, Phase, Picture, Prompt, ViewState

__all__ = ['EpisodeProgress', 'PastAnswer', 'Phase', 'Picture', 'Prompt', 'TeacherDialogue', 'ViewState']
