"""Whatever is drawn from the extremes: numbers or a clear sentence, no warning, and every curve a compliance."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.marks import examples
from weier import Profile
from weier.accuracy.extremes import check
from weier.accuracy.runner import Variant, attempt
from weier.methods.registry import METHODS, find_method

MAX_WAVES = 30  # in a period, of what is solved on a mesh or contact by contact

ULP = np.finfo(float).eps
dimensions = st.sampled_from([1 + 1e-9, 1.25, 1.5, 2 - 1e-9]) | st.floats(1 + 1e-9, 2 - 1e-9)
ratios = st.sampled_from(["1000001/1000000", "1000000", "3/2", "2", "5/2", "4", "9"]) | st.fractions(
    "1000001/1000000", 10**6, max_denominator=10**6
)
small_ratios = st.sampled_from(["6/5", "3/2", "2", "5/2", "3", "5"])
terms = st.sampled_from([1, 2, 3, 12, 1000, math.inf])
few_terms = st.integers(1, 3)
angles = st.sampled_from([0.0, math.pi, -math.pi, math.pi / 2, math.pi + 1e-15]) | st.floats(-6.28, 6.28)
at_one = st.sampled_from([1 - ULP / 2, 1.0, 1 + ULP])


def light_and_heavy_loads():
    """Up to eight loads, light and heavy, some of them a rounding apart."""
    load = st.floats(-300, 300).map(lambda exponent: 10.0**exponent) | st.floats(1e-6, 30) | at_one
    return st.lists(load, min_size=2, max_size=8, unique=True).map(lambda found: np.array(sorted(found)))


@st.composite
def any_series(draw):
    """Any series there is."""
    return Profile(draw(dimensions), draw(ratios), draw(terms), draw(angles))


def series_of_persson():
    """Series that are not refused for a gamma close to 1."""
    return any_series().filter(find_method("persson").takes)


@st.composite
def solvable_series(draw):
    """A series that can be solved, symmetric ones among them."""
    m = draw(few_terms)
    profile = Profile(draw(dimensions), draw(small_ratios), m, draw(st.lists(angles, min_size=m, max_size=m)))
    assume(profile.waves_per_period[-1] <= MAX_WAVES)
    return profile


def checked_run(name, profile, mean_pressure, **options):
    """A run whose numbers, where there are any, make a compliance: each load else has a clear sentence."""
    made = attempt(Variant(name, options), profile, mean_pressure)
    assert not made.warned
    stated = np.nan_to_num(made.stated[:, made.solved])
    assert all(check(name, profile, mean_pressure[made.solved], made.values[:, made.solved], stated).values())
    return made


one_wave = st.builds(Profile, dimensions, ratios, st.just(1))
CLOSED_FORM_SERIES = {
    "westergaard": one_wave,
    "archard": any_series(),
    "demelio": any_series(),
    "persson": series_of_persson(),
}
DRAWN = {
    method.name: CLOSED_FORM_SERIES.get(method.name, solvable_series())
    for method in METHODS
    if method.stiffness and method.takes(Profile(1.5, 2, 1))  # which leaves out those for the infinite series alone
}


@examples(25, 1000)
@pytest.mark.parametrize("method", DRAWN)
def test_any_curve_is_monotone_concave_and_within_its_bounds(method, how_many):
    """A closed form has a number for each load."""

    @how_many
    @given(DRAWN[method], light_and_heavy_loads())
    def run(profile, mean_pressure):
        found = checked_run(method, profile, mean_pressure)
        assert method not in CLOSED_FORM_SERIES or found.solved.all()

    run()


@pytest.mark.parametrize("method", ["bem", "patches", "auto"])
@pytest.mark.parametrize("gamma", ["1000001/1000000", "1000000"])
@pytest.mark.parametrize("m", [3, 1000])
def test_what_no_computer_holds_is_refused_in_a_sentence(method, gamma, m):
    found = checked_run(method, Profile(1.5, gamma, m), np.array([0.01, 0.1]))
    assert not found.solved.any()
