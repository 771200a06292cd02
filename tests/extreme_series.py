"""Series and loads at the ends of every range, and how close doubles can come to their sums in mpmath."""

import mpmath as mp
import numpy as np

EPS = np.finfo(float).eps
TINY = np.finfo(float).tiny
ACCURACY = 1e-12


def input_sensitivity(oracle, part, p, D, gamma, m):
    """What half a unit in the last place of each input, and of the result, changes in the result, relative to it."""
    exact, total = oracle(p, D, gamma, m)[part], mp.mpf(EPS)
    with mp.workdps(60):
        step = mp.mpf(10) ** -25
        for i in range(3):
            nudged = [mp.mpf(p), mp.mpf(D), mp.mpf(gamma)]
            nudged[i] *= 1 + step
            total += EPS / 2 * abs(oracle(*nudged, m)[part] / exact - 1) / step
    return float(total)


def assert_accurate(computed, exact, oracle, part, case):
    if exact < TINY:
        assert 0 <= computed <= TINY  # doubles have no digits left
        return
    error = float(abs(mp.mpf(float(computed)) / exact - 1))
    if error > ACCURACY:
        # No double can do better than the rounding of its inputs: R near full contact is the logarithm of
        # nearly 1, and its slope with p, D and gamma is then what bounds the error.
        assert error <= input_sensitivity(oracle, part, *case), case


def assert_sums(method, oracle, cases):
    """Compliance and resistance of all cases together, against the sums of each."""
    h, R = method.compliance(*np.transpose(cases)), method.resistance(*np.transpose(cases))
    for case, *computed in zip(cases, h, R, strict=True):
        for part, exact in enumerate(oracle(*case)):
            assert_accurate(computed[part], exact, oracle, part, case)


def extreme_cases(seed, count, terms):
    """Draws that crowd at the ends of every range: D -> 1, 2; gamma -> 1, 1e6; p from 1e-300 to 1e300."""
    rng = np.random.default_rng(seed)
    near = 10 ** rng.uniform(-9, 0, count)
    D = np.choose(rng.integers(0, 3, count), [1 + near, 2 - near, rng.uniform(1, 2, count)])
    D = np.clip(D, 1 + 1e-9, 2 - 1e-9)
    gamma = np.where(rng.integers(0, 2, count), 10 ** rng.uniform(0, 6, count), 1 + 10 ** rng.uniform(-6, 0, count))
    reach = np.choose(rng.integers(0, 3, count), [300.0, 3.0, 0.01])
    p = 10 ** (reach * rng.uniform(-1, 1, count))
    return list(zip(p, D, gamma, rng.choice(terms, count), strict=True))


CORNERS = [
    (p, D, gamma, m)
    for p in (1e-300, 1e-9, 0.5, 1.0, 1 + EPS, 2.0, 1e300)
    for D in (1 + 1e-9, 1.5, 2 - 1e-9)
    for gamma in (1 + 1e-6, 2.0, 4.0, 1e6)  # D = 1.5, gamma = 4: the fixed point lies at zeta = 1
    for m in (1, 7, 1000, np.inf)
    if m != 1000 or D == 1.5
]
