"""The stated error of the resistance: each part of it against what a change of the contacts does in closed form."""

import numpy as np
import pytest

from tests.methods.patches.westergaard_states import WAVES, OneWave
from weier.methods.patches.certificate import GAP_FACTOR, GAP_ROUNDING
from weier.methods.patches.resistance_error import EPS, TANGENT_ERROR, resistance_error
from weier.methods.patches.segments import MINIMUM, Cracks
from weier.methods.patches.surface import make_series

HEIGHT = 1e-9  # g_0, of which the heights may be off


def stated(wave, dual=False, **fields):
    """The error of the resistance of one wave in a series, without that of the end of conjugate gradients."""
    state = wave.state(dual)._replace(**({"height_error": 0.0, "error": 0.0} | fields))
    heights = wave.series(False)
    return resistance_error(state, heights) - TANGENT_ERROR * max(wave.resistance, 1.0)


def moved(wave, change):
    """The change of R if both edges move out by a distance."""
    return abs(wave._replace(half_width=wave.half_width + change).resistance - wave.resistance)


@pytest.mark.parametrize("wave", WAVES)
def test_rounding_alone_is_far_below_the_tangent(wave):
    assert 0 <= stated(wave) < 1e-12 * wave.period


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("wave", WAVES)
def test_edges_that_move_change_the_resistance_as_stated(wave, dual):
    """dR = (2 pi^2/L) sum B^2 delta is the derivative of -L ln sin^2(pi a/L)."""
    step = np.full((1, 2), 1e-7 * wave.period)
    left_over = stated(wave, dual, edge_move=step) - stated(wave, dual)
    assert left_over == pytest.approx(moved(wave, step[0, 0]), rel=1e-5)


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("wave", [wave for wave in WAVES if wave.half_width < 0.3 * wave.period])
def test_heights_that_are_off_move_edges(wave, dual):
    """By 2 k_0/A with k_0 = e/(2^(1/2) pi a^(1/2)), and by 2 a e/(chi F), where F is Hertz's force of A."""
    a, A = wave.half_width, wave.strength
    force = np.pi / np.sqrt(8) * a**1.5 * A
    chi = max(-2 * np.log(np.pi * a / wave.period), 1.0)
    move = np.sqrt(2) * HEIGHT / (np.pi * A * np.sqrt(a)) + 2 * a * HEIGHT / (chi * force)
    by_heights = stated(wave, dual, height_error=HEIGHT) - stated(wave, dual)
    assert by_heights == pytest.approx(moved(wave, move), rel=1e-4)


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_heights_change_hertz_s_contact_by_no_more_than_stated(period):
    """A curvature 4 e/a^2 on the same force, and a plane that is off by e: both within what is stated."""
    wave = OneWave(period, 0.02 * period, 0.2 * period)
    by_heights = stated(wave, height_error=HEIGHT) - stated(wave)
    curvature = (2 * np.pi / period) ** 2
    sharper = 0.5 * wave.half_width * (4 * HEIGHT / wave.half_width**2) / curvature  # a^2 = 4 F/kappa
    assert moved(wave, -sharper) < by_heights
    assert moved(wave, -sharper) > 0.05 * by_heights


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_an_edge_beside_a_narrow_gap_counts_twice(period):
    wave = OneWave(period, 0.4 * period, 0.2 * period)  # the gap is 0.2 L wide
    half_gap, A, a = 0.1 * period, wave.strength, wave.half_width
    force = np.pi / np.sqrt(8) * a**1.5 * A
    chi = max(-2 * np.log(np.pi * a / period), 1.0)
    move = np.sqrt(2) * HEIGHT / (np.pi * A * np.sqrt(half_gap)) + 2 * a * HEIGHT / (chi * force)
    by_heights = stated(wave, height_error=HEIGHT) - stated(wave)
    assert by_heights == pytest.approx(2 * moved(wave, move), rel=1e-4)


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_a_contact_or_a_gap_that_may_not_be_there_counts_whole(period):
    """Four times what the loss of a contact changes, L f^2 chi, and eight times that of a gap, pi^2 b^2 q^2/L."""
    contact = OneWave(period, 1e-3 * period, 0.2 * period)
    chi = -2 * np.log(np.pi * contact.half_width / period)
    assert stated(contact, height_error=1.0) == pytest.approx(4 * period * chi, rel=1e-4)
    gap = OneWave(period, 0.5 * period * (1 - 1e-3), 0.2 * period)
    b = 0.5e-3 * period  # q = 1 near full contact
    assert stated(gap, height_error=1.0) == pytest.approx(8 * np.pi**2 * b**2 / period, rel=1e-3)


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_tension_that_is_left_counts_as_the_gap_that_it_may_be(period, dual):
    """Twice pi^2 b^2 q^2/L, b being 2^(1/2) times the interval of tension, with q by the strength at the edges."""
    wave = OneWave(period, 0.1 * period, 0.2 * period)
    tensions = np.array([[0.0, 0.3, 1e-4]])
    r = wave.half_width
    q = max(wave.tangent_strength * np.sqrt(2 / (r * (1 - 0.09))), 1.0)
    expected = 2 * np.pi**2 * 2 * (1e-4 * r * q) ** 2 / period
    assert stated(wave, dual, tensions=tensions) - stated(wave, dual) == pytest.approx(expected, rel=1e-9)
    # The pressure of an increment is that of the flat punch, cos(pi x/L)/(sin^2(pi a/L) - sin^2(pi x/L))^(1/2).
    y = np.pi / period * 0.3 * r
    exact = np.cos(y) / np.sqrt(np.sin(wave.alpha) ** 2 - np.sin(y) ** 2)
    assert q == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize("dual", [False, True])
@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
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
    by_neighbour = stated(wave, dual, cracks=cracks) - stated(wave, dual)
    assert by_neighbour == pytest.approx(4 * rise * (b / (0.6 * wave.half_width)) ** 2, rel=1e-5)
    off = HEIGHT * state.segments.node_count[0] / (2 * np.pi * state.segments.half_width[0] * np.sqrt(1 - t * t))
    both = stated(wave, dual, cracks=cracks, height_error=HEIGHT) - stated(wave, dual, height_error=HEIGHT)
    by_tension = np.pi**2 * q**2 / period * (4 * off / curvature)
    assert both - by_neighbour == pytest.approx(by_tension, rel=1e-5)


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
@pytest.mark.parametrize(("part", "distance"), [(0.1, 0.5), (0.02, 0.025)])
def test_a_contact_that_may_be_born_takes_part_of_an_increment(period, part, distance):
    """tau^2/(chi L), where tau is at most R + 2 L ln 2, and chi is that of a punch, less the relief by one nearby."""
    wave = OneWave(period, part * period, 0.2 * period)
    gaps = np.zeros(1, MINIMUM)
    gaps["position"], gaps["curvature"] = wave.crest + distance * period, 50.0
    depth = GAP_FACTOR * HEIGHT + GAP_ROUNDING
    b = np.sqrt(2 * depth / 50)
    relief = -2 * np.log(np.pi * part) + 4 * np.log(2 * np.sin(np.pi * distance))
    assert (relief < 0) == (distance < 0.1)
    chi = -2 * np.log(np.pi * b / period) + min(relief, 0.0)
    expected = (wave.resistance + 2 * np.log(2) * period) ** 2 / (chi * period)
    assert expected < wave.resistance
    born = stated(wave, height_error=HEIGHT, narrow_gaps=gaps) - stated(wave, height_error=HEIGHT)
    assert born == pytest.approx(expected, rel=1e-9)
    gaps["value"] = depth * (1 - 1e-12)  # the less it may penetrate, the less
    less = stated(wave, height_error=HEIGHT, narrow_gaps=gaps) - stated(wave, height_error=HEIGHT)
    assert less < born


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_rounding_widens_contacts(period):
    """Of curvatures, by half of itself relative to a; and of heights on crests that are not the highest."""
    wave = OneWave(period, 0.1 * period, 0.2 * period)
    a, A, waves = wave.half_width, wave.strength, np.array([1, 2])
    force = np.pi / np.sqrt(8) * a**1.5 * A
    chi = max(-2 * np.log(np.pi * a / period), 1.0)
    amplitude = np.array([1.0, 0.7])
    of_curvature = EPS * np.sum(amplitude * (2 * np.pi * waves / period) ** 2) * a**3 / (8 * force)
    total = EPS * amplitude.sum()
    of_height = np.sqrt(2) * total / (np.pi * A * np.sqrt(a)) + 2 * a * total / (chi * force)
    state = wave.state(False)._replace(height_error=0.0, error=0.0)
    for shift, is_lower in ((0.0, False), (np.pi, True)):
        # cos x + 0.7 cos 2x has its highest crest at 0, and a lower one at half a period.
        phases = -2 * np.pi * waves * wave.crest / period + shift * waves
        series = make_series(amplitude, [1, 2], phases, period)
        found = resistance_error(state, series) - TANGENT_ERROR * max(wave.resistance, 1.0)
        move = of_curvature + (of_height if is_lower else 0.0)
        assert found == pytest.approx(4 * np.pi**2 / period * wave.tangent_strength**2 * move, rel=1e-2)
