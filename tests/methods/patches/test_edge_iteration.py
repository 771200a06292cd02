"""One step on the edges of contacts or gaps: each closed form of a move, and the order of the method."""

import numpy as np
import pytest
from numpy.polynomial import Chebyshev, Polynomial

from tests.methods.patches.westergaard_states import KINDS, WAVES
from weier import ConvergenceError
from weier.kernels.blas import one_thread
from weier.methods.patches.edge_iteration import (
    ContactProblem,
    _changes,
    carried_along,
    edge_moves,
    make_guess,
    merged_intervals,
    next_guess,
    rearrange,
    take_step,
)
from weier.methods.patches.segments import make_segments
from weier.methods.patches.surface import make_series

TOLERANCE, RESIDUAL = 1e-12, 1e-14


def moves_of(psi, r, gap, dual):
    """The moves of the edges of segments from polynomials psi(t), one each, and what goes with them."""
    coefficients = [np.append(p.convert(kind=Chebyshev).coef, np.zeros(2)) for p in psi]
    first, b = np.append(0, np.cumsum([c.size for c in coefficients])), np.concatenate(coefficients)
    kind, extent = KINDS[dual], (first, np.array(r), np.array(gap))
    _, sides, (_, merging), move, *_ = edge_moves(*extent, np.ones(b.size), b, kind.right_sign, kind.curvature_k_0)
    return sides[:2].T, merging, move, sides[2]


def psi_of_hertz(r, a, shift, curvature):
    """b_0 = F/(pi r), b_1 = -kappa (c-x_c)/(2 pi), b_2 = -kappa r/(4 pi), with F = kappa a^2/4."""
    force = curvature * a**2 / 4
    return Chebyshev([force / (np.pi * r), -curvature * shift / (2 * np.pi), -curvature * r / (4 * np.pi)])


def psi_of_gap(r, a, shift, curvature):
    """-2 pi sum s_k T_(k+1) in the tension q_0 - kappa (x-x_c)^2/2 = sum s_k U_k, with q_0 = kappa a^2/4."""
    tension = 0.25 * curvature * a**2 - 0.5 * curvature * (shift**2 + 0.25 * r**2)
    return Chebyshev([0, tension, -0.5 * curvature * shift * r, -0.125 * curvature * r**2]) * (-2 * np.pi)


@pytest.mark.parametrize("off", [-0.3, 0.0, 0.3])
@pytest.mark.parametrize("wanted", [0.7, 1.0, 1.6])
def test_a_narrow_segment_gets_its_width_and_its_middle_at_once(dual, off, wanted):
    """Of contacts exactly, and of gaps where they are in the middle, and to first order beside it."""
    r, off = 0.02, off * (0.05 if dual else 1)
    a, shift = wanted * r, off * r
    psi = (psi_of_gap if dual else psi_of_hertz)(r, a, shift, 30.0)
    outward, closed, relative, singular = moves_of([psi], [r], [1 - 2 * r], dual)
    left, right = -r - outward[0, 0], r + outward[0, 1]
    assert 0.5 * (right - left) == pytest.approx(a, rel=1e-12 + 3 * dual * off**2)
    if not dual or wanted == 1.0:  # The middle of a gap of another width is moved too far by the ratio of squares.
        assert abs(0.5 * (right + left) + shift) <= 1e-12 + 3 * dual * abs(shift) * off**2
    assert not closed[0]
    assert relative == pytest.approx(np.abs(outward).max() / r)
    assert singular[0] == pytest.approx(2 * np.pi * r * max(abs(psi(1)), abs(psi(-1))))


def psi_with(k_0, k_1, r, right):
    """A straight line psi with k_0 = (r/2)^(1/2) psi and k_1 = [psi/4 -+ psi']/(2r)^(1/2) at one end."""
    end = k_0 * np.sqrt(2 / r)
    inward = k_1 * np.sqrt(2 * r) - end / 4
    return Polynomial([end + inward, -inward]) if right else Polynomial([end + inward, inward])


@pytest.mark.parametrize("other_end", [0.0, 0.1])
@pytest.mark.parametrize("square", [0.3, 1.0, 2.5])
def test_what_is_narrow_between_segments_gets_its_width(dual, square, other_end):
    """p = |x| [C + kappa (x^2-b^2)/2]/(x^2-b^2)^(1/2) beside a gap: C = kappa b^2/4 - q_0.

    Beside a contact between gaps w' = [C + kappa (x^2-b^2)]/(x^2-b^2)^(1/2) and b^2 -> b^2 - 2 C/kappa.
    Beside one that is off its middle the ends yield different squares, and half their difference shifts it.
    """
    b, r, curvature = 0.01, 0.2, 30.0
    psi = []
    for right, change in ((True, other_end), (False, -other_end)):  # the segment on the left ends at the gap
        part = square + change
        if dual:
            C = 0.5 * curvature * b**2 * (1 - part)
            k_0 = C / np.sqrt(2 * b)
            k_1 = (2 * curvature * b**2 / np.sqrt(2 * b) - 0.25 * k_0) / b
        else:
            C = 0.25 * curvature * b**2 * (1 - part)
            k_0 = C * np.sqrt(b / 2)
            k_1 = (curvature * b**2 * np.sqrt(b / 2) + 0.75 * k_0) / b
        sign = -1.0 if dual and right else 1.0
        psi.append(sign * psi_with(k_0, k_1, r, right))
    outward, closed, relative, _ = moves_of(psi, [r, r], [2 * b, 2.0], dual)
    left, right = -b + outward[0, 1], b - outward[1, 0]
    assert 0.5 * (right - left) == pytest.approx(b * np.sqrt(square), rel=1e-12, abs=0)
    assert 0.5 * (right + left) == pytest.approx(-0.5 * b * other_end, abs=1e-14)
    assert not np.any(closed)
    assert relative == pytest.approx(np.abs(outward).max() / b)


def test_what_has_no_width_left_is_closed(dual):
    """A square of -0.5 by the formula: the gap on the right of the first segment closes, the other does not."""
    b, r = 0.01, 0.2
    growth = 1.5 / 4  # 1 - 4 k_0/curvature = -0.5
    k_0 = 1.0
    curvature = k_0 / growth
    k_1 = (curvature - (0.25 if dual else -0.75) * k_0) / b
    sign = -1.0 if dual else 1.0
    psi = [sign * psi_with(k_0, k_1, r, True), psi_with(k_0, k_1, r, False)]
    _, closed, _, _ = moves_of(psi, [r, r], [2 * b, 2.0], dual)
    assert closed.tolist() == [True, False]
    open_still = [sign * psi_with(k_0, 3 * k_1, r, True), psi_with(k_0, 3 * k_1, r, False)]
    assert not np.any(moves_of(open_still, [r, r], [2 * b, 2.0], dual)[1])


def problem_of(wave, dual):
    """The problem of one wave, its exact segments, and the half-width of the narrower of contact and gap."""
    scale = min(wave.half_width, 0.5 * wave.period - wave.half_width)
    return ContactProblem(wave.series(dual), wave.load, KINDS[dual]), wave.state(dual).segments, scale


def displaced(segments, error):
    """The segments with half-widths that are off by an error, and centres by 0.4 of it."""
    return segments._replace(centre=segments.centre + 0.4 * error, half_width=segments.half_width + error)


@one_thread
def test_a_step_squares_the_error_of_edges(wave, dual):
    """One wave whose edges are off by 1e-3 and 2e-3 of what is the narrower, contact or gap, to either side."""
    problem, exact, scale = problem_of(wave, dual)
    errors = []
    for size in (1e-3, 2e-3):
        segments = displaced(exact, size * scale)
        step = take_step(problem, make_guess(problem, segments, TOLERANCE), RESIDUAL)
        moved = next_guess(problem, step, TOLERANCE, step.punches.segments.node_count)
        found = moved.segments
        assert step.settled
        off = abs(found.middle[0] - exact.middle[0]) + abs(found.half_width[0] - exact.half_width[0])
        errors.append(off / scale)
    assert errors[0] < 4e-6
    assert errors[1] < 16e-6


@one_thread
def test_a_density_that_is_carried_along_is_the_next_solution_but_for_the_square_of_the_move(wave, dual):
    problem, exact, scale = problem_of(wave, dual)
    errors = []
    for size in (1e-4, 2e-4):
        segments = displaced(exact, size * scale)
        step = take_step(problem, make_guess(problem, segments, TOLERANCE), RESIDUAL)
        carried = carried_along(step, 0.0)
        assert not np.any(carried.moves[4:])  # which more nodes would make again
        solved = take_step(problem, next_guess(problem, step, TOLERANCE, step.punches.segments.node_count), RESIDUAL)
        np.testing.assert_allclose(carried.punches.offset, solved.punches.offset, rtol=1e-12)
        errors.append(np.abs(carried.b - solved.b).max() / np.abs(solved.b).max())
        assert np.all(np.abs(solved.moves[:2].T) <= np.abs(carried.moves[:2].T))
        np.testing.assert_allclose(carried.forces.force, solved.forces.force, rtol=1e-5)
        moves = np.abs(step.moves[:2].T)
        left = 2 * moves.max() ** 2 / scale  # twice the square and rounding, to the displacement of the segments
        for rounding, part in ((0.0, 0.0), (0.1 * step.moves[2, 0], 0.1), (1.0, 1.0)):
            np.testing.assert_allclose(carried_along(step, rounding).moves[:2].T, left + part * moves, rtol=3e-3)
    moved = np.abs(step.b - solved.b).max() / np.abs(solved.b).max()
    assert errors[1] < 0.01 * moved
    assert errors[0] < 0.35 * errors[1] + 1e-11  # a quarter


@one_thread
def test_a_step_from_the_right_edges_has_the_exact_density(wave, dual):
    """Moves follow from ratios of its coefficients, so that a wrong factor of all forces would not change them."""
    exact = wave.state(dual)
    problem = ContactProblem(wave.series(dual), wave.load, KINDS[dual])
    step = take_step(problem, make_guess(problem, exact.segments, TOLERANCE), RESIDUAL)
    count = min(step.a.size, exact.coefficient.size)
    scale = np.abs(exact.coefficient).max()
    np.testing.assert_allclose(step.a[:count], exact.coefficient[:count], rtol=0, atol=1e-10 * scale)
    assert -step.forces.plane == pytest.approx(exact.approach, abs=1e-12)
    assert step.move < 1e-9


def test_a_rearranged_guess_has_the_segments_that_remain_and_the_new_ones_in_order(dual):
    wave = WAVES[0]
    problem, exact, scale = problem_of(wave, dual)
    step = take_step(problem, make_guess(problem, exact, TOLERANCE), RESIDUAL)
    beside = exact.middle[0] - 0.5 * wave.period
    added = beside + 0.1 * scale * np.array([[-2.0, 1.0]])
    one = np.ones(1, bool)
    found = rearrange(problem, step, exact, one, added, TOLERANCE, np.array([30])).segments
    at = int(np.argmax(found.half_width))
    assert found.half_width[[at, 1 - at]] == pytest.approx([exact.half_width[0], 0.15 * scale], rel=1e-12)
    assert found.node_count[at] == 30
    turns = (found.middle[[at, 1 - at]] - [exact.middle[0], beside - 0.05 * scale]) / wave.period
    assert turns == pytest.approx(np.rint(turns), abs=1e-9)
    assert 0 <= found.middle[0] < found.middle[1] < wave.period
    with pytest.raises(ConvergenceError, match="no contact is left"):
        rearrange(problem, step, exact, ~one, np.empty((0, 2)), TOLERANCE, np.array([30]))


def test_contacts_merge_if_the_moves_of_their_edges_leave_no_gap_and_vanish_without_a_force():
    """Each of two edges takes half of the gap between the contacts, and one of them alone would not close it."""
    first, gap, force = np.array([0, 1, 2]), np.array([0.1, 3.0]), np.ones(2)
    both, closed = np.array([[0.0, 0.051], [0.051, 0.0]]), np.zeros(2, bool)
    for outward, merges in ((both, True), (both * [[1, 1], [0, 1]], False), (both * [[1, 1], [-1, 1]], False)):
        (vanishing, merging), changes = _changes(first, gap, force, outward.T, closed)
        assert merging.tolist() == [merges, False]
        assert changes == merges
        assert not np.any(vanishing)
    (vanishing, merging), changes = _changes(first, gap, np.array([1.0, -1.0]), both.T, np.array([True, False]))
    assert (vanishing.tolist(), merging.tolist(), changes) == ([False, True], [False, False], True)


def test_contacts_that_merge_reach_from_the_first_to_the_last_also_round_the_period():
    """Contacts on [0.1, 0.2], [0.4, 0.6] and [0.9, 1.0], each of which may merge with the next one."""
    middle, r, none = np.array([0.15, 0.5, 0.95]), np.array([0.05, 0.1, 0.05]), np.zeros(3)
    segments = make_segments(none.astype(int), none, middle, r, np.full(3, 8))
    problem = ContactProblem(make_series(np.ones(1), [1], np.zeros(1), 1.0), 0.1, KINDS[False])
    for merging, (start, end) in (([True, False, False], (0.1, 0.6)), ([False, True, True], (0.4, 1.2))):
        (found,) = merged_intervals(problem, segments, np.array(merging))
        assert found == pytest.approx((start, end), rel=1e-12)


def test_a_pressure_that_is_no_number_is_the_largest_singularity():
    """Else the iteration would take it for converged."""
    (first, r, gap), kind = (np.array([0, 3, 6]), np.array([0.1, 0.1]), np.array([0.3, 0.3])), KINDS[False]
    for wrong in (2, 5):  # on the first contact and on the last
        b = np.array([1.0, 0.0, -1.0, 1.0, 0.0, -1.0])
        b[wrong] = np.nan
        largest = edge_moves(first, r, gap, np.ones(6), b, kind.right_sign, kind.curvature_k_0)[4]
        assert np.isnan(largest)
