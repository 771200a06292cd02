"""The times on which the limit of direct solutions is based are those of the same solutions."""

import numpy as np
import pytest

from benchmarks import direct_solution
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS


@pytest.mark.parametrize("kind", [CONTACTS, GAPS])
def test_both_solutions_are_the_same(kind):
    segments = direct_solution.random_segments(12)
    (direct, first), (iterative, second) = (direct_solution.solve(segments, kind, way) for way in (True, False))
    np.testing.assert_allclose(direct.force, iterative.force, rtol=1e-8)
    assert first.plane == pytest.approx(second.plane, rel=1e-10)
    assert direct.even is not None
    assert iterative.steps > 3
