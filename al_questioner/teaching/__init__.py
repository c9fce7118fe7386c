"""Those who answer: the Teacher protocol, the scripted teacher, and what a person types."""

from al_questioner.teaching.plain_words import read_plain_answer, respelt
from al_questioner.teaching.scripted import ScriptedTeacher
from al_questioner.teaching.teacher import Teacher

__all__ = ['ScriptedTeacher', 'Teacher', 'read_plain_answer', 'respelt']
