"""Methods of solution that the package does not know, for tests of what it derives from a method."""

from weier.methods import westergaard
from weier.methods.method import Estimate, Method, Style


def solve_first_wave(profile, loads, factor: float = 1.0):
    """The compliance of the first wave alone, times a factor."""
    return Estimate(factor * westergaard.compliance(loads), factor * westergaard.resistance(loads))


def raising(error):
    """A method that raises an error."""

    def solve(profile, loads):
        raise error

    return Method("raising", "raising", "raises an error", solve)


FIRST_WAVE = Method(
    name="first wave",
    label="first wave alone",
    summary="the closed form of the first wave, whatever the others",
    solve=solve_first_wave,
    style=Style("#882255", (2, 2), "h"),
    variants=lambda profile: [(f"{factor:g}", {"factor": factor}) for factor in (0.5, 0.9)],
    seconds=lambda profile, loads: 1e-6 * loads.size,
    solution_error=lambda profile, solved: profile.total_amplitude - 1,
)
