"""Tables from columns, and pages from templates."""

import numpy as np

from weier.accuracy.report import number, rows_as_table, write_page


def test_a_heading_stands_over_what_its_column_says():
    columns = [("n", str), ("square", lambda n: number(n**2, ".1f"))]
    assert rows_as_table(columns, [2, 3]) == "| n | square |\n| --- | --- |\n| 2 | 4.0 |\n| 3 | 9.0 |"


def test_what_is_unknown_leaves_its_cell_empty():
    assert number(np.nan) == ""
    assert number(0.0123) == "1e-02"


def test_a_page_is_a_template_with_its_parts_filled_in(tmp_path):
    write_page(tmp_path / "page.md", "tradeoff.md", title="Title", variants="| one |")
    page = (tmp_path / "page.md").read_text()
    assert page.startswith("# Title\n\n| one |\n\nEach row")
