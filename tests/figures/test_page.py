"""The page of a scene: it stands in one file, and works in a browser without a network."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from bokeh.embed import json_item
from bokeh.models import Line, Plot, Scatter, Select

import weier
from tests.scenes import blank, scene_in, solve_scene
from weier.data.variables import Status
from weier.figures import page, style
from weier.figures.page import explorer
from weier.methods import registry
from weier.pipeline.gather import read_cases

LOADS = np.geomspace(1e-2, 1, 5)
METHODS = ["demelio", "bem"]
CASES = [(1.25, 5, 2), (1.5, 5, 2), (1.5, 3, 2), (1.5, 3, 3)]
KEYS = [f"case{row}" for row in range(len(CASES))]
HERE = Path(__file__).parent
PNG = bytes.fromhex("89504e470d0a1a0a")
SCENE = {"title": "test", "loads": [0.02, 0.3, 1.5], "methods": ["demelio"]}


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
    for name in ("compliance", "resistance"):
        data[name].values[3, 0] = np.nan  # demelio has no curve of the last case
    data["phases"].values[:, :2] = 0, 1
    data["status"].values[:] = Status.solved
    return data


def write(folder, data, name="page.html", interface=None):
    """A page of all cases of some data."""
    text = page.render(data, "<b>Waves</b> & </script>", data.sizes["case"], interface)
    (folder / name).write_text(text, encoding="utf-8")
    return text


def test_the_page_opens_on_the_first_case_of_the_scene():
    """Not on the first one in the order of its lists, and with axes that follow the methods that count."""
    data = blank(2, ["persson", "patches"], LOADS, 3)
    for row, values in enumerate([(1.25, 5.0, 3), (1.25, 2.0, 2)]):
        for name, value in zip(("D", "gamma", "m"), values, strict=True):
            data[name].values[row] = value
    data["key"].values[:] = KEYS[:2]
    data["compliance"].values[:] = data["resistance"].values[:] = 1.0
    parts = explorer.curve_explorer(data)
    chosen = {select.name: select.value for select in parts.select({"type": Select})}
    assert (chosen["gamma"], chosen["m"]) == ("5", "3")
    ranges = {plot.name: plot.y_range for plot in parts.select({"type": Plot})}
    assert ranges["compliance"].start == 0
    assert np.isnan(ranges["resistance"].start)
    for own in ranges.values():
        assert [glyph.name for glyph in own.renderers] == ["contact patches"]


def test_the_page_needs_no_network(text):
    markup = re.sub(r"<script.*?</script>", "", text, flags=re.S)
    assert re.findall(r"<script[^>]*\ssrc=|<link[^>]*href=\"(?!data:)|@import", text) == []
    assert re.findall(r"(?:src|href)=\"(?!data:)([^\"]*)", markup) == []
    assert "<p>This page has all 4 cases.</p>" in markup


def test_text_of_a_scene_stays_text(text):
    assert "&lt;b&gt;Waves&lt;/b&gt; &amp; &lt;/script&gt;" in text


def test_same_data_same_page(folder):
    """Only the numbers of bokeh's models differ, which it counts through one process."""
    first, second = (re.sub(r"p\d{4,}", "p", write(folder, cases(), name)) for name in ("a.html", "b.html"))
    assert first == second


def test_a_method_looks_as_in_the_figures():
    """Contact patches are a black line, and boundary elements circles beside them, a black line without them."""
    loads = np.geomspace(1e-3, 10, 100)

    def glyphs(methods):
        data = blank(1, methods, loads, 3)
        data["compliance"].values[:] = data["resistance"].values[:] = 1.0
        data["key"].values[:] = "case"
        made = explorer.curve_explorer(data)
        json_item(made)  # what is drawn can be written, too
        plot = made.select_one({"name": "compliance"})
        return {item.label.value: line for item, line in zip(plot.legend.items, plot.renderers, strict=True)}

    both, alone = glyphs(["demelio", "bem", "patches"]), glyphs(["demelio", "bem"])
    for method in ("demelio", "patches"):
        look, glyph = style.line(method), both[style.line(method)["label"]].glyph
        assert isinstance(glyph, Line)
        assert glyph.line_color == look["color"]
        dashed = look["linestyle"] != "-"
        assert glyph.line_dash == ([round(2 * length) for length in look["linestyle"][1]] if dashed else [])
    circles = both["boundary elements"]
    assert isinstance(circles.glyph, Scatter)
    assert circles.glyph.line_color == style.line("bem")["color"]
    assert 20 < len(circles.view.filter.indices) <= 30
    assert isinstance(alone["boundary elements"].glyph, Line)


def test_a_page_of_many_cases_has_evenly_spread_ones_and_says_so(tmp_path, monkeypatch):
    many = {"product": {"D": [1.25, 1.5], "gamma": 5, "m": [1, 2], "seed": [*range(5)]}, "methods": ["archard"]}
    loaded = scene_in(tmp_path, SCENE | {"studies": {"many": many}})
    solutions = solve_scene(loaded, tmp_path / "curves")
    page.write(solutions, tmp_path / "page.html")
    assert "<p>This page has all 20 cases.</p>" in (tmp_path / "page.html").read_text()
    monkeypatch.setattr(page, "MAX_CASES", 8)
    read = []
    monkeypatch.setattr(page, "read_cases", lambda *given: read.append(given[1]) or read_cases(*given))
    page.write(solutions, tmp_path / "page.html")
    assert read[0].tolist() == [0, 3, 5, 8, 11, 14, 16, 19]
    assert "<p>This page has 8 of 20 cases, evenly spread" in (tmp_path / "page.html").read_text()


def test_the_explorer_lists_parameters_in_order_and_phases_with_their_seed():
    data = blank(4, METHODS, LOADS, 3)
    data["compliance"].values[:] = data["resistance"].values[:] = 1.0
    data["D"].values[:], data["gamma"].values[:] = 1.5, 5
    data["m"].values[:], data["phases"].values[:, :2] = [3, 1, 10, 3], [[0, 1]] * 4
    data = data.assign_coords(seed=("case", [7.0, np.nan, 8.0, 9.0]))
    made = explorer.curve_explorer(data)
    (choose,) = made.select_one({"name": "m"}).js_property_callbacks["change:value"]
    assert choose.args["labels"]["m"] == ["1", "3", "3", "10"]
    assert explorer._labels(data, "phase") == ["seed 7: 1", "1", "seed 8: 1", "seed 9: 1"]


def test_curves_are_in_si_units_where_the_scene_has_two_bodies(tmp_path):
    data = blank(1, METHODS, LOADS, 3)
    data["D"].values[:], data["gamma"].values[:], data["m"].values[:] = 1.5, 5, 2
    data["compliance"].values[:], data["resistance"].values[:] = 1 + LOADS, 2 + LOADS
    data["compliance_error"].values[:] = 1e-4
    bodies = dict.fromkeys(("mu_1", "mu_2"), 8e10) | dict.fromkeys(("nu_1", "nu_2"), 0.3)
    bodies |= dict.fromkeys(("rho_1", "rho_2"), 2e-7) | {"lambda_0": 1e-3, "g_0": 1e-6}
    interface = weier.Interface(**bodies)
    made = explorer.curve_explorer(data, interface)
    (choose,) = made.select_one({"name": "m"}).js_property_callbacks["change:value"]
    table = choose.args["allCurves"].data
    assert table["mean_pressure"] == pytest.approx(interface.pressure(LOADS), rel=1e-6)
    assert table["compliance demelio"] == pytest.approx(1e-6 * (1 + LOADS), rel=1e-6)
    assert table["compliance_error demelio"] == pytest.approx(1e-10, rel=1e-6)
    assert table["resistance demelio"] == pytest.approx(interface.resistance(2 + LOADS), rel=1e-6)
    assert made.select_one({"name": "compliance"}).yaxis.axis_label == "compliance h (m)"
    assert "ohm m^2" in write(tmp_path, data, interface=interface)


def with_script(page, name):
    """A page with one of the scripts of this folder at its end, which find elements."""
    script = "".join((HERE / script_file).read_text(encoding="utf-8") for script_file in ("find.js", name))
    return f"{page.rpartition('</body>')[0]}<script>{script}</script></body></html>"


def browse(folder, *arguments):
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:  # on a developer's machine; the gate installs one
        pytest.skip("there is no chromium to open the page in: apt-get install chromium")
    command = [
        browser,
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-background-networking",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        "--proxy-server=127.0.0.1:9",
        f"--user-data-dir={folder / 'browser'}",
        "--enable-logging=stderr",
        "--window-size=1100,1400",
        "--virtual-time-budget=10000",
        *arguments,
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert re.findall(r"CONSOLE.*(?:[Ee]rror|Uncaught|fail).*", done.stderr) == []
    assert "CONSOLE" in done.stderr  # bokeh greets there: without it nothing ran
    return done.stdout


def test_choosing_a_case_changes_the_curve(folder):
    text = (folder / "page.html").read_text(encoding="utf-8")
    (folder / "driven.html").write_text(with_script(text, "drive.js"), encoding="utf-8")
    shown = browse(folder, "--dump-dom", (folder / "driven.html").as_uri())
    result = re.search(r'<pre id="result">(.*?)</pre>', shown)
    start, rough, finer, longer = json.loads(result.group(1))
    assert start["compliance"] == pytest.approx(1 + LOADS)
    assert start["chosen"] == ["1.25", "5", "2", "1", "case"]
    assert not start["keyed"]  # the other labels distinguish all cases
    assert rough["compliance"] == pytest.approx(2 + LOADS)
    assert finer["compliance"] == pytest.approx(3 + LOADS)
    assert finer["resistance"] == pytest.approx(6 + LOADS)
    assert finer["chosen"] == ["1.5", "3", "2", "1", "case"]
    assert finer["named"] == [True, True]
    assert longer["compliance"] == pytest.approx(4 + LOADS)
    assert longer["named"] == [False, True]  # there is no such curve


def test_a_narrow_window_is_wide_enough(tmp_path):
    """With all methods, random phases, and cases that differ in nothing but their keys."""
    data = blank(2, registry.names(), LOADS, 6)
    data["compliance"].values[:] = data["resistance"].values[:] = 1.0
    data["phases"].values[:] = np.random.default_rng(0).uniform(0, 6, 6)
    data["key"].values[:] = "0123456789ab", "ba9876543210"
    text = write(tmp_path, data)
    (tmp_path / "measured.html").write_text(with_script(text, "measure.js"), encoding="utf-8")
    shutil.copy(HERE / "frame.html", tmp_path)
    text = browse(tmp_path, "--dump-dom", (tmp_path / "frame.html").as_uri())
    widths = json.loads(re.search(r'<pre id="result">(.*?)</pre>', text).group(1))
    assert widths["page"] == widths["window"] <= 420  # the frame, less a bar to scroll up and down
    assert len(widths["ends"]) >= 5 + 2  # drop-downs and plots
    assert max(widths["ends"]) <= widths["window"]


def test_an_error_in_the_browser_fails_a_test(folder):
    """So the tests above can fail."""
    (folder / "broken.html").write_text("<script>undefined.curve</script>")
    with pytest.raises(AssertionError, match="Uncaught"):
        browse(folder, "--dump-dom", (folder / "broken.html").as_uri())
