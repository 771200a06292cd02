"""Claims on hand-made curves of which it is known whether they hold: each can hold, not hold, and not be measured."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import netCDF4
import numpy as np
import pytest
import xarray as xr

from weier.data import dataset
from weier.methods import westergaard
from weier.pipeline import claims
from weier.pipeline.claims import claim, readings
from weier.scene import Scene, SceneError

LOADS = np.geomspace(1e-3, 4, 40)
TOTAL = 1.4
# Concave, from 0 at no load to 1.4 at p = 2, where the contact is full.
NUMERICAL = TOTAL * (1 - np.maximum(1 - LOADS / 2, 0) ** 3)
RESISTANCE = TOTAL * 1.5 * np.maximum(1 - LOADS / 2, 0) ** 2
FRACTION = np.minimum(LOADS / 2, 1)
RELATIVE = NUMERICAL / TOTAL


def case(D: float = 1.25, gamma: float = 5, m: float = 3, phase: float = 1.0, **methods: Any) -> xr.Dataset:
    """One case with a curve of compliance, or of several variables, for each method."""
    data = dataset.blank(1, list(methods), LOADS, 4)
    total, tail = (TOTAL, 0.04) if m > 1 else (1.0, 0.44)
    values = {"key": f"{D}{gamma:g}{m}{phase:.1f}", "D": D, "gamma": gamma, "m": m}
    for name, value in {**values, "total_amplitude": total, "tail_amplitude": tail}.items():
        data[name].values[0] = value
    data["phase"].values[0, : int(m)] = np.where(np.arange(m) == 0, 0, phase)
    for row, curve in enumerate(methods.values()):
        given = curve if isinstance(curve, dict) else {"compliance": curve}
        for name, value in {"contact_fraction": FRACTION, "resistance": RESISTANCE, **given}.items():
            data[name].values[0, row] = value
    return data


def estimate(excess: Any, **methods: Any) -> xr.Dataset:
    """A case whose estimates are all off by as much, and whose numerical curve is known."""
    curves = dict.fromkeys(("archard", "demelio", "layer"), NUMERICAL + excess)
    return case(**{**curves, "patches": NUMERICAL, **methods})


def holds(name: str, *studies: xr.Dataset) -> bool | None:
    return claims.evaluate(name, studies).holds


def elements(error_of_more: float) -> xr.Dataset:
    exact = westergaard.compliance(LOADS)
    fraction = np.where(LOADS < 0.02, 1, 3) / 12
    bem = {"compliance": exact * np.where(LOADS < 0.02, 0.5, 1 + error_of_more), "contact_fraction": fraction}
    data = case(m=1, bem=bem, westergaard=exact)
    data["points"].values[0, 0] = 12
    return data


def test_twelve_elements() -> None:
    assert holds("twelve_elements", elements(0.03))
    assert holds("twelve_elements", elements(-0.3)) is False
    measured = claims.evaluate("twelve_elements", [elements(0.03)])
    assert measured.value == pytest.approx(0.03)
    assert "-50.0% where only one is (up to 0.02 p_0*)" in measured.text


def phases(gamma: float, spread: float, between: float = 0.0) -> xr.Dataset:
    """Curves that differ at light loads: phases 0 and pi by `spread`, and pi/2 from their middle by `between`."""
    light = np.maximum(1 - LOADS, 0) * TOTAL
    shifts = {0.0: -spread / 2, np.pi / 2: between, np.pi: spread / 2}
    return xr.concat(
        [case(gamma=gamma, m=2, phase=phi, bem=NUMERICAL + shift * light) for phi, shift in shifts.items()],
        "case", data_vars="minimal", coords="minimal", compat="override",
    )  # fmt: skip


def test_phase_spread() -> None:
    assert holds("phase_spread", phases(2, 0.3), phases(5, 0.01))
    assert holds("phase_spread", phases(5, 0.01), phases(2, 0.3))
    assert holds("phase_spread", phases(2, 0.3), phases(5, 0.1)) is False
    assert holds("phase_spread", phases(2, 0.3, between=0.2), phases(5, 0.01)) is False
    measured = claims.evaluate("phase_spread", [phases(2, 0.3), phases(5, 0.1)])
    assert measured.value == pytest.approx(0.1, rel=0.01)
    first = LOADS[LOADS >= 0.1][0]
    assert f"({0.3 * (1 - first) * TOTAL:.2g} g_0 from 0.1 p_0* on)" in measured.text


def test_archard_above() -> None:
    assert holds("archard_above", estimate(0.1))
    assert holds("archard_above", estimate(0.1), estimate(np.where(LOADS > 1, -0.01, 0.1))) is False
    assert claims.evaluate("archard_above", [estimate(0.1), estimate(0.07)]).value == pytest.approx(0.07)


def test_a_claim_that_does_not_hold_says_why() -> None:
    reason = "The statement does not hold here: Archard's compliance is too low by up to 0.01 g_0."
    too_low = claims.evaluate("archard_above", [estimate(np.where(LOADS > 1, -0.01, 0.1))])
    assert too_low.text.endswith(reason)
    assert "does not hold" not in claims.evaluate("archard_above", [estimate(0.1)]).text


def test_archard_may_meet_the_numerical_curve_at_full_contact() -> None:
    assert holds("archard_above", estimate(np.where(LOADS >= 2, -0.01, 0.1)))


def test_demelio_below() -> None:
    crossing = np.where(LOADS < 1, -0.1, 0.1)
    assert holds("demelio_below", estimate(crossing))
    assert holds("demelio_below", estimate(-crossing)) is False
    assert "above from 1.1 p_0* on" in claims.evaluate("demelio_below", [estimate(crossing)]).text
    assert "nowhere above" in claims.evaluate("demelio_below", [estimate(-0.1)]).text


def test_layer_close() -> None:
    low = RELATIVE <= 0.5
    assert holds("layer_close", estimate(np.where(low, 0.03, -0.01)))
    assert holds("layer_close", estimate(np.where(low, 0.1, -0.01))) is False
    assert holds("layer_close", estimate(np.where(low, 0.03, 0.01))) is False


def test_errors_grow_with_dimension() -> None:
    assert holds("errors_grow_with_dimension", estimate(0.1), estimate(0.15, D=1.5))
    assert holds("errors_grow_with_dimension", estimate(0.15), estimate(0.1, D=1.5)) is False
    one_better = estimate(0.15, D=1.5, layer=NUMERICAL)
    assert holds("errors_grow_with_dimension", estimate(0.1), one_better) is False


def ratios(archard: float, demelio: float, layer: float) -> xr.Dataset:
    given = {"archard": archard, "demelio": demelio, "layer": layer}
    curves = {m: {"compliance": NUMERICAL, "resistance": RESISTANCE * ratio} for m, ratio in given.items()}
    return case(**curves, patches=NUMERICAL)


@pytest.mark.parametrize(
    ("archard", "demelio", "layer", "expected"),
    [
        (0.8, 1.3, 1.1, True),
        (1.2, 1.3, 1.1, False),
        (0.8, 1.9, 1.1, False),
        (0.8, 0.9, 1.05, False),
        (0.95, 1.3, 1.1, False),
        (0.7, 1.3, 1.25, False),
    ],
)
def test_resistance_errors(archard: float, demelio: float, layer: float, expected: bool) -> None:
    measured = claims.evaluate("resistance_errors", [ratios(archard, demelio, layer)])
    assert measured.holds is expected
    assert measured.value == pytest.approx(layer - 1)
    assert f"{demelio - 1:+.0%} to {demelio - 1:+.0%} with a mean of {demelio - 1:+.0%} (Demelio)" in measured.text


def terms(changes: list[float]) -> list[xr.Dataset]:
    """Series of m = 1, 2, ... whose mean gap at light loads grows by the given changes."""
    gap = [1 - RELATIVE]
    for change in changes:
        gap.append(gap[-1] + change * (1 - RELATIVE))
    studies = [case(m=m + 1, bem=np.zeros_like(LOADS)) for m in range(len(gap))]
    for data, d in zip(studies, gap, strict=True):
        data["compliance"].values[0, 0] = float(data["total_amplitude"][0]) - d
    return studies


def test_fourth_term() -> None:
    assert holds("fourth_term", *terms([0.3, 0.05, 0.02]))
    assert holds("fourth_term", *terms([0.3, 0.05, 0.2])) is False
    assert holds("fourth_term", *terms([0.01, 0.005, 0.02])) is False
    assert claims.evaluate("fourth_term", terms([0.3, 0.028])).value == pytest.approx(0.02, rel=0.01)


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
    assert holds("one_wave_bounds", near_wave(0.9 * tail), one_wave())
    assert holds("one_wave_bounds", near_wave(-0.9 * tail), one_wave())
    assert holds("one_wave_bounds", near_wave(1.1 * tail), one_wave()) is False
    assert holds("one_wave_bounds", near_wave(0.9 * tail, resistance=5), one_wave()) is False
    assert claims.evaluate("one_wave_bounds", [near_wave(0.2), one_wave()]).value == pytest.approx(0.2 / tail)


@pytest.mark.parametrize("name", list(claims.CLAIMS))
def test_without_the_curves_a_claim_is_not_measured(name: str) -> None:
    measured = claims.evaluate(name, [case(archard=np.nan, bem=np.nan)])
    assert measured.holds is None
    assert np.isnan(measured.value)
    assert measured.text.startswith("Not measured: ")


def test_unknown_claim(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no claim 'everything'.*twelve_elements, phase_spread"):
        claims.evaluate("everything", [])
    with pytest.raises(SceneError, match=r"scene test: claims: there is no claim 'everything'.*twelve_elements"):
        claims.check_names(scene_of(tmp_path, {}, archard_above=("a",), everything=("a",)))
    claims.check_names(scene_of(tmp_path, {}, **dict.fromkeys(claims.CLAIMS, ("a",))))


def test_a_new_claim_is_a_function_with_its_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing but the function is added, and the claim is checked, measured and written."""
    monkeypatch.setitem(claim.CLAIMS, "layer_exact", None)  # for its removal after the test

    @claim.claim("The layer is exact.", "largest error of the compliance, in g_0", paper_value=0.0)
    def layer_exact(cases: claim.Cases) -> claim.Measured:
        error = max(float(np.abs(readings.curve(each, "layer") - readings.numerical(each)).max()) for each in cases)
        return claim.judge(f"The largest error is {error:.2g} g_0.", error, [(error < 1e-6, "that is not exact")])

    scene = scene_of(tmp_path, {"smooth": estimate(0.1)}, layer_exact=("smooth",))
    claims.check_names(scene)
    claims.write(scene, tmp_path, tmp_path / "contact.nc", tmp_path / "claims.md")
    with netCDF4.Dataset(tmp_path / "contact.nc") as data:
        assert data["claim_statement"][:].tolist() == ["The layer is exact."]
        assert data["claim_measured"][0] == (
            "The largest error is 0.1 g_0. The statement does not hold here: that is not exact."
        )
        assert data["claim_quantity"][0] == "largest error of the compliance, in g_0"
        assert data["claim_paper_value"][0] == 0
        assert data["claim_measured_value"][0] == pytest.approx(0.1)
        assert data["claim_holds"][:].tolist() == [0]
    assert "| layer\\_exact | The layer is exact." in (tmp_path / "claims.md").read_text()
    assert claims.evaluate("layer_exact", [estimate(0.0)]).holds


def scene_of(folder: Path, studies: dict[str, xr.Dataset], **names: tuple[str, ...]) -> Scene:
    """A scene with these claims, whose studies are in the folder, each in a batch of its own name."""
    for name, data in studies.items():
        dataset.write(data, folder / f"{name}.nc", name)
    keys = {name: data["key"].values.tolist() for name, data in studies.items()}
    return cast(
        Scene,
        SimpleNamespace(
            name="test", title="A scene", text="title: A scene", claims=names, batches=studies,
            cases=dict.fromkeys(key for each in keys.values() for key in each),
            study=lambda name: [SimpleNamespace(key=key) for key in keys[name]], batches_of=lambda name: [name],
        ),
    )  # fmt: skip


def test_written_dataset_is_whole_and_plain(tmp_path: Path) -> None:
    studies = {"smooth": estimate(0.1), "rough": estimate(-0.1, D=1.5), "again": estimate(0.1)}
    names = {"archard_above": ("smooth", "rough"), "demelio_below": ("again",), "phase_spread": ("again",)}
    scene = scene_of(tmp_path, studies, **names)
    claims.write(scene, tmp_path, tmp_path / "contact.nc", tmp_path / "new" / "claims.md")
    with netCDF4.Dataset(tmp_path / "contact.nc") as data:
        assert data["D"][:].tolist() == [1.25, 1.5]  # each case once
        assert list(data["claim"][:]) == list(names)
        assert data["claim_holds"][:].tolist() == [0, 0, 2]
        assert data["claim_holds"].flag_meanings == "no yes not_measured"
        assert data["claim_measured_value"][0] == pytest.approx(-0.1)
        assert str(data["claim_statement"][0]).startswith("The Archard approximation overestimates")
        assert all(data[name].long_name and data[name].units for name in data.variables)
    again = dataset.read(tmp_path / "contact.nc")
    assert again["compliance"].sizes == {"case": 2, "solution_method": 4, "mean_pressure": LOADS.size}
    table = (tmp_path / "new" / "claims.md").read_text()
    assert [line.split(" | ")[-1] for line in table.splitlines() if line.startswith("| ")][2:] == [
        "no |", "no |", "not measured |",
    ]  # fmt: skip
    assert " p_0*" not in table


def test_scene_without_claims(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, {"smooth": estimate(0.1)})
    claims.write(scene, tmp_path, tmp_path / "contact.nc", tmp_path / "claims.md")
    assert "claim" not in dataset.read(tmp_path / "contact.nc").sizes
    assert "no claims" in (tmp_path / "claims.md").read_text()


def test_unknown_claim_writes_nothing(tmp_path: Path) -> None:
    made = tmp_path / "made"
    scene = scene_of(made, {"a": estimate(0)}, everything=("a",))
    with pytest.raises(ValueError, match="no claim 'everything'"):
        claims.write(scene, made, tmp_path / "contact.nc", tmp_path / "claims.md")
    assert [path.name for path in tmp_path.iterdir()] == ["made"]
