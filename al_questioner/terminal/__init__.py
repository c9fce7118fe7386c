"""Interface of a person who teaches at a terminal: the screen, the meaning of keys and lines, and the dialogue."""

from al_questioner.terminal.dialogue import TeacherDialogue
from al_questioner.terminal.view_state import EpisodeProgress, PastAnswer, Phase, Picture, Prompt, ViewState

__all__ = ['EpisodeProgress', 'PastAnswer', 'Phase', 'Picture', 'Prompt', 'TeacherDialogue', 'ViewState']
