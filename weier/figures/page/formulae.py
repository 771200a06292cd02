"""The symbols of the paper as HTML, from plain text; no font, script or network is needed."""

from __future__ import annotations

import re

from markupsafe import Markup, escape

# The names of Greek letters and their HTML; a subscript and a star may follow.
LETTERS = {name: f"&{name};" for name in ("gamma", "lambda", "phi", "rho", "epsilon", "zeta", "xi")}
# Symbols with subscripts, symbols alone before a relation, powers of ten, and words.
SUBSCRIPTED = r"(?P<letter>gamma|lambda|phi|rho|epsilon|zeta|xi|\b[A-Za-z])_(?P<below>[0-9a-z](?![a-z]))(?P<star>\*?)"
ALONE = r"\b(?P<greek>gamma|lambda|phi|epsilon)\b|\b(?P<symbol>[DmhkRpxG])(?= ?(?:=|&lt;|&gt;)| from \d)"
POWER = r"(?<![\w.])(?P<number>[-+]?\d+(?:\.\d+)?)e(?P<sign>[-+])0*(?P<power>\d+)\b"
WORDS = {"sum": "&sum;", "inf": "&infin;", "pi": "&pi;"}
WORD = r"\b(?P<word>sum(?= [a-z]_)|(?:inf|pi)\b)"
PATTERN = re.compile("|".join((SUBSCRIPTED, POWER, WORD, ALONE)))
EQUAL = re.compile(r"(</i>) = (?=[\d&])")  # No line break is allowed between a symbol and its value.


def typeset(text: object) -> Markup:
    """A plain text as HTML, with its symbols and powers of ten as in print.

    Examples
    --------
    >>> print(typeset("h = sum g_n at 1e-04 p_0*"))
    <i>h</i>&nbsp;=&nbsp;&sum; <i>g<sub>n</sub></i> at 1&times;10<sup>&minus;4</sup> <i>p<sub>0</sub></i><sup>*</sup>

    """
    return Markup(EQUAL.sub(r"\1&nbsp;=&nbsp;", PATTERN.sub(_symbol, str(escape(str(text))))))


def _symbol(found: re.Match[str]) -> str:
    part = found.groupdict()
    if part["letter"]:
        letter = LETTERS.get(part["letter"], part["letter"])
        return f"<i>{letter}<sub>{part['below']}</sub></i>{'<sup>*</sup>' if part['star'] else ''}"
    if part["number"]:
        sign = "&minus;" if part["sign"] == "-" else ""
        return f"{part['number']}&times;10<sup>{sign}{part['power']}</sup>"
    if part["word"]:
        return WORDS[part["word"]]
    name = part["greek"] or part["symbol"]
    return f"<i>{LETTERS.get(name, name)}</i>"
