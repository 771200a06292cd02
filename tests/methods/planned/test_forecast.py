"""Contacts, as plans foresee them."""

import numpy as np

from weier import Profile, random_phases
from weier.methods import patches
from weier.methods.planned.forecast import contacts

LOADS = np.geomspace(1e-3, 10, 12)


def test_contacts_are_foreseen_to_a_factor_in_nine_of_ten():
    ratio = []
    for seed in range(4):
        profile = Profile(1.5, 3, 4, random_phases(seed))
        exact = patches.curve(profile, LOADS)
        here = exact.patch_count > 0
        ratio += (contacts(profile, LOADS)[here] / exact.patch_count[here]).tolist()
    assert np.quantile(ratio, 0.05) > 1 / 4
    assert np.quantile(ratio, 0.95) < 4
