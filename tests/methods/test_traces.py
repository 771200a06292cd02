"""Measured surfaces by the numerical methods: the waves of a series, closed forms of one contact, and refusals."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import weier
from weier.methods.bem.boundary_elements import RESIDUAL
from weier.methods.errors import NotApplicableError
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile

UNIT = 1e-6  # m


def trace_of(profile, samples=8):
    """The heights of a series at so many samples for each of its finest waves."""
    heights = profile.sampled_height(samples * profile.waves_per_period[-1])
    return Trace(UNIT * heights, profile.period * 1e-3, ends="periodic", unit="m")


@pytest.mark.parametrize("method", ["bem", "patches"])
@pytest.mark.parametrize("profile", [Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), Profile(1.4, "5/2", 3, seed=3)])
def test_the_trace_of_a_series_has_its_curve(method, profile):
    """After conversion: its lambda_0 is the period of the series, and its g_0 another height."""
    trace = trace_of(profile)
    height, length = trace.g_0 / UNIT, profile.period
    loads = np.geomspace(1e-3, 0.9 * profile.full_contact_load, 8)
    exact = weier.solve(profile, loads, method)
    found = weier.solve(trace, loads / height * length, method)
    # Counted from first contact by the trace, from the sum of all amplitudes by the series.
    first = profile.total_amplitude - profile.crest[1]
    off = {"bem": RESIDUAL, "patches": 1e-11}[method]
    np.testing.assert_allclose(found.compliance * height + first, exact.compliance, atol=off, rtol=0)
    # The resistance is a sum of logarithms of lengths over the period, in units of lambda_0.
    np.testing.assert_allclose(found.resistance * length, exact.resistance, atol=1e-8, rtol=1e-8)
    np.testing.assert_array_equal(found.patch_count, exact.patch_count)


def abels_load(slope, inner, half_width):
    """Mean pressure, in units of g_0 and lambda_0, on one symmetric contact in a period of 1.

    A body f(x), flat up to `inner`, is pressed in by steps of a flat punch that grows with the contact; Abel's
    integral of them is p = 1/pi int f'(x) sin(pi x)/sqrt(sin^2(pi a) - sin^2(pi x)) dx up to the half-width a.
    """
    top = math.sin(math.pi * half_width) ** 2

    def integrand(angle):  # x = a sin(angle): the root at the edge is gone
        x = half_width * math.sin(angle)
        root = math.sqrt((top - math.sin(math.pi * x) ** 2) / (half_width**2 - x**2))
        return slope(x) * math.sin(math.pi * x) / root

    start = math.asin(inner / half_width)
    return quad(integrand, start, math.pi / 2 - 1e-9, epsabs=1e-13, epsrel=1e-11)[0] / math.pi


@pytest.mark.parametrize("method", ["bem", "patches"])
@pytest.mark.parametrize("inner", [0.0, 0.1])
def test_a_parabola_and_a_rounded_punch_touch_as_abels_integral_says(method, inner):
    """Flat up to `inner`, then a parabola; periodic, so that for inner = 0 the load is -ln cos(pi a)/(2 pi^2)."""
    n, waves = 1200, 60
    x = np.abs((np.arange(n) / n + 0.5) % 1 - 0.5)
    z = -(np.maximum(x - inner, 0) ** 2) / 2
    trace = Trace(z, 1.0, shortest=1 / waves, ends="periodic", unit="m")
    widths = [0.18, 0.25, 0.32]
    loads = np.array([abels_load(lambda x: x - inner, inner, a) for a in widths])
    if inner == 0:
        np.testing.assert_allclose(loads, -np.log(np.cos(np.pi * np.array(widths))) / (2 * np.pi**2), rtol=1e-8)
    found = weier.solve(trace, loads / trace.g_0, method)
    np.testing.assert_array_equal(found.patch_count, 1)
    # Waves shorter than 1/60 are cut off: of a kink in the second derivative they move edges by its height over k^2.
    half_width = found.contact_fraction.values / 2
    np.testing.assert_allclose(half_width, widths, atol=0.3 / waves**1.5)
    np.testing.assert_allclose(found.resistance, -2 * np.log(np.sin(np.pi * half_width)), rtol=2e-3)
    np.testing.assert_allclose(found.resistance, -2 * np.log(np.sin(np.pi * np.array(widths))), rtol=5e-3)


def random_heights(waves, samples, seed=1):
    k = np.arange(1, samples // 2)
    random = np.exp(2j * np.pi * np.random.default_rng(seed).random(k.size))
    return UNIT * np.fft.irfft(np.concatenate([[0], (k <= waves) * k**-1.2 * random]), samples)


def test_fields_and_events_of_a_trace():
    trace = Trace(random_heights(8, 100), 1e-3, ends="periodic", unit="m")
    field = weier.fields(trace, 1.0)
    assert float(field.pressure.mean()) == pytest.approx(1.0, rel=0.01)  # the sum over 512 positions
    grid = weier.solve(trace, [1.0], "bem").contact_fraction.item()
    # Each edge lies between two positions.
    assert float((field.pressure > 0).mean()) == pytest.approx(grid, abs=field.sizes["patch"] / field.sizes["x"])
    events = weier.events(trace, 0.01, 1.1 * trace.full_contact_load)
    assert events.patch_count.values[-1] == 0
    assert float(events.mean_pressure[-1]) == pytest.approx(trace.full_contact_load, rel=1e-9)


def test_what_rests_on_the_series_refuses_a_trace_and_names_the_fit():
    """The trace is one wave, which Westergaard's solution is for."""
    trace = Trace(random_heights(1, 200), 1e-3, ends="periodic", unit="m")
    with pytest.raises(NotApplicableError, match=r"for the Weierstrass series, got a trace of 200 .* weier\.fit"):
        weier.solve(trace, [0.1], "westergaard")


def test_waves_that_fall_to_rounding_are_solved():
    """Two smooth bumps: the finest of their waves is as low as rounding leaves it."""
    x = np.arange(600) / 600 - 0.5
    bumps = np.exp(-((x / 0.05) ** 2)) + np.exp(-(((x - 0.3) / 0.03) ** 2))
    trace = Trace(UNIT * bumps, 1e-3, ends="periodic", unit="m")
    assert trace.amplitude[-1] < 1e-12
    exact, grid = (weier.solve(trace, [1e-3, 0.1, 3.0], method) for method in ("patches", "bem"))
    assert np.all(np.abs(grid.compliance - exact.compliance) <= grid.compliance_error + 1e-9)
    np.testing.assert_array_equal(exact.patch_count, grid.patch_count)
