"""What single precision would gain and lose for boundary elements: `python -m weier.accuracy.single_precision`."""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from weier import Profile
from weier.methods.bem.active_set import NestedSolver
from weier.theory.halfplane import eigenvalues

# The profile of the other benchmarks, and the sizes and loads of the two measurements.
PROFILE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
POINTS = [2**power for power in range(9, 18)]
POINTS_PER_WAVE = (64, 512, 4096)
LOADS = (1e-3, 0.1, 1.0)
# The repetitions of a run have so many nodes together, so that its time is well above the resolution of the clock.
MIN_TIMED_NODES = 2**22


def main() -> None:
    """Print the time of a pair of FFTs in both precisions, and the residual that it finds of an exact solution."""
    for points in POINTS:
        double, single = (_pair_seconds(points, dtype) for dtype in (np.float64, np.float32))
        print(f"{points} nodes: {1e6 * double:.0f} us, {1e6 * single:.0f} us, {double / single:.2f} times as fast")
    for points_per_wave in POINTS_PER_WAVE:
        points = points_per_wave * PROFILE.waves_per_period[-1]
        residuals = ", ".join(f"{residual:.0e} g_0 at {load:g} p_0*" for load, residual in _residuals(points))
        print(f"{points} nodes: an exact solution has the residual {residuals}")


def _pair_seconds(points: int, dtype: Any) -> float:
    x, influence = np.random.default_rng(0).normal(size=points).astype(dtype), eigenvalues(points, 1).astype(dtype)
    least, repeat = np.inf, max(20, MIN_TIMED_NODES // points)
    for _ in range(5):
        start = process_time()
        for _ in range(repeat):
            _product(influence, x)
        least = min(least, (process_time() - start) / repeat)
    return least


def _product(influence: NDArray[Any], x: NDArray[Any]) -> NDArray[Any]:
    return np.asarray(scipy.fft.irfft(scipy.fft.rfft(x) * influence, x.size))


def _residuals(points: int) -> list[tuple[float, float]]:
    """Each load, with half the range of z - A p in contact: a solution to 1e-10 g_0, examined in single precision."""
    grids = NestedSolver(PROFILE, points, 1e-10)
    influence, z = eigenvalues(points, 1).astype(np.float32), PROFILE.sampled_height(points).astype(np.float32)
    residuals = []
    for load in LOADS:
        grids.solve(load)
        deformed = z - _product(influence, grids.state.pressure.astype(np.float32))
        residuals.append((load, float(np.ptp(deformed[grids.state.contact]) / 2)))
    return residuals


if __name__ == "__main__":
    main()
