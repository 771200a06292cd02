"""Heights that are evaluated from crests."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches.surface import evaluate_series, nearest_crest, surface_of


def test_heights_near_a_crest_keep_their_digits():
    profile = Profile(1.5, 5, 3, (0.0, 1.0, 2.0))
    heights = surface_of(profile).heights
    highest = int(np.argmax(heights.crest_offset))
    curvature = -evaluate_series(heights, highest, 0.0)[2]
    for y in (1e-9, 1e-6):
        value, slope, _ = evaluate_series(heights, highest, y)
        # The cubic term, at most y k of the quadratic one.
        assert value == pytest.approx(-0.5 * curvature * y**2, rel=300 * y)
        assert slope == pytest.approx(-curvature * y, rel=300 * y)
    y = 0.173
    value, slope, second = evaluate_series(heights, highest, y)
    x = heights.crest_position[highest] + y
    assert value + heights.maximum == pytest.approx(float(profile.height(x)))
    assert slope == pytest.approx(float(profile.slope(x)))
    assert second == pytest.approx(float(profile.curvature(x)))


@pytest.mark.parametrize("phases", [(0.0, 0.0, 0.0), (1e-17, 0.0, 0.0), (-1e-17, 0.0, 0.0), (0.0, 1.0, 2.0)])
def test_the_nearest_crest(phases):
    """On the periodic line, with a crest at its seam or beside it, against a look at all of them."""
    heights = surface_of(Profile(1.5, 5, 3, phases)).heights
    for x in np.concatenate([np.linspace(-1.2, 1.2, 97), [-1e-18, 1e-18, 1 - 1e-16]]):
        apart = x - heights.crest_position - np.rint(x - heights.crest_position)
        crest, y = nearest_crest(heights, x)
        assert abs(y) == np.abs(apart).min()
        assert y == apart[crest]
