"""Tables of Markdown, text that a reader of it sees as written, and numbers with few digits."""

from weier.data.markdown import significant


def test_numbers_are_written_in_full_unless_they_are_too_long():
    written = {428.3: "430", 0.0123: "0.012", 1.234e7: "1.2e+07", 2.1e-7: "2.1e-07"}
    assert {value: significant(value, 2) for value in written} == written
