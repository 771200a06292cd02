"""What holds of every method that is listed: what it declares, and that loads do not depend on each other."""

import inspect

import numpy as np
import pytest

from weier import Profile, solve
from weier.cli import options
from weier.data.variables import VARIABLES
from weier.methods import registry
from weier.methods.method import Range
from weier.methods.settings import checked_settings
from weier.surface.profile import random_phases

INFINITE = Profile(1.02, 10, np.inf, random_phases(1))
SURFACES = Profile(1.5, 3, 3, np.pi), Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), Profile(1.1, 3, np.inf, random_phases(0))
LOADS = np.geomspace(0.1, 10, 12)
CASES = [(method, profile) for method in registry.METHODS for profile in SURFACES if method.takes(profile)]
every_method = pytest.mark.parametrize("method", registry.METHODS, ids=lambda method: method.name)


@every_method
def test_the_help_tells_which_methods_take_the_infinite_series(method):
    (m,) = (option for option in options.one_profile_options("") if option.name == "m")
    assert (method.name in m.help) == method.infinite == method.takes(INFINITE)
    if method.infinite:
        solved = solve(INFINITE, [0.1], method.name)
        assert np.isfinite(solved.compliance if method.stiffness else solved.contact_fraction).all()


@every_method
def test_a_method_says_whether_phases_change_its_curve(method):
    """Numbers of one that says no are those of another profile, to the last bit: batches copy them."""
    for m in (1, 2, 3, np.inf):
        profiles = [Profile(1.02, 10, m, seed=seed) for seed in (1, 2)]
        if method.takes(profiles[0]):
            one, other = (method.solve(profile, np.array([0.1, 1.0])) for profile in profiles)
            one, other = (found.compliance if method.stiffness else found.contact_fraction for found in (one, other))
            if not method.uses_phases:
                np.testing.assert_array_equal(one, other)
            elif m > 1:
                assert np.abs(one - other).max() > 1e-6


@every_method
def test_declared_defaults_are_those_of_the_solver(method):
    parameters = inspect.signature(method.solve).parameters.values()
    known = {each.name: each.default for each in parameters if each.default is not each.empty}
    assert {name: setting.default for name, setting in method.settings.items()} == known


RANGES = [
    (method, name)
    for method in registry.METHODS
    for name, setting in method.settings.items()
    if isinstance(setting.values, Range) and (method.name, name) != ("bem", "tolerance")  # of which less is in reach
]


@pytest.mark.parametrize(("method", "name"), RANGES)
def test_settings_are_taken_in_their_range_and_refused_beyond_it(method, name):
    """Before anything is solved."""
    least, most, half_open = method.settings[name].values
    step = 1 if isinstance(least, int) else 1e-3 * least

    def check(value):
        return checked_settings(method, {name: type(step)(value)})[name]

    taken = [check(least), check(most - step if half_open else most)]
    method.check(Profile(1.5, 2, 2), **{name: taken[0]})
    for value in (least - step, most if half_open else most + step):
        with pytest.raises(ValueError, match=f"^{name} of {method.name} must .*{least:g}"):
            check(value)


def test_no_two_methods_look_alike():
    """The two numerical ones have the same line: the second is drawn as points beside the first."""
    count = len(registry.METHODS)
    features = zip(*(method.style for method in registry.METHODS), strict=True)
    assert [len(set(own)) for own in features] == [count - 1, count - 1, count]


@every_method
def test_what_a_method_returns_is_known_before_it_runs_and_is_in_the_table(method):
    """The method "auto" passes on what that of its choice returns."""
    found = method.solve(Profile(1.5, 2, 1), np.array([0.1, 1.0])).values()
    chosen = registry.find_method(found.get("chosen_method", method.name))
    assert {*found} == registry.returned_by([chosen.name]) | {*found} & {"chosen_method", "chosen_terms"}
    assert {*found} <= registry.returned_by([method.name]) <= VARIABLES.keys()
    assert method.stiffness or "contact fraction alone" in method.summary


@pytest.mark.parametrize(("method", "profile"), CASES)
def test_the_numbers_of_a_load_do_not_depend_on_the_others(method, profile):
    """On one load, a few and most of them, to the last bit, but for errors of R that chords to all loads bound."""
    settings = {"tolerance": 0.02} if method is registry.WITHIN_TOLERANCE else {}
    together, random = method.solve(profile, LOADS, **settings), np.random.default_rng(5)
    for size in (1, 5, LOADS.size - 1):
        some = np.sort(random.choice(LOADS.size, size, replace=False))
        alone = method.solve(profile, LOADS[some], **settings).values()
        for name, values in together.values().items():
            if np.ndim(values) > 0 and (name != "resistance_error" or method.name not in ("bem", "auto")):
                own, others = np.ravel(alone[name]), np.ravel(values[some])  # edges are padded by NaN
                np.testing.assert_array_equal(own[~np.isnan(own)], others[~np.isnan(others)], name)
