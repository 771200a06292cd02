"""Claims on hand-made curves of which it is known what they say: yes, no, neither, or nothing to measure."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import netCDF4
import numpy as np
import pytest
import xarray as xr

from weier.data import dataset
from weier.data.check import Check
from weier.methods import westergaard
from weier.pipeline import claims
from weier.pipeline.batches import Place, Solutions
from weier.pipeline.claims import claim, measures, report
from weier.pipeline.claims.ensemble import by_phases
from weier.scene import Layout, Scene

LOADS = np.geomspace(1e-3, 4, 40)
TOTAL = 1.4
# Concave, from 0 at no load to 1.4 at p = 2, where the contact is full.
NUMERICAL = TOTAL * (1 - np.maximum(1 - LOADS / 2, 0) ** 3)
RESISTANCE = TOTAL * 1.5 * np.maximum(1 - LOADS / 2, 0) ** 2
RELATIVE = NUMERICAL / TOTAL


def case(
    D: float = 1.25, gamma: float = 5, m: float = 3, phase: float = 1.0, loads: Any = LOADS, **methods: Any
) -> xr.Dataset:
    """One case with a curve of compliance, or of several variables, for each method."""
    data = dataset.blank(1, list(methods), loads, 4)
    fraction = np.minimum(loads / 2, 1)
    usual = {"contact_fraction": fraction, "resistance": TOTAL * 1.5 * (1 - fraction) ** 2}
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


def estimate(excess: Any, D: float = 1.25, phase: float = 1.0, **methods: Any) -> xr.Dataset:
    """A case whose estimates are all off by as much, and whose numerical curve is known."""
    curves = dict.fromkeys(("archard", "demelio", "layer"), NUMERICAL + excess)
    return case(D, phase=phase, **{**curves, "patches": NUMERICAL, **methods})


def concat(cases: Iterable[xr.Dataset]) -> xr.Dataset:
    return xr.concat(list(cases), "case", data_vars="minimal", coords="minimal", compat="override")


def ensemble(*excesses: Any, count: int = 6, **methods: Any) -> xr.Dataset:
    """Profiles of different phases, whose estimates are off by each of the excesses in turn."""
    return concat(estimate(excesses[i % len(excesses)], phase=0.1 * i, **methods) for i in range(count))


def outcome(name: str, *studies: xr.Dataset) -> Check:
    return claims.evaluate(name, studies).outcome


YES, NO, OPEN = Check.yes, Check.no, Check.not_decided


def elements(error_of_more: float) -> xr.Dataset:
    exact = westergaard.compliance(LOADS)
    fraction = np.where(LOADS < 0.02, 1, 3) / 12
    bem = {"compliance": exact * np.where(LOADS < 0.02, 0.5, 1 + error_of_more), "contact_fraction": fraction}
    data = case(m=1, bem=bem, westergaard=exact)
    data["points"].values[0, 0] = 12
    return data


@pytest.mark.parametrize(("error", "expected"), [(0.03, YES), (-0.3, NO), (0.11, OPEN)])
def test_twelve_elements(error: float, expected: Check) -> None:
    measured = claims.evaluate("twelve_elements", [elements(error)])
    assert measured.outcome == expected
    assert [finding.value for finding in measured.findings] == pytest.approx([abs(error), 0.5])


def phases(gamma: float, spread: float, between: float = 0.0) -> xr.Dataset:
    """Curves that differ at light loads: phases 0 and pi by `spread`, and pi/2 from their middle by `between`."""
    light = np.maximum(1 - LOADS, 0) * TOTAL
    shifts = {0.0: -spread / 2, np.pi / 2: between, np.pi: spread / 2}
    return concat(case(gamma=gamma, m=2, phase=phi, bem=NUMERICAL + shift * light) for phi, shift in shifts.items())


@pytest.mark.parametrize(
    ("coarse", "fine", "expected"),
    [
        ((0.3,), (0.01,), YES),
        ((0.3,), (0.1,), NO),
        ((0.3,), (0.022,), OPEN),  # little more than what we call extremely small
        ((0.3, 0.2), (0.01,), NO),
        ((0.3, 0.085), (0.01,), OPEN),
        ((0.02,), (0.01,), NO),
    ],
)
def test_phase_spread(coarse: tuple[float, ...], fine: tuple[float], expected: Check) -> None:
    assert outcome("phase_spread", phases(2, *coarse), phases(5, *fine)) == expected
    assert outcome("phase_spread", phases(5, *fine), phases(2, *coarse)) == expected


LOW = RELATIVE <= 0.5


@pytest.mark.parametrize(
    ("name", "excesses", "expected"),
    [
        ("archard_above", (0.1, 0.2), YES),
        ("archard_above", (np.where(LOADS > 1, -0.05, 0.1),), NO),
        ("archard_above", (*[0.1] * 5, np.where(LOADS > 1, -0.05, 0.1)), NO),  # it is said of all loads and profiles
        (
            "archard_above",
            (np.where(LOADS >= 2, -0.01, 0.1),),
            YES,
        ),  # in full contact it may meet the numerical curve
        (
            "archard_above",
            (0.1 + 0.2 * np.where(np.arange(LOADS.size) % 2, 1, -1) * (LOADS > 1),),
            OPEN,
        ),  # of every second load
        ("demelio_below", (np.where(LOADS < 1, -0.1, 0.1),), YES),
        ("demelio_below", (np.where(LOADS < 1, 0.1, -0.1),), NO),
        ("demelio_below", (-1e-4,), OPEN),  # within the numerical error
        ("layer_close", (np.where(LOW, 0.03, -0.01),), YES),
        ("layer_close", (*[np.where(LOW, 0.03, -0.01)] * 5, 0.03), YES),  # a tendency: five of six show it
        ("layer_close", (np.where(LOW, 0.1, -0.01),), NO),
        ("layer_close", (np.where(LOW, 0.03, 0.01),), NO),
        ("layer_close", (np.where(LOW, 0.03, -0.0007),), OPEN),
        ("layer_close", (np.where(LOW, 0.03, -0.01), np.where(LOW, 0.03, 0.01)), OPEN),  # it depends on the phase
        ("layer_close", (np.where(LOW, 0.08, -0.01),), OPEN),  # between what is close and what is not
    ],
)
def test_what_is_said_of_the_excess_of_one_estimate(name: str, excesses: tuple[Any, ...], expected: Check) -> None:
    assert outcome(name, ensemble(*excesses)) == expected


def test_a_few_profiles_confirm_nothing_but_one_refutes() -> None:
    assert outcome("archard_above", ensemble(0.1, count=5)) == OPEN
    assert outcome("archard_above", ensemble(0.1, count=6)) == YES
    assert outcome("archard_above", ensemble(np.where(LOADS > 1, -0.05, 0.1), count=1)) == NO


def test_one_number_decides() -> None:
    """Of what holds for every profile the worst one, of what usually holds the middle one, with what all say."""
    low = np.where(LOADS > 1, -0.05, 0.1)
    said = [
        report.decisive_line(claims.evaluate(name, [ensemble(*excesses)]))
        for name, excesses in {
            "archard_above": (0.2, 0.1), "demelio_below": (0.1, -1e-4, low), "layer_close": (-0.0001,),
        }.items()
    ]  # fmt: skip
    assert said == [
        "Least excess of Archard's compliance in partial contact: 0.1 g_0; limit: at least -0.001 g_0; 6 of 6 say "
        "yes",
        "Largest excess of Demelio's compliance at low loads: 0.1 g_0; limit: below 0; 4 of 6 say no, 2 too close to "
        "call",
        "Mean excess of the layer's compliance at high loads: -0.0001 g_0; limit: below 0; 6 of 6 too close to call",
    ]
    judged = claims.evaluate("archard_above", [ensemble(0.1, 0.1, low)])
    assert report.decisive_cells(judged)[1:] == ("at least -0.001 g_0", "4 of 6 say yes, 2 say no")


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [(2146.0, "", "2100"), (2.146, "%", "210 %"), (-2.1e-5, "g_0", "-2.1e-05 g_0"), (0.0, "g_0", "0")],
)
def test_numbers_are_written_with_two_digits_and_large_ones_in_full(value: float, unit: str, text: str) -> None:
    assert claim.written(value, unit) == text


def rough(*excesses: Any, **methods: Any) -> xr.Dataset:
    return ensemble(*excesses, D=1.5, **methods)


@pytest.mark.parametrize(
    ("smooth_excess", "rough_excess", "methods", "expected"),
    [
        (0.1, 0.15, {}, YES),
        (0.15, 0.1, {}, NO),
        (0.1, 0.1005, {}, OPEN),  # 2.4 and 2.5 %
        (0.1, 0.15, {"layer": NUMERICAL}, NO),
    ],
)
def test_errors_grow_with_dimension(
    smooth_excess: float, rough_excess: float, methods: dict[str, Any], expected: Check
) -> None:
    assert outcome("errors_grow_with_dimension", ensemble(smooth_excess), rough(rough_excess, **methods)) == expected


def test_errors_are_compared_at_the_same_phases() -> None:
    assert outcome("errors_grow_with_dimension", ensemble(0.1, 0.3), rough(0.12, 0.32)) == YES
    assert outcome("errors_grow_with_dimension", ensemble(0.1, 0.3), rough(0.32, 0.12)) == OPEN


def ratios(archard: float, demelio: float, layer: float, phase: float) -> xr.Dataset:
    given = {"archard": archard, "demelio": demelio, "layer": layer}
    curves = {m: {"compliance": NUMERICAL, "resistance": RESISTANCE * ratio} for m, ratio in given.items()}
    return case(phase=phase, **curves, patches=NUMERICAL)


@pytest.mark.parametrize(
    ("archard", "demelio", "layer", "expected"),
    [
        (0.8, 1.3, 1.1, YES),
        (1.2, 1.3, 1.1, NO),
        (0.8, 1.9, 1.1, NO),
        (0.8, 0.9, 1.05, NO),
        (0.95, 1.3, 1.1, NO),
        (0.7, 1.3, 1.25, NO),
        (0.8, 1.3, 0.9, NO),  # the layer's error is said to be an overestimate
        (0.8, 1.4, 1.1, OPEN),
        (0.8, 1.3, 1.17, OPEN),
        (0.995, 1.3, 1.003, OPEN),
    ],
)
def test_resistance_errors(archard: float, demelio: float, layer: float, expected: Check) -> None:
    measured = claims.evaluate(
        "resistance_errors", [concat(ratios(archard, demelio, layer, 0.1 * i) for i in range(6))]
    )
    assert measured.outcome == expected
    assert measured.findings[0].value == pytest.approx(abs(layer - 1))


def discretised(resistance: float) -> xr.Dataset:
    """Boundary elements that are off by a tenth of full contact, and by a part of the resistance."""
    bem = {"compliance": NUMERICAL - 0.1 * TOTAL, "resistance": RESISTANCE * (1 + resistance)}
    return concat(case(phase=0.1 * i, bem=bem, patches=NUMERICAL) for i in range(6))


@pytest.mark.parametrize(("resistance", "expected"), [(0.3, YES), (0.05, NO), (0.11, OPEN)])
def test_boundary_elements(resistance: float, expected: Check) -> None:
    measured = claims.evaluate("boundary_elements", [discretised(resistance)])
    assert measured.outcome == expected
    assert measured.findings[0].value == pytest.approx(10 * resistance)


def terms(changes: list[float], count: int = 6) -> xr.Dataset:
    """Series of m = 1, 2, ... of several phases, whose mean gap at light loads grows by the given changes."""
    gap = [1 - RELATIVE]
    for change in changes:
        gap.append(gap[-1] + change * (1 - RELATIVE))
    made = []
    for phase in 0.1 * np.arange(count):
        for m, d in enumerate(gap, start=1):
            made.append(case(m=m, phase=phase, bem=np.zeros_like(LOADS)))
            made[-1]["compliance"].values[0, 0] = float(made[-1]["total_amplitude"][0]) - d
    return concat(made)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ([0.3, 0.05, 0.02], YES),
        ([0.3, 0.05, 0.2], NO),
        ([0.01, 0.005, 0.02], NO),
        ([0.3, 0.2, 0.08], OPEN),
        ([0.3, 0.02, 0.022], OPEN),
    ],
)
def test_fourth_term(changes: list[float], expected: Check) -> None:
    measured = claims.evaluate("fourth_term", [terms(changes)])
    assert measured.outcome == expected
    assert measured.findings[0].value == pytest.approx(changes[-1] / TOTAL, rel=0.01)


def one_wave() -> xr.Dataset:
    return case(m=1, westergaard=westergaard.compliance(LOADS))


def near_wave(off: float, resistance: float = 1.0) -> xr.Dataset:
    """Estimates that lie `off` below the one-wave solution, both counted from the mean plane."""
    curve = {
        "compliance": westergaard.compliance(LOADS) - 1 + TOTAL - off,
        "resistance": westergaard.resistance(LOADS) * resistance,
    }
    return case(archard=curve, demelio=curve, layer=curve)


def test_one_wave_bounds() -> None:
    tail = 5**-0.75 / (1 - 5**-0.75)  # G_1 for D = 1.25, gamma = 5
    assert outcome("one_wave_bounds", near_wave(0.9 * tail), one_wave()) == YES
    assert outcome("one_wave_bounds", near_wave(-0.9 * tail), one_wave()) == YES
    assert outcome("one_wave_bounds", near_wave(1.1 * tail), one_wave()) == NO
    assert outcome("one_wave_bounds", near_wave(0.9 * tail, resistance=5), one_wave()) == NO
    judged = claims.evaluate("one_wave_bounds", [near_wave(0.2), one_wave()])
    assert judged.decisive.value == pytest.approx(0.2 / tail)


SPACINGS = {
    "equal ratios": np.geomspace(1e-3, 4, 160),
    "fewer": np.geomspace(1e-3, 4, 60),
    "equal steps": np.linspace(1e-3, 4, 160),
    "at random": np.sort(np.random.default_rng(0).uniform(1e-3, 4, 160)),
}


@pytest.mark.parametrize("spacing", SPACINGS)
def test_the_spacing_of_loads_changes_nothing(spacing: str) -> None:
    """An excess that changes its sign among the high loads: the spacing must not decide which sign outweighs."""
    loads = SPACINGS[spacing]
    total = TOTAL * (1 - np.maximum(1 - loads / 2, 0) ** 3)
    off = 0.06 * np.sin(np.pi * loads) * (loads < 2)  # high loads are from 0.41 to 2 p_0*

    def member(phase: float) -> xr.Dataset:
        curves = {"patches": total, **dict.fromkeys(("archard", "demelio", "layer"), total + off)}
        return case(phase=phase, loads=loads, **curves)

    measured = claims.evaluate("layer_close", [concat(member(0.1 * i) for i in range(6))])
    half = 2 * (1 - 0.5 ** (1 / 3))
    mean = 0.06 * (np.cos(np.pi * half) - np.cos(2 * np.pi)) / np.pi / (2 - half)
    # The trapezoidal rule, the last load before full contact and the ends of the range make up the difference.
    assert measured.findings[0].value == pytest.approx(mean, abs=1e-3)
    assert measured.outcome == YES


@pytest.mark.parametrize("name", list(claims.CLAIMS))
def test_without_the_curves_a_claim_is_not_measured(name: str) -> None:
    measured = claims.evaluate(name, [case(archard=np.nan, bem=np.nan)])
    assert measured.outcome == Check.not_measured
    assert report.decisive_line(measured).startswith("Not measured: ")


def test_a_case_of_two_studies_counts_once() -> None:
    assert len(claims.evaluate("archard_above", [ensemble(0.1), ensemble(0.1)]).decisive.values) == 6


def test_a_scene_names_claims_that_there_are() -> None:
    (mistake,) = claims.check_names(scene_of({"archard_above": ("a",), "archard_abov": ("a",)}))
    assert mistake.keys == ("claims", "archard_abov")
    assert mistake.text.endswith("did you mean 'archard_above'?")
    assert not list(claims.check_names(scene_of(dict.fromkeys(claims.CLAIMS, ("a",)))))


def test_a_new_claim_is_one_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing but the row is added, and the claim is checked, measured, written, and read again."""

    def error(case: xr.Dataset) -> float:
        return float(np.abs(measures.excess(case, "layer")).max())

    exact = claim.Condition("the layer is exact", "error of the layer", "g_0", error, claim.at_most(1e-6))
    monkeypatch.setitem(claims.CLAIMS, "layer_exact", claim.Claim("The layer is exact.", by_phases, exact))
    solutions = solutions_of(tmp_path, {"smooth": estimate(0.1)}, layer_exact=("smooth",))
    assert not list(claims.check_names(solutions.scene))
    claims.write(solutions, tmp_path / "contact.nc", tmp_path / "claims.md")
    with netCDF4.Dataset(tmp_path / "contact.nc") as data:
        assert data["claim_statement"][:].tolist() == ["The layer is exact."]
        assert data["claim_measured"][0] == "Error of the layer: 0.1 g_0; limit: at most 1e-06 g_0"
        assert data["claim_holds"][:].tolist() == [0]
    judged = claims.evaluate("layer_exact", [estimate(0.1)])
    assert report.from_dataset(dataset.read(tmp_path / "contact.nc")) == {"layer_exact": judged}
    text = (tmp_path / "claims.md").read_text()
    assert "| [layer\\_exact](#layer_exact) | The layer is exact. | no |" in text
    assert "\n## layer_exact\n" in text
    assert outcome("layer_exact", ensemble(0.0)) == YES


def scene_of(names: dict[str, tuple[str, ...]], **more: Any) -> Scene:
    """A scene with these claims."""
    fields = {"name": "test", "title": "A scene", "text": "title: A scene", "claims": names}
    return cast(Scene, SimpleNamespace(**fields, **more))


def solutions_of(folder: Path, studies: dict[str, xr.Dataset], **names: tuple[str, ...]) -> Solutions:
    """A scene with these claims, whose studies are in the folder, each in a batch of its own name."""
    cases = {}
    for name, data in studies.items():
        dataset.write(data, folder / f"{name}.nc", name)
        methods = tuple(data["solution_method"].values.tolist())
        batch = [SimpleNamespace(key=key, methods=methods) for key in data["key"].values.tolist()]
        cases |= {case.key: (case, Place(folder / f"{name}.json", row)) for row, case in enumerate(batch)}
    terms = max(data.sizes["term"] for data in studies.values())
    of = {name: [cases[key][0] for key in data["key"].values.tolist()] for name, data in studies.items()}
    scene = scene_of(
        names, loads=LOADS, products=(),
        layout=Layout(methods, terms, 0), layout_of=lambda cases: Layout(methods, terms, 0),
        studies_of_cases=[()] * len(cases), distinct=[case for case, _ in cases.values()], study=of.get,
    )  # fmt: skip
    places = {key: dict.fromkeys(case.methods, place) for key, (case, place) in cases.items()}
    return cast(Solutions, SimpleNamespace(scene=scene, folder=folder, places=lambda case: places[case.key]))


def test_written_dataset_is_whole_and_plain(tmp_path: Path) -> None:
    studies = {"smooth": estimate(0.1), "rough": estimate(-0.1, D=1.5), "again": ensemble(0.02, -0.02, D=1.6)}
    names = {"archard_above": ("smooth", "rough"), "layer_close": ("again",), "phase_spread": ("again",)}
    claims.write(solutions_of(tmp_path, studies, **names), tmp_path / "contact.nc", tmp_path / "new" / "claims.md")
    with netCDF4.Dataset(tmp_path / "contact.nc") as data:
        assert data["D"][:].tolist() == [1.25, 1.5, *[1.6] * 6]
        assert list(data["claim"][:]) == list(names)
        assert data["claim_holds"][:].tolist() == [0, 3, 2]
        assert data["claim_holds"].flag_meanings == "no yes not_measured not_decided"
        assert str(data["claim_statement"][0]).startswith("The Archard approximation overestimates")
        assert all(data[name].long_name and data[name].units for name in data.variables)
    again = dataset.read(tmp_path / "contact.nc")
    assert again["compliance"].sizes == {"case": 8, "solution_method": 4, "mean_pressure": LOADS.size}
    table = (tmp_path / "new" / "claims.md").read_text()
    lines = [line.split(" | ") for line in table.splitlines() if line.startswith("| [")]
    assert [line[2] for line in lines] == ["no", "not decided", "not measured"]
    assert " p_0*" not in table


def test_scene_without_claims(tmp_path: Path) -> None:
    claims.write(solutions_of(tmp_path, {"smooth": estimate(0.1)}), tmp_path / "contact.nc", tmp_path / "claims.md")
    assert "claim" not in dataset.read(tmp_path / "contact.nc").sizes
    assert "no claims" in (tmp_path / "claims.md").read_text()
