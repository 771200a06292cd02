"""The crests that heights are evaluated from."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches.surface import nearest_crests, surface_of


@pytest.mark.parametrize("phases", [(0.0, 0.0, 0.0), (1e-17, 0.0, 0.0), (-1e-17, 0.0, 0.0), (0.0, 1.0, 2.0)])
def test_the_nearest_crest(phases):
    """On the periodic line, with a crest at its seam or beside it, against a look at all of them."""
    heights = surface_of(Profile(1.5, 5, 3, phases)).heights
    x = np.concatenate([np.linspace(-1.2, 1.2, 97), [-1e-18, 1e-18, 1 - 1e-16]])
    apart = x[:, None] - heights.crest_position - np.rint(x[:, None] - heights.crest_position)
    crest, y = nearest_crests(heights, x)
    np.testing.assert_array_equal(np.abs(y), np.abs(apart).min(axis=1))
    np.testing.assert_array_equal(y, np.take_along_axis(apart, crest[:, None], 1)[:, 0])
