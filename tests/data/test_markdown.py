"""Tables of Markdown, and text that a reader of it sees as written."""

from weier.data.markdown import plain, table


def test_a_table_has_a_line_a_row():
    assert table(["a", "b"], [["1", "2"], ["3", "4"]]) == "| a | b |\n| --- | --- |\n| 1 | 2 |\n| 3 | 4 |"


def test_plain_text_neither_ends_a_cell_nor_turns_slanted():
    assert plain("|gap| in g_0, p in p_0*") == r"\|gap\| in g\_0, p in p\_0\*"
