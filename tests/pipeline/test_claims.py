"""Claims on hand-made curves of which it is known what they say: yes, no, neither, or nothing to measure."""

from dataclasses import replace

import numpy as np
import pytest

from tests.scenes import read
from weier.data.variables import Check
from weier.methods import westergaard
from weier.pipeline import claims
from weier.pipeline.claims import claim, measures, paper, verdicts
from weier.pipeline.gather import read_study
from weier.pipeline.needed_curves import Curves

LOADS = np.geomspace(1e-3, 4, 40)
TOTAL = 1.4
# Concave, from 0 at no load to 1.4 at p = 2, where the contact is full.
NUMERICAL = TOTAL * (1 - np.maximum(1 - LOADS / 2, 0) ** 3)
RESISTANCE = TOTAL * 1.5 * np.maximum(1 - LOADS / 2, 0) ** 2
RELATIVE = NUMERICAL / TOTAL


def case(D=1.25, gamma=5, m=3, phase=1.0, loads=LOADS, **methods):
    """One case with a curve of compliance, or of several variables, for each method."""
    fraction = np.minimum(loads / 2, 1)
    resistance = TOTAL * 1.5 * (1 - fraction) ** 2
    usual = {"contact_fraction": fraction, "resistance": resistance, "points": 12.0}
    usual |= {"compliance_error": np.full(loads.size, 1e-3), "resistance_error": 0.01 * resistance}
    rows = [usual | (curve if isinstance(curve, dict) else {"compliance": curve}) for curve in methods.values()]
    total, tail = (TOTAL, 0.04) if m > 1 else (1.0, 0.44)
    made = {"key": f"{D}{gamma:g}{m}{phase:.2f}", "D": D, "gamma": gamma, "m": m, "mean_pressure": loads}
    made |= {"phases": np.array([0.0, *[phase] * (m - 1)]), "first_contact": 0.0}
    made |= {"total_amplitude": total, "tail_amplitude": tail, "solution_method": np.array([*methods])}
    return made | {
        name: np.array([np.broadcast_to(row[name], np.shape(usual.get(name, loads))) for row in rows])
        for name in rows[0]
    }


def judged(name, cases):
    """The judgement of a claim on some cases, and on the same at every second load."""
    size = cases[0]["mean_pressure"].size
    fewer = [
        {
            key: value[..., 1 - size % 2 :: 2] if np.shape(value)[-1:] == (size,) else value
            for key, value in one.items()
        }
        for one in cases
    ]
    return claim.judge(claims.CLAIMS[name], cases, fewer)


def ensemble(*excesses, count=6, **others):
    """Profiles of different phases, whose estimates are off by each of the excesses in turn."""

    def member(i):
        curves = dict.fromkeys(("archard", "demelio", "layer"), NUMERICAL + excesses[i % len(excesses)])
        return case(**{"phase": 0.1 * i, **curves, "patches": NUMERICAL, **others})

    return [member(i) for i in range(count)]


YES, NO, OPEN = Check.yes, Check.no, Check.not_decided
CLAIMS = claims.CLAIMS


def elements(error):
    """Twelve elements of one wave: those of several in contact are off by this error, a single one by half."""
    exact = westergaard.compliance(LOADS)
    fraction = np.where(LOADS < 0.02, 1, 3) / 12
    bem = {"compliance": exact * np.where(LOADS < 0.02, 0.5, 1 + error), "contact_fraction": fraction}
    return [case(m=1, bem=bem, westergaard=exact)]


def phases(gamma, spread, between=0.0):
    """Curves that differ at light loads: phases 0 and pi by `spread`, and pi/2 from their middle by `between`."""
    light = np.maximum(1 - LOADS, 0) * TOTAL
    shifts = {0.0: -spread / 2, np.pi / 2: between, np.pi: spread / 2}
    return [case(gamma=gamma, m=2, phase=phi, bem=NUMERICAL + shift * light) for phi, shift in shifts.items()]


def coarse_and_fine(coarse, fine):
    return [*phases(2, *coarse), *phases(5, fine)]


def smooth_and_rough(smooth, wilder, **methods):
    return [*ensemble(*smooth), *ensemble(*wilder, D=1.5, **methods)]


def ratios(archard, demelio, layer):
    """Resistances of the estimates over the numerical one."""
    given = {"archard": archard, "demelio": demelio, "layer": layer}
    curves = {m: {"compliance": NUMERICAL, "resistance": RESISTANCE * ratio} for m, ratio in given.items()}
    return [case(phase=0.1 * i, **curves, patches=NUMERICAL) for i in range(6)]


def dropping(*smooth):
    """Estimates beside resistances that drop by a third at another load for each profile."""
    cases, steps = ratios(*smooth), np.where(np.arange(LOADS.size) % 6 == np.arange(6)[:, None], 1.5, 1.0)
    for one, step in zip(cases, steps / steps.mean(axis=0), strict=True):
        one["resistance"][-1] *= step
    return cases


def bounded(*, h, R):
    """Bounds on both quantities, of these relative widths."""
    curve = {"compliance": NUMERICAL}
    for name, values, width in (("compliance", NUMERICAL, h), ("resistance", RESISTANCE, R)):
        curve |= {f"{name}_lower": values * (1 - width / 2), f"{name}_upper": values * (1 + width / 2)}
    return [case(phase=0.1 * i, bem=curve) for i in range(6)]


def discretised(resistance):
    """Boundary elements that are off by a tenth of full contact, and by a part of the resistance."""
    bem = {"compliance": NUMERICAL - 0.1 * TOTAL, "resistance": RESISTANCE * (1 + resistance)}
    return [case(phase=0.1 * i, bem=bem, patches=NUMERICAL) for i in range(6)]


def terms(*changes):
    """Series of m = 1, 2, ... of several phases, whose mean gap at light loads grows by the given changes."""
    gap = [(1 + sum(changes[:n])) * (1 - RELATIVE) for n in range(len(changes) + 1)]
    total = [1.0, *[TOTAL] * len(changes)]
    return [case(m=m + 1, phase=0.1 * i, bem=total[m] - d) for i in range(6) for m, d in enumerate(gap)]


def areas(*, fall=0.6, change=0.01, contacts=3):
    """Series of m = 1, 2, 3 whose area falls and whose contacts multiply, and whose last term changes R."""
    made = []
    for phase in 0.1 * np.arange(6):
        for m in (1, 2, 3):
            curve = {"compliance": NUMERICAL, "resistance": RESISTANCE * (1 + change * (m == 3))}
            curve["patch_count"] = np.full(LOADS.size, float(contacts ** (m - 1)))
            curve["contact_fraction"] = np.minimum(LOADS / 4, 0.99) * fall ** (m - 1)
            made.append(case(m=m, phase=phase, patches=curve))
    return made


TAIL = 5**-0.75 / (1 - 5**-0.75)  # G_1 for D = 1.25, gamma = 5


def near_wave(spread, resistance=1.0):
    """Estimates whose compliances differ by a fraction of the width of the bounds from the one-wave solution."""
    h = westergaard.compliance(LOADS)
    curve = {"compliance": h, "resistance": westergaard.resistance(LOADS) * resistance}
    other = curve | {"compliance": h + 2 * TAIL * spread * (LOADS < 1)}
    return [case(archard=curve, demelio=other, layer=curve), case(m=1, westergaard=h)]


LOW, HEAVY, EVERY_SECOND = RELATIVE <= 0.5, LOADS > 1, np.where(np.arange(LOADS.size) % 2, 1, -1)
HIGHEST = RELATIVE > 0.9
SUNK, TYPICAL = np.where(HEAVY, -0.05, 0.1), np.where(LOW, 0.03, -0.01)

# A claim, the studies that it looks at, and what comes of it.
SAID = [
    ("twelve_elements", lambda: elements(0.03), YES),
    ("twelve_elements", lambda: elements(0.11), OPEN),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.01), YES),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.1), NO),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.022), OPEN),  # little more than what we call extremely small
    ("phase_spread", lambda: coarse_and_fine((0.3, 0.2), 0.01), NO),
    ("phase_spread", lambda: coarse_and_fine((0.02,), 0.01), NO),
    ("archard_above", lambda: ensemble(0.1, 0.2), YES),
    ("archard_above", lambda: ensemble(*[0.1] * 5, SUNK), NO),  # it is said of all loads and profiles
    ("archard_above", lambda: ensemble(np.where(LOADS < 5e-3, -0.01, 0.1)), YES),  # as it must as p -> 0
    ("archard_above", lambda: ensemble(0.1 + 0.2 * EVERY_SECOND * HEAVY), OPEN),
    ("archard_above", lambda: ensemble(0.1, count=5), OPEN),  # few profiles confirm nothing, and one refutes
    ("demelio_below", lambda: ensemble(np.where(LOADS < 1, -0.1, 0.1)), YES),
    ("demelio_below", lambda: ensemble(np.where(LOADS < 1, 0.1, -0.1)), NO),
    ("demelio_below", lambda: ensemble(-1e-4), OPEN),  # within the numerical error
    ("layer_close", lambda: ensemble(TYPICAL), YES),
    ("layer_close", lambda: ensemble(*[TYPICAL] * 5, 0.03), YES),  # a tendency: five of six show it
    ("layer_close", lambda: ensemble(np.where(LOW, 0.1, -0.01)), NO),
    ("layer_close", lambda: ensemble(np.where(LOW, 0.03, 0.01)), NO),
    ("layer_close", lambda: ensemble(TYPICAL, np.where(LOW, 0.03, 0.01)), OPEN),  # it depends on the phase
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.15]), YES),
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.1005]), OPEN),  # 2.4 and 2.5 %
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.15], layer=NUMERICAL), NO),
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1, 0.3], [0.12, 0.32]), YES),  # at the same phases
    ("resistance_errors", lambda: ratios(0.8, 1.3, 1.1), YES),
    ("resistance_errors", lambda: ratios(1.2, 1.3, 1.1), NO),
    ("resistance_errors", lambda: ratios(np.where(HIGHEST, 0.0, 1.05), 1.3, 1.02), YES),  # high loads end at 99 %
    ("resistance_errors", lambda: ratios(0.8, np.where(HIGHEST, 0.5, 1.3), 1.1), NO),
    ("resistance_errors", lambda: ratios(0.8, 0.9, 1.05), NO),
    ("resistance_errors", lambda: ratios(0.95, 1.3, 1.1), NO),
    ("resistance_errors", lambda: ratios(0.7, 1.3, 1.25), NO),
    ("resistance_errors", lambda: ratios(0.8, 1.3, 0.9), NO),  # the layer's error is said to be an overestimate
    ("resistance_errors", lambda: ratios(0.8, 1.4, 1.1), OPEN),
    ("resistance_errors", lambda: dropping(0.8, 1.3, 1.1), YES),  # drops of single profiles do not decide
    ("resistance_falls", lambda: ratios(0.8, 1.3, 1.1), YES),
    ("resistance_falls", lambda: ratios(0.8, 1.3, 1.1 + 1.0 * (LOADS > 0.5)), NO),
    ("bounds_looser", lambda: bounded(h=0.1, R=0.3), YES),
    ("bounds_looser", lambda: bounded(h=0.3, R=0.1), NO),
    ("bounds_looser", lambda: bounded(h=0.1, R=0.11), OPEN),
    ("approximations_good", lambda: ratios(0.8, 1.25, 1.1), YES),
    ("approximations_good", lambda: ratios(0.8, 1.9, 1.1), NO),
    ("boundary_elements", lambda: discretised(0.3), YES),
    ("boundary_elements", lambda: discretised(0.05), NO),
    ("fourth_term", lambda: terms(0.3, 0.05, 0.02), YES),
    ("fourth_term", lambda: terms(0.3, 0.05, 0.2), NO),
    ("fourth_term", lambda: terms(0.01, 0.005, 0.02), NO),
    ("area_vanishes", areas, YES),
    ("area_vanishes", lambda: areas(fall=1.2), NO),
    ("area_vanishes", lambda: areas(fall=0.95), NO),  # it falls, but more slowly than gamma^(1-D) = 0.67
    ("area_vanishes", lambda: areas(change=0.1), NO),
    ("area_vanishes", lambda: areas(change=0.1 * EVERY_SECOND), NO),  # changes of either sign do not cancel
    ("independent_contacts", areas, YES),
    ("independent_contacts", lambda: areas(contacts=1), NO),
    ("independent_contacts", lambda: areas(fall=1e-4, contacts=2), NO),  # the logarithm outweighs their number
    ("one_wave_bounds", lambda: near_wave(0.9), YES),
    ("one_wave_bounds", lambda: near_wave(1.1), NO),
    ("one_wave_bounds", lambda: near_wave(0.9, resistance=5), NO),
    ("one_wave_bounds", lambda: near_wave(0.9, resistance=0), NO),
]


@pytest.mark.parametrize(("name", "cases", "expected"), SAID)
def test_what_is_said_of_a_claim(name, cases, expected):
    assert judged(name, cases()).outcome == expected


@pytest.mark.parametrize(
    ("name", "cases", "values"),
    [
        ("twelve_elements", lambda: elements(0.11), [0.11, 0.5]),
        ("resistance_errors", lambda: ratios(0.8, 1.3, 1.17), [0.17]),
        # between profiles of equal phases, of which half are off by 0.05 more, and half by 0.02
        ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1, 0.3], [0.15, 0.32]), [0.035 / TOTAL]),
        ("boundary_elements", lambda: discretised(0.3), [3.0]),
        ("fourth_term", lambda: terms(0.3, 0.05, 0.02), [0.02 / TOTAL]),
        ("one_wave_bounds", lambda: near_wave(0.25), [0.25]),
        ("area_vanishes", lambda: areas(change=0.03 * EVERY_SECOND), [0.6, 0.6 * 5**0.25, 0.03, 0.03]),
        ("independent_contacts", lambda: areas(fall=1.0), [3.0, 1 / 3]),
    ],
)
def test_what_is_measured_for_a_claim(name, cases, values):
    found = judged(name, cases()).findings
    assert [finding.number.value for finding in found[: len(values)]] == pytest.approx(values, rel=0.01)


def test_one_independent_contact_is_the_contact_of_one_wave():
    """And N of them in a period have the resistance of one over N."""
    xi = np.minimum(LOADS, 0.999)
    for count in (1, 3):
        curve = {"compliance": NUMERICAL, "contact_fraction": 2 * westergaard.contact_half_width(xi)}
        data = case(patches=curve | {"patch_count": np.full(LOADS.size, float(count))})
        found = measures.resistance_of_independent_contacts(data)
        np.testing.assert_allclose(found, westergaard.resistance(xi) / count, rtol=1e-9)


@pytest.mark.parametrize("loads", [np.geomspace(1e-3, 4, 60), np.linspace(1e-3, 4, 160)], ids=["ratios", "steps"])
def test_the_spacing_of_loads_changes_nothing(loads):
    """An excess that changes its sign among the high loads: the spacing must not decide which sign outweighs."""
    total = TOTAL * (1 - np.maximum(1 - loads / 2, 0) ** 3)
    off = 0.06 * np.sin(np.pi * loads) * (loads < 2)  # high loads are from 0.41 to 2 p_0*
    curves = {"patches": total, **dict.fromkeys(("archard", "demelio", "layer"), total + off)}
    measured = judged("layer_close", [case(phase=0.1 * i, loads=loads, **curves) for i in range(6)])
    half = 2 * (1 - 0.5 ** (1 / 3))
    mean = 0.06 * (np.cos(np.pi * half) - np.cos(2 * np.pi)) / np.pi / (2 - half)
    # The trapezoidal rule, the last load before full contact and the ends of the range make up the difference.
    assert measured.findings[0].number.value == pytest.approx(mean, abs=1e-3)
    assert measured.outcome == YES


@pytest.mark.parametrize("name", CLAIMS)
def test_without_the_curves_a_claim_is_not_measured(name):
    measured = judged(name, [case(archard=np.nan * LOADS, bem=np.nan * LOADS)])
    assert measured.outcome == Check.not_measured
    assert verdicts.decisive_line(measured).startswith("Not measured: ")


def test_single_profiles_and_the_other_datum_stand_beside_the_verdict():
    """Archard counted from first contact, at 0.15 g_0, is above where it is below counted from full contact."""
    cases = [one | {"first_contact": 0.15} for one in ensemble(np.where(LOADS < 0.5, -0.05, 0.1))]
    found = judged("archard_above", cases)
    assert (found.outcome, found.decisive.outcome) == (NO, NO)
    assert [(finding.number.decides, finding.outcome) for finding in found.findings] == [(True, NO), (False, YES)]
    found = judged("resistance_errors", dropping(0.8, 1.3, 1.1)).findings
    assert {finding.ensemble.name.rpartition(", ")[2]: finding.number.decides for finding in found} == {
        "mean of 6": True,
        "one by one": False,
    }
    found = judged("resistance_errors", ratios(0.8, 1.3, np.where(LOADS < 0.02, 2.0, 1.05))).findings
    best = [one for one in found if "root mean" in one.number.quantity and ", mean of" in one.ensemble.name]
    assert [(one.outcome, one.number.decides) for one in best] == [
        (YES, True),
        (NO, False),
    ]  # not at the lightest loads


@pytest.fixture
def solved_with(solutions):
    """The solved scene, with claims about its studies."""
    return lambda **names: Curves(replace(solutions.scene, claims=names), solutions.store)


def test_a_scene_names_claims_that_there_are(solved_with):
    (mistake,) = claims.check(solved_with(archard_above=("two",), archard_abov=("two",)).scene)
    assert mistake.keys == ("claims", "archard_abov")
    assert mistake.text == f"a claim must be one of {', '.join(CLAIMS)}, got 'archard_abov'"
    assert not list(claims.check(solved_with(**dict.fromkeys(CLAIMS, ("two",))).scene))


def test_a_new_claim_is_one_row(solved_with, tmp_path, monkeypatch):
    """Nothing but the row is added, and the claim is checked, measured, written, and read again."""

    @paper.claim(measures.by_phases, "Demelio is exact.")
    def exact(case):
        yield claim.Number("error of Demelio", "g_0", abs(measures.excess(case, "demelio")).max(), "at most", 1e-6)

    monkeypatch.setitem(CLAIMS, "demelio_exact", exact)
    solutions = solved_with(demelio_exact=("two",))
    assert not list(claims.check(solutions.scene))
    claims.write(solutions, tmp_path / "contact.nc", tmp_path / "claims.md")
    study = read_study(solutions, "two")
    found = claims.evaluate("demelio_exact", [study, study])  # a case of two studies counts once
    assert found.outcome == NO
    assert len(found.decisive.values) == study.sizes["case"]
    data = read(tmp_path / "contact.nc").sel(claim="demelio_exact")
    assert (data.claim_statement, data.claim_holds) == (found.statement, NO)
    assert data.claim_measured == verdicts.decisive_line(found)
    text = (tmp_path / "claims.md").read_text()
    assert "| [demelio\\_exact](#demelio_exact) | Demelio is exact. | no |" in text
    assert "\n## demelio_exact\n" in text


def test_scene_without_claims(solved_with, tmp_path):
    claims.write(solved_with(), tmp_path / "contact.nc", tmp_path / "claims.md")
    assert "claim" not in read(tmp_path / "contact.nc").sizes
    assert "no claims" in (tmp_path / "claims.md").read_text()
