"""Files of text: their units, their missing heights, their encodings, and what is no table of heights."""

import re
import zipfile

import numpy as np
import pytest

from weier.surface.measured.trace import Trace
from weier.surface.measured.units import units_in

N = np.arange(200)
X = N / 200  # mm
Z = np.cos(2 * np.pi * N / 50) + 0.2 * np.cos(2 * np.pi * N / 9 + 1)  # um
RIGHT = Trace(Z, 1e-3, height_unit="um")


@pytest.fixture
def file(tmp_path):
    def write(text, name="shaft.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return write


def rows(z, x=None):
    return "\n".join(map(str, z) if x is None else (f"{a:.9g},{b}" for a, b in zip(x, z, strict=True)))


def assert_right(trace):
    assert trace.lambda_0 == pytest.approx(1e-3, rel=1e-12)
    assert trace.g_0 == pytest.approx(RIGHT.g_0, rel=1e-9)
    assert trace.m == RIGHT.m


@pytest.mark.parametrize(
    ("heading", "units"),
    [
        ("x (mm),z (um)", ["mm", "um"]),
        ("x_mm,z_um", ["mm", "um"]),
        ("x_mm z_um", ["mm", "um"]),
        ("[mm];[\u00b5m]", ["mm", "\u00b5m"]),
        ("mm um", ["mm", "um"]),
        ("x / mm; z / nm", ["mm", "nm"]),
        ("Lateral um,Raw Micrometer,", ["um", "um"]),
        ("X (MICRONS)\tZ (Angstroms)", ["um", "angstrom"]),
        ("x [in], z [A]", ["inch", "angstrom"]),
        ("x in um;z in um", ["um", "um"]),
        ("Value units: um", ["um"]),
        ("x (m),z (V)", ["m", ""]),
        ("x,z", ["", ""]),
        ("Pixel, in place", ["", ""]),
        ("Width: 12.34 um", []),
        ("M,a", ["", ""]),
    ],
)
def test_units_of_a_heading(heading, units):
    assert units_in(heading) == units


HEADINGS = [
    "x (mm),z (um)",
    "x_mm,z_um",
    "x [mm]\tz [\u00b5m]",
    "# x (mm), z (um)",
    "a shaft\nx,z\nmm,um",
    "# Channel: Profile\n# Lateral units: mm\n# Value units: \u03bcm",
    "# tip radius (nm)\nx / mm;z / um",
    "\n\nposition in millimeters, height in microns\n",
]


@pytest.mark.parametrize("heading", HEADINGS)
def test_units_that_a_file_names_count(file, heading):
    path = file(f"{heading}\n{rows(Z, X)}\n\n")
    assert_right(Trace.read(path))
    assert_right(Trace.read(path, x_unit="mm", height_unit="um"))
    with pytest.raises(ValueError, match=r"heights must have one unit, got height_unit='nm' and '.*' by itself"):
        Trace.read(path, height_unit="nm")
    with pytest.raises(ValueError, match="positions must have one unit, got unit='um' and 'mm' by itself"):
        Trace.read(path, unit="um")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_units_count_in_the_encodings_of_windows(file, encoding, ends):
    text = f"x (mm);z (\u00b5m)\n{rows(Z, X).replace(',', ';')}\n"
    assert_right(Trace.read(file(text.replace("\n", ends), encoding=encoding)))


@pytest.mark.parametrize("heading", ["height in um", "# Value units: um", "[\u00b5m]", "z_um", "# z (um)"])
def test_units_of_one_column(file, heading):
    path = file(f"{heading}\n{rows(Z)}")
    assert_right(Trace.read(path, length=1e-3))
    assert_right(Trace.read(path, length=1.0, x_unit="mm"))
    with pytest.raises(ValueError, match="heights must have one unit"):
        Trace.read(path, length=1.0, unit="mm")


def test_a_length_is_in_the_unit_that_is_given(file):
    path = file(rows(Z))
    assert_right(Trace.read(path, length=1.0, x_unit="mm", height_unit="um"))
    assert_right(Trace.read(path, length=1000.0, unit="um"))
    assert_right(Trace.read(path, length=1e-3, height_unit="um"))


@pytest.mark.parametrize("text", [rows(Z, X), f"x,z\n{rows(Z, X)}", f"# tip (um)\nx,z\n{rows(Z, X)}"])
def test_where_no_unit_is_known_none_is_taken(file, text):
    path = file(text)
    with pytest.raises(ValueError, match=r'heights must have a unit: name it, as in height_unit="um", or unit="m"'):
        Trace.read(path)
    with pytest.raises(ValueError, match=r'positions must have a unit: name it, as in x_unit="um", or unit="m"'):
        Trace.read(path, height_unit="um")
    assert_right(Trace.read(path, x_unit="mm", height_unit="um"))


GONE = np.isin(N, [60, 61, 90])


@pytest.mark.parametrize("written", ["", "# 0.5", "#0.5,", "nan", "NaN", "NA", "--", "***", "1.#QNAN"])
def test_what_is_missing_between_heights_closes_no_gap(file, written):
    """In one column: an empty line, a height behind #, or what programs write for a missing one."""
    path = file(rows(np.where(GONE, written, Z.astype(str))) + "\n# the end\n\n")
    with pytest.raises(ValueError, match=r"^3 of 200 heights are missing, the first is height 61, at most 2 beside"):
        Trace.read(path, length=1e-3, height_unit="um")
    filled = Trace.read(path, length=1e-3, height_unit="um", missing="interpolate")
    straight = Trace(np.interp(N, N[~GONE], Z[~GONE]), 1e-3, height_unit="um")
    np.testing.assert_allclose(filled.amplitude, straight.amplitude, rtol=1e-9, atol=1e-12)
    assert tuple(filled.filled) == (3, 2, 0)


def test_heights_behind_a_sign_at_the_end_are_missing_too(file):
    lines = rows(Z).split("\n")
    path = file("\n".join([*lines[:197], *(f"# {line}" for line in lines[197:]), "# the end", "", ""]))
    with pytest.raises(
        ValueError, match=r"^3 of 200 heights are missing, the first is height 198, 3 of them at the ends"
    ):
        Trace.read(path, length=1e-3, height_unit="um")
    cut = Trace.read(path, length=1e-3, height_unit="um", missing="interpolate")
    assert cut.lambda_0 == pytest.approx(1e-3 * 197 / 200)


def test_remarks_between_heights_are_no_heights(file):
    lines = rows(Z).split("\n")
    lines.insert(100, "# the lamp was changed")
    assert_right(Trace.read(file("\n".join(lines)), length=1e-3, height_unit="um"))


@pytest.mark.parametrize("written", [None, "", "nan", "-"])
def test_rows_that_are_left_out_of_two_columns_are_missing_heights(file, written):
    lines = [f"{x:.9g};{z}" if not gone else f"{x:.9g};{written}" for x, z, gone in zip(X, Z, GONE, strict=True)]
    if written is None:
        lines = [line for line, gone in zip(lines, GONE, strict=True) if not gone]
    path = file("x (mm);z (um)\n" + "\n".join(lines))
    with pytest.raises(ValueError, match=r"^3 of 200 heights are missing, the first is height 61, at most 2 beside"):
        Trace.read(path)
    filled = Trace.read(path, missing="interpolate")
    assert filled.lambda_0 == pytest.approx(1e-3, rel=1e-12)
    assert tuple(filled.filled) == (3, 2, 0)


def test_positions_that_are_rounded_need_a_length(file):
    path = file("x (um),z (um)\n" + "\n".join(f"{x:.1f},{z}" for x, z in zip(N / 6, Z, strict=True)))
    with pytest.raises(ValueError, match=r"ones that are rounded to 0.1: give the length, which is 200 steps, or"):
        Trace.read(path)
    trace = Trace.read(path, length=200 / 6, x_unit="um")
    assert trace.lambda_0 == pytest.approx(1e-6 * 200 / 6)
    assert trace.m == RIGHT.m
    with pytest.raises(ValueError, match=r"length must be that of 200 steps where positions go from 0 to 33.2"):
        Trace.read(path, length=40, x_unit="um")


COS = np.cos(2 * np.pi * np.arange(100) / 50)
EVEN = np.arange(100.0)
NUMBERS = "must have one or two numbers"


@pytest.mark.parametrize(
    ("text", "more", "says"),
    [
        ("It is rough,\nin places.\n", {}, "must have one or two columns of numbers, got none, but 'It is rough,'"),
        ("\n\n", {}, "shaft.csv must have one or two columns of numbers, got none"),
        ("1 2 3\n", {}, f"line 1, {NUMBERS}"),
        ("1 2\n3\n", {}, "shaft.csv, line 2, must have .* as many as the lines before, .* got '3'"),
        ("1 2\n3 four\n", {}, "shaft.csv, line 2, must have .* got '3 four'"),
        (rows(COS), {}, "length must be given where heights have no positions"),
        (rows(COS, EVEN), {"length": 1.0}, "length must be that of 100 steps where positions go from 0 to 99, about"),
        (rows(COS, EVEN**2), {}, "positions must rise in equal steps, got .*: interpolate the heights"),
        (rows(COS, np.zeros(100)), {}, "positions must rise in equal steps, and decimals have points, got 0.0"),
        (rows(COS, EVEN[::-1]), {}, "positions must rise in equal steps, .* got 99.0 at position 0"),
        ("0,5;1,25\n", {}, "shaft.csv, line 1, must have decimal points, got '0,5;1,25'"),
        ("x z\n0,5\t-1,25\n", {}, r"shaft.csv, line 2, must have decimal points, got '0,5\\t-1,25'"),
        (
            "0,5\n0,7\n" * 20,
            {},
            "positions must rise in equal steps, and decimals have points, got 0.0 at position 0",
        ),
        (rows(COS, np.where(EVEN == 50, np.nan, EVEN)), {}, f"line 51, {NUMBERS}"),
        (
            rows(np.where(EVEN == 9, np.inf, COS), EVEN),
            {},
            "heights must be finite or missing, got inf at position 9",
        ),
        ("1\n" * (10**6 + 1), {"length": 1.0}, "heights must be 16 to 1000000 numbers, got 1000001"),
        (rows(COS, EVEN), {"x_unit": "foot"}, "x_unit must be one of m, cm, mm, um, .*nm, .*, got 'foot'"),
        (rows(COS, EVEN), {"height_unit": "A"}, "height_unit must be one of m, cm, mm, um, .*nm, .*, got 'A'"),
    ],
)
def test_a_file_that_is_no_trace_is_refused_in_one_sentence(file, text, more, says):
    units = {"x_unit": "m", "height_unit": "m"}
    with pytest.raises(ValueError, match=says) as refused:
        Trace.read(file(text), **units | more)
    assert "\n" not in str(refused.value)


TEXT = f"x (mm),z (um)\n{rows(Z, X)}\n"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (TEXT.encode("utf-16"), "is UTF-16 text, not a table of heights as text: save it as UTF-8"),
        (TEXT.encode("utf-16-le"), "is UTF-16 text"),
        (TEXT.encode("utf-16-be"), "is UTF-16 text"),
        (TEXT.encode("utf-32"), "is UTF-32 text"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), r"old Office \(.xls\), .*: save the heights as text"),
        (b"\x1f\x8b\x08\x00", "is compressed by gzip, .*: unpack it"),
        (b"%PDF-1.7", "is a PDF document"),
        (b"\x89PNG\r\n\x1a\n", "is a PNG picture"),
        (b"\x89HDF\r\n\x1a\n", "is an HDF5 or netCDF file"),
        (b"\x93NUMPY\x01\x00", "is an array of NumPy, .*: take weier.Trace of what numpy.load returns"),
        (b"1.0\n\x00\x01\x02", "is no text"),
        (b"\x01\x00\x02\x00" * 100, "is no text"),
    ],
)
def test_what_is_no_text_is_named_by_its_first_bytes(file, content, says):
    with pytest.raises(ValueError, match=says) as refused:
        Trace.read(file(content))
    assert "point" not in str(refused.value)


@pytest.mark.parametrize(
    ("member", "says"),
    [
        ("xl/workbook.xml", r"is a workbook \(.xlsx\), .*: save its sheet as text"),
        ("content.xml", r"is a workbook or document of OpenDocument \(.ods\)"),
        ("main.xml", "is an X3P file of ISO 25178-72"),
        ("other", "is a zip archive"),
    ],
)
def test_archives_are_named_by_what_they_hold(tmp_path, member, says):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr(member, "")
    with pytest.raises(ValueError, match=says):
        Trace.read(tmp_path / "a.zip")


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"^there is no file .*nowhere\.csv$"):
        Trace.read(tmp_path / "nowhere.csv")
    with pytest.raises(FileNotFoundError, match=rf"^there is no file {re.escape(str(tmp_path))}: that is a folder$"):
        Trace.read(tmp_path)
    with pytest.raises(ValueError, match=r"^path must be the name of a file, got 5$"):
        Trace.read(5)


def test_a_trace_is_named_by_its_file(file):
    trace = Trace.read(file(TEXT))
    assert trace.source == "shaft.csv"
    assert trace.describe().startswith("trace shaft.csv of 200 heights over 0.001 m")
    assert Trace.read(file(TEXT), source="shaft, at 30 degrees").source == "shaft, at 30 degrees"
