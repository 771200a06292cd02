"""Stability at the extremes: all methods at the limits of floats, load by load, as tables.

A curve rises and is concave, its resistance lies between the chords on both sides, and so falls, and both lie within
the bounds that the closed form of the first wave gives for all longer series (Section 5.5).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress

import numpy as np

from weier.accuracy.comparison import Compared, by_problem, compare
from weier.accuracy.measurement import measurement
from weier.accuracy.reference import digits
from weier.accuracy.runner import Problem, Variant
from weier.api.fields import events
from weier.data.markdown import plain
from weier.kernels.arrays import Array
from weier.methods import registry, westergaard
from weier.methods.method import Method
from weier.surface.profile import Profile
from weier.surface.waves import Waves
from weier.theory.bounds import resistance_bounds

# Unstated errors: of heights relative to the total amplitude, and relative errors of slopes. The layer interpolates
# tables of accuracy 1e-5.
ROUNDING, NOISE = (1e-12, 1e-11), {"layer": (1e-6, 1e-5)}

# Loads over the whole range of floats, and usual loads.
SWEEP = 10.0 ** np.array(
    [*range(-300, -20, 50), -30, -20, *range(-15, -3, 2), *np.arange(-3, 1.5, 0.5), 2, 6, 12, *range(50, 301, 50)]
)
USUAL = np.geomspace(1e-6, 100, 25)
ONE_LOAD = np.array([0.1])
MAX_SECONDS = 60.0  # of a method for a curve and for its loads one by one


def neighbours(*loads: float) -> Array:
    """Return each load and its neighbours, one and two units in the last place (ulp) away."""
    below = np.nextafter(loads, 0)
    above = np.nextafter(loads, np.inf)
    return np.unique([np.nextafter(below, 0), below, loads, above, np.nextafter(above, np.inf)])


def around_events(profile: Profile) -> Array:
    """Return loads at and around every third birth or merger of contacts, which bounds the time."""
    births = events(profile, 1e-3, 100.0)["mean_pressure"].values[::3]
    return np.unique(np.multiply.outer(births, 1 + np.array([-1e-4, -1e-8, -1e-12, 0, 1e-12, 1e-8, 1e-4])))


def _end_of_range(text: str, D: float, gamma: str) -> Iterator[tuple[str, Profile, Array]]:
    """Yield series with D or gamma at one end of its range; slow methods are run at a single load."""
    long = Profile(D, gamma, 1000)
    yield f"{text}, m = 3", Profile(D, gamma, 3, [0.0, 1.0, 2.0]), USUAL
    yield f"{text}, m = inf", Profile(D, gamma, math.inf), USUAL
    yield f"{text}, m = 1000", long, USUAL
    yield f"{text}, m = 1000, one load", long, ONE_LOAD


ONE_WAVE, THREE_WAVES = Profile(1.25, "5", 1), Profile(1.25, "5", 3, [0.0, 1.0, 2.0])
EXTREMES: tuple[tuple[str, Profile, Array | Callable[[Profile], Array]], ...] = (
    ("one wave, loads 1e-300 to 1e300", ONE_WAVE, SWEEP),
    ("three waves, loads 1e-300 to 1e300", THREE_WAVES, SWEEP),
    ("m = inf, loads 1e-300 to 1e300", Profile(1.25, "5", math.inf), SWEEP),
    ("one wave, xi one ulp from 1", ONE_WAVE, neighbours(1.0)),
    # p_n* = 1 and 3, g_n = 1 and 1/3, and full contact at 4 are floats or round to one.
    ("p one ulp from p_n* and full contact", Profile(1.5, "9", 2, [0.0, 0.0]), neighbours(1.0, 3.0, 4.0)),
    *_end_of_range("D = 1 + 1e-9", 1 + 1e-9, "5"),
    *_end_of_range("D = 2 - 1e-9", 2 - 1e-9, "5"),
    *_end_of_range("gamma = 1 + 1e-6", 1.5, "1000001/1000000"),
    *_end_of_range("gamma = 1e6", 1.5, "1000000"),
    ("m = 1000, loads 1e-300 to 1e300", Profile(1.5, "2", 1000), SWEEP),
    ("m = 1000, one load", Profile(1.5, "2", 1000), ONE_LOAD),
    ("about to merge, just merged", Profile(1.5, "3", 3, [0.0, 1.0, 2.0]), around_events),
    ("phases 0, births in pairs", Profile(1.5, "3", 3, [0.0, 0.0, 0.0]), around_events),
    ("phases pi, births in pairs", Profile(1.5, "3", 3, [0.0, math.pi, math.pi]), around_events),
    ("two crests of one height", Profile(1.25, "2", 2, [0.0, math.pi]), SWEEP),
    ("two crests, 1e-15 apart in height", Profile(1.25, "2", 2, [0.0, math.pi + 1e-15]), SWEEP),
    ("a wave of 1e-3 on one of 1", Profile(1 + 1e-9, "1000", 2, [0.0, 1.0]), USUAL),
    ("finer waves flat to rounding", Profile(1 + 1e-9, "1000000", 1000), USUAL),
    ("waves that cancel to 1 %", Profile(1 + 1e-9, "101/100", 2, [0.0, math.pi]), USUAL),
)


def variants(profile: Profile, loads: Array) -> dict[str, Variant]:
    """Return all methods that give compliance and resistance of the profile in affordable time, or refuse it."""
    methods = (method for method in registry.METHODS if method.stiffness)
    return {method.name: Variant(method.name) for method in methods if _is_affordable(method, profile, loads)}


def _is_affordable(method: Method, profile: Profile, loads: Array) -> bool:
    if not method.takes(profile):
        return method.numerical and math.isfinite(profile.m)
    with suppress(ValueError):  # A tolerance that is out of reach is refused at once.
        method.check(profile)
        # A curve that is refused is solved load by load.
        one_by_one = sum(method.seconds(profile, loads[i : i + 1]) for i in range(loads.size))
        return method.seconds(profile, loads) + one_by_one <= MAX_SECONDS
    return True


def extremes() -> Iterator[Problem]:
    """Yield all extremes with their loads and variants; loads near events are computed here."""
    for name, profile, chosen in EXTREMES:
        loads = chosen(profile) if callable(chosen) else chosen
        yield Problem(name, profile, loads, variants(profile, loads))


def faults(one: Compared) -> list[str]:
    """Return the faults of a variant at an extreme, in words."""
    result, method = one.result, one.problem.variants[one.name].method
    stated = np.nan_to_num(result.stated[:, result.solved])
    checks = check(
        method, one.problem.profile, one.problem.loads[result.solved], result.values[:, result.solved], stated
    )
    found = [f"not {name}" for name, holds in checks.items() if not holds]
    found += [f"warning: {text}" for text in result.warned]
    # Each load alone is solved.
    found += ["not one curve"] * bool(result.message and result.solved.all())
    return found + list(one.exceeded())


def check(method: str, profile: Waves, p: Array, curve: Array, stated: Array) -> dict[str, bool]:
    """Return the checks of compliance and resistance, with stated errors or 0, each of shape (2, loads), by name.

    Checks of the shape of a curve need at least two loads.
    """
    (h, R), found = curve, dict[str, bool]()
    noise, slope_noise = NOISE.get(method, ROUNDING)
    error, R_error = stated[0] + noise * profile.total_amplitude, stated[1] + slope_noise * R
    # Without a first contact, Persson's compliance falls without bound as ln p (docs/persson.md).
    if p.size > 0 and method != "persson":
        finer = profile.total_amplitude - 1  # amplitude of all waves but the first
        one, band = westergaard.compliance(p), finer + error.max()
        low, high = resistance_bounds(p, one, band, first_contact=0.0)
        within = (np.abs(h - finer - one) <= band) & (low - R_error <= R) & (R - R_error <= high)
        found["within the bounds"] = bool(np.all(within))
    if p.size > 1:
        found["monotone"] = bool(np.all(np.diff(h) >= -_both_ends(error)))
        with np.errstate(over="ignore", invalid="ignore"):
            slack, chord = _both_ends(error) / np.diff(p), np.diff(h) / np.diff(p)
            between = (chord <= (R + R_error)[:-1] + slack) & (chord >= (R - R_error)[1:] - slack)
        found["concave"] = bool(np.all(between))
    return found


def _both_ends(error: Array) -> Array:
    """Return the sum of the errors at both ends of each interval of loads."""
    return np.asarray(error[:-1] + error[1:])


def parts(found: Sequence[Compared]) -> Iterator[str]:
    """Yield the faults, the digits by method and by extreme, and an error message of each kind."""
    faulty = [f"{one.problem.name}, {one.name}: {', '.join(own)}" for one in found if (own := faults(one))]
    messages = dict.fromkeys(one.result.message for one in found if one.result.message)
    one_of_each = {re.split(r"\d", message)[0]: message for message in reversed(messages)}
    yield f"{len(found)} rows, " + (
        f"and these have a fault:\n\n{_list(faulty)}" if faulty else "none of them with a fault."
    )
    yield "## Digits of the compliance and of the resistance"
    yield by_problem(found, "extreme", _digits_left)
    yield "## Error messages\n\nOne of each kind:"
    yield _list(reversed(one_of_each.values()))


def _list(texts: Iterable[str]) -> str:
    return "\n".join(f"- {plain(text)}" for text in texts)


def _digits_left(found: Sequence[Compared]) -> str:
    """Return the least correct digits of h and R, or what became of the loads."""
    (one,) = found
    if not one.result.solved.any():
        return "all refused"
    least = np.fmin.reduce(digits(one.result.values, one.reference.values), axis=1)
    left = ", ".join(f"{own:.1f}" for own in least if not np.isnan(own)) or "finite"
    return left if one.result.solved.all() else f"{left}, some refused"


@measurement("Stability at the extremes")
def main() -> list[str]:
    """Examine all methods at the limits of floats.

    Each method is run at ill-conditioned loads of series at the limits of their parameters. Every load must give a
    number or a clear error, and the numbers must be a curve of compliance, within the errors that the method states.
    `docs/stability.md` has this page with its definitions.
    """
    return [*parts([*compare(extremes(), own_sums=True)])]
