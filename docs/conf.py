"""How the documentation is built: `python -m sphinx docs results/docs`, once the scene `paper` is run."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]  # the checkout, not an installed copy, and directives.py

project = "weier"
author = "The weier developers"
copyright = "the weier developers, MIT licence"

extensions = [
    "matplotlib.sphinxext.plot_directive",
    "myst_parser",
    "sphinx-mathjax-offline",  # the script of sphinx.ext.mathjax, so that no network is needed
    "sphinx.ext.autodoc",
    "sphinx.ext.githubpages",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "directives",  # beside this file
]
myst_heading_anchors = 2
myst_enable_extensions = ["dollarmath"]
default_role = "py:obj"  # `single backticks` in docstrings link to what they name
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say types, shapes and units
plot_include_source = plot_apply_rcparams = True
plot_html_show_formats = plot_html_show_source_link = False
plot_formats = [("png", 200)]
plot_working_directory = str(HERE.parent)  # code names files from there, as a user of the checkout does

html_theme = "furo"
html_title = "weier"
html_static_path = ["style.css"]
html_css_files = ["style.css"]
