"""A person who teaches at a terminal: what is shown, what keys and lines mean, and what was said."""

from al_questioner.terminal.board import Board, Moment, Phase, Picture, Progress, Said
from al_questioner.terminal.session import Session

__all__ = ['Board', 'Moment', 'Phase', 'Picture', 'Progress', 'Said', 'Session']
