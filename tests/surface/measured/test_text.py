"""Files of text: each dialect gives the reference line, or a refusal with its line and what to do."""

import re

import numpy as np
import pytest

from weier.surface.measured.lines import heading_of
from weier.surface.measured.trace import Trace

N = np.arange(200)
X = N / 200  # mm
Z = np.cos(2 * np.pi * N / 50) + 0.2 * np.cos(2 * np.pi * N / 9 + 1)  # um
RIGHT = Trace(Z, 1e-3, height_unit="um")
UNITS = {"x_unit": "mm", "height_unit": "um"}
ALONE = {"length": 1e-3, "height_unit": "um"}


@pytest.fixture
def file(tmp_path):
    def write(text, name="shaft.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return write


def written(z):
    return f"{z:.6f}"


def column(heights=None, heading="z (um)\n", end=""):
    return heading + "".join(f"{z}{end}\n" for z in (map(written, Z) if heights is None else heights))


def columns(delimiter=",", heading="x (mm),z (um)\n", x=X, z=written, end=""):
    """Positions as texts or with four decimals, and heights as texts or as they are written by a function."""
    places = x if isinstance(x, list) else [f"{place:.4f}" for place in x]
    heights = z if isinstance(z, list) else map(z, Z)
    return heading + "".join(f"{place}{delimiter}{z}{end}\n" for place, z in zip(places, heights, strict=True))


def decimal_commas(text):
    return re.sub(r"(?<=\d)\.(?=\d)", ",", text)


def with_line(text, line, at=101):
    """The text with a line put in, or appended at the end."""
    lines = text.split("\n")
    return "\n".join([*lines[:at], line, *lines[at:]])


def assert_right(trace, tolerance=1e-5):
    """The same length, and the same waves but for the digits that are written."""
    assert trace.lambda_0 == pytest.approx(1e-3, rel=tolerance)
    assert trace.samples == 200
    expected = RIGHT.amplitude * RIGHT.g_0
    assert trace.m >= RIGHT.m
    np.testing.assert_allclose((trace.amplitude * trace.g_0)[: RIGHT.m], expected, atol=tolerance * RIGHT.g_0)


MINUS = "\u2212"
ORDINARY = {
    "commas": (columns(), {}),
    "commas and blanks": (columns(", "), {}),
    "blanks": (columns("   ", "x (mm) z (um)\n"), {}),
    "decimal commas and semicolons": (decimal_commas(columns(";")), {}),
    "decimal commas and tabs": (decimal_commas(columns("\t")), {}),
    "decimal commas and blanks": (decimal_commas(columns(" ")), {}),
    "decimal commas in one column": (decimal_commas(column()), {"length": 1e-3}),
    "decimal commas in one column without heading": (decimal_commas(column(heading="")), ALONE),
    "whole numbers": (
        columns(x=[str(5 * n) for n in N], z=lambda z: f"{1e6 * z:.0f}", heading="x (um),z (pm)\n"),
        {"decimal": "."},
    ),
    "quotes around heights": (columns(z=lambda z: f'"{z:.6f}"'), {}),
    "quotes around lines": ("".join(f'"{line}"\n' for line in columns().splitlines()), {}),
    "semicolons at the ends": (columns(";", "x (mm);z (um);\n", end=";"), {}),
    "semicolons at the ends of one column": (column(end=";"), {"length": 1e-3}),
    "exponents of Fortran": (columns(z=lambda z: f"{z:.6E}".replace("E", "D")), {}),
    "printed minus": (columns(z=lambda z: written(z).replace("-", MINUS)), {}),
    "no zero before decimals": (columns(z=lambda z: written(z).replace("0.", ".")), {}),
    "signs of plus": (columns(z=lambda z: f"{z:+.6f}"), {}),
    "ends of lines of Windows": (columns().replace("\n", "\r\n"), {}),
    "ends of lines of an old Macintosh": (column().replace("\n", "\r"), {"length": 1e-3}),
    "ends of lines converted twice": (column().replace("\n", "\r\r\n"), {"length": 1e-3}),
    "no end of the last line": (columns().rstrip("\n"), {}),
    "remarks below": (columns() + "\n# made by an instrument\n# Ra (um): 0.7\n\n", {}),
    "empty lines between rows": (columns().replace("\n", "\n\n"), {}),
    "a header block": ("Cutoff (mm),0.25\nDate,2024-01-01\nPoints,200\n" + columns(), {}),
    "units in a line of their own": (columns(heading="X,Z\nmm,um\n"), {}),
    "one unit for both": (
        columns("  ", "Profile 1\nx  y1\n[m]  [m]\n", [f"{x:.6e}" for x in X / 1e3], lambda z: f"{z / 1e6:.6e}"),
        {},
    ),
    "a heading as a remark": (columns(heading="# x (mm), z (um)\n"), {}),
    "a rule below the heading": (columns(heading="x (mm),z (um)\n----------\n"), {}),
    "heights first": (columns(heading="z [um],x [mm]\n", x=list(map(written, Z)), z=[f"{x:.4f}" for x in X]), {}),
    "exponents of three digits": (columns(z=lambda z: re.sub(r"(e[-+])", r"\g<1>0", f"{z:.6e}")), {}),
    "signs of units in one": (columns(heading="x (\u339c),z (\uff55\uff4d)\n"), {}),
    "positions with three decimals": (columns(x=[f"{x:.3f}" for x in X]), {}),
    "negative positions by a printed minus": (columns(x=[f"{x - 0.5:.3f}".replace("-", MINUS) for x in X]), {}),
}


@pytest.mark.parametrize(("text", "more"), ORDINARY.values(), ids=ORDINARY)
def test_ordinary_files_are_read(file, text, more):
    assert_right(Trace.read(file(text), **more))


RARE = {
    "decimal commas in quotes": "".join(
        f'"{x:.4f}","{z:.6f}"\n'.replace(".", ",") for x, z in zip(X, Z, strict=True)
    ),
    "quotes without an end": columns().replace("0.5000,", '0.5000,"'),
    "positions with two digits": columns(x=[f"{x:.2g}" for x in X]),
    "blanks in words": columns(" ", z=["No Data" if n == 60 else written(z) for n, z in enumerate(Z)]),
    "single quotes": columns(z=lambda z: f"'{z:.6f}'"),
    "a sign in another channel": columns(";", end=";-"),
}


@pytest.mark.parametrize("text", RARE.values(), ids=RARE)
@pytest.mark.parametrize("more", [UNITS, UNITS | {"columns": (0, 1)}, ALONE | {"columns": 1}])
def test_rare_dialects_are_right_or_refused(file, text, more):
    refused = None
    try:
        assert_right(Trace.read(file(text), **more))
    except ValueError as error:
        refused = str(error)
    assert refused is None or re.search(r"(line|height) \d+", refused)


ENDS = ["\n", "\r\n", "  \n", "\t\n", " \n\t\n\n", "\u00a0\n", ";\n", ",,\n,,\n", "\f\n"]


@pytest.mark.parametrize("end", ENDS)
def test_empty_lines_at_the_end_are_nothing(file, end):
    for more in ({}, {"skip": 1}, {"rows": 200}):
        assert_right(Trace.read(file(column() + end), length=1e-3, **more))
        assert_right(Trace.read(file(columns() + end), **more))
    index = "".join(f"{n};{z:.6f};{x:.4f}\n" for n, x, z in zip(N, X, Z, strict=True))
    assert_right(Trace.read(file(index + end), columns=1, **ALONE))
    assert_right(Trace.read(file((column() + end).replace("\n", "\r")), length=1e-3))
    with pytest.raises(ValueError, match="rows must be at most the 200 rows"):
        Trace.read(file(column() + end), length=1e-3, rows=201)


def apart(form):
    """A table with the sign apart from each height."""
    signs = ["-" if z < 0 else "" for z in Z]
    return "".join(
        form.format(x=f"{x:.4f}", s=s, p=s or "+", w="minus" if s else "plus", b="(" if s else "", z=f"{abs(z):.6f}")
        for x, s, z in zip(X, signs, Z, strict=True)
    )


APART = {
    "{x};{s};{z}\n": (0, 2),
    "{x}\t{w}\t{z}\n": (0, 2),
    "{x};{b};{z}\n": (0, 2),
    "{s};{z}\n": 1,
    "{p} {z}\n": 1,
    "{z};{s}\n": 0,
    "{x} {s} {z}\n": (0, 2),
}


@pytest.mark.parametrize("form", APART)
@pytest.mark.parametrize("minus", ["-", MINUS])
def test_a_sign_apart_from_its_number_is_never_lost(file, form, minus):
    path, given = file(apart(form).replace("-", minus)), APART[form]
    units = UNITS if isinstance(given, tuple) else ALONE
    with pytest.raises(ValueError, match=r"line \d+, (has|stands)"):
        Trace.read(path, columns=given, **units)
    with pytest.raises(ValueError, match=r"line \d+, |positions must"):
        Trace.read(path, **UNITS | units)


def beside(entries, heading="", z=Z):
    """Heights between positions and a column of these entries, in turn."""
    return heading + "".join(f"{x:.4f};{entries[n % len(entries)]};{z[n]:.6f}\n" for n, x in enumerate(X))


@pytest.mark.parametrize("text", [beside("-", z=Z + 2), beside("ab"), beside("abc")])
def test_entries_that_may_be_signs_or_marks_are_refused(file, text):
    with pytest.raises(ValueError, match=r"line \d, has an entry in column 1 that may be a sign, or mark heights"):
        Trace.read(file(text), columns=(0, 2), **UNITS)


@pytest.mark.parametrize("text", [beside("a"), beside("abcd"), beside("0123", "x;No.;z\n")])
def test_other_entries_beside_heights_are_left_out(file, text):
    assert_right(Trace.read(file(text), columns=(0, 2), **UNITS))


def test_a_number_that_only_one_column_has_is_no_height(file):
    """A parameter or a count at an end, beside a word or among missing heights."""
    for text in (columns() + "Ra (um),0.700000\n", "Ra (um),0.700000\n" + columns(heading="")):
        with pytest.raises(ValueError, match=r"line \d+, stands (above|below) the numbers, .* (skip|rows)="):
            Trace.read(file(text), columns=1, length=1e-3, height_unit="um")
    assert_right(Trace.read(file(columns() + "Ra (um),0.7\n"), columns=1, length=1e-3, rows=200))
    whole = ["nan" if n % 5 == 0 else f"{100 * z:.0f}" for n, z in enumerate(Z)]
    path = file(column(whole) + "200\n")
    says = r"line 202, may be a count, .* rows=201 if it is a height"
    with pytest.raises(ValueError, match=says):
        Trace.read(path, **ALONE)
    for rows in (201, 200):
        with pytest.raises(ValueError, match=f"^40 of {rows} heights are missing"):
            Trace.read(path, rows=rows, **ALONE)


@pytest.mark.parametrize("heading", ["", "z (um)\n"])
@pytest.mark.parametrize("given", [0, 1])
def test_decimals_behind_commas_are_no_column(file, heading, given):
    path = file(decimal_commas(column(heading=heading)))
    with pytest.raises(ValueError, match=r"line \d+, has a comma of decimals, .* say decimal=',' .*pandas"):
        Trace.read(path, columns=given, **ALONE)
    assert_right(Trace.read(path, columns=0, decimal=",", **ALONE))


@pytest.mark.parametrize(("yes", "no"), [("1", "0"), ("true", "false"), ("1.0", "")])
def test_heights_that_a_column_marks_as_invalid_are_refused(file, yes, no):
    def table(height, mark):
        rows = [f"{written(z)};{yes}" for z in Z]
        rows[60] = f"{height};{mark}"
        return file(columns(";", "x;z;g\u00fcltig\nmm;um;-\n", z=rows))

    assert_right(Trace.read(table(written(Z[60]), yes), columns=(0, 1)))
    for more in ({"columns": (0, 1)}, {"columns": 1, "length": 1e-3}):
        with pytest.raises(
            ValueError, match=r"line 63, has an entry in column 2 that may be a sign, or mark .* nan for .* pandas"
        ):
            Trace.read(table(written(Z[60]), no), **more)
    with pytest.raises(ValueError, match=r"^1 of 200 heights are missing, the first is height 61, "):
        Trace.read(table("nan", no), columns=(0, 1))


# Files that may be read in two ways: what the message says, and the argument that settles it.
TIMES = "t;x (mm);z (um);note\n" + "".join(
    f"2024-01-01 12:00;{x:.3f};{z:.6f};good one\n" for x, z in zip(X, Z, strict=True)
)
INDEX = "".join(f"{n},{x:.4f},{z:.6f}\n" for n, x, z in zip(N, X, Z, strict=True))
NM = [f"{1e3 * z:,.0f}" for z in Z]
NM_3 = [f"{1e3 * z:,.3f}" for z in Z]
SETTLED = {
    "commas for all": (decimal_commas(columns()), {}, "has a comma of decimals, between columns or", None),
    "decimals or thousands": (
        column([f"{z + 3:.3f}" for z in Z]),
        {"length": 1e-3},
        r"got '4\.108': say decimal='\.' for decimals",
        {"decimal": "."},
    ),
    "three columns": (INDEX, UNITS, r"line 1, has 3 columns, .* say columns=\(0, 1\)", {"columns": (1, 2)}),
    "a column behind the last": (
        columns(";", end=";"),
        {"columns": (0, 2)},
        "line 2, has 2 columns",
        {"columns": (0, 1)},
    ),
    "columns of text": (TIMES, {}, "say columns=", {"columns": [1, 2]}),
    "a step too many": (
        with_line(columns(), "0.5001,0.9"),
        {},
        r"positions must rise in equal steps, got 0\.5\d* at height 10\d",
        None,
    ),
    "empty lines in one column": (column().replace("\n", "\n\n"), {"length": 1e-3}, "line 2, stands above", None),
    "an empty line in one column": (
        with_line(column(), ""),
        {"length": 1e-3},
        "line 102, does not have the number of columns .* write nan if a height is missing, leave out an empty line",
        None,
    ),
    "text below one column": (column() + "END\n", {"length": 1e-3}, "line 202, .* rows=200", {"rows": 200}),
    "numbers below": (columns() + "Ra (um),0.7\n", {}, "line 202, .* rows=200", {"rows": 200}),
    "a second table": (columns() + "\n" + columns(), {}, "line 203, .* say .* rows=", {"rows": 200}),
    "a count above": (column(heading="200\n"), ALONE, "line 1, may be a count, .* skip=0", {"skip": 1}),
    "a step above": (column(heading="z (um)\n0.005\n"), ALONE, "line 2, may be a count, a step", {"skip": 2}),
    "a count below": (column() + "200\n", ALONE, "line 202, may be a count, .* rows=201", {"rows": 200}),
    "a title above one column": (column(heading="shaft\n"), ALONE, "line 1, stands above .* skip=1", {"skip": 1}),
    "a quantity above": (columns(heading="Cutoff (mm),0.25\n"), UNITS, "line 1, .* say skip=1", {"skip": 1}),
    "wrong units": (columns(heading="x (um),z (um)\n"), {}, "is a unit wrong", {"x_unit": "mm"}),
}


@pytest.mark.parametrize(("text", "more", "says", "settled"), SETTLED.values(), ids=SETTLED)
def test_what_is_not_clear_is_refused_and_settled_by_an_argument(file, text, more, says, settled):
    with pytest.raises(ValueError, match=says) as refused:
        Trace.read(file(text), **more)
    assert "\n" not in str(refused.value)
    if settled is not None:
        trace = Trace.read(file(text), **more | settled)
        assert_right(trace, 1e-3)


# Dialects for pandas.
FOREIGN = {
    "pipes": (columns("|"), UNITS),
    "whole numbers or decimals": (column([f"{z:.1f}".replace(".", ",") for z in Z], ""), ALONE),
    "thousands": (column(NM), ALONE),
    "thousands with blanks": (column([z.replace(",", " ") for z in NM]), ALONE),
    "thousands with apostrophes": (column([z.replace(",", "'") for z in NM_3]), ALONE),
    "a remark within": (with_line(columns(), "# lamp changed"), {}),
    **{name: (text.encode(name), UNITS) for name in ("utf-16-le", "utf-16-be", "cp037") for text in (columns(),)},
}


@pytest.mark.parametrize(("text", "more"), FOREIGN.values(), ids=FOREIGN)
def test_what_is_for_pandas_is_refused(file, text, more):
    with pytest.raises(ValueError, match=r"line \d+.*(pandas.read_csv|say skip=)"):
        Trace.read(file(text), **more)


WORDS = ["OVER", "No Data", "<1.3", "0.5um", "inf", "1e400", "0x1p3", "1_000", "(0.5)", "0.5-", "# 0.5", "1.2.3"]


@pytest.mark.parametrize("word", [*WORDS, "\u0663", "----"])
@pytest.mark.parametrize(("rows", "heading"), [([0], ""), ([100], "z (um)\n"), (range(150, 200), "z (um)\n")])
def test_words_are_never_left_out(file, word, rows, heading):
    """They are no numbers and not known for missing heights: in one column, and beside positions."""
    heights = [word if n in rows else written(z) for n, z in enumerate(Z)]
    places = [word if n in rows else f"{x:.4f}" for n, x in enumerate(X)]
    texts = [(column(heights, heading), ALONE), (columns(z=heights), UNITS), (columns(x=places, z=heights), UNITS)]
    for text, more in texts[: 2 if rows == [0] else 3]:  # a row without numbers above others is a heading
        with pytest.raises(ValueError, match=r"line \d+, .*(write nan|columns=)"):
            Trace.read(file(text), **more)


def test_numbers_for_missing_heights_are_given(file):
    heights = ["-9999" if n in (60, 61) else "88" if n == 90 else written(z) for n, z in enumerate(Z)]
    filled = Trace.read(file(columns(z=heights)), missing_value=[-9999, 88], max_gap=5)
    assert filled.filled == 3


KNOWN = ["nan", "NaN", "#N/A", "#NV", "-nan(ind)", "1.#QNAN"]


@pytest.mark.parametrize("word", [*KNOWN, "--"])
@pytest.mark.parametrize("rows", [[60, 61, 90], range(150, 200)])
def test_known_words_are_missing_heights(file, word, rows):
    heights = [word if n in rows else written(z) for n, z in enumerate(Z)]
    says = rf"^{len(rows)} of 200 heights are missing, the first is height {rows[0] + 1}, "
    if word in KNOWN or rows[0] == 60:
        with pytest.raises(ValueError, match=says):
            Trace.read(file(column(heights)), length=1e-3)
    else:  # They may also be a rule above or below the table.
        with pytest.raises(ValueError, match=r"line \d+, stands (above|below) the numbers"):
            Trace.read(file(column(heights)), length=1e-3)
    with pytest.raises(ValueError, match=says):
        Trace.read(file(columns(z=heights)))


@pytest.mark.parametrize(
    ("heading", "units"),
    [
        ("x (mm),z (um)", ["mm", "um"]),
        ("x_mm z_um", ["mm", "um"]),
        ("x (mm) z (um)", ["mm", "um"]),
        ("x (mm) , z (um)", ["mm", "um"]),
        ("[mm];[\u00b5m]", ["mm", "\u03bcm"]),
        ("mm um", ["mm", "um"]),
        ("x / mm; z / nm", ["mm", "nm"]),
        ("Lateral um,Raw Micrometer,", ["um", "um"]),
        ("X (MICRONS)\tZ (Angstroms)", ["um", "angstrom"]),
        ("Value units: um", ["um"]),
        ("Profile 1 (um)", [""]),
        ("x (m),z (V)", ["m", ""]),
        ("Pixel, in place", ["", ""]),
        ("Width: 12.34 um", [""]),
        ("M,a", ["", ""]),
        ("z [10 um]", [""]),
        ("z (nm) [um]", [""]),
        ("x1 (mm);z1 (um)", ["mm", "um"]),
        ("z, um", ["um"]),
        ("z [\u212b]", ["angstrom"]),
        ("Heights in um, step in mm", [""]),
        ("R profile, cutoff in mm", [""]),
        ("z in tenths of um", [""]),
        ("z 10\u207b\u00b9 um", [""]),
        ("z [\u339b\u00b2]", [""]),
        ("Ra (um)", [""]),
    ],
)
def test_units_of_a_heading(heading, units):
    assert [unit for _, unit in heading_of(heading, len(units), ";")] == units


@pytest.mark.parametrize("heading", ["x (mm)", "Position [mm]", "Profile length (mm)"])
def test_a_heading_of_positions_is_none_of_heights(file, heading):
    with pytest.raises(ValueError, match="heights must have a unit"):
        Trace.read(file(column(heading=f"{heading}\n")), length=1e-3, skip=1)
    with pytest.raises(ValueError, match="heights must have a unit"):
        Trace.read(file(columns(heading=f"s (mm),{heading}\n")), columns=(0, 1))
    with pytest.raises(ValueError, match="positions must have a unit"):
        Trace.read(file(columns(heading="Height (um),step of heights\n")), height_unit="um")


def test_a_unit_for_both_must_agree_with_the_heading(file):
    for heading, unit in (("x (mm),z (um)", "um"), ("x (mm),z (um)", "mm"), ("x (um),z (nm)", "mm")):
        with pytest.raises(ValueError, match=rf"must have one unit, got unit='{unit}' and '(mm|um|nm)' by itself"):
            Trace.read(file(columns(heading=f"{heading}\n")), unit=unit)


def test_a_call_has_one_unit_of_length(file):
    path = file(column())
    assert_right(Trace.read(path, length=1.0, x_unit="mm"))
    assert_right(Trace.read(file(column(heading=""), "bare.csv"), length=1.0, x_unit="mm", height_unit="um"))
    cut = Trace.read(path, length=1.0, x_unit="mm", shortest=0.05)
    assert cut.shortest == pytest.approx(5e-5)
    assert Trace.read(path, length=1e-3, shortest=5e-5).digest == cut.digest
    of_file = Trace.read(file(columns(heading="x,z (um)\n"), "two.csv"), x_unit="mm", shortest=0.05)
    assert of_file.shortest == pytest.approx(5e-5)
    with pytest.raises(ValueError, match=r"between two steps and the length of the trace, 0\.01 and 1 mm, got 5e-05"):
        Trace.read(path, length=1.0, x_unit="mm", shortest=5e-5)


@pytest.mark.parametrize(
    "text", [columns(heading=""), columns(heading="x,z\n"), columns(heading="# tip (um)\nx,z\n")]
)
def test_where_no_unit_is_known_none_is_taken(file, text):
    path = file(text)
    with pytest.raises(ValueError, match=r'heights must have a unit: name it, as in height_unit="um", or unit="m"'):
        Trace.read(path)
    with pytest.raises(ValueError, match=r'positions must have a unit: name it, as in x_unit="um", or unit="m"'):
        Trace.read(path, height_unit="um")
    assert_right(Trace.read(path, **UNITS))


@pytest.mark.parametrize(
    ("text", "more", "says"),
    [
        ("It is rough,\nin places.\n", {}, "line 2, and the others, are no rows of numbers, got 'in places.'"),
        ("\n\n", {}, "shaft.csv must have a table of numbers, got no text in 3 lines"),
        (
            columns(x=["nan" if n == 50 else str(n) for n in N]),
            {"x_unit": "um"},
            "positions must rise in equal steps, got nan at height 51",
        ),
        (columns(), {"columns": (0, 0)}, r"columns must be that of heights, or .* got \(0, 0\)"),
    ],
)
def test_a_file_that_is_no_trace_is_refused_in_one_sentence(file, text, more, says):
    with pytest.raises(ValueError, match=says) as refused:
        Trace.read(file(text), **more)
    assert "\n" not in str(refused.value)


TEXT = columns(heading="x (mm),z (\u00b5m)\n")
UTF_8 = b"\xef\xbb\xbf"


@pytest.mark.parametrize(
    "content",
    [
        *(TEXT.encode(name) for name in ("utf-8", "utf-8-sig", "cp1252", "mac-roman", "utf-16")),
        "\ufeff".encode("utf-16-be") + TEXT.encode("utf-16-be"),
        UTF_8 + TEXT.encode("cp1252"),
    ],
)
def test_text_is_read_by_its_mark_or_as_utf_8_or_as_of_windows(file, content):
    assert_right(Trace.read(file(content)))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"PK\x03\x04", "is no text, .* workbook as CSV"),
        (TEXT.encode() + b"\x00\x00\n", r"no text, got the control character '\\x00' in line 202: .*pandas"),
        (TEXT.encode("utf-16")[:-1], "is no text, got"),
        (b"\x01\x00\x02\x00" * 100, "is no text, got"),
    ],
)
def test_what_is_no_text_is_refused(file, content, says):
    with pytest.raises(ValueError, match=says):
        Trace.read(file(content))


def test_lengths_are_the_decimal_numbers_of_the_file(file):
    """Not 0.00039999999999999996 for 400 um."""
    for step in (2, 0.7, 0.005):
        text = "x (um),z (nm)\n" + "".join(f"{30.1 + n * step:.3f},{z}\n" for n, z in zip(N, Z, strict=True))
        trace = Trace.read(file(text))
        assert trace.lambda_0 == float(f"{200 * step:.6g}e-6")
        assert trace.shortest == float(f"{2 * step:.6g}e-6")
    assert Trace.read(file(column()), length=400, x_unit="um").lambda_0 == 4e-4


@pytest.mark.parametrize(("form", "column"), [("12.05.2026,{}", 1), ("{},v1.0", 0), ("{},v1.0", 1)])
def test_points_outside_the_heights_tell_nothing_of_their_comma(file, form, column):
    rows = "\n".join(form.format(written(z).replace(".", ",")) for z in Z)
    with pytest.raises(ValueError, match=r"line 1, has a comma of decimals, .* say decimal=',' for decimals"):
        Trace.read(file(rows), columns=column, **ALONE)
