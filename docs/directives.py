"""Parts of the documentation from the program: tables of variables, of keys and figures of scenes, docstrings."""

import os
import re
from pathlib import Path

import scene_keys
from cycler import cycler
from docutils import nodes
from matplotlib import rc_params_from_file
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from weier import scene
from weier.data import markdown
from weier.data.provenance import VERSION
from weier.data.variables import VARIABLES
from weier.figures import KINDS, caption, style
from weier.methods.registry import METHODS, PLOTTED
from weier.methods.settings import described

ROOT = Path(__file__).resolve().parents[1]
MAX_WORD = 24  # letters of a word that a cell of a table holds in one line
NUMBER = r"[-+]?[\d.]+(e[-+]?\d+)?|inf|nan"
COLON = "\ue000"  # of a private range: no text has it


class SceneFigures(SphinxDirective):
    """The figures of a scene with their captions, as the pipeline left them."""

    required_arguments = 1

    def run(self):
        """A figure node for each."""
        loaded = scene.load(ROOT / f"config/scenes/{self.arguments[0]}.yaml")
        if not all(self.path(name).exists() for name in loaded.figures):
            raise self.error(f"the figures of {loaded.name} are not in {self.config.scene_figures}: run snakemake")
        return [self.picture(loaded, name) for name in loaded.figures]

    def path(self, name):
        """Where a figure is."""
        return Path(self.config.scene_figures, f"{name}.png")

    def picture(self, loaded, name):
        """Picture and caption."""
        title, text = name.replace("_", " ").capitalize(), caption(loaded, name)
        words = nodes.caption("", "", nodes.strong("", f"{title}. "), nodes.Text(text))
        return nodes.figure(
            "", nodes.image(uri=os.path.relpath(self.path(name), ROOT / "docs"), alt=text, width="28em"), words
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
        meaning = f"{entry.long_name}. {entry.comment}" if entry.comment else entry.long_name
        cells = meaning, entry.symbol, entry.unit, ", ".join(entry.dims)
        return [f"`{name}`", *map(markdown.plain, cells)]


class SceneKeys(SphinxDirective):
    """Every key of a scene and of its parts, such as studies and figures, from the models of scenes."""

    def run(self):
        """A table for each."""
        made = []
        for title, table in scene_keys.tables():
            made += [nodes.rubric("", f"Keys of {title}"), *self.parse_text_to_nodes(table)]
        return made


class SettingsOfMethods(SphinxDirective):
    """Every setting of every method, from the methods themselves."""

    def run(self):
        """A table with a row for each."""
        rows = [self.row(*entry) for entry in described(METHODS)]
        return self.parse_text_to_nodes(markdown.table(["setting", "default", "what it is"], rows))

    @staticmethod
    def row(setting, meaning):
        """Its cells, as Markdown."""
        name, _, default = setting.partition("=")
        return [f"`{name}`", markdown.plain(default), markdown.plain(meaning)]


class FigureKinds(SphinxDirective):
    """Every kind of figure, by its caption."""

    def run(self):
        """A table with a row for each."""
        rows = [
            [f"`{name}`", markdown.plain(kind.caption), "yes" if kind.grouped else ""] for name, kind in KINDS.items()
        ]
        head = ["draw", "what it shows", "takes parameters"]
        return self.parse_text_to_nodes(markdown.table(head, rows))


def before_napoleon(app, what, name, obj, options, lines):
    """Docstrings are plain text: |k|, p_0* and (13) are no markup, nor does a colon end the type of a property."""
    plain = list(without_markup(lines))
    if what == "property":
        plain = [line.replace(":", COLON) for line in plain]
    lines[:] = with_fields(plain) if what == "class" else plain


def without_markup(lines):
    """The lines with what would be markup escaped, but for the stars of lists, and for examples as a whole."""
    example = False
    for line in lines:
        example = bool(line.strip()) and (example or line.lstrip().startswith(">>>"))
        bullet, text = re.fullmatch(r"(\s*\* )?(.*)", line).groups(default="")
        yield line if example else bullet + re.sub(r"^( *)(\()|([|*])", r"\1\\\2\3", text)


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


def mark_cells(app, doctree):
    """Long words in tables have a class for the style sheet, and so have columns of numbers."""
    for entry in doctree.findall(nodes.entry):
        if any(len(word) > MAX_WORD for word in entry.astext().split()):
            entry["classes"].append("long")
    for body in doctree.findall(nodes.tbody):
        for column in zip(*(row.children for row in body.children), strict=False):
            numbers = [entry for entry in column if re.fullmatch(NUMBER, entry.astext())]
            if 2 * len(numbers) > sum(bool(entry.astext()) for entry in column):  # units are words, though some are 1
                for entry in numbers:
                    entry["classes"].append("number")


def configure(app, config):
    """What the configuration takes from weier: its version, and how figures look."""
    config.version = config.release = VERSION
    lines = [style.line(method) for method in PLOTTED]
    cycle = cycler(color=[line["color"] for line in lines], linestyle=[line["linestyle"] for line in lines])
    config.plot_rcparams = rc_params_from_file(style.SHEET, use_default_template=False) | {
        "figure.figsize": (style.WIDTH, style.HEIGHT),
        "figure.constrained_layout.use": True,
        "axes.prop_cycle": cycle,
    }


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension with Sphinx."""
    app.connect("config-inited", configure)
    app.add_config_value("scene_figures", str(ROOT / "results/paper/figures"), "env", str)
    app.add_directive("scene-figures", SceneFigures)
    app.add_directive("table-of-variables", TableOfVariables)
    app.add_directive("scene-keys", SceneKeys)
    app.add_directive("figure-kinds", FigureKinds)
    app.add_directive("settings-of-methods", SettingsOfMethods)
    app.connect("autodoc-skip-member", skip_fields)
    app.connect("doctree-read", mark_cells)
    app.connect("autodoc-process-docstring", before_napoleon, priority=100)
    app.connect("autodoc-process-docstring", after_napoleon, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
