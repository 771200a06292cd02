"""How the documentation is built: `snakemake --cores 2 docs` draws its figures and builds it."""

import os
import re
import sys
from pathlib import Path

from cycler import cycler
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # the checkout, not an installed copy

from weier import scene  # noqa: E402 - only now is it found
from weier.data import markdown  # noqa: E402 - likewise
from weier.data.provenance import VERSION  # noqa: E402 - likewise
from weier.data.variables import VARIABLES  # noqa: E402 - likewise
from weier.figures import kinds, style  # noqa: E402 - likewise
from weier.figures.captions import caption  # noqa: E402 - likewise
from weier.methods.registry import PLOTTED  # noqa: E402 - likewise
from weier.scene.file import schema  # noqa: E402 - likewise

project = "weier"
author = "The weier developers"
copyright = "the weier developers, MIT licence"
version = release = VERSION

extensions = [
    "matplotlib.sphinxext.plot_directive",
    "myst_parser",
    "sphinx-mathjax-offline",  # the script of sphinx.ext.mathjax, so that no network is needed
    "sphinx.ext.autodoc",
    "sphinx.ext.githubpages",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
myst_heading_anchors = 2
default_role = "py:obj"  # `single backticks` in docstrings link to what they name
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say types, shapes and units
plot_include_source = plot_apply_rcparams = True
plot_html_show_formats = plot_html_show_source_link = False
plot_formats = [("png", 200)]
LINES = [style.line(method) for method in PLOTTED]
plot_rcparams = style.RC | {
    "figure.figsize": (style.WIDTH, style.HEIGHT),
    "figure.constrained_layout.use": True,
    "axes.prop_cycle": cycler(
        color=[line["color"] for line in LINES], linestyle=[line["linestyle"] for line in LINES]
    ),
}

html_theme = "furo"
html_title = "weier"
html_static_path = ["style.css"]
html_css_files = ["style.css"]

COLON = "\ue000"  # of a private range: no text has it


class SceneFigures(SphinxDirective):
    """The figures of a scene with their captions, as the pipeline left them."""

    required_arguments = 1

    def run(self):
        """A figure node for each."""
        loaded = scene.load(ROOT / f"config/scenes/{self.arguments[0]}.yaml")
        return [self.picture(loaded, name) for name in loaded.figures]

    def picture(self, loaded, name):
        """Picture and caption."""
        title, text, alternative = caption(loaded, name)
        path = Path(self.config.scene_figures, f"{name}.png")
        words = nodes.caption("", "", nodes.strong("", f"{title}. "), nodes.Text(text))
        return nodes.figure(
            "", nodes.image(uri=os.path.relpath(path, ROOT / "docs"), alt=alternative, width="28em"), words
        )


class TableOfVariables(SphinxDirective):
    """All variables of the data, from their one table."""

    def run(self):
        """A table with a row for each."""
        head = ["variable", "what it is", "symbol", "normalised by or unit", "dimensions"]
        return self.parse_text_to_nodes(markdown.table(head, map(self.row, VARIABLES.items())))

    @staticmethod
    def row(variable):
        """Its cells, as Markdown."""
        name, entry = variable
        cells = entry.long_name, entry.symbol, entry.unit, ", ".join(entry.dims)
        return [f"`{name}`", *map(markdown.plain, cells)]


class SceneKeys(SphinxDirective):
    """Every key of a scene, a study, a profile, a figure and a range, from the schema of scenes."""

    parts = ("", "study", "profile", "figure", "range")

    def run(self):
        """A table for each."""
        known = schema()
        made = []
        for part in self.parts:
            within = known["$defs"][part] if part else known
            caption = f"Keys of a {part}" if part else "Keys of a scene"
            needed = within.get("required", [])
            rows = [self.row(known, name, of, name in needed) for name, of in within["properties"].items()]
            made.append(nodes.rubric("", caption))
            made += self.parse_text_to_nodes(markdown.table(["key", "what it says", "value"], rows))
        return made

    def row(self, known, name, of, needed):
        """Its cells, as Markdown."""
        says = f"{of.get('description', '')}{' Required.' if needed else ''}"
        return [f"`{name}`", markdown.plain(says), markdown.plain(self.kind(known, of))]

    def kind(self, known, of):
        """What a value may be, in words."""
        name = of.get("$ref", "").rpartition("/")[2]
        if name:
            own = {"axis": "number, text, range, or list of these", "line": "text", "name": "name", "names": "names"}
            of = known["$defs"][name]
            return own.get(name) or (", ".join(of["enum"]) if "enum" in of else self.kind(known, of))
        if "enum" in of:
            return ", ".join(of["enum"])
        if "anyOf" in of:
            return " or ".join(dict.fromkeys(self.kind(known, each) for each in of["anyOf"]))
        if of.get("type") == "array":
            return f"list of {self.kind(known, of['items'])}"
        kind = of.get("type", "mapping")
        words = kind if isinstance(kind, list) else [kind]
        return " or ".join("mapping" if word == "object" else word for word in words)


class FigureKinds(SphinxDirective):
    """Every kind of figure, by its caption."""

    def run(self):
        """A table with a row for each."""
        rows = [[f"`{name}`", *self.cells(kind)] for name, kind in kinds().items()]
        head = ["draw", "what it shows", "takes parameters", "drawn from"]
        return self.parse_text_to_nodes(markdown.table(head, rows))

    def cells(self, kind):
        """Its cells after the name, as Markdown."""
        text = " ".join(kind.caption.replace("{methods}", "").split())
        file = f"the file of `weier {kind.command}`" if kind.command else "studies"
        return markdown.plain(text), "yes" if kind.grouped else "", file


def before_napoleon(app, what, name, obj, options, lines):
    """Docstrings are plain text: |k|, p_0* and (13) are no markup, nor does a colon end the type of a property."""
    plain = [re.sub(r"^( *)(\()|([|*])", r"\1\\\2\3", line) for line in lines]
    if what == "property":
        plain = [line.replace(":", COLON) for line in plain]
    lines[:] = with_fields(plain) if what == "class" else plain


def with_fields(lines):
    """What a class holds, `name : meaning` line by line ahead of any section, as a list."""
    section = False
    for line in lines:
        section = section or line.startswith("---")
        name, colon, meaning = line.partition(" : ")
        if not section and colon and re.fullmatch(r"\w+(, \w+)*", name):
            yield f"* ``{name}`` : {meaning}"
        else:
            yield line if section or not line.startswith("    ") else f"  {line.strip()}"


def after_napoleon(app, what, name, obj, options, lines):
    """The colons again."""
    lines[:] = [line.replace(COLON, ":") for line in lines]


def skip_fields(app, what, name, obj, skip, options):
    """The fields of a NamedTuple stand in its own docstring; Python says of each that it is an alias for a number."""
    return True if (obj.__doc__ or "").startswith("Alias for field number") else None


def mark_numbers(app, doctree):
    """Numbers in tables have a class, for the style sheet."""
    for entry in doctree.findall(nodes.entry):
        if re.fullmatch(r"[-+]?[\d.]+(e[-+]?\d+)?|inf|nan", entry.astext()):
            entry["classes"].append("number")


def setup(app: Sphinx) -> None:
    """What is not in the lists above."""
    app.add_config_value("scene_figures", str(ROOT / "results/paper/figures"), "env", str)
    app.add_directive("scene-figures", SceneFigures)
    app.add_directive("table-of-variables", TableOfVariables)
    app.add_directive("scene-keys", SceneKeys)
    app.add_directive("figure-kinds", FigureKinds)
    app.connect("autodoc-skip-member", skip_fields)
    app.connect("doctree-read", mark_numbers)
    app.connect("autodoc-process-docstring", before_napoleon, priority=100)
    app.connect("autodoc-process-docstring", after_napoleon, priority=900)
