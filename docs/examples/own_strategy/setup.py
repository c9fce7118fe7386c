"""For colcon, which needs this file; everything is declared in setup.cfg."""

from setuptools import setup

setup()
