"""The bound on h holds where it is sharp and counts each violation; R's error against closed forms of each part."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import linprog
from scipy.special import jv

from tests.methods.patches.westergaard_states import KINDS, OneWave
from tests.profiles import THREE_WAVES
from weier.methods import patches
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.patches.certificate import (
    EPS,
    SAMPLED_FACTOR,
    TANGENT_ERROR,
    _effect_of_edges,
    _sizes,
    certify,
    contact_residual,
    crack_effect,
    error_bound,
    largest_displacement,
    sample_points,
    stated_errors,
)
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.inequalities import NEGATIVE, find_negative_intervals, minima_between
from weier.methods.patches.kind import FIELD_ROUNDING
from weier.methods.patches.segments import MINIMUM, Cracks
from weier.methods.patches.surface import make_series

HEIGHT = 1e-9  # g_0, of which the heights may be off


def one_wave(load):
    """Compliance of one wave, by Westergaard, which is the indentation from first contact as well."""
    return load * (1 - np.log(load))


def bound_by(state, load, gap=0.0, missing=0.0, pressure=(), width=(), period=1.0):
    """The bound on a state under this load by its violations."""
    return error_bound(state, load, missing, gap, np.array(pressure), np.array(width), period)


@pytest.mark.parametrize("load", [1e-6, 0.1, 0.9])
@pytest.mark.parametrize("part", [1e-3, 0.1, 0.5, 0.9])
def test_the_bound_holds_for_states_that_use_up_their_tension(load, part):
    """A pressure in the gaps that is exact once sigma is taken off it, and one with sigma added everywhere."""
    sigma = part * load
    for other in (load - sigma, load + sigma):
        state, exact = one_wave(other) if other < 1 else 1.0, one_wave(load)
        bound = bound_by(state, load, pressure=[sigma], width=[1.0])
        assert abs(state - exact) <= bound
        assert abs(state - exact) + 1e-3 <= bound_by(state, load, 1e-3, 0.0, [sigma], [1.0])
        assert bound_by(state, load, missing=sigma) == pytest.approx(bound, rel=1e-12, abs=0)
        parts = np.array([0.2, 0.5]) * sigma, np.array([0.4, 0.6])
        several = bound_by(state, load, 1e-3, 0.5 * sigma, *parts)
        assert bound_by(state, load, 0.0, 0.5 * sigma, *parts) <= bound * (1 + 1e-12)
        # Pressures are smaller by the length of a wave that is as high.
        longer = bound_by(state, load / 9, 1e-3, 0.5 * sigma / 9, parts[0] / 9, parts[1] * 9, 9.0)
        assert longer == pytest.approx(several, rel=1e-12, abs=0)
    drop = one_wave(load) - one_wave(load - sigma)
    # h is nearly a straight line under a light load, so that the bound is hardly larger than the difference.
    sharp = bound_by(one_wave(load - sigma), load, pressure=[sigma], width=[1.0])
    assert drop <= sharp
    assert load > 1e-5 or sharp < 1.3 * drop
    assert sigma * -np.log(load) < drop  # R sigma is no bound


def test_no_bound_follows_from_as_much_tension_as_load():
    assert bound_by(0.3, 0.1, pressure=[0.1], width=[1.0]) == np.inf


@pytest.mark.parametrize("width", [1e-3, 0.1, 0.5, 0.9])
def test_pressures_on_a_width_move_the_surface_by_no_more_than_the_bound(period, width):
    """The potential of a constant pressure on the width, from the Fourier series of -2 ln|2 sin|."""
    k, width = np.arange(1, 100_000), width * period
    half = 0.5 * width
    # int_{-W/2}^{W/2} -2 ln|2 sin(pi x/L)| dx = (2 L/pi) sum sin(pi k W/L)/k^2, and its negative around L/2.
    most = 2 * period / np.pi * float(np.sum(np.sin(2 * np.pi * k * half / period) / k**2))
    least = 2 * period / np.pi * float(np.sum((-1.0) ** k * np.sin(2 * np.pi * k * half / period) / k**2))
    bound = largest_displacement(1.0, width, period)
    assert max(most, -least) <= bound * (1 + 1e-4)
    assert max(most, -least) > 0.9 * bound or width > 0.01 * period


@pytest.mark.parametrize("load", [0.5, 4.0])
def test_a_state_that_is_wrong_by_a_height_or_a_load_is_certified_to_no_less(load):
    """Contacts, and gaps: the state of another load, and a plane that is off."""
    solution = patches.solve_load(THREE_WAVES, load)
    state, series = solution.state, solution.state.kind.series(solution.surface)
    assert state.kind is KINDS[load > 1]

    def certified(wrong):
        minima, negative = minima_between(wrong, series, 0.0, 0.0), find_negative_intervals(wrong)
        violations = *contact_residual(wrong, series), *wrong.kind.overlaps_and_tensions(minima, negative)
        return certify(wrong, *violations, series, solution.surface.total_amplitude, 1e-3, 0.0).error

    assert certified(state) < 1e-12
    if state.kind is CONTACTS:  # the residual of gaps is a pressure
        assert 1e-7 <= certified(state._replace(approach=state.approach + 1e-7)) < 2.1e-7
    moved = patches.solve_load(THREE_WAVES, load * (1 + 1e-6)).state
    deviation = abs(moved.approach - state.approach)
    assert deviation <= certified(moved._replace(load=load))


def test_a_missing_load_and_gaps_that_do_not_close_are_violations(wave):
    contacts, gaps = wave.state(False), wave.state(True)
    assert contacts.kind.imbalance(contacts, wave.period)[0] == pytest.approx(0, abs=1e-12 * wave.load)
    more = CONTACTS.imbalance(contacts._replace(load=1.5 * wave.load), wave.period)
    assert more == pytest.approx((0.5 * wave.load, 0.0), rel=1e-9, abs=0)
    mean = np.zeros(gaps.coefficient.size)
    mean[0] = 1e-6
    off = gaps._replace(coefficient=gaps.coefficient + mean)
    closure = 0.5 * np.pi * gaps.segments.half_width[0] * 1e-6  # the integral of a slope of 1e-6 (1-t^2)^(1/2)
    assert off.kind.imbalance(off, wave.period) == pytest.approx((0.0, closure), rel=1e-4)
    nothing = np.zeros(0, MINIMUM)
    found = certify(off, np.zeros(1), np.ones(1), np.zeros(1), nothing, nothing, wave.series(True), 1.0, 1e-3, 0.0)
    assert found.residual == pytest.approx(closure, rel=1e-4)
    assert found.error == pytest.approx(closure, rel=1e-4)


def test_tension_outside_a_thin_gap_is_taken_off_in_the_other_gaps(period):
    """int w dx/[2 L^2 sin^2(pi (x-c)/L)] over both gaps beside a contact, by quadrature."""
    wave, volume, t = OneWave(period, 0.2 * period, 0.3 * period), 1e-9, 0.4
    one, none = np.ones(1), np.zeros(1)
    cracks = Cracks(np.zeros(1, int), t * one, none, none, none, none, volume * one, 3e-12 * one, none)
    place, (left, right) = wave.crest + t * wave.half_width, (wave.crest - 0.2 * period, wave.crest + 0.2 * period)

    def tension(x):
        return volume / (2 * period**2 * np.sin(np.pi * (x - place) / period) ** 2)

    force = quad(tension, right, left + period)[0]
    for dual in (False, True):
        moved, mean, doubt = crack_effect(wave.state(dual)._replace(cracks=cracks), period)
        assert mean == pytest.approx(force / period, rel=1e-9, abs=0)
        assert moved == pytest.approx(largest_displacement(tension(right), force, period), rel=1e-9, abs=0)
        assert doubt == pytest.approx(abs(3e-12 - volume / period), rel=1e-12, abs=0)
        state, series, none = wave.state(dual)._replace(cracks=cracks), wave.series(dual), np.zeros(1)
        found = certify(state, none, none, none, np.empty(0, MINIMUM), np.empty(0, MINIMUM), series, 1.0, 1e-3, 0.0)
        missing, closure = state.kind.imbalance(state, period)
        indentation = state.indentation(1.0)
        bound = bound_by(indentation, wave.load, closure + moved, missing + mean, period=period)
        assert found.error == pytest.approx(doubt + bound, rel=1e-9, abs=0)


@pytest.mark.parametrize("volume", [(1e-9, 3e-8), (3e-8, 1e-9)])
@pytest.mark.parametrize("apart", [1.6, 1.5e-3])
def test_tension_of_a_thin_gap_is_taken_off_in_another_one(period, dual, volume, apart):
    """Its largest value there, at the distance l - b_1 - b_2, on the width 2 b: above the force by quadrature."""
    wave, none, volume = OneWave(period, 0.4 * period, 0.95 * period), np.zeros(2), np.array(volume)
    t, b = np.array([-0.8, apart - 0.8]), np.array([2e-4, 1e-4]) * period
    cracks = Cracks(np.zeros(2, int), t, b / wave.half_width, b, none, none, volume, volume / period, none)
    state = wave.state(dual)._replace(cracks=cracks)
    _, mean, _ = crack_effect(state, period)
    alone = [
        crack_effect(state._replace(cracks=Cracks(*(values[i : i + 1] for values in cracks))), period)[1]
        for i in range(2)
    ]

    def tension(x, i):
        return volume[i] / (2 * period**2 * np.sin(np.pi * (x - t[i] * wave.half_width) / period) ** 2)

    x = t * wave.half_width
    force = sum(quad(tension, x[i] - b[i], x[i] + b[i], (1 - i,))[0] for i in range(2))
    nearest = 1 - b.sum() / min(apart * wave.half_width, period - apart * wave.half_width)
    assert force <= (mean - sum(alone)) * period <= force / nearest**2


def test_tension_at_an_edge_is_not_a_missing_gap(wave):
    found, none = np.zeros(2, NEGATIVE), np.zeros(1)
    found["start"], found["end"], found["value"] = [0.1, 0.9], [0.2, 1.0], -1e-12
    checks = wave.series(False), 1.0, 1e-3, 0.0
    state = certify(wave.state(False), none, none, none, np.empty(0, MINIMUM), found, *checks)
    np.testing.assert_allclose(state.tensions, [[0.0, 0.15, 0.05]], rtol=1e-12)


@pytest.mark.parametrize("part", [0.1, 0.4])
def test_pressures_in_gaps_and_tensions_between_them_are_bounded_on_their_widths(period, part):
    """A pressure in a part of the gap, and a parabola at a minimum of the pressure: each counts on its width."""
    wave = OneWave(period, part * period, 0.2 * period)
    state, series, sigma, depth, curvature = wave.state(True), wave.series(True), 1e-9, 1e-8, 50.0
    r, indentation = state.segments.half_width[0], 1 + state.approach
    minima = np.zeros(1, MINIMUM)
    minima["value"], minima["curvature"], minima["position"] = -depth, curvature, wave.crest + period
    nothing = find_negative_intervals(state)
    found = certify(
        state, np.array([sigma]), np.array([0.3 * r]), np.zeros(1), nothing, minima, series, 1.0, 1e-3, 0.0
    )
    assert found.residual == pytest.approx(2 * r * sigma, rel=1e-9, abs=0)
    reach = np.sqrt(2 * depth / curvature)
    expected = bound_by(
        indentation, wave.load, 0.0, 0.0, [SAMPLED_FACTOR * sigma, depth], [0.3 * r, 2 * reach], period
    )
    closure = abs(0.5 * np.pi * r * state.coefficient[0])
    assert found.error == pytest.approx(expected, rel=1e-6, abs=2 * closure)
    assert found.height_error == pytest.approx(found.error + 4 * SAMPLED_FACTOR * r * sigma, rel=1e-6, abs=0)
    assert found.tensions[0, 2] == pytest.approx(reach / wave.half_width)
    minima["curvature"] = 0.0  # no parabola: on no more than this
    flat = state.kind.tensions(state.kind.contacts_of(state.segments.extent, period), minima, period)
    assert flat[0, 2] == pytest.approx(np.sqrt(2) * period / wave.half_width)


@pytest.mark.parametrize("nodes", [8, 11])
def test_no_polynomial_exceeds_the_factor_between_samples(nodes):
    """The largest value of any polynomial of degree K + 2 that is at most 1 at the samples, by linear programming."""
    state = OneWave(1.0, 0.2, 0.3).state(False, nodes)
    _, _, y = sample_points(state.segments.arrays, state.segments.crest)
    t = (y - state.segments.centre[0]) / state.segments.half_width[0]
    samples = np.polynomial.chebyshev.chebvander(t, nodes + 2)
    limits, most, largest = np.concatenate([samples, -samples]), np.ones(2 * t.size), 0.0
    for x in np.cos(np.arange(t.size + 1) * np.pi / t.size):  # halfway between the samples
        row = np.polynomial.chebyshev.chebvander(x, nodes + 2)
        largest = max(largest, -linprog(-row, limits, most, bounds=(None, None)).fun)
    assert 0.7 * SAMPLED_FACTOR <= largest <= SAMPLED_FACTOR * (1 + 1e-9)


@pytest.mark.parametrize("nodes", [8, 30])
def test_the_force_of_a_residual_is_no_larger_than_its_width_says(nodes):
    """Random polynomials, and one that is large at an end only, whose width is far less than the segment's."""
    state, random = OneWave(1.0, 0.2, 0.3).state(False, nodes), np.random.default_rng(nodes)
    (_, _, y), first = sample_points(state.segments.arrays, state.segments.crest), state.segments.first_node
    r = state.segments.half_width[0]
    t, dense = (y - state.segments.centre[0]) / r, np.cos(np.linspace(0, np.pi, 20_001))
    for degree in range(nodes + 3):
        for coefficient in (np.eye(degree + 1)[-1], random.normal(size=degree + 1), np.arange(degree + 1.0)):
            polynomial = np.polynomial.Chebyshev(coefficient)
            largest, width, roughness = _sizes(first, state.segments.half_width, polynomial(t))
            assert roughness[0] == pytest.approx(np.abs(coefficient) @ np.arange(degree + 1.0), rel=1e-9, abs=1e-11)
            force = r * np.abs(np.trapezoid(np.abs(polynomial(dense)), dense))
            assert SAMPLED_FACTOR * largest[0] * width[0] >= force * (1 - 1e-6)
            assert width[0] <= 2 * r
    one = np.zeros(t.size)
    one[2] = 1.0  # pi/(m-n-1) times the sine of its angle, over the factor of the sampled maximum
    _, width, _ = _sizes(first, state.segments.half_width, one)
    expected = np.pi / (t.size - nodes - 3) * np.sin(2.5 * np.pi / t.size) / SAMPLED_FACTOR
    assert width[0] == pytest.approx(r * expected, rel=1e-12, abs=0)
    if nodes == 30:  # the last polynomial, sum k T_k, is as large as its degree squared at the right end
        assert width[0] < 0.2 * r


def stated_both(wave, dual, **fields):
    """The errors of the resistance of one wave in a series, and of its length in contact."""
    state = wave.state(dual)._replace(**({"height_error": 0.0, "error": 0.0, "roughness": np.zeros(1)} | fields))
    R, fraction = stated_errors(state, wave.series(False))
    return R, fraction * wave.period


def stated(wave, dual=False, **fields):
    """The error of the resistance, without that of the end of conjugate gradients."""
    return stated_both(wave, dual, **fields)[0] - TANGENT_ERROR * max(wave.resistance, 1.0)


def added(wave, dual=False, height_error=0.0, **fields):
    """What these fields add to both errors."""
    with_fields = stated_both(wave, dual, height_error=height_error, **fields)
    return np.subtract(with_fields, stated_both(wave, dual, height_error=height_error))


def moved(wave, change):
    """The change of R if both edges move out by a distance."""
    return abs(wave._replace(half_width=wave.half_width + change).resistance - wave.resistance)


def test_edges_that_move_change_the_resistance_as_stated(wave, dual):
    """dR = (2 pi^2/L) sum B^2 delta is the derivative of -L ln sin^2(pi a/L)."""
    step = np.full((1, 2), 1e-7 * wave.period)
    assert added(wave, dual, edge_move=step)[0] == pytest.approx(moved(wave, step[0, 0]), rel=1e-5, abs=0)


def test_the_next_move_of_an_edge_that_has_not_settled_counts_twice(wave, dual):
    r = wave.state(dual).segments.half_width[0]
    for move, factor in ((0.09, 1), (0.11, 2), (-0.11, 2)):
        step = np.array([[0.0, move * r]])
        longer = factor * abs(move) * r
        expected = 2 * np.pi**2 / wave.period * wave.tangent_strength**2 * longer, longer
        assert added(wave, dual, edge_move=step) == pytest.approx(expected, rel=1e-9, abs=0)


def test_the_force_of_a_light_contact_limits_the_strengths_of_its_edges(period):
    """By rounding they are ten times those of Hertz's contact, A = sqrt(8) F/(pi a^(3/2)); then delta = a e/2F."""
    wave = OneWave(period, 1e-4 * period, 0.2 * period)
    a, force, coefficient = wave.half_width, wave.load * period, wave.state(False).coefficient
    coefficient[2] += 3 * coefficient[0]  # U_2(+-1) = 3
    height_error = 1e-4 * force
    move = 0.5 * a * height_error / force + 2 * a * height_error / (-2 * np.log(np.pi * a / period) * force)
    rounded = stated(wave, coefficient=coefficient, height_error=height_error) - stated(wave, coefficient=coefficient)
    assert rounded == pytest.approx(moved(wave, move), rel=1e-3, abs=0)


def test_an_edge_moves_by_the_gap_beside_it(period):
    """Two contacts 0.05 L apart, and the increment at one edge only; the length in contact changes by all moves."""
    r, A, none = np.full(2, 0.1 * period), np.full((2, 2), 3.0), np.zeros(2)
    extent, first = (none, np.array([0.2, 0.45]) * period, r), np.arange(3)
    density = (*extent, first), A[0] / np.sqrt(2 / r), extent, period
    force = np.pi / np.sqrt(8) * r[0] ** 1.5 * 3
    by_force = 2 * r[0] * HEIGHT / (max(-2 * np.log(0.1 * np.pi), 1.0) * force)
    narrow, wide = (np.sqrt(2) * HEIGHT / (np.pi * 3 * np.sqrt(s * period)) + by_force for s in (0.025, 0.1))
    for (j, side), half_gap in (((0, 0), 0.275), ((0, 1), 0.025), ((1, 0), 0.025), ((1, 1), 0.275)):
        B = np.zeros((2, 2))
        B[j, side] = 1.0
        expected = (2 * narrow if half_gap < 0.1 else wide), 4 * narrow + 2 * wide
        strengths, crests, errors = (0, 1.0, np.inf, B), (none[:1], none[:1], 0.0), (HEIGHT, np.nan, none, 0.0)
        release, length = _effect_of_edges(*density, strengths, crests, errors)
        assert (release * period / (2 * np.pi**2), length) == pytest.approx(expected, rel=1e-12, abs=0)


def test_a_contact_or_a_gap_that_may_not_be_there_counts_whole(period):
    """R = R_0 - tau^2/(chi L), with chi of the contact, of none, or of the largest force; 8 times pi^2 b^2 q^2/L."""
    contact = OneWave(period, 1e-3 * period, 0.2 * period)
    chi, force = -2 * np.log(np.pi * contact.half_width / period), contact.load * period
    for error in (3 * force, 10 * force, 1.0):
        largest = max(chi - np.log(1 + 4 * error / (chi * force)), 1.0)
        drop = max(1.0, chi / largest - 1)
        assert (drop > 1) == (error == 1.0)
        assert stated(contact, height_error=error) == pytest.approx(period * chi * drop, rel=1e-3, abs=0)
    gap = OneWave(period, 0.5 * period * (1 - 1e-3), 0.2 * period)
    b = 0.5e-3 * period  # q = 1 near full contact
    assert stated(gap, height_error=1.0) == pytest.approx(8 * np.pi**2 * b**2 / period, rel=1e-3, abs=0)


@pytest.mark.parametrize("part", [0.1, 0.4])
def test_tension_that_is_left_counts_as_the_gap_that_it_may_be(period, dual, part):
    """Twice pi^2 b^2 q^2/L, b being 2^(1/2) times the interval of tension, with q by the strength at the edges."""
    wave = OneWave(period, part * period, 0.2 * period)
    tensions = np.array([[0.0, 0.3, 1e-4]])
    r = wave.half_width
    q = max(wave.tangent_strength * np.sqrt(2 / (r * (1 - 0.09))), 1.0)
    expected = 2 * np.pi**2 * 2 * (1e-4 * r * q) ** 2 / period, 2 * np.sqrt(8) * 1e-4 * r
    assert added(wave, dual, tensions=tensions) == pytest.approx(expected, rel=1e-9, abs=0)
    # The pressure of an increment is that of the flat punch, cos(pi x/L)/(sin^2(pi a/L) - sin^2(pi x/L))^(1/2).
    y = np.pi / period * 0.3 * r
    exact = np.cos(y) / np.sqrt(np.sin(wave.alpha) ** 2 - np.sin(y) ** 2)
    assert q == pytest.approx(exact, rel=0.07)


def test_a_thin_gap_is_off_by_its_tension_and_by_its_neighbour(period, dual):
    """pi^2 b^2 q^2/L with b^2 = 4 q_0/kappa, and four times (b/l)^2 of it, with the nearest edge at l."""
    wave, t, b, q, curvature = OneWave(period, 0.2 * period, 0.2 * period), 0.4, 1e-4, 1.7, 30.0
    rise = np.pi**2 * b**2 * q**2 / period
    one = np.ones(1)
    cracks = Cracks(
        np.zeros(1, int),
        t * one,
        b / wave.half_width * one,
        b * one,
        curvature * b**1.5 / np.sqrt(2) * one,
        q * np.sqrt(b / 2) * one,
        np.pi**2 * curvature * b**4 / 8 * one,
        0 * one,
        rise * one,
    )
    state = wave.state(dual)
    by_neighbour = 4 * rise * (b / (0.6 * wave.half_width)) ** 2
    off = HEIGHT * state.segments.node_count[0] / (2 * np.pi * state.segments.half_width[0] * np.sqrt(1 - t * t))
    by_tension = np.pi**2 * q**2 / period * (4 * off / curvature)
    # R rises by b^2, so that the width 2 b is off by b times the relative error of the rise.
    of_length = np.array([1, b / rise])
    for height_error, expected in ((0.0, by_neighbour), (HEIGHT, by_neighbour + by_tension)):
        found = added(wave, dual, height_error, cracks=cracks)
        assert found == pytest.approx(expected * of_length, rel=1e-5, abs=0)


@pytest.mark.parametrize(("part", "distance"), [(0.1, 0.5), (0.02, 0.025), (0.45, 0.5)])
def test_a_contact_that_may_be_born_takes_part_of_an_increment(period, part, distance):
    """tau^2/(chi L), where tau is at most R + 2 L ln 2, and chi is that of a punch, less the relief by one nearby."""
    wave = OneWave(period, part * period, 0.2 * period)
    gaps = np.zeros(1, MINIMUM)
    gaps["position"], gaps["curvature"] = wave.crest + distance * period, 50.0
    depth = 4 * HEIGHT + FIELD_ROUNDING
    b = np.sqrt(2 * depth / 50)
    relief = -2 * np.log(np.pi * part) + 4 * np.log(2 * np.sin(np.pi * distance))
    assert (relief < 0) == (distance < 0.1)
    chi = -2 * np.log(np.pi * b / period) + min(relief, 0.0)
    expected = (wave.resistance + 2 * np.log(2) * period) ** 2 / (chi * period)
    assert (expected < wave.resistance) == (part < 0.4)
    expected = min(expected, wave.resistance)
    born = added(wave, height_error=HEIGHT, narrow_gaps=gaps)
    assert born == pytest.approx((expected, 2 * b), rel=1e-9, abs=0)
    gaps["value"] = depth * (1 - 1e-12)  # the less it may penetrate, the less
    assert added(wave, height_error=HEIGHT, narrow_gaps=gaps)[0] < born[0] or part > 0.4
    gaps["curvature"] = 0.0  # A flat gap may close over no more than this.
    length = added(wave, height_error=HEIGHT, narrow_gaps=gaps)[1]
    assert length == pytest.approx(2 * np.sqrt(2) * period, rel=1e-9, abs=0)


def test_rounding_widens_contacts(period):
    """Of curvatures, by half of itself relative to a; and of heights on crests that are not the highest."""
    wave = OneWave(period, 0.1 * period, 0.2 * period)
    a, A, waves = wave.half_width, wave.strength, np.array([1, 2])
    force = np.pi / np.sqrt(8) * a**1.5 * A
    chi = max(-2 * np.log(np.pi * a / period), 1.0)
    amplitude = np.array([1.0, 0.7])
    of_curvature = EPS * np.sum(amplitude * (2 * np.pi * waves / period) ** 2) * a**3 / (8 * force)
    total = EPS * amplitude.sum() + COMPLIANCE_ROUNDING * wave.load * period
    of_height = np.sqrt(2) * total / (np.pi * A * np.sqrt(a)) + 2 * a * total / (chi * force)
    state = wave.state(False)._replace(height_error=0.0, error=0.0, roughness=np.zeros(1))
    for shift, is_lower in ((0.0, False), (np.pi, True)):
        # cos x + 0.7 cos 2x has its highest crest at 0, and a lower one at half a period.
        phases = -2 * np.pi * waves * wave.crest / period + shift * waves
        series = make_series(amplitude, [1, 2], phases, period)
        found = stated_errors(state, series)[0] - TANGENT_ERROR * max(wave.resistance, 1.0)
        move = of_curvature + (of_height if is_lower else 0.0)
        assert found == pytest.approx(4 * np.pi**2 / period * wave.tangent_strength**2 * move, rel=1e-2, abs=0)


def test_edges_respond_to_the_waves_of_a_residual():
    """Heights e cos(2 pi k x/L), of any number of waves on the contact, whose effect on R is known.

    The load is the mean of S over theta, with sin(pi x/L) = sin(pi b/L) sin(theta) in the gap; its derivative with
    respect to a is that of one wave.
    """
    theta, ratios = (np.arange(400) + 0.5) * np.pi / 400, []
    for a in (0.05, 0.1, 0.2, 0.3, 0.4):
        wave = OneWave(1.0, a, 0.0)
        for k in range(2, 60):
            x = np.arcsin(np.cos(np.pi * a) * np.cos(theta)) / np.pi + 0.5
            drift = np.mean(k * np.cos(2 * np.pi * k * x)) / (np.pi * np.sin(2 * np.pi * a))
            n = np.arange(2, 200, 2)
            roughness = HEIGHT * np.array([np.sum(2 * n * np.abs(jv(n, 2 * np.pi * k * a)))])
            change = HEIGHT * 2 * np.pi / np.tan(np.pi * a) * abs(drift)
            ratios.append(change / added(wave, roughness=roughness)[0])
    assert 0.9 < max(ratios) <= 1
