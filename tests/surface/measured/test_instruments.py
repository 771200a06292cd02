"""Lines of topographies: of stand-ins for the objects of SurfaceTopography, and of the package where it is there."""

import os
import sys
from types import ModuleType, SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from weier.surface.measured.trace import Trace

X, Y = np.arange(80), np.arange(40)
MAP = np.cos(2 * np.pi * X / 20)[:, None] + 0.1 * np.cos(2 * np.pi * Y / 10 + 1)[None, :]  # um


class Topography:
    """The interface of a topography for Trace."""

    is_uniform, is_periodic = True, False

    def __init__(self, heights, sizes, unit, **more):
        self._heights, self.physical_sizes, self.unit = heights, sizes, unit
        vars(self).update(more)

    def heights(self):
        """Of a map, the first axis is x."""
        return self._heights

    def positions(self):
        """Along x, where steps are not equal."""
        return self.x


def assert_same(trace, z, length):
    expected = Trace(z, length, height_unit="um", max_gap=5)
    assert trace.lambda_0 == pytest.approx(expected.lambda_0, rel=1e-14)
    assert trace.shortest == pytest.approx(expected.shortest, rel=1e-14)
    np.testing.assert_allclose(trace.amplitude * trace.g_0, expected.amplitude * expected.g_0, rtol=1e-12, atol=1e-20)


def test_a_line_scan_is_a_trace_with_its_unit():
    scan = Topography(MAP[:, 0], (400.0,), "\u00b5m")
    assert_same(Trace.of(scan), MAP[:, 0], 4e-4)
    assert Trace.of(scan).lambda_0 == 4e-4  # 400 * 1e-6 is 0.00039999999999999996
    with pytest.raises(ValueError, match="heights must have one unit, got unit='mm' and '\u03bcm' by itself"):
        Trace.of(scan, unit="mm")
    with pytest.raises(ValueError, match=r"length must be that of the file, 0.0004 m, got 0.001 m: leave it out"):
        Trace.of(scan, length=1e-3)
    with pytest.raises(ValueError, match="line and across are of maps, and this is one line of heights: leave them"):
        Trace.of(scan, line=3)
    with pytest.raises(ValueError, match="heights must have a unit"):
        Trace.of(Topography(MAP[:, 0], (400.0,), None))


def test_a_line_scan_of_given_positions_must_have_equal_steps():
    scan = Topography(MAP[:, 0], (395.0,), "um", is_uniform=False, x=5.0 * X)
    assert_same(Trace.of(scan), MAP[:, 0], 80 * 5e-6)
    with pytest.raises(ValueError, match="positions must rise in equal steps"):
        Trace.of(Topography(MAP[:, 0], (395.0,), "um", is_uniform=False, x=X**1.5))


def test_lines_of_a_map_run_along_one_of_its_axes():
    topography = Topography(MAP, (400.0, 160.0), "um")
    assert_same(Trace.of(topography, line=7), MAP[:, 7], 400 * 1e-6)
    assert_same(Trace.of(topography, line=9, across="y"), MAP[9], 160 * 1e-6)
    lines = Trace.of(topography, across="x", shortest=3e-5)
    assert [line.source for line in lines] == [f"x {number}" for number in Y]
    assert {line.shortest for line in lines} == {3e-5}
    assert lines[5].lambda_0 == pytest.approx(4e-4)
    assert len(Trace.of(topography, across="y")) == 80
    with pytest.raises(ValueError, match=r'a map of 80 by 40 heights has many lines: say line=0 .* or across="x"'):
        Trace.of(topography)
    with pytest.raises(ValueError, match="line must be a whole number, from 0 to 39, got 40"):
        Trace.of(topography, line=40)
    with pytest.raises(ValueError, match="across must be one of x, y, got 'z'"):
        Trace.of(topography, across="z")


def test_masked_heights_are_missing_and_a_line_that_is_wrong_is_named():
    masked = np.ma.masked_array(MAP, np.zeros(MAP.shape, bool))
    masked[30:32, 7] = np.ma.masked
    topography = Topography(masked, (400.0, 160.0), "um")
    assert_same(Trace.of(topography, line=6), MAP[:, 6], 4e-4)
    with pytest.raises(ValueError, match=r"^line x 7: 2 of 80 heights are missing, the first is height 31, at"):
        Trace.of(topography, line=7)
    with pytest.warns(UserWarning, match="1 of 40 lines are left out, for reasons such as: line x 7: 2 of 80"):
        lines = Trace.of(topography, across="x")
    assert [line.line for line in lines] == [*range(7), *range(8, 40)]
    with pytest.raises(ValueError, match="line y 0: heights must have a unit"):
        Trace.of(Topography(MAP, (400.0, 160.0), None), across="y")
    lines = Trace.of(topography, across="x", max_gap=5)
    assert [line.filled for line in lines] == [2 if number == 7 else 0 for number in Y]


def test_a_periodic_topography_is_continued_so():
    periodic = Topography(MAP, (400.0, 160.0), "um", is_periodic=True)
    assert Trace.of(periodic, line=3).ends == "periodic"
    assert Trace.of(periodic, line=3, ends="mirrored").ends == "mirrored"


def test_what_is_no_topography_is_refused():
    with pytest.raises(ValueError, match=r"topography must be one of SurfaceTopography, got 'map.x3p'"):
        Trace.of("map.x3p")


def test_without_the_package_one_sentence_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    (tmp_path / "map.x3p").write_bytes(b"\x01\x02\x00\x03")
    for more in ({}, {"line": 120}, {"across": "x"}):
        with pytest.raises(
            ValueError, match=r"to read the formats of instruments, pip install 'weier\[instruments\]'$"
        ):
            Trace.read(tmp_path / "map.x3p", **more)


@pytest.fixture
def surface_topography():
    return pytest.importorskip("SurfaceTopography", reason="the extra of instruments is not installed")


def write_map(surface_topography, path, heights=MAP):
    """A map of 400 by 160 um in the format of SurfaceTopography, which is netCDF."""
    topography = surface_topography.Topography(heights, (400.0, 160.0), unit="um")
    topography.to_netcdf(str(path))


def test_lines_of_a_file_are_those_of_its_map(surface_topography, tmp_path):
    path = tmp_path / "map.nc"
    write_map(surface_topography, path)
    lines = Trace.read(path, across="x")
    assert len(lines) == 40
    one = Trace.read(path, line=7)
    assert one.source == "map.nc, x 7"
    assert one.digest == lines[7].digest
    assert one.lambda_0 == pytest.approx(4e-4, rel=1e-9)
    expected = Trace(MAP[:, 7], 4e-4, height_unit="um")
    np.testing.assert_allclose(one.amplitude * one.g_0, expected.amplitude * expected.g_0, atol=1e-15)
    same = Trace.of(surface_topography.read_topography(str(path)), line=7)
    assert same.digest == one.digest
    with pytest.raises(ValueError, match=r"; skip, rows, columns, decimal are of text: leave them out"):
        Trace.read(path, line=7, columns=1)


def test_arguments_have_precedence_over_the_file_of_an_instrument(surface_topography, tmp_path):
    """Its reader may take nm for mm."""
    write_map(surface_topography, tmp_path / "map.nc")
    right = Trace.read(tmp_path / "map.nc", line=7)
    scaled = Trace.read(tmp_path / "map.nc", line=7, length=8e-4, height_unit="nm")
    assert scaled.lambda_0 == pytest.approx(2 * right.lambda_0)
    assert scaled.g_0 == pytest.approx(1e-3 * right.g_0)


def test_two_files_of_one_name_and_date_are_two(surface_topography, tmp_path, monkeypatch):
    traces = []
    for name, heights in (("a", MAP), ("b", 2 * MAP)):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        write_map(surface_topography, "map.nc", heights)
        os.utime("map.nc", (1e9, 1e9))
        traces.append(Trace.read("map.nc", line=7))
    assert traces[1].g_0 == pytest.approx(2 * traces[0].g_0)


@pytest.mark.parametrize("more", [{"line": 7}, {"across": "x"}])
def test_text_is_read_by_one_reader(tmp_path, more):
    """SurfaceTopography leaves out what it does not read."""
    path = tmp_path / "map.txt"
    path.write_text("\n".join(" ".join(f"{z:.4f}" for z in row) for row in MAP.tolist()).replace("-", "\u2212"))
    with pytest.raises(ValueError, match=r"line 1, has 40 columns, .*: say columns=\(0, 1\) .* columns=0"):
        Trace.read(path)
    with pytest.raises(ValueError, match=r"line 1, has 40 columns|is text, and line and across are of maps"):
        Trace.read(path, **more)
    assert_same(Trace.read(path, columns=7, length=4e-4, height_unit="um"), MAP[:, 7].round(4), 4e-4)


def test_a_file_that_the_package_cannot_read_either_is_refused(surface_topography, tmp_path):
    (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\x1a\n\0rough")
    with pytest.raises(ValueError, match=r"is no text: .*; SurfaceTopography cannot read it either"):
        Trace.read(tmp_path / "a.h5")
    (tmp_path / "a.h5").write_bytes(b"\x89HDF\r\n\0\n")  # eight bytes: as a terrain model, 2 by 2 heights
    with pytest.raises(ValueError, match=r"is no text: .*; SurfaceTopography finds no map of heights in it"):
        Trace.read(tmp_path / "a.h5", line=0)


def test_a_time_limit_is_no_damaged_file(tmp_path, monkeypatch):
    package = ModuleType("SurfaceTopography")
    package.open_topography = Mock(side_effect=TimeoutError)
    errors = SimpleNamespace(ReadFileError=type("ReadFileError", (Exception,), {}))
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
    monkeypatch.setitem(sys.modules, "SurfaceTopography.Exceptions", errors)
    (tmp_path / "a.opd").write_bytes(bytes(range(256)))
    with pytest.raises(TimeoutError):
        Trace.read(tmp_path / "a.opd")
    package.open_topography = Mock(side_effect=errors.ReadFileError)
    with pytest.raises(ValueError, match=r"SurfaceTopography cannot read it either \(ReadFileError\)"):
        Trace.read(tmp_path / "a.opd")


@pytest.mark.parametrize(("kind", "name"), [("x3p", "a.opd"), ("nms", "a.nms")])
def test_the_first_channel_of_heights_is_read(tmp_path, monkeypatch, kind, name):
    def channel(is_height, factor):
        scan = Topography(factor * MAP[:, 0], (400.0,), "um")
        return Mock(is_height_channel=is_height, physical_sizes=(400.0,), topography=lambda physical_sizes: scan)

    channels = [channel(False, 3), channel(True, 1), channel(True, 2)]
    package = ModuleType("SurfaceTopography")
    package.open_topography = lambda path: SimpleNamespace(format=lambda: kind, channels=channels)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
    monkeypatch.setitem(sys.modules, "SurfaceTopography.Exceptions", SimpleNamespace(ReadFileError=KeyError))
    (tmp_path / name).write_bytes(bytes(range(256)) + kind.encode())
    assert_same(Trace.read(tmp_path / name), MAP[:, 0], 4e-4)
    for kind, own in (("xyz", channels), ("nms", channels), ("x3p", channels[:1])):  # text, any bytes, no heights
        (tmp_path / "b.opd").write_bytes(bytes(range(256)) + kind.encode() * 2)
        package.open_topography = lambda path, kind=kind, own=own: SimpleNamespace(format=lambda: kind, channels=own)
        with pytest.raises(ValueError, match=f"finds no map of heights in it, and takes it for {kind}"):
            Trace.read(tmp_path / "b.opd")
