"""The page of a scene: it stands in one file, and works in a browser without a network."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import weier
from tests.scenes import blank
from weier.data.variables import Status
from weier.figures import page

LOADS = np.geomspace(1e-2, 1, 5)
METHODS = ["demelio", "bem"]
CASES = [(1.25, 5, 2), (1.5, 5, 2), (1.5 + 1e-9, 5, 2), (1.5, 3, 3)]  # the third has the name of the second
KEYS = [f"case{row}" for row in range(len(CASES))]
HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def text(folder):
    return (folder / "page.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("a scene")
    write(folder, cases())
    return folder


def cases():
    data = blank(len(CASES), METHODS, LOADS, 3)
    for row, values in enumerate(CASES):
        for name, value in zip(("D", "gamma", "m"), values, strict=True):
            data[name].values[row] = value
        data["key"].values[row] = KEYS[row]
        data["compliance"].values[row] = row + 1 + LOADS
        data["resistance"].values[row] = 2 * (row + 1) + LOADS
    data["phases"].values[:, :2] = 0, 1
    data["status"].values[:] = Status.solved
    return data


def write(folder, data, name="page.html", interface=None):
    """A page of all cases of some data."""
    text = page.render(data, "<b>Waves</b> & </script>", data.sizes["case"], interface)
    (folder / name).write_text(text, encoding="utf-8")
    return text


def test_the_page_needs_no_network(text):
    markup = re.sub(r"<script.*?</script>", "", text, flags=re.S)
    assert re.findall(r"<script[^>]*\ssrc=|<link[^>]*href=\"(?!data:)|@import", text) == []
    assert re.findall(r"(?:src|href)=\"(?!data:)([^\"]*)", markup) == []
    assert "<p>This page has all 4 cases.</p>" in markup
    assert "&lt;b&gt;Waves&lt;/b&gt; &amp; &lt;/script&gt;" in text  # the title of a scene stays text


def test_same_data_same_page(folder):
    """Only the numbers of bokeh's models differ, which it counts through one process."""
    first, second = (re.sub(r"p\d{4,}", "p", write(folder, cases(), name)) for name in ("a.html", "b.html"))
    assert first == second


def test_curves_are_in_si_units_where_the_scene_has_two_bodies():
    data = blank(1, METHODS, LOADS, 3)
    data["D"].values[:], data["gamma"].values[:], data["m"].values[:] = 1.5, 5, 2
    data["compliance"].values[:], data["resistance"].values[:] = 1 + LOADS, 2 + LOADS
    data["compliance_error"].values[:] = 1e-4
    bodies = dict.fromkeys(("mu_1", "mu_2"), 8e10) | dict.fromkeys(("nu_1", "nu_2"), 0.3)
    bodies |= dict.fromkeys(("rho_1", "rho_2"), 2e-7) | {"lambda_0": 1e-3, "g_0": 1e-6}
    interface = weier.Interface(**bodies)
    made = page.explorer(data, interface)
    table = made.select_one({"name": "curve demelio"}).data
    assert table["mean_pressure"] == pytest.approx(interface.pressure(LOADS), rel=1e-6)
    assert table["compliance"] == pytest.approx(1e-6 * (1 + LOADS), rel=1e-6)
    assert table["compliance_error"] == pytest.approx(1e-10, rel=1e-6)
    assert table["resistance"] == pytest.approx(interface.resistance(2 + LOADS), rel=1e-6)
    assert made.select_one({"name": "compliance"}).yaxis.axis_label == "compliance h (m)"
    assert made.select_one({"name": "resistance"}).yaxis.axis_label.endswith("(Omega m^2)")


def test_each_case_is_shown_at_the_loads_of_its_study():
    data = cases()
    for name in ("compliance", "resistance"):
        data[name].values[1, :, ::2] = np.nan
    (table, *_), count = page._tables(data)
    pressures, h = (table[name].reshape(len(CASES), count) for name in ("mean_pressure", "compliance"))
    assert pressures[1, :2] == pytest.approx(LOADS[1::2])
    assert h[1, :2] == pytest.approx(2 + LOADS[1::2])
    assert np.isnan(pressures[1, 2:]).all()
    assert pressures[2] == pytest.approx(LOADS)


def browse(folder, *arguments):
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:  # on a developer's machine; the gate installs one
        pytest.skip("there is no chromium to open the page in: apt-get install chromium")
    command = [
        browser,
        "--headless",
        "--no-sandbox",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        f"--user-data-dir={folder / 'browser'}",
        "--enable-logging=stderr",
        "--virtual-time-budget=10000",
        *arguments,
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert re.findall(r"CONSOLE.*(?:[Ee]rror|Uncaught|fail).*", done.stderr) == []
    assert "CONSOLE" in done.stderr  # bokeh greets there: without it nothing ran
    return done.stdout


def test_choosing_a_case_changes_the_curve(folder, text):
    script = (HERE / "drive.js").read_text(encoding="utf-8")
    driven = f"{text.rpartition('</body>')[0]}<script>{script}</script></body></html>"
    (folder / "driven.html").write_text(driven, encoding="utf-8")
    shown = browse(folder, "--dump-dom", (folder / "driven.html").as_uri())
    first, third = json.loads(re.search(r'<pre id="result">(.*?)</pre>', shown).group(1))
    assert first["compliance"] == pytest.approx(1 + LOADS)
    assert third["compliance"] == pytest.approx(3 + LOADS)
    assert third["resistance"] == pytest.approx(6 + LOADS)
