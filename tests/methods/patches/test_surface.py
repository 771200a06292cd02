"""The crests that heights are evaluated from."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches.surface import nearest_crest, surface_of


@pytest.mark.parametrize("phases", [(0.0, 0.0, 0.0), (1e-17, 0.0, 0.0), (-1e-17, 0.0, 0.0), (0.0, 1.0, 2.0)])
def test_the_nearest_crest(phases):
    """On the periodic line, with a crest at its seam or beside it, against a look at all of them."""
    heights = surface_of(Profile(1.5, 5, 3, phases)).heights
    for x in np.concatenate([np.linspace(-1.2, 1.2, 97), [-1e-18, 1e-18, 1 - 1e-16]]):
        apart = x - heights.crest_position - np.rint(x - heights.crest_position)
        crest, y = nearest_crest(heights, x)
        assert abs(y) == np.abs(apart).min()
        assert y == apart[crest]
