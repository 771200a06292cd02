"""Claims on hand-made curves of which it is known what they say: yes, no, neither, or nothing to measure."""

import json
from dataclasses import replace

import netCDF4
import numpy as np
import pytest
import xarray as xr

from tests.pipeline.conftest import SCENE
from tests.scenes import blank, scene_in, solve_scene
from weier.data import dataset
from weier.data.variables import Check
from weier.methods import westergaard
from weier.pipeline import claims
from weier.pipeline.claims import claim, measures, verdicts
from weier.pipeline.claims.paper import by_phases
from weier.pipeline.claims.rows import StudyArrays
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
    data = blank(1, list(methods), loads, 4)
    fraction = np.minimum(loads / 2, 1)
    usual = {"contact_fraction": fraction, "resistance": TOTAL * 1.5 * (1 - fraction) ** 2}
    usual |= {"compliance_error": np.full(loads.size, 1e-3), "resistance_error": 0.01 * usual["resistance"]}
    total, tail = (TOTAL, 0.04) if m > 1 else (1.0, 0.44)
    values = {"key": f"{D}{gamma:g}{m}{phase:.2f}", "D": D, "gamma": gamma, "m": m}
    for name, value in {**values, "total_amplitude": total, "tail_amplitude": tail}.items():
        data[name].values[0] = value
    data["phases"].values[0, : int(m)] = np.where(np.arange(m) == 0, 0, phase)
    for row, curve in enumerate(methods.values()):
        given = curve if isinstance(curve, dict) else {"compliance": curve}
        for name, value in {**usual, **given}.items():
            data[name].values[0, row] = value
    return data


def concat(cases):
    return xr.concat(list(cases), "case", data_vars="minimal", coords="minimal", compat="override")


def ensemble(*excesses, count=6, **others):
    """Profiles of different phases, whose estimates are off by each of the excesses in turn."""

    def member(i):
        curves = dict.fromkeys(("archard", "demelio", "layer"), NUMERICAL + excesses[i % len(excesses)])
        return case(**{"phase": 0.1 * i, **curves, "patches": NUMERICAL, **others})

    return concat(member(i) for i in range(count))


def rough(*excesses, **methods):
    return ensemble(*excesses, D=1.5, **methods)


YES, NO, OPEN = Check.yes, Check.no, Check.not_decided
CLAIMS = claims.CLAIMS


def elements(error):
    """Twelve elements of one wave: those of several in contact are off by this error, a single one by half."""
    exact = westergaard.compliance(LOADS)
    fraction = np.where(LOADS < 0.02, 1, 3) / 12
    bem = {"compliance": exact * np.where(LOADS < 0.02, 0.5, 1 + error), "contact_fraction": fraction}
    data = case(m=1, bem=bem, westergaard=exact)
    data["points"].values[0, 0] = 12
    return [data]


def phases(gamma, spread, between=0.0):
    """Curves that differ at light loads: phases 0 and pi by `spread`, and pi/2 from their middle by `between`."""
    light = np.maximum(1 - LOADS, 0) * TOTAL
    shifts = {0.0: -spread / 2, np.pi / 2: between, np.pi: spread / 2}
    return concat(case(gamma=gamma, m=2, phase=phi, bem=NUMERICAL + shift * light) for phi, shift in shifts.items())


def coarse_and_fine(coarse, fine):
    return [phases(2, *coarse), phases(5, fine)]


def one_ensemble(*excesses):
    return [ensemble(*excesses)]


def smooth_and_rough(smooth, wilder, **methods):
    return [ensemble(*smooth), rough(*wilder, **methods)]


def ratios(archard, demelio, layer):
    """Resistances of the estimates over the numerical one."""
    given = {"archard": archard, "demelio": demelio, "layer": layer}
    curves = {m: {"compliance": NUMERICAL, "resistance": RESISTANCE * ratio} for m, ratio in given.items()}
    return [concat(case(phase=0.1 * i, **curves, patches=NUMERICAL) for i in range(6))]


def dropping(*smooth):
    """Estimates beside resistances that drop by a third at another load for each profile."""
    (study,) = ratios(*smooth)
    steps = np.where(np.arange(LOADS.size) % 6 == np.arange(6)[:, None], 1.5, 1.0)
    study["resistance"].values[:, -1] *= steps / steps.mean(axis=0)
    return [study]


def bounded(*, h, R):
    """Bounds on both quantities, of these relative widths."""
    curve = {"compliance": NUMERICAL}
    for name, values, width in (("compliance", NUMERICAL, h), ("resistance", RESISTANCE, R)):
        curve |= {f"{name}_lower": values * (1 - width / 2), f"{name}_upper": values * (1 + width / 2)}
    return [concat(case(phase=0.1 * i, bem=curve) for i in range(6))]


def discretised(resistance):
    """Boundary elements that are off by a tenth of full contact, and by a part of the resistance."""
    bem = {"compliance": NUMERICAL - 0.1 * TOTAL, "resistance": RESISTANCE * (1 + resistance)}
    return [concat(case(phase=0.1 * i, bem=bem, patches=NUMERICAL) for i in range(6))]


def terms(*changes):
    """Series of m = 1, 2, ... of several phases, whose mean gap at light loads grows by the given changes."""
    gap = [(1 + sum(changes[:n])) * (1 - RELATIVE) for n in range(len(changes) + 1)]
    made = []
    for phase in 0.1 * np.arange(6):
        for m, d in enumerate(gap, start=1):
            made.append(case(m=m, phase=phase, bem=np.zeros_like(LOADS)))
            made[-1]["compliance"].values[0, 0] = float(made[-1]["total_amplitude"][0]) - d
    return [concat(made)]


def areas(*, fall=0.6, change=0.01, contacts=3):
    """Series of m = 1, 2, 3 whose area falls and whose contacts multiply, and whose last term changes R."""
    made = []
    for phase in 0.1 * np.arange(6):
        for m in (1, 2, 3):
            curve = {"compliance": NUMERICAL, "resistance": RESISTANCE * (1 + change * (m == 3))}
            curve["patch_count"] = np.full(LOADS.size, float(contacts ** (m - 1)))
            curve["contact_fraction"] = np.minimum(LOADS / 4, 0.99) * fall ** (m - 1)
            made.append(case(m=m, phase=phase, patches=curve))
    return [concat(made)]


TAIL = 5**-0.75 / (1 - 5**-0.75)  # G_1 for D = 1.25, gamma = 5


def near_wave(spread, resistance=1.0):
    """Estimates whose compliances differ by a fraction of the width of the bounds from the one-wave solution."""
    h = westergaard.compliance(LOADS)
    curve = {"compliance": h, "resistance": westergaard.resistance(LOADS) * resistance}
    other = curve | {"compliance": h + 2 * TAIL * spread * (LOADS < 1)}
    return [case(archard=curve, demelio=other, layer=curve), case(m=1, westergaard=h)]


FASTER = TOTAL * (1 - np.maximum(1 - LOADS / 1.5, 0) ** 3)  # full contact at a lighter load
LOW, HEAVY, EVERY_SECOND = RELATIVE <= 0.5, LOADS > 1, np.where(np.arange(LOADS.size) % 2, 1, -1)
HIGHEST = RELATIVE > 0.9
SUNK, TYPICAL = np.where(HEAVY, -0.05, 0.1), np.where(LOW, 0.03, -0.01)

# A claim, the studies that it looks at, and what comes of it.
SAID = [
    ("twelve_elements", lambda: elements(0.03), YES),
    ("twelve_elements", lambda: elements(-0.3), NO),
    ("twelve_elements", lambda: elements(0.11), OPEN),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.01), YES),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.01)[::-1], YES),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.1), NO),
    ("phase_spread", lambda: coarse_and_fine((0.3,), 0.022), OPEN),  # little more than what we call extremely small
    ("phase_spread", lambda: coarse_and_fine((0.3, 0.2), 0.01), NO),
    ("phase_spread", lambda: coarse_and_fine((0.3, 0.085), 0.01), OPEN),
    ("phase_spread", lambda: coarse_and_fine((0.02,), 0.01), NO),
    ("archard_above", lambda: one_ensemble(0.1, 0.2), YES),
    ("archard_above", lambda: one_ensemble(SUNK), NO),
    ("archard_above", lambda: one_ensemble(*[0.1] * 5, SUNK), NO),  # it is said of all loads and profiles
    ("archard_above", lambda: one_ensemble(np.where(LOADS >= 2, -0.01, 0.1)), YES),  # in full contact they may meet
    ("archard_above", lambda: one_ensemble(np.where(LOADS < 5e-3, -0.01, 0.1)), YES),  # as it must as p -> 0
    ("archard_above", lambda: one_ensemble(np.where(LOADS < 0.02, -0.01, 0.1)), NO),
    ("archard_above", lambda: one_ensemble(0.1 + 0.2 * EVERY_SECOND * HEAVY), OPEN),
    ("archard_above", lambda: [ensemble(0.1, count=5)], OPEN),  # few profiles confirm nothing, and one refutes
    ("archard_above", lambda: [ensemble(SUNK, count=1)], NO),
    ("demelio_below", lambda: one_ensemble(np.where(LOADS < 1, -0.1, 0.1)), YES),
    ("demelio_below", lambda: one_ensemble(np.where(LOADS < 1, 0.1, -0.1)), NO),
    ("demelio_below", lambda: one_ensemble(-1e-4), OPEN),  # within the numerical error
    ("layer_close", lambda: one_ensemble(TYPICAL), YES),
    ("layer_close", lambda: one_ensemble(*[TYPICAL] * 5, 0.03), YES),  # a tendency: five of six show it
    ("layer_close", lambda: one_ensemble(np.where(LOW, 0.1, -0.01)), NO),
    ("layer_close", lambda: one_ensemble(np.where(LOW, 0.03, 0.01)), NO),
    ("layer_close", lambda: one_ensemble(np.where(LOW, 0.03, -0.0007)), OPEN),
    ("layer_close", lambda: one_ensemble(TYPICAL, np.where(LOW, 0.03, 0.01)), OPEN),  # it depends on the phase
    ("layer_close", lambda: one_ensemble(np.where(LOW, 0.08, -0.01)), OPEN),  # between what is close and what is not
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.15]), YES),
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.15], [0.1]), NO),
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.1005]), OPEN),  # 2.4 and 2.5 %
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1], [0.15], layer=NUMERICAL), NO),
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1, 0.3], [0.12, 0.32]), YES),  # at the same phases
    ("errors_grow_with_dimension", lambda: smooth_and_rough([0.1, 0.3], [0.32, 0.12]), OPEN),
    ("resistance_errors", lambda: ratios(0.8, 1.3, 1.1), YES),
    ("resistance_errors", lambda: ratios(1.2, 1.3, 1.1), NO),
    ("resistance_errors", lambda: ratios(np.where(HIGHEST, 0.0, 1.05), 1.3, 1.02), YES),  # high loads end at 99 %
    ("resistance_errors", lambda: ratios(0.8, np.where(HIGHEST, 0.5, 1.3), 1.1), NO),
    ("resistance_errors", lambda: ratios(0.8, 1.9, 1.1), NO),
    ("resistance_errors", lambda: ratios(0.8, 0.9, 1.05), NO),
    ("resistance_errors", lambda: ratios(0.95, 1.3, 1.1), NO),
    ("resistance_errors", lambda: ratios(0.7, 1.3, 1.25), NO),
    ("resistance_errors", lambda: ratios(0.8, 1.3, 0.9), NO),  # the layer's error is said to be an overestimate
    ("resistance_errors", lambda: ratios(0.8, 1.4, 1.1), OPEN),
    ("resistance_errors", lambda: ratios(0.8, 1.3, 1.17), OPEN),
    ("resistance_errors", lambda: ratios(0.995, 1.3, 1.003), OPEN),
    ("resistance_errors", lambda: dropping(0.8, 1.3, 1.1), YES),  # drops of single profiles do not decide
    ("resistance_falls", lambda: ratios(0.8, 1.3, 1.1), YES),
    ("resistance_falls", lambda: ratios(0.8, 1.3, 1.1 + 1.0 * (LOADS > 0.5)), NO),
    ("bounds_looser", lambda: bounded(h=0.1, R=0.3), YES),
    ("bounds_looser", lambda: bounded(h=0.3, R=0.1), NO),
    ("rises_further", lambda: smooth_and_rough([0.1], [0.1], patches=NUMERICAL * 0.9), YES),
    ("rises_further", lambda: smooth_and_rough([0.1], [0.1], patches=FASTER), NO),
    ("approximations_good", lambda: ratios(0.8, 1.25, 1.1), YES),
    ("approximations_good", lambda: ratios(0.8, 1.9, 1.1), NO),
    ("approximations_good", lambda: ratios(0.8, 1.33, 1.1), OPEN),
    ("boundary_elements", lambda: discretised(0.3), YES),
    ("boundary_elements", lambda: discretised(0.05), NO),
    ("boundary_elements", lambda: discretised(0.11), OPEN),
    ("fourth_term", lambda: terms(0.3, 0.05, 0.02), YES),
    ("fourth_term", lambda: terms(0.3, 0.05, 0.2), NO),
    ("fourth_term", lambda: terms(0.01, 0.005, 0.02), NO),
    ("fourth_term", lambda: terms(0.3, 0.2, 0.08), OPEN),
    ("fourth_term", lambda: terms(0.3, 0.02, 0.022), OPEN),
    ("area_vanishes", areas, YES),
    ("area_vanishes", lambda: areas(fall=1.2), NO),
    ("area_vanishes", lambda: areas(fall=0.95), NO),  # it falls, but more slowly than gamma^(1-D) = 0.67
    ("area_vanishes", lambda: areas(fall=0.78), OPEN),
    ("area_vanishes", lambda: areas(change=0.1), NO),
    ("area_vanishes", lambda: areas(change=0.1 * EVERY_SECOND), NO),  # changes of either sign do not cancel
    ("independent_contacts", areas, YES),
    ("independent_contacts", lambda: areas(contacts=1), NO),
    (
        "independent_contacts",
        lambda: areas(fall=1e-4, contacts=2),
        NO,
    ),  # so small that the logarithm outweighs their number
    ("one_wave_bounds", lambda: near_wave(0.9), YES),
    ("one_wave_bounds", lambda: near_wave(-0.9), YES),
    ("one_wave_bounds", lambda: near_wave(1.1), NO),
    ("one_wave_bounds", lambda: near_wave(0.9, resistance=5), NO),
    ("one_wave_bounds", lambda: near_wave(0.9, resistance=0), NO),
]


@pytest.mark.parametrize(("name", "studies", "expected"), SAID)
def test_what_is_said_of_a_claim(name, studies, expected):
    """From the variables that claims of a scene are read with."""
    read = [study.drop_vars(claims.unused([name]), errors="ignore") for study in studies()]
    assert claims.evaluate(name, read).outcome == expected


def test_a_case_is_a_row_of_the_arrays_of_its_study():
    both = (NUMERICAL, np.nan), (np.nan, 2 * NUMERICAL), (np.nan, np.nan)
    study = concat(case(patches=patches, bem=bem) for patches, bem in both)
    found = StudyArrays.from_dataset(study.transpose("mean_pressure", ...)).cases
    assert [one.numerical_method for one in found] == ["patches", "bem", None]
    changed = found[1].with_values({"compliance": found[0]["compliance"]})
    for row, one in enumerate([*found[:2], changed]):
        expected = study.isel(case=row % 2)
        expected["compliance"] = study["compliance"].isel(case=row % 2 if one is not changed else 0)
        for every, thinned in ((slice(None), one), (slice(1, None, 2), one.thinned)):
            for name, values in expected.isel(mean_pressure=every).variables.items():
                np.testing.assert_array_equal(thinned[name], values.values)


@pytest.mark.parametrize(
    ("name", "studies", "values"),
    [
        ("twelve_elements", lambda: elements(0.11), [0.11, 0.5]),
        ("resistance_errors", lambda: ratios(0.8, 1.3, 1.17), [0.17]),
        ("boundary_elements", lambda: discretised(0.3), [3.0]),
        ("fourth_term", lambda: terms(0.3, 0.05, 0.02), [0.02 / TOTAL]),
        ("one_wave_bounds", lambda: near_wave(0.25), [0.25]),
        ("area_vanishes", lambda: areas(change=0.03 * EVERY_SECOND), [0.6, 0.6 * 5**0.25, 0.03, 0.03]),
        ("independent_contacts", lambda: areas(fall=1.0), [3.0, 1 / 3]),
    ],
)
def test_what_is_measured_for_a_claim(name, studies, values):
    found = claims.evaluate(name, studies()).findings
    assert [finding.value for finding in found[: len(values)]] == pytest.approx(values, rel=0.01)


def test_the_layer_may_be_best_but_at_the_lightest_loads():
    found = claims.evaluate("resistance_errors", ratios(0.8, 1.3, np.where(LOADS < 0.02, 2.0, 1.05))).findings
    best = [finding for finding in found if "best" in finding.statement and "mean of" in finding.ensemble]
    assert [(finding.outcome, finding.decides) for finding in best] == [(YES, True), (NO, False)]


def test_one_independent_contact_is_the_contact_of_one_wave():
    """And N of them in a period have the resistance of one over N."""
    xi = np.minimum(LOADS, 0.999)
    for count in (1, 3):
        curve = {"compliance": NUMERICAL, "contact_fraction": 2 * westergaard.contact_half_width(xi)}
        data = case(patches=curve | {"patch_count": np.full(LOADS.size, float(count))})
        found = measures.resistance_of_independent_contacts(StudyArrays.from_dataset(data).cases[0])
        np.testing.assert_allclose(found, westergaard.resistance(xi) / count, rtol=1e-9)


# Of what holds for every profile the worst one decides, of what usually holds the middle one.
@pytest.mark.parametrize(
    ("name", "excesses", "said"),
    [
        ("archard_above", (0.2, 0.1), ": 0.001 p_0*; limit: at most 0.01 p_0*; 6 of 6 say yes"),
        ("archard_above", (0.1, 0.1, SUNK), "p_0*; limit: at most 0.01 p_0*; 4 of 6 say yes, 2 say no"),
        ("demelio_below", (0.1, -1e-4, SUNK), ": 0.1 g_0; limit: below 0; 4 of 6 say no, 2 too close to call"),
        ("layer_close", (-0.0001,), ": -0.0001 g_0; limit: below 0; 6 of 6 too close to call"),
    ],
)
def test_one_number_decides(name, excesses, said):
    assert verdicts.decisive_line(claims.evaluate(name, one_ensemble(*excesses))).endswith(said)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(2146.0, "", "2100"), (2.146, "%", "210 %"), (-2.1e-5, "g_0", "-2.1e-05 g_0"), (0.0, "g_0", "0")],
)
def test_numbers_are_written_with_two_digits_and_large_ones_in_full(value, unit, text):
    assert claim.written(value, unit) == text


@pytest.mark.parametrize("loads", [np.geomspace(1e-3, 4, 60), np.linspace(1e-3, 4, 160)], ids=["ratios", "steps"])
def test_the_spacing_of_loads_changes_nothing(loads):
    """An excess that changes its sign among the high loads: the spacing must not decide which sign outweighs."""
    total = TOTAL * (1 - np.maximum(1 - loads / 2, 0) ** 3)
    off = 0.06 * np.sin(np.pi * loads) * (loads < 2)  # high loads are from 0.41 to 2 p_0*
    curves = {"patches": total, **dict.fromkeys(("archard", "demelio", "layer"), total + off)}
    six = concat(case(phase=0.1 * i, loads=loads, **curves) for i in range(6))
    measured = claims.evaluate("layer_close", [six])
    half = 2 * (1 - 0.5 ** (1 / 3))
    mean = 0.06 * (np.cos(np.pi * half) - np.cos(2 * np.pi)) / np.pi / (2 - half)
    # The trapezoidal rule, the last load before full contact and the ends of the range make up the difference.
    assert measured.findings[0].value == pytest.approx(mean, abs=1e-3)
    assert measured.outcome == YES


@pytest.mark.parametrize("name", CLAIMS)
def test_without_the_curves_a_claim_is_not_measured(name):
    measured = claims.evaluate(name, [case(archard=np.nan, bem=np.nan)])
    assert measured.outcome == Check.not_measured
    assert verdicts.decisive_line(measured).startswith("Not measured: ")


def test_single_profiles_and_the_other_datum_stand_beside_the_verdict():
    """Archard counted from first contact, at 0.15 g_0, is above where it is below counted from full contact."""
    study = ensemble(np.where(LOADS < 0.5, -0.05, 0.1))
    study["first_contact"].values[:] = 0.15
    judged = claims.evaluate("archard_above", [study])
    assert (judged.outcome, judged.decisive.outcome) == (NO, NO)
    assert [(finding.decides, finding.outcome) for finding in judged.findings] == [(True, NO), (False, YES)]
    found = claims.evaluate("resistance_errors", dropping(0.8, 1.3, 1.1)).findings
    assert {finding.ensemble.rpartition(", ")[2]: finding.decides for finding in found} == {
        "mean of 6": True,
        "one by one": False,
    }
    assert max(finding.value for finding in found if finding.unit == "%") > 0.15


def test_a_case_of_two_studies_counts_once():
    assert len(claims.evaluate("archard_above", [ensemble(0.1), ensemble(0.1)]).decisive.values) == 6


@pytest.fixture
def solved_with(loaded, solutions):
    """The solved scene, with claims about its studies."""
    return lambda **names: Curves(replace(loaded, claims=names), solutions.store)


def test_a_scene_names_claims_that_there_are(solved_with):
    (mistake,) = claims.check_names(solved_with(archard_above=("two",), archard_abov=("two",)).scene)
    assert mistake.keys == ("claims", "archard_abov")
    assert mistake.text.endswith("did you mean 'archard_above'?")
    assert not list(claims.check_names(solved_with(**dict.fromkeys(CLAIMS, ("two",))).scene))


def test_a_new_claim_is_one_row(solved_with, tmp_path, monkeypatch):
    """Nothing but the row is added, and the claim is checked, measured, written, and read again."""

    def error(case):
        return float(np.abs(measures.excess(case, "demelio")).max())

    exact = claim.Condition("demelio is exact", "error of Demelio", "g_0", error, claim.at_most(1e-6))
    monkeypatch.setitem(CLAIMS, "demelio_exact", claim.Claim("Demelio is exact.", by_phases, exact))
    solutions = solved_with(demelio_exact=("two",))
    assert not list(claims.check_names(solutions.scene))
    claims.write(solutions, tmp_path / "contact.nc", tmp_path / "claims.md")
    judged = claims.evaluate("demelio_exact", [read_study(solutions, "two")])
    assert judged.outcome == NO
    data = dataset.read(tmp_path / "contact.nc").sel(claim="demelio_exact")
    assert (data.claim_statement, data.claim_holds) == (judged.statement, NO)
    (finding,) = json.loads(data.claim_conditions.item())
    assert finding == json.loads(json.dumps(judged.findings[0]._asdict()))
    text = (tmp_path / "claims.md").read_text()
    assert "| [demelio\\_exact](#demelio_exact) | Demelio is exact. | no |" in text
    assert "\n## demelio_exact\n" in text


def test_a_claim_is_judged_at_the_loads_of_its_study(tmp_path, monkeypatch):
    """By the data of a scene, whose other studies have other loads."""
    seen = []

    def number(case):
        seen.append(case["mean_pressure"].tolist())
        return 0.0

    listed = claim.Condition("loads", "loads", "", number, claim.at_most(1))
    monkeypatch.setitem(CLAIMS, "loads", claim.Claim("Of its loads.", by_phases, listed))
    text = SCENE.replace("m: 2}}", "m: 2}, loads: [0.02, 0.5]}") + "claims: {loads: [two]}"
    claims.write(solve_scene(scene_in(tmp_path, text), tmp_path / "curves"), tmp_path / "a.nc", tmp_path / "a.md")
    assert [0.02, 0.5] in seen
    assert all(set(loads) <= {0.02, 0.5} for loads in seen)


def test_written_dataset_is_whole_and_plain(solved_with, tmp_path):
    names = {"archard_above": ("waves",), "one_wave_bounds": ("waves", "two"), "phase_spread": ("two",)}
    solutions = solved_with(**names)
    claims.write(solutions, tmp_path / "contact.nc", tmp_path / "new" / "claims.md")
    studies = {name: read_study(solutions, name) for name in ("waves", "two")}
    outcomes = [claims.evaluate(name, [studies[study] for study in of]).outcome for name, of in names.items()]
    with netCDF4.Dataset(tmp_path / "contact.nc") as data:
        data = data["details"]
        assert list(data["claim"][:]) == list(names)
        assert data["claim_holds"][:].tolist() == outcomes
        assert data["claim_holds"].flag_meanings == "no yes not_measured not_decided"
        assert str(data["claim_statement"][0]).startswith("The Archard approximation overestimates")
        assert all(data[name].long_name for name in data.variables)
    table = (tmp_path / "new" / "claims.md").read_text()
    lines = [line.split(" | ") for line in table.splitlines() if line.startswith("| [")]
    assert [line[2] for line in lines] == [outcome.name.replace("_", " ") for outcome in outcomes]
    assert " p_0*" not in table


def test_scene_without_claims(solved_with, tmp_path):
    claims.write(solved_with(), tmp_path / "contact.nc", tmp_path / "claims.md")
    assert "claim" not in dataset.read(tmp_path / "contact.nc").sizes
    assert "no claims" in (tmp_path / "claims.md").read_text()
