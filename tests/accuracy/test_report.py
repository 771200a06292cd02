"""Numbers of tables, and pages from templates."""

import numpy as np

from weier.accuracy.report import number, write_page


def test_what_is_unknown_leaves_its_cell_empty():
    assert number(np.nan) == ""
    assert number(0.0123) == "1e-02"


def test_a_page_is_a_template_with_its_parts_filled_in(tmp_path):
    write_page(tmp_path / "page.md", "tradeoff.md", title="Title", variants="| one |")
    page = (tmp_path / "page.md").read_text()
    assert page.startswith("# Title\n\n| one |\n\nEach row")
