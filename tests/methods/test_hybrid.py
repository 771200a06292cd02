"""The infinite series: the layer model where one term is resolved, and closing in on the truth as more are."""

import math
import sys
from itertools import pairwise

import numpy as np
import pytest

from weier import Profile, figures, random_phases
from weier.accuracy import convergence as study
from weier.methods import bem, hybrid, layer, patches
from weier.methods.hybrid import newton
from weier.methods.hybrid.solver import LOADS as CARRIED
from weier.methods.hybrid.truncation_bounds import BOUND_SHARE
from weier.theory.profile import RandomPhases

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, math.inf, random_phases(2))


def test_one_resolved_term_is_the_layer_model_and_converges_to_it():
    """The mesh's own error is of second order: four times less at each halving, and 0.9 g_0/N^2 at most."""
    exact = layer.curve(LOADS, 1.5, 5, math.inf)
    errors = []
    for points in (32, 64, 128):
        found = hybrid.curve(Profile(1.5, 5, math.inf), LOADS, 1, points)
        errors.append(np.abs(found.compliance - exact.compliance).max())
        assert np.all(found.residual <= newton.TOLERANCE)
    orders = [math.log2(coarse / fine) for coarse, fine in pairwise(errors)]
    assert min(orders) > 1.7, errors
    assert errors[-1] < 1.5 / 128**2 + 1e-5  # the layer's own tables
    # The slope of both curves, where neither is close to 0.
    assert found.resistance[:-1] == pytest.approx(exact.resistance[:-1], rel=0.05)


@pytest.fixture(scope="module")
def convergence():
    return study.convergence([PROFILE], LOADS, 6).isel(case=0)


def test_estimates_lie_within_all_bounds_and_close_in(convergence):
    h = convergence["compliance"].values
    low, high = convergence["compliance_lower"].values, convergence["compliance_upper"].values
    mesh = bem.error_model.COMPLIANCE / 32**2  # of the estimate's grid, in g_0
    assert np.all((low - mesh <= h) & (h <= high + mesh))
    # The last estimate lies within the bounds of every shorter series: they are about the same infinite one.
    assert np.all((low - mesh <= h[-1]) & (h[-1] <= high + mesh))
    off = np.abs(h[:-1] - h[-1]).max(axis=1)
    assert off[-1] < off[0] / 3
    # Far better than the certificate, which is half as wide as the bounds.
    assert np.all(off < 0.75 * (high - low)[:-1].max(axis=1) / 2)


def test_a_tail_on_a_layer_is_nearer_than_the_middle_of_the_bounds(convergence):
    """Against five terms more, whose own tail may move them by a tenth of that of the four."""
    long = Profile(1.25, 2, 9, random_phases(2))
    truth = bem.curve(long, LOADS, points=16 * long.wavenumber[-1]).compliance + long.tail_amplitude
    h, low, high = (convergence[name].values[3] for name in ("compliance", "compliance_lower", "compliance_upper"))
    estimate, middle = np.abs(h - truth).mean(), np.abs((low + high) / 2 - truth).mean()
    assert estimate < middle / 2


def test_bounds_go_further_than_the_estimate(monkeypatch, tmp_path):
    """Where the layer takes too many points, bounds are found alone; where they take too many, the status says so."""
    monkeypatch.setattr(study, "MAX_POINTS", 300)
    monkeypatch.setattr(sys.modules["weier.methods.hybrid.truncation_bounds"], "MAX_POINTS", 2000)
    data = study.convergence([Profile(1.25, 5, math.inf, random_phases(1))], LOADS[::2], 5)
    found = data.isel(case=0)
    assert np.isfinite(found["compliance"].values).all(axis=1).tolist() == [True, True, False, False, False]
    assert found["status"].values.tolist() == [0, 0, 0, 0, 2]
    low, high = (found[f"compliance_{side}"].values[:4] for side in ("lower", "upper"))
    assert np.all(low.max(axis=0) <= high.min(axis=0))
    assert np.all(high <= float(found["total_amplitude"]))
    figures.draw("endless", [data], "", tmp_path / "endless.png")


def test_bad_loads_are_not_taken_for_too_many_points():
    with pytest.raises(ValueError, match=r"must lie in \[1e-06, 1000\]"):
        study.convergence([PROFILE], [1e-9, 1.0], 2)


class OnePlace(RandomPhases):
    """Crests of all waves at one place: `seed` nodes in a period, half of a node from the first."""

    def first(self, m):
        """Phases of m waves."""
        return -math.pi / self.seed * 5.0 ** np.arange(m)


def test_bounds_hold_for_crests_between_two_nodes():
    """The infinite series with all its crests at that place touches at h = 0, and no bound lies below."""
    kept = Profile(1.25, 5, 2)
    points = bem.error_model.fewest_points(kept, BOUND_SHARE * kept.tail_amplitude, "compliance")
    lower, upper = hybrid.bounds(Profile(1.25, 5, math.inf, OnePlace(points)), [1e-9, 1.0], 2)
    truth = patches.curve(Profile(1.25, 5, 4, OnePlace(points)), np.array([1e-9, 1.0])).compliance
    assert np.all(lower <= truth)
    assert lower[0] == 0
    assert np.all(upper > truth)


def test_resistance_is_the_slope_of_the_estimate():
    """To the step, since nodes come into contact on the way."""
    step = 1e-4
    loads = np.array([0.1 * (1 - step), 0.1, 0.1 * (1 + step)])
    found = hybrid.curve(PROFILE, loads, 2)
    slope = (found.compliance[2] - found.compliance[0]) / (loads[2] - loads[0])
    assert found.resistance[1] == pytest.approx(slope, rel=step)
    assert np.all(np.diff(found.resistance) < 0)


def test_what_is_not_infinite_or_too_long_is_refused():
    with pytest.raises(ValueError, match="m must be inf, got 3"):
        hybrid.curve(Profile(1.5, 5, 3), LOADS, 1)
    with pytest.raises(ValueError, match="m must be inf, got 3"):
        hybrid.bounds(Profile(1.5, 5, 3), LOADS, 1)
    with pytest.raises(ValueError, match="terms must be fewer, got 7"):
        hybrid.curve(Profile(1.5, 5, math.inf), LOADS, 7)


@pytest.mark.parametrize("load", [1e-300, 0.9e-6, 1.1e3, 1e300])
def test_loads_that_the_equations_do_not_carry_are_refused(load):
    with pytest.raises(ValueError, match=r"must lie in \[1e-06, 1000\] p_0\*.*got .*: take method layer"):
        hybrid.curve(PROFILE, [load], 1)


def test_the_heaviest_load_is_full_contact_and_the_lightest_close_to_first():
    """Within the error of the mesh, 9e-4 of a wave, twice as much where a node is all of the contact."""
    profile = Profile(1.25, 5, math.inf)
    found, exact = hybrid.curve(profile, list(CARRIED), 1), layer.curve(CARRIED, 1.25, 5, math.inf)
    assert found.compliance == pytest.approx(exact.compliance, abs=2e-3)
    assert found.compliance[1] == pytest.approx(profile.total_amplitude, abs=1e-5)
    assert np.all(found.resistance >= 0)


def test_the_figure(convergence, tmp_path):
    figures.draw("endless", [convergence.expand_dims("case")], "", tmp_path / "endless.png")
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".pdf", ".svg"}
    with pytest.raises(ValueError, match="resolve more terms"):
        figures.draw("endless", [convergence.isel(solution_method=[0]).expand_dims("case")], "", tmp_path / "one.png")
