"""Tables of HTML, and how a profile looks in a notebook."""

import numpy as np

import weier
from weier.surface.profile import MAX_TERMS_SHOWN
from weier.tables import html_table, significant


def test_numbers_are_written_in_full_unless_they_are_too_long():
    written = {428.3: "430", 0.0123: "0.012", 1.234e7: "1.2e+07", 2.1e-7: "2.1e-07"}
    assert {value: significant(value, 2) for value in written} == written


def test_html_keeps_text_as_text():
    text = html_table("<b>", ["<i>"], [["a & b"]], "end")
    assert text.startswith("<p>&lt;b&gt;</p><table>")
    assert "a &amp; b" in text
    assert text.endswith("</table><p>end</p>")


def test_a_profile_shows_its_terms_in_a_notebook():
    text = weier.Profile(1.25, 5, 2, (0.0, 1.5))._repr_html_()
    assert "D = 1.25, gamma = 5, m = 2, phases 0, 1.5" in text
    assert text.count("<tr>") == 3
    assert f"{5**-0.75:.6g}" in text  # g_1 (20)
    assert f"{5**0.25:.6g}" in text  # p_1* (16)
    long = weier.Profile(1.5, 2, 30)._repr_html_()
    assert long.count("<tr>") == 1 + MAX_TERMS_SHOWN
    assert "18 more terms" in long
    assert f"{1 / (1 - 5**-0.75):.6g}" in weier.Profile(1.25, 5, np.inf)._repr_html_()  # G (22)


def test_a_trace_and_the_series_that_is_fitted_to_it_show_what_they_are_in_a_notebook():
    series = weier.Profile(D=1.4, gamma=1.5, m=11, seed=1)
    heights = 1e-6 * series.height(np.arange(2000) / 50)
    heights[7] = np.nan
    trace = weier.Trace(heights, 40e-3, source="<shaft>", unit="m", missing="interpolate")
    text = trace._repr_html_()
    assert text.startswith("<p>trace &lt;shaft&gt; of 2000 heights, 1 of them interpolated,")
    for value in ("0.04 m", f"{trace.g_0:.6g} m", f"{trace.total_amplitude:.6g} g_0", "mirrored", "tilt", "1, 0"):
        assert f">{value}" in text
    found = weier.fit(trace, longest=1e-3, shortest=1e-4, gamma="3/2")
    text = found._repr_html_()
    for value in (f"{found.D:.6g}", f"{found.D_error:.1g}", "3/2", str(found.m), f"{found.g_0:.6g}"):
        assert f">{value}</td>" in text
