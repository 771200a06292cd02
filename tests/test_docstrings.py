"""The examples in docstrings, run."""

import doctest
import pkgutil
from importlib import import_module

import pytest

import weier

MODULES = [module.name for module in pkgutil.walk_packages(weier.__path__, "weier.") if "__main__" not in module.name]
FINDER = doctest.DocTestFinder(exclude_empty=True)
WITH_EXAMPLES = [name for name in MODULES if any(test.examples for test in FINDER.find(import_module(name)))]


PUBLIC = [name for name in weier.__all__ if name[0] != "_" and not name.endswith("Error")]


@pytest.mark.parametrize("name", PUBLIC)
def test_the_public_interface_has_examples(name):
    public = getattr(weier, name)
    assert any(test.examples for test in FINDER.find(public, name))
    assert public.__module__ in WITH_EXAMPLES  # run below


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_are_true(name, tmp_path):
    path = tmp_path / "contact.nc"
    weier.solve([weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)], [0.1, 1.0], "demelio").to_netcdf(path)
    done = doctest.testmod(import_module(name), extraglobs={"path": path})
    assert done.attempted > 0
    assert done.failed == 0
