"""The names that other programs import."""

from __future__ import annotations

import ast
import importlib
import inspect
from importlib.resources import files

import pytest

import al_questioner
from al_questioner import simulation

NEEDING_MORE = {'ConceptClassifier'}
"""Names that `import *` leaves out, as a library that they need may be missing."""


@pytest.mark.parametrize(
    'package', ['al_questioner', 'al_questioner.bags', 'al_questioner.event_log', 'al_questioner.simulation']
)
def test_every_public_name_is_there(package: str) -> None:
    """Otherwise a name that is imported when it is asked for would be missed no sooner than by its first user."""
    module = importlib.import_module(package)
    imports = [node for node in ast.walk(ast.parse(inspect.getsource(module))) if isinstance(node, ast.ImportFrom)]
    of_types = {(node.module, each.asname) for node in imports for each in node.names if each.asname}
    found = {name: getattr(importlib.import_module(home), name) for home, name in of_types}
    assert found == {name: getattr(module, name) for name in found}
    assert set(module.__all__) == found.keys() - NEEDING_MORE


def test_the_package_offers_what_the_contract_names() -> None:
    """Notebooks import these, and look for them with the tabulator key."""
    promised = {
        'Answer', 'ConceptModels', 'Costs', 'Episode', 'EpisodeSettings', 'InputError', 'Outcome', 'Pool',
        'PoolComparison', 'Query', 'QueryKind', 'Scene', 'compare', 'load_task', 'load_weights', 'make_strategy',
        'read_concepts', 'run_episode', 'write_concepts',
    }  # fmt: skip
    assert set(al_questioner.__all__) == promised
    assert promised | NEEDING_MORE | {'__version__'} <= set(dir(al_questioner))
    assert al_questioner.run_episode is simulation.run_episode


def test_another_name_is_an_error_that_names_it() -> None:
    """Otherwise `from al_questioner import Epsiode` would be anything else but an ImportError."""
    with pytest.raises(AttributeError, match="module 'al_questioner' has no attribute 'Epsiode'"):
        _ = al_questioner.Epsiode  # type: ignore[attr-defined]


def test_the_package_says_that_it_has_types() -> None:
    """Otherwise Mypy would take everything that is imported from it for Any."""
    assert (files('al_questioner') / 'py.typed').is_file()
