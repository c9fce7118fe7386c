"""The names that other programs import."""

from __future__ import annotations

import importlib
from importlib.resources import files

import pytest

import al_questioner
from al_questioner import simulation


@pytest.mark.parametrize('package', ['al_questioner', 'al_questioner.bags', 'al_questioner.simulation'])
def test_every_public_name_is_there(package: str) -> None:
    """A name that is imported when it is asked for would be missed no sooner than by its first user."""
    module = importlib.import_module(package)
    assert sorted(module._HOMES) == sorted(module.__all__)
    assert [name for name in module.__all__ if not hasattr(module, name)] == []


def test_the_package_offers_what_the_contract_names() -> None:
    """Notebooks import these, and look for them with the tabulator key."""
    promised = {
        'Answer', 'ConceptModels', 'Costs', 'Episode', 'EpisodeSettings', 'InputError', 'Outcome', 'Query', 'QueryKind',
        'Scene', 'load_task', 'load_weights', 'make_strategy', 'run_episode',
    }  # fmt: skip
    assert set(al_questioner.__all__) == promised
    assert promised | {'__version__'} <= set(dir(al_questioner))
    assert al_questioner.run_episode is simulation.run_episode


def test_another_name_is_an_error_that_names_it() -> None:
    """`from al_questioner import Epsiode` would be anything else but an ImportError."""
    with pytest.raises(AttributeError, match="module 'al_questioner' has no attribute 'Epsiode'"):
        _ = al_questioner.Epsiode  # type: ignore[attr-defined]


def test_the_package_says_that_it_has_types() -> None:
    """Mypy would take everything that is imported from it for Any."""
    assert (files('al_questioner') / 'py.typed').is_file()
