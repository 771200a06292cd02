"""Expected seconds against work that is counted, not timed."""

import numpy as np
import pytest

from weier import Profile
from weier.accuracy.runner import by_default, run
from weier.methods import bem


def test_seconds_of_boundary_elements_grow_as_their_counted_work():
    """From 320 to 8000 nodes: pairs of FFTs times nodes."""
    loads, work, seconds = np.geomspace(0.01, 1, 5), [], []
    for m in (2, 4):
        profile = Profile(1.25, 5, m, seed=0)
        found = run(by_default("bem"), profile, loads).others
        work.append(found["work"].sum() * found["points"])
        seconds.append(bem.METHOD.seconds(profile, loads))
    assert seconds[1] / seconds[0] == pytest.approx(work[1] / work[0], rel=0.5)
