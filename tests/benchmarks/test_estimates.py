"""Errors of estimates on ensembles: those of one wave are known, and the reference of itself is exact."""

import numpy as np
import pytest

from benchmarks import estimates
from weier import Profile
from weier.methods import archard, patches
from weier.surface.series import leading_amplitude


def test_estimates_of_one_wave_are_westergaards_solution():
    found = {errors.method: errors for errors in estimates.measure(1, [(1.25, 5, 1)])}
    for method in ("archard", "demelio"):
        assert found[method].median[:2].max() < 1e-9
        assert np.isnan(found[method].median[2])
    assert found["persson"].median[2] > 0.01


def test_errors_are_those_of_single_loads():
    series = 1.25, 3, 2
    (errors, *_) = estimates.measure(2, [series])
    partial, off = [], []
    for seed in range(2):
        solved = patches.METHOD.solve(Profile(*series, seed=seed), estimates.LOADS)
        partial.append(solved.resistance > estimates.MIN_RESISTANCE)
        off.append(np.abs(archard.compliance(estimates.LOADS, *series) - solved.compliance))
    within = np.concatenate([own[there] for own, there in zip(off, partial, strict=True)])
    assert errors.method == "archard"
    assert errors.median[0] == pytest.approx(np.median(within))
    assert within.max() < leading_amplitude(2, 1.25, 3)


def test_the_stiffness_of_one_wave_has_a_logarithmic_exponent():
    """1/R = -1/ln p (13): its exponent between two loads is ln(ln p_1/ln p_2)/ln(p_2/p_1)."""
    found = estimates.exponents(1, (1.25, 5, 1))
    for (low, high), exponent in found.items():
        assert exponent == pytest.approx(np.log(np.log(low) / np.log(high)) / np.log(high / low), rel=1e-6)
