"""What terms resolved on the layer offer to plans."""

import math

import numpy as np

from weier import Profile, plan, random_phases
from weier.methods import hybrid
from weier.methods.planned import solver as planned


def test_many_heavy_loads_leave_the_finer_terms_to_the_layer():
    profile = Profile(1.7, 2, math.inf, random_phases(7))
    parts = plan(profile, np.geomspace(1, 30, 60), 0.3).parts
    some = tuple(part.at(slice(None, None, 8)) for part in parts if part.method == "hybrid")
    resolved = [part.terms for part in some]
    assert resolved == sorted(resolved, reverse=True)
    assert resolved[-1] == 1
    curve = planned.run(profile, some)
    loads = np.concatenate([part.mean_pressure for part in some])
    assert np.all(np.abs(curve.compliance - hybrid.curve(profile, loads, 8).compliance) <= curve.compliance_error)
    assert np.all(curve.compliance_error <= 0.3)
