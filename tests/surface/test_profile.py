"""The series: its numbers against mpmath, its crest by brute force, its phases, its refusals."""

import json
import math
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest

from weier.surface.profile import Profile, random_phases, terms_within
from weier.surface.series import leading_amplitude, tail_amplitude
from weier.surface.waves import check_resolvable

EPS = np.finfo(float).eps
EXAMPLES = [
    Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0)),
    Profile(1.7, "5/2", 5, random_phases(3)),
    Profile(1.5, Fraction(3, 2), 3, 2.0),
]


@pytest.mark.parametrize("phases", [(0, 5, 180), (0, 90, 1), (1, -360, 0), 7.0, (7200, 0, 7200)])
def test_phases_in_degrees_are_doubted(phases):
    with pytest.warns(UserWarning, match="exceed 2 pi, got .*: phases are in radians"):
        Profile(1.25, 5, 3, phases)


@pytest.mark.parametrize(
    "phases", [(0, 7, 1), (0, 0.5 - 20 * np.pi, 1), (0, 2 * np.pi, -2 * np.pi), np.radians([0, 360, 180])]
)
def test_phases_of_several_turns_are_not(phases):
    Profile(1.25, 5, 3, phases)  # a warning is an error


def test_phases_that_look_like_degrees_are_doubted_once():
    with pytest.warns(UserWarning, match="in radians") as doubted:
        profile = Profile(1.25, 5, 3, (0, 90, 180))
    assert doubted[0].filename == __file__
    assert profile.truncated(2).phases == (0.0, 90.0)  # without a warning, which would be an error here


def series(profile, x, derivative=0):
    """The value of (1), or of its derivative, in 50 digits at a rational x."""
    with mp.workdps(50):
        gamma = mp.mpf(profile.gamma.numerator) / profile.gamma.denominator
        k = [2 * mp.pi * gamma**n for n in range(profile.terms)]
        at = mp.mpf(Fraction(x).numerator) / Fraction(x).denominator
        return mp.fsum(
            gamma ** ((mp.mpf(profile.D) - 2) * n)
            * k[n] ** derivative
            * mp.cos(k[n] * at + mp.mpf(float(profile.phase[n])) + derivative * mp.pi / 2)
            for n in range(profile.terms)
        )


def test_profile_and_functions_agree_on_the_sums():
    profile, infinite = EXAMPLES[0], Profile(1.25, 5, np.inf)
    assert profile.total_amplitude == pytest.approx(leading_amplitude(4, 1.25, 5), rel=2 * EPS)
    assert profile.tail_amplitude == tail_amplitude(4, 1.25, 5)
    assert (infinite.total_amplitude, infinite.tail_amplitude) == (tail_amplitude(0, 1.25, 5), 0)
    # p_n* = 2 pi M g_n/lambda_n, in p_0* = 2 pi M g_0/lambda_0
    np.testing.assert_allclose(profile.full_contact_pressure, profile.amplitude * 5.0 ** np.arange(4), rtol=4 * EPS)


@pytest.mark.parametrize("profile", EXAMPLES)
def test_height_slope_and_curvature_against_mpmath(profile):
    x = np.linspace(-0.3, 1.7, 9) * profile.period
    top = 2 * np.pi * float(profile.gamma) ** (profile.terms - 1)
    for derivative, function in enumerate((profile.height, profile.slope, profile.curvature)):
        exact = [float(series(profile, float(value), derivative)) for value in x]
        # x itself is exact; top x cycles are rounded before the cosine: EPS top |x|, times the wavenumbers drawn down
        scale = np.sum(profile.amplitude * (top * 1.0) ** derivative)
        np.testing.assert_allclose(function(x), exact, atol=2 * EPS * scale * (1 + top * np.max(np.abs(x))), rtol=0)


def test_what_is_done_to_its_waves_does_not_reach_a_profile():
    profile = Profile(1.5, 5, 3, 1.0)
    before, load = profile.height(0.1), profile.full_contact_pressure.tolist()
    profile.amplitude[0] = profile.phase[1] = profile.full_contact_pressure[2] = 9
    profile.waves_per_period.append(7)
    assert (profile.height(0.1), profile.full_contact_pressure.tolist()) == (before, load)
    assert profile.waves_per_period == [1, 5, 25]


@pytest.mark.parametrize("profile", [*EXAMPLES, Profile(1.9, 1000, 5, 1.0)])
@pytest.mark.parametrize("points", [7, 64, 1000])
def test_sampled_height_against_mpmath(profile, points):
    """Nothing is lost to fine waves either: the last profile has 1e12 in a period."""
    z = profile.sampled_height(points)
    assert z.shape == (points,)
    for j in (0, 1, points // 3, points - 1):
        exact = float(series(profile, Fraction(j * profile.period, points)))
        assert z[j] == pytest.approx(exact, abs=16 * EPS * profile.total_amplitude)


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.25, 5, 3), (1.5, "5/2", 4), (1.9, 2, 6), (1.5, 3, 1)])
def test_root_mean_squares_are_those_of_samples(D, gamma, m):
    """Equidistant samples, more than two of the finest wave, give the mean of a square exactly."""
    profile = Profile(D, gamma, m, phases=1.0)
    x = np.linspace(0, profile.period, 5 * profile.waves_per_period[-1], endpoint=False)
    sampled = [np.sqrt(np.mean(of(x) ** 2)) for of in (profile.height, profile.slope, profile.curvature)]
    assert profile.rms == pytest.approx(sampled, rel=1e-12)
    assert super(Profile, profile).rms == pytest.approx(sampled, rel=1e-12)  # by sums over the waves


def test_the_infinite_series_has_a_height_and_neither_slope_nor_curvature():
    """Its squared amplitudes are a geometric series."""
    assert Profile(1.5, 3, math.inf).rms == (pytest.approx(math.sqrt(0.75), rel=1e-14), math.inf, math.inf)
    assert Profile(1.5, 3, 10**6).rms[1:] == (math.inf, math.inf)  # beyond floats


def test_period_is_the_denominator_to_the_power_of_the_terms():
    assert Profile(1.5, 5, 4).period == 1
    profile = Profile(1.5, "5/2", 4, 0.3)
    assert profile.period == 8
    assert profile.waves_per_period == [8, 20, 50, 125]
    x = np.linspace(0, 8, 50)
    np.testing.assert_allclose(profile.height(x + 8), profile.height(x), atol=1e-13)
    for shorter in (1, 2, 4):
        assert np.max(np.abs(profile.height(x + shorter) - profile.height(x))) > 0.1


def test_ratio_may_be_written_in_many_ways():
    for gamma in ("5/2", 2.5, Fraction(5, 2), "2.5"):
        assert Profile(1.5, gamma, 2).gamma == Fraction(5, 2)
    assert Profile(1.5, 1.1, 2).gamma == Fraction(11, 10)
    assert Profile(1.5, 1000001 / 10**6, 2).gamma == Fraction(1000001, 10**6)
    assert Profile(1.5, 1500003 / 1000003, 2).gamma == Fraction(1500003 / 1000003)  # as it is: too large integers


@pytest.mark.parametrize("kind", np.typecodes["AllInteger"] + np.typecodes["Float"])
def test_numbers_of_numpy_become_pythons_own(kind):
    """Those of NumPy overflow in the powers of a series, or round them to three digits."""
    of = np.dtype(kind).type
    number = of if kind in np.typecodes["Float"] else float
    profile = Profile(number(1.25), of(10), of(30), number(0.5))
    assert profile == Profile(1.25, 10, 30, 0.5)
    assert profile.waves_per_period == [10**n for n in range(30)]
    kinds = [type(value) for value in (profile.D, profile.gamma.numerator, profile.gamma.denominator, profile.m)]
    assert kinds == [float, int, int, int]
    assert Profile(1.25, 5, 3, [of(0), of(1), of(2)]) == Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
    assert Profile(1.25, 5, 3, of(2)) == Profile(1.25, 5, 3, 2.0)
    if number is of:
        assert Profile(1.25, of(2.5), of(np.inf)) == Profile(1.25, "5/2", math.inf)
    else:
        assert Profile(1.25, Fraction(of(5), of(3)), 12).waves_per_period[-1] == 5**11
        assert Profile(1.25, 5, 3, seed=of(7)) == Profile(1.25, 5, 3, random_phases(7))


def test_one_phase_shifts_every_term_but_the_first():
    np.testing.assert_array_equal(Profile(1.5, 5, 3, 0.7).phase, [0, 0.7, 0.7])
    np.testing.assert_array_equal(Profile(1.5, 5, 2, [0.7, 0.1]).phase, [0.7, 0.1])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2.0, 5, 3), r"D must lie in \(1, 2\), got 2.0"),
        ((1.5, 1, 3), "gamma must exceed 1, .* got 1"),
        ((1.5, "5/0", 3), "gamma must be a finite number or a fraction .*, got '5/0'"),
        ((1.5, 10**400, 3), "gamma must be a finite number or a fraction .*, got 10+[.][.][.]0+"),
        ((1.5, 5, 0), "m must be a whole number of terms, .* got 0"),
        ((1.5, 5, np.True_), "m must be a whole number of terms, .* got True"),
        ((1.5, 5, 3, (0.0, 1.0)), "one for each of the m = 3 terms, got 2"),
        ((1.5, 5, 2, (0.0, np.nan)), "phases must be finite numbers in radians"),
    ],
)
def test_profile_refuses_what_it_cannot_be(arguments, message):
    with pytest.raises(ValueError, match=message):
        Profile(*arguments)


def test_labels_list_a_thousand_random_phases_at_most():
    assert [json.loads(Profile(1.5, 2, m, seed=1).labels["phases"]) is None for m in (1000, 1001)] == [False, True]


def test_terms_whose_waves_fit():
    assert [terms_within(Profile(1.5, 5, m), waves) for m, waves in ((math.inf, 624), (math.inf, 625), (3, 1e9))] == [
        4,
        5,
        3,
    ]


def test_an_irrational_ratio_is_kept_to_the_last_digit():
    profile = Profile(1.5, math.sqrt(2), 3)
    assert float(profile.gamma) == math.sqrt(2)
    assert profile.describe() == "D = 1.5, gamma = 1.4142135623730951, m = 3"
    assert profile.height(0.25) == pytest.approx(
        sum(math.sqrt(2) ** (-0.5 * n) * math.cos(math.pi / 2 * math.sqrt(2) ** n) for n in range(3)), abs=1e-14
    )


def test_a_wave_too_short_for_a_float_has_no_heights():
    profile = Profile(1.5, 10**6, 100)
    for evaluate in (profile.height, profile.slope, profile.curvature):
        with pytest.raises(ValueError, match=r"the finest wave of D = 1.5, .* is too short for a float: take fewer"):
            evaluate(0.1)


@pytest.mark.parametrize("name", ["amplitude", "period", "crest"])
def test_the_infinite_series_has_sums_but_no_heights(name):
    with pytest.raises(ValueError, match="m = inf has no last term"):
        getattr(Profile(1.5, 5, np.inf), name)


@pytest.mark.parametrize("seed", [0, 7, 2**53 - 1])
def test_random_phases_of_a_longer_series_extend_the_shorter(seed):
    shorter, longer = (Profile(1.5, 5, terms, random_phases(seed)).phase for terms in (3, 50))
    np.testing.assert_array_equal(longer[:3], shorter)
    assert np.all((longer >= 0) & (longer < 2 * np.pi))


@pytest.mark.parametrize(
    ("seeds", "says"),
    [
        ((2**53, 2**53 + 1, 2**64, 10**400, np.uint64(2**63)), r"at most 2\^53 - 1 = 9007199254740991, got"),
        ((-1, 1.5, True, "1", np.timedelta64(1)), "a non-negative integer, got"),
    ],
)
def test_what_is_no_seed_or_a_larger_one_than_floats_hold_is_refused(seeds, says):
    """Data hold seeds as floats: 2^53 + 1 would be rebuilt as another surface."""
    for seed in seeds:
        with pytest.raises(ValueError, match=f"seed must be {says}"):
            Profile(1.5, 5, 3, seed=seed)
    assert random_phases(np.uint64(2**53 - 1)).seed == 2**53 - 1


def test_the_most_waves_are_taken_and_one_more_refused():
    """5^7 = 78 125 waves, 10^5, and 46^3 = 97 336, beside 47^3."""
    for gamma, m in ((5, 8), (10, 6), (46, 4)):
        check_resolvable(Profile(1.5, gamma, m))
    for gamma, m in ((47, 4), (2**0.5, 3), (1.0000001, 3)):
        with pytest.raises(ValueError, match="at most 100000 times into the period"):
            check_resolvable(Profile(1.5, gamma, m))


@pytest.mark.parametrize(
    "profile", [Profile(1.1, math.pi, 2, 1 / 3), Profile(1.5, "5/2", math.inf), Profile(1.5, 5, 3, seed=7)]
)
def test_the_repr_of_a_profile_makes_it(profile):
    assert eval(repr(profile), {"Profile": Profile}) == profile
