"""What the program derives from the methods that are listed."""

import inspect

import numpy as np
import pytest

from weier import Profile, solve
from weier.cli import options
from weier.data.variables import VARIABLES
from weier.figures import style
from weier.methods import registry
from weier.methods.method import Range
from weier.methods.settings import check_names, checked_settings
from weier.surface.profile import random_phases

INFINITE = Profile(1.02, 10, np.inf, random_phases(1))


@pytest.mark.parametrize("method", registry.METHODS, ids=lambda method: method.name)
def test_the_help_tells_which_methods_take_the_infinite_series(method):
    (m,) = (option for option in options.SERIES_OPTIONS if option.name == "m")
    assert (method.name in m.help) == method.infinite == method.takes(INFINITE)
    if method.infinite:
        solved = solve(INFINITE, [0.1], method.name)
        assert np.isfinite(solved.compliance if method.stiffness else solved.contact_fraction).all()


@pytest.mark.parametrize("method", registry.METHODS, ids=lambda method: method.name)
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


@pytest.mark.parametrize("method", registry.METHODS, ids=lambda method: method.name)
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
    """But for the numerical ones: the second is drawn as points beside the first."""
    assert len({method.style.marker for method in registry.METHODS}) == len(registry.METHODS)
    lines = [style.line(name) for name in registry.names() if name not in registry.numerical_names()[1:]]
    for feature in ("color", "linestyle"):
        assert len({str(line[feature]) for line in lines}) == len(lines)


@pytest.mark.parametrize("method", registry.METHODS, ids=lambda method: method.name)
def test_what_a_method_returns_is_known_before_it_runs_and_is_in_the_table(method):
    """The method "auto" passes on what that of its choice returns."""
    found = method.solve(Profile(1.5, 2, 1), np.array([0.1, 1.0])).values()
    chosen = registry.find_method(found.get("chosen_method", method.name))
    assert {*found} == registry.returned_by([chosen.name]) | {*found} & {"chosen_method", "chosen_terms"}
    assert {*found} <= registry.returned_by([method.name]) <= VARIABLES.keys()
    assert method.stiffness or "contact fraction alone" in method.summary


def test_a_message_names_the_methods_that_have_a_setting():
    with pytest.raises(ValueError, match='it takes points, accuracy; \'tolerance\' is a setting of "bem", "patches"'):
        check_names(registry.find_method("layer"), ["tolerance"])
