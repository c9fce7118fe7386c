"""Dialogue of a person who teaches with the robot, and all that is shown to them, on whatever screen."""

from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import EpisodeProgress, PastAnswer, Phase, Picture, Prompt, ViewState

__all__ = ['EpisodeProgress', 'PastAnswer', 'Phase', 'Picture', 'Prompt', 'TeacherDialogue', 'ViewState']
