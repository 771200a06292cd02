"""Bounds on the infinite series: where a batch has them, and that they hold."""

import math

import numpy as np

from tests.scenes import scene_in
from weier import Profile
from weier.api import batch
from weier.methods import patches
from weier.pipeline.gather import read_study

BETWEEN_NODES = """
title: crests of all waves at one place, half a node off the grid
loads: [1.0e-9, 1.0e-6]
methods: [bem]
settings: {bem: {staircase: kept}}
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2, phases: [[%r, %r]]}}
"""


def test_bounds_stand_around_the_exact_methods_only(solutions):
    waves = read_study(solutions, "waves")
    solved = waves.sel(solution_method="bem").isel(case=[0, 1])
    # At most: 64 nodes a wave miss 5 g_n (waves_n/points)^2 of each, and the residual is 1e-10.
    mesh = np.pi**2 / 2 * solved.total_amplitude / 64**2 + 1e-9
    assert np.all(solved.compliance_lower <= solved.compliance)
    assert np.all(solved.compliance - mesh <= solved.compliance_lower)
    full = solved.total_amplitude + solved.tail_amplitude
    widest = np.minimum(solved.compliance + 2 * solved.tail_amplitude + mesh, full)
    assert np.all((solved.compliance_upper <= widest) & (solved.compliance_upper >= solved.compliance))
    one, two = solved.isel(case=0), solved.isel(case=1)  # both hold the same infinite series
    assert np.all((one.compliance_lower < two.compliance_upper) & (two.compliance_lower < one.compliance_upper))
    assert np.all((solved.resistance_lower <= solved.resistance) & (solved.resistance <= solved.resistance_upper))
    assert waves.sel(solution_method="demelio").compliance_lower.isnull().all()


def test_bounds_hold_for_crests_between_two_nodes(tmp_path):
    """The infinite series with all its crests at that place touches at h = 0."""
    phase = -math.pi / 320
    loaded = scene_in(tmp_path, BETWEEN_NODES % (phase, 5 * phase))
    data = batch.solve_batch(loaded.studies["one"], loaded.loads)
    bounded = data.squeeze()
    assert bounded["points"] == 320
    long = Profile(1.25, 5, 4, [phase * 5**n for n in range(4)])
    exact = patches.curve(long, loaded.loads).compliance  # more terms raise it, by what they have at most
    assert exact[0] < 1e-7
    assert bounded["compliance"][0] > 4e-4
    assert np.all(bounded["compliance_lower"] <= exact)
    assert np.all(bounded["compliance_lower"] >= 0)
