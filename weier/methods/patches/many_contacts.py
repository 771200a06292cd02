"""One load on any number of contacts, without a dense matrix of all of them: in memory O(contacts).

The contacts start wave by wave. Newton's method on their edges solves for the pressure by conjugate gradients, and
the set of contacts is corrected in bulk where the inequalities of contact do not hold: first roughly, then to the
tolerance. The solution is checked at other nodes with a fresh operator, and on a few contacts by direct sums of
closed forms that share nothing with the fast ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.edge_iteration import Stage, Step, make_guess, next_guess, rearrange, take_step
from weier.methods.patches.fields import ContactState, complementary_residual
from weier.methods.patches.inequalities import NegativeIntervals, find_negative_intervals
from weier.methods.patches.punch_edges import transfer_forces
from weier.methods.patches.punch_inequalities import find_missing_contacts
from weier.methods.patches.punches import (
    MAX_NODES,
    Bounds,
    displacement,
    expansion_of_regular_part,
    make_punches,
    solve_forces_on_contacts,
)
from weier.methods.patches.segments import make_segments
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests
from weier.methods.patches.wave_by_wave import wave_by_wave
from weier.theory.profile import Profile

MIN_CONTACTS = 64  # from here on this is faster than a dense matrix, whose unknowns are some twenty for each
MAX_STEPS = 60  # 8 to 25 are usual
MIN_TOLERANCE = 1e-10  # in g_0, of the residual: what comes out is mostly a hundredth, where rounding begins
TARGET = 0.01  # of the tolerance: for all parts of the residual while iterating
ROUNDING = 1e-13  # of the displacement under the whole load, as a height
REDUCTION = 1e-3  # of the residual by the conjugate gradients of a step
ROUGH_TOLERANCE = 1e-6  # of the finest wave's amplitude, before the set of contacts is right
ROUGH_TENSION, MAX_TENSION = 1e-4, 1e-9  # over the pressure of a contact: before and in the end
RATE_REDUCTION = 1e-8  # of the residual of the resistance, an energy: its error is far smaller
MAX_TAIL = 0.3  # height of the last coefficients, over the target: with more, a contact needs nodes
MORE_NODES, AT_LEAST_MORE = 1.3, 2
OTHER_NODES = 7  # that a contact has more when the solution is checked
MAX_RESIDUAL = 100  # that is accepted, in units of the tolerance
DIRECT_SUMS = 40  # points at which the solution is checked without fast sums
CUT_WIDENING = 0.2  # at each end of a cut, so that the cut is sqrt(2) times the interval of tension
MIN_PIECE = 1e-3  # of a contact's width: shorter pieces do not survive a cut

Edges = tuple[Array, Array]  # left and right ones, each of shape (contacts,)


class _Limits(NamedTuple):
    """A gap below -gap, in g_0, is a violation, and a pressure below -tension times the largest of its contact."""

    gap: float
    tension: float


def solve_if_many(
    profile: Profile, surface: Surface, load: float, tolerance: float
) -> tuple[ContactState, int] | None:
    """The state under one load and Newton's steps, if a dense matrix of all contacts takes longer; else None.

    None, too, where this method fails: near full contact the gaps are few, and the dense matrix is theirs.
    """
    if profile.waves_per_period[-1] < MIN_CONTACTS:
        return None
    try:
        start = wave_by_wave(profile, load, _rough_stage(profile, _target(profile, load, tolerance)))
        return (
            solve_many_contacts(profile, surface, load, tolerance, start) if start[0].size >= MIN_CONTACTS else None
        )
    except ConvergenceError:
        return None


def _rough_stage(profile: Profile, target: float) -> Stage:
    return Stage(8.0, 5.0, Bounds(REDUCTION, target, _rough_tolerance(profile)))


def _fine_stage(profile: Profile, target: float) -> Stage:
    return Stage(12.0, 9.0, Bounds(REDUCTION, 0.1 * target, _rough_tolerance(profile)))


def _rough_tolerance(profile: Profile) -> float:
    return ROUGH_TOLERANCE * float(profile.amplitude[-1])


def _target(profile: Profile, load: float, tolerance: float) -> float:
    return max(TARGET * max(tolerance, MIN_TOLERANCE), ROUNDING * load * float(profile.period))


def solve_many_contacts(
    profile: Profile, surface: Surface, load: float, tolerance: float, start: Edges | None = None
) -> tuple[ContactState, int]:
    """The state under one load, in partial contact, and the steps of Newton's method.

    It starts from left and right edges of contact; they are found wave by wave if None. ConvergenceError is raised if
    a contact needs more nodes than a matrix of its own should hold, as near full contact, if corrections do not end,
    or if the state fails a check.
    """
    target = _target(profile, load, tolerance)
    rough, fine = _rough_stage(profile, target), _fine_stage(profile, target)
    stage, limits = rough, _Limits(_rough_tolerance(profile), ROUGH_TENSION)
    guess = make_guess(profile, *(wave_by_wave(profile, load, rough) if start is None else start), rough)
    for steps in range(1, MAX_STEPS + 1):
        step = take_step(profile, load, guess, stage)
        if not (_converged(step, target) if stage is fine else step.settled):
            guess = next_guess(profile, step, stage, _node_counts(step, target) if stage is fine else None)
            continue
        state = contact_state(surface, step, load)
        added, keep = _corrections(profile, step, state, limits)
        if not np.all(keep) or len(added) > 0:
            counts = step.punches.node_count.astype(float) if stage is fine else None
            guess = rearrange(profile, step, step.b, _edges(step), keep, added, stage, counts)
        elif stage is rough:
            stage, limits = fine, _Limits(target, MAX_TENSION)
            guess = next_guess(profile, step, stage)
        else:
            residual = _residuals_at_other_nodes(profile, step)
            if not np.any(short := (residual > MIN_TOLERANCE) & (step.punches.node_count < MAX_NODES)):
                return _checked_state(surface, step, state, float(residual.max()), tolerance), steps
            counts = np.where(short, _increase(step.punches.node_count), step.punches.node_count)
            guess = next_guess(profile, step, stage, counts)
    raise ConvergenceError(f"no set of contacts was found that meets all conditions under {load:.6g} p_0*")


def _edges(step: Step) -> Edges:
    return step.punches.centre - step.punches.half_width, step.punches.centre + step.punches.half_width


def _converged(step: Step, target: float) -> bool:
    return bool(step.singular.max() < target and step.forces.residual < target)


def _increase(count: Indices) -> NDArray[np.float64]:
    return np.asarray(MORE_NODES * count + AT_LEAST_MORE)


def _node_counts(step: Step, target: float) -> NDArray[np.float64]:
    """As many nodes as before, and more where the last coefficients have not decayed."""
    last, count = step.punches.first_node[1:], step.punches.node_count
    tail = np.maximum(np.abs(step.b[last - 1]), np.abs(step.b[last - 2]))
    height = 2 * np.pi * step.punches.half_width * tail / count
    short = step.settled & (height > MAX_TAIL * target)
    return np.where(short, _increase(count), count)


def _corrections(
    profile: Profile, step: Step, state: ContactState, limits: _Limits
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Intervals of contact to add, shape (added, 2), and which contacts stay as they are."""
    negative = find_negative_intervals(state, np.full(step.punches.centre.size, limits.tension))
    keep = np.ones(step.punches.centre.size, bool)
    keep[negative.segment] = False
    missing = find_missing_contacts(profile, step, limits.gap)
    return np.concatenate([_cut_contacts(step, negative), missing]), keep


def _cut_contacts(step: Step, negative: NegativeIntervals) -> NDArray[np.float64]:
    """What is left of each contact without its intervals of tension."""
    pieces = []
    for j in np.unique(negative.segment):
        centre, r, here = step.punches.centre[j], step.punches.half_width[j], negative.segment == j
        left = -1.0
        for a, b in [*zip(negative.start[here], negative.end[here], strict=True), (1.0, 1.0)]:
            widening = CUT_WIDENING * (b - a) if a > -1 and b < 1 else 0.0
            if a - widening - left > MIN_PIECE:
                pieces.append((centre + r * left, centre + r * (a - widening)))
            left = b + widening
    return np.array(pieces).reshape(-1, 2)


def contact_state(surface: Surface, step: Step, load: float) -> ContactState:
    """A step as a state of contact, whose pressure vanishes at all edges; without resistance and residual."""
    punches, series = step.punches, surface.heights
    crest, y = nearest_crests(series, punches.centre)
    segments = make_segments(crest, punches.centre - y, y, punches.half_width, punches.node_count, series.period)
    phi = np.empty(step.a.size)
    for rule, _, node in punches.groups:
        count = rule.node.size
        angle = np.arange(1, count + 1) * (np.pi / (count + 1))
        phi[node] = step.a[node] @ (np.sin(np.arange(1, count + 1)[:, None] * angle) / np.sin(angle))
    approach = series.maximum - step.forces.plane
    return ContactState(False, load, approach, segments, phi, step.a, np.zeros(1), np.nan)


def _residuals_at_other_nodes(profile: Profile, step: Step) -> Array:
    """The largest gap on each contact, without sign, at other nodes than those solved at, in g_0."""
    punches = step.punches
    count, everyone = punches.node_count + OTHER_NODES, np.arange(punches.centre.size)
    other = make_punches(punches.centre, punches.half_width, count, punches.period)
    b = expansion_of_regular_part(punches, step.a)
    force = transfer_forces(punches, b, everyone, punches.half_width, count)
    gap = step.forces.plane + displacement(other, force) - profile.height(other.position)
    return np.asarray(np.maximum.reduceat(np.abs(gap), other.first_node[:-1]))


def _checked_state(
    surface: Surface, step: Step, state: ContactState, residual: float, tolerance: float
) -> ContactState:
    """The state with resistance and residual; ConvergenceError if it fails a check."""
    punches, period = step.punches, step.punches.period
    direct = float(np.abs(_gaps_by_direct_sums(state, surface.heights, _sample_of(state))).max())
    carried = 0.5 * np.pi * float(punches.half_width @ step.a[punches.first_node[:-1]])
    residual = max(residual, direct)
    relative = max(residual / state.approach, abs(carried / (state.load * period) - 1))
    if not relative <= MAX_RESIDUAL * tolerance:
        raise ConvergenceError(
            f"the contacts under the mean pressure {state.load:.6g} p_0* violate their conditions by {relative:.1e}, "
            f"more than {MAX_RESIDUAL * tolerance:.1e}; take a larger tolerance or boundary elements",
            relative,
        )
    none = np.zeros(punches.position.size)
    rate = solve_forces_on_contacts(punches, none, period, none, Bounds(RATE_REDUCTION, 0.0, np.inf))
    return state._replace(sensitivity=np.array([-rate.plane]), residual=residual)


def _sample_of(state: ContactState) -> Indices:
    """Nodes of the state at which it is checked by direct sums: the same ones each time."""
    size = state.phi.size
    return np.random.default_rng(size).choice(size, min(size, DIRECT_SUMS), replace=False)


@kernel
def _gaps_by_direct_sums(state: ContactState, series: CosineSeries, which: Indices) -> Array:
    """The gap on contacts at some nodes of the state, in g_0."""
    gap, segments = np.empty(which.size), state.segments
    for i in range(which.size):
        j = np.searchsorted(segments.first_node, which[i], side="right") - 1
        y = segments.centre[j] + segments.half_width[j] * segments.node[which[i]]
        gap[i] = complementary_residual(state, series, segments.crest[j], y)
    return gap
