"""What a tolerance takes: the cheapest methods that do, load by load, or why there are none."""

import itertools
import math
import re

import numpy as np
import pytest

import weier
from tests.profiles import THREE_WAVES
from weier import Profile, plan, random_phases
from weier.methods import bem, patches
from weier.methods.errors import NotApplicableError, OutOfReachError
from weier.methods.planned.plan import cheapest

LOADS = np.geomspace(1e-3, 10, 12)


def test_a_finer_tolerance_takes_no_less():
    plans = [plan(THREE_WAVES, LOADS, tolerance) for tolerance in (0.5, 1e-1, 1e-2, 1e-4, 1e-6, 1e-9)]
    seconds = [sum(part.seconds for part in found.parts) for found in plans]
    assert seconds == sorted(seconds)
    assert seconds[0] < seconds[-1] / 10


@pytest.mark.parametrize("tolerance", [0.5, 1e-2, 1e-4, 1e-9])
@pytest.mark.parametrize("quantity", ["compliance", "resistance"])
def test_the_parts_cover_the_loads_and_add_up(quantity, tolerance):
    found = plan(THREE_WAVES, LOADS, tolerance, quantity)
    assert np.array_equal(np.concatenate([part.mean_pressure for part in found.parts]), LOADS)
    sums = [p.truncation + p.discretisation + p.estimate for p in found.parts]
    assert found.error == np.concatenate(sums).max() <= tolerance
    assert found.parts[-1].method == "full contact"
    head, _, *rows, total = str(found).splitlines()
    assert len(rows) == len(found.parts)
    assert total.startswith("  in all: error ")
    html = found._repr_html_()
    assert html.count("<tr>") == 1 + len(found.parts)
    assert head in html


def test_each_load_takes_the_method_of_least_seconds_that_does():
    """Whatever the others take, and in as few parts as that allows."""
    random = np.random.default_rng(4)
    (like,) = plan(Profile(1.5, 3, 1), [0.1] * 1, 1e-3).parts
    none = np.zeros(5)
    for _ in range(20):
        those = [
            like._replace(
                method=name,
                mean_pressure=np.arange(1.0, 6.0),
                estimate=none,
                discretisation=none,
                truncation=np.where(random.random(5) < 0.3, np.inf, 0.0) if number else none,
                seconds_start=random.random(),
                seconds_load=random.random(5),
            )
            for number, name in enumerate("abc")
        ]
        least = [
            min((part.seconds_load[load], part.method) for part in those if np.isfinite(part.truncation[load]))
            for load in range(5)
        ]
        parts = cheapest(those, 1e-3)
        taken = [(second, part.method) for part in parts for second in part.seconds_load]
        assert taken == least
        assert np.concatenate([part.mean_pressure for part in parts]).tolist() == [1, 2, 3, 4, 5]
        assert all(one.method != other.method for one, other in itertools.pairwise(parts))


def test_a_compliance_takes_the_coarsest_grid_whose_bound_is_within_it_or_exact_edges():
    profile, loads = Profile(1.25, 5, 4, random_phases(1)), np.geomspace(1e-6, 2, 20)
    (part,) = plan(profile, loads, 1e-3).parts
    assert part.method == "bem"
    assert bem.error_model.compliance_error(profile, part.settings["points"]) < 1e-3
    assert bem.error_model.compliance_error(profile, 0.8 * part.settings["points"]) > 1e-3
    for tolerance, quantity in ((1e-8, "compliance"), (1e-2, "resistance")):
        assert {part.method for part in plan(profile, loads, tolerance, quantity).parts} == {"patches"}


def test_one_contact_is_not_too_many_however_many_the_waves():
    """There are 16 807 of them in a period, and a load so light that a single crest touches."""
    profile, loads = Profile(1.02, "7/3", 6, 1.0), [1e-9]
    found = plan(profile, loads, 0.56, "resistance")
    assert found.seconds < 3
    curve = weier.solve(profile, loads, "planned", tolerance=0.56, quantity="resistance")
    # One crest on a half-plane: Hertz's contact in each of the periods, -2 ln(pi a/L) of which is the resistance.
    bend = (profile.amplitude * (2 * np.pi * float(profile.gamma) ** np.arange(6)) ** 2).sum()
    angle = math.pi / profile.period * 2 * math.sqrt(loads[0] * profile.period / bend)
    assert curve.resistance.item() == pytest.approx(-2 * profile.period * math.log(angle), 0.01)


def test_thousands_of_contacts_are_not_too_many():
    (part,) = plan(Profile(1.25, 5, 6, 1.0), [1.0], 1e-9).parts
    assert part.method == "patches"
    assert 1e7 < part.memory < 1e9


def test_what_is_out_of_reach_is_refused_with_what_is_missing():
    infinite = Profile(1.9, 2, math.inf)
    with pytest.raises(OutOfReachError, match=r"others may change it by .*; no power of ten below 1 is within reach"):
        plan(infinite, LOADS, 1e-3)
    with pytest.raises(NotApplicableError, match="tolerance must be larger"):
        weier.solve(infinite, LOADS, "planned", tolerance=1e-3)


@pytest.mark.parametrize("tolerance", [1e-30, 1e-310])
@pytest.mark.parametrize("quantity", ["compliance", "resistance"])
def test_what_no_method_can_do_is_refused_with_what_is_within_reach(quantity, tolerance, monkeypatch):
    with pytest.raises(OutOfReachError, match="is within reach") as refusal:
        plan(THREE_WAVES, LOADS, tolerance, quantity)
    within = float(re.search(r"(\S+) is within reach", str(refusal.value))[1])
    assert plan(THREE_WAVES, LOADS, within, quantity).error <= within
    monkeypatch.setattr(patches.error_model, "MAX_CONTACTS", 10_000)
    with pytest.raises(OutOfReachError, match="no method can hold the contacts"):
        plan(Profile(1.1, 10, 6, 1.0), LOADS, 1e-9)
