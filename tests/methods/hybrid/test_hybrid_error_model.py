"""The error that is expected of resolved terms on a layer, against first contact, where the truth is a maximum."""

import numpy as np

from weier import Profile
from weier.methods.hybrid import error_model

SERIES = 120
TERMS = 10  # of gamma = 2; at D = 1.1 what follows has 2 % of the height of the tail
SAMPLES = 8  # a wave of the finest term
LIGHT_LOAD = np.array([1e-9])  # p_0*: the plane stands at the highest crest


def _random_phases(random: np.random.Generator) -> tuple[float, ...]:
    """Phases of TERMS waves: any, or 0 and pi, where the largest errors are."""
    some = random.uniform(0, 2 * np.pi, TERMS), np.pi * random.integers(0, 2, TERMS)
    return tuple(some[random.integers(2)].tolist())


def test_error_at_light_loads_holds_for_random_phases():
    """A layer does not know where the crests of its waves are: they may all be troughs where the coarse ones peak."""
    random = np.random.default_rng(3)
    ratios = []
    for _ in range(SERIES):
        D, resolved = random.uniform(1.02, 1.3), int(random.integers(1, 4))
        series = Profile(D, 2, TERMS, _random_phases(random))
        kept = Profile(D, 2, resolved, series.phases[:resolved])
        grid = SAMPLES * series.waves_per_period[-1]
        lower = kept.sampled_height(grid).max() - series.sampled_height(grid).max()
        error = abs(lower + series.total_amplitude - kept.total_amplitude)
        ratios.append(error / error_model.compliance_error(LIGHT_LOAD, kept)[0])
    assert max(ratios) <= 1
    assert max(ratios) > 0.7  # and is not far too wide
