"""docs/notation.md against the formulas of all pages, and the sections and files that sources and pages name."""

import pkgutil
import re
from pathlib import Path
from typing import NamedTuple

import pytest

import weier
from weier.data.variables import VARIABLES

APPENDIX_B = Path("docs/api/punch.rst")  # has the symbols of the paper
PAGES = sorted({path for suffix in ("md", "rst") for path in Path("docs").rglob(f"*.{suffix}")} - {APPENDIX_B})
ACCENTS = "bar|hat|dot|mathsf"
# A letter with its accent, primes, stars and subscript.
SYMBOL = re.compile(
    rf"(?P<letter>\\(?:{ACCENTS}) ?\{{?\\?[A-Za-z]+\}}?|\\[A-Za-z]+|[A-Za-z])'*(?P<star>(?:\^\*|\^\{{\*2\}})?)"
    r"(?:_(?P<sub>\\[A-Za-z]+\{\w+\}|\\[A-Za-z]+|\{[^{}]*(?:\{\w+\}[^{}]*)?\}|\w|[+-]))?(?P<late>(?:\^\*|\^\{\*2\})?)"
)
COMMAND_NAMES = """
sin cos tan cot arcsin cosh sinh ln log max min int sum frac tfrac sqrt overline left right bigl bigr quad qquad cdot
ldots le ge ne approx propto infty partial nabla langle rangle lceil rceil begin end times to in operatorname text
mathrm mp pm Re sign arsinh erf zeta pi i j k l n O
"""
COMMANDS = set(COMMAND_NAMES.split())  # commands and functions of LaTeX, constants and indices
NOT_SYMBOLS = [
    r"\\(?:text|operatorname|begin|end)\{[^}]*\}",
    r"\\mathrm\{(?:d|diag)\}",
    r"\\mathsf T\b",  # transposed
    r"(?<![A-Za-z\\])e(?=\^)",  # the exponential function
    r"(?<![A-Za-z\\])d(?= ?(?:x|\\vartheta)\b)",  # differentials
    r"\\[Dd]elta(?= ?\\?,? ?(?:[A-Zac-wyzt]|\\ln))(?!_)",  # variations and increments of a symbol
    r"(?<![A-Za-z\\])[TU]_(?:\w|\{[^{}]*(?:\{\w+\}[^{}]*)?\})",  # Chebyshev polynomials
]
INDICES = r"[ijklmnN0-9+\-, ]+|\\infty|[+-]|\\mp|\\pm|N_\\mathrm\{s\}"


class Entry(NamedTuple):
    """A row of the table."""

    meaning: str
    unit: str
    code: str
    page: str


def formulas(text: str, suffix: str) -> list[str]:
    """All formulas of a page."""
    if suffix == ".rst":
        blocks = re.findall(r"\.\. math::\n\n((?: +.*\n|\n)+)", text)
        return [*re.findall(r":math:`([^`]*)`", text), *blocks]
    blocks = re.findall(r"```\{math\}\n(.*?)```", text, re.S)
    return [*re.findall(r"\$([^$]+)\$", prose(text)), *blocks]


def prose(text: str) -> str:
    """A page without blocks and code."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"```.*?```", "", text, flags=re.S))


def symbols(formula: str) -> list[str]:
    """The symbols of a formula, with `_n` for any index and without primes and the subscripts of states."""
    formula = formula.replace(r"\Delta x", r"\spacing")
    for pattern in NOT_SYMBOLS:
        formula = re.sub(pattern, " ", formula)
    found = []
    for match in SYMBOL.finditer(formula):
        letter = re.sub(r"[{}]", " ", match["letter"]).strip()
        if letter.lstrip("\\") in COMMANDS and not (letter == "k" and match["sub"]):
            continue
        sub = re.sub(r"^\{(.*)\}$", r"\1", match["sub"] or "").removesuffix(",i").removesuffix(",j")
        star = "*" if match["star"] or match["late"] else ""
        found.append(re.sub(r"\s+", " ", letter) + (f"_{sub}" if sub else "") + star)
    return found


def candidates(symbol: str) -> list[str]:
    """Rows in which a symbol may stand: as it is, with any index, and as one of several states."""
    base, _, sub = symbol.removesuffix("*").partition("_")
    star = "*" if symbol.endswith("*") else ""
    general = [f"{base}_n{star}"] if re.fullmatch(INDICES, sub) else []
    state = (
        [base + star] if sub in ("1", "2", "\\mathrm{e}", "+", "-", "0", "00", "01", "i", "j") or base == "x" else []
    )
    return [symbol, *general, *state]


def read_table() -> dict[str, Entry]:
    """The table of notation, by symbol."""
    table: dict[str, Entry] = {}
    for line in Path("docs/notation.md").read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| $"):
            (symbol,) = symbols(cells[0].strip("$"))
            symbol = re.sub(r"_(?:m|n)(?=\*|$)", "_n", symbol)
            assert symbol not in table, f"{cells[0]} has two rows"
            table[symbol] = Entry(*cells[1:])
    return table


TABLE = read_table()


def row_of(symbol: str) -> Entry | None:
    return next((TABLE[name] for name in candidates(symbol) if name in TABLE), None)


def unknown_symbols(text: str, suffix: str) -> set[str]:
    return {symbol for formula in formulas(text, suffix) for symbol in symbols(formula) if row_of(symbol) is None}


@pytest.mark.parametrize("path", PAGES, ids=str)
def test_pages_use_the_symbols_of_the_notation(path):
    text = path.read_text(encoding="utf-8")
    assert unknown_symbols(text, path.suffix) == set()


def test_each_symbol_stands_on_its_page():
    names = {path.relative_to("docs").with_suffix("").as_posix(): path for path in PAGES}
    texts = {
        name: (path.read_text(encoding="utf-8"), path.suffix) for name, path in names.items() if name != "notation"
    }
    used = {name: {s for formula in formulas(*page) for s in symbols(formula)} for name, page in texts.items()}
    rows = {symbol: {c for s in used[entry.page] for c in candidates(s)} for symbol, entry in TABLE.items()}
    assert [symbol for symbol, names in rows.items() if symbol not in names] == []


def test_names_in_the_code_exist():
    copper = {"mu_1": 4e10, "mu_2": 4e10, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 2e-8, "rho_2": 2e-8}
    objects = {"Profile": weier.Profile(1.25, 5, 2), "Interface": weier.Interface(**copper, lambda_0=1e-3, g_0=1e-6)}
    fields = weier.fields(objects["Profile"], 0.5)
    checked = 0
    for entry in TABLE.values():
        for kind, name in re.findall(r"(data: |fields: |)`([\w.]+)`", entry.code):
            owner, _, attribute = name.partition(".")
            if kind:
                assert name in (VARIABLES if kind == "data: " else {*fields.variables, *fields.attrs}), name
            elif owner in objects:
                assert hasattr(objects[owner], attribute), name
            elif owner == "weier":
                pkgutil.resolve_name(name)
            checked += 1
    assert checked > 30


def headings(path: Path) -> set[str]:
    """The sections of a page."""
    title = r"^#+ (.*)$" if path.suffix == ".md" else r"^(.+)\n[=-]{4,}$"
    return set(re.findall(title, path.read_text(encoding="utf-8"), re.M))


SOURCES = sorted(
    path
    for folder in ("weier", "tests", "benchmarks")
    for path in Path(folder).rglob("*.py")
    if path.name != "test_notation.py"
)


@pytest.mark.parametrize("path", SOURCES, ids=str)
def test_sections_that_a_file_names_exist(path):
    """`docs/PAGE.md, "Section"`."""
    text = re.sub(r"\n\s*(?:#\s*)?", " ", path.read_text(encoding="utf-8"))  # also across the lines of a comment
    for name in re.findall(r"docs/\w+\.(?:md|rst)", text):
        assert Path(name).is_file(), name
    for name, sections in re.findall(r'(docs/\w+\.(?:md|rst))(?:, |: | has [\w ]*|\. |; )?\(?("[^"\\]{3,60}")', text):
        if sections.strip('"')[0].isupper():
            assert sections.strip('"') in headings(Path(name)), f"{path}: {name}, {sections}"


@pytest.mark.parametrize("path", PAGES, ids=str)
def test_files_that_a_page_names_exist(path):
    named = re.findall(
        r"`((?:weier|tests|config|benchmarks|docs|profiles|rules)/[\w/.]*\w)`", path.read_text(encoding="utf-8")
    )
    assert [name for name in named if not Path(name).exists()] == []


def test_the_checks_can_fail():
    assert unknown_symbols("The spacing $\\Omega_j$ and $x$.", ".md") == {"\\Omega_j"}
    assert unknown_symbols(".. math::\n\n   \\Omega = p\n", ".rst") == {"\\Omega"}
