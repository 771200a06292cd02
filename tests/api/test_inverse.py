"""`weier.find_load`: the load for a given resistance, compliance or contact fraction."""

import math
import warnings

import numpy as np
import pytest

import weier
from tests.profiles import THREE_WAVES
from weier.accuracy.cosines import Cosines
from weier.methods import patches, westergaard

TWO = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)


@pytest.mark.parametrize("xi", [1e-6, 0.3, 0.99])
def test_one_wave_follows_from_westergaard(xi):
    one = weier.Profile(D=1.5, gamma=2, m=1)
    values = {
        "resistance": float(westergaard.resistance(xi)),
        "contact_fraction": 2 * float(westergaard.contact_half_width(xi)),
        "compliance": float(westergaard.compliance(xi)),
    }
    for name, value in values.items():
        found = weier.find_load(one, **{name: value})
        off, error = abs(found.mean_pressure.item() - xi), found.mean_pressure_error.item()
        # The value has one rounding, which moves the load by itself over the slope of the value in ln p.
        rounding = 4e-16 * {"resistance": -math.log(xi), "contact_fraction": 2, "compliance": 1 / xi}[name] * xi
        assert off <= error + 8 * rounding, (name, off, error)
        assert error <= 1e-6 * xi, name
        assert found[name].item() == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_the_load_of_a_curve_comes_back_within_its_error(seed):
    random = np.random.default_rng(seed)
    profile = weier.Profile(
        1 + 0.9 * random.random(), int(random.integers(2, 6)), int(random.integers(2, 5)), seed=seed
    )
    loads = np.exp(random.uniform(math.log(1e-3), math.log(0.95 * profile.full_contact_load), 3))
    curve = weier.solve(profile, loads, "patches")
    for name in ("resistance", "compliance", "contact_fraction"):
        found = weier.find_load(profile, **{name: curve[name].values})
        error = found.mean_pressure_error.values
        assert (np.abs(found.mean_pressure.values - loads) <= error).all(), name
        assert (error <= 1e-6 * loads).all(), name
        for farther in (-error, error):  # where the value is certainly above or below
            beside = weier.solve(profile, found.mean_pressure.values + farther, "patches")
            off = np.abs(beside[name].values - curve[name].values)
            assert (off >= 0.99 * beside[f"{name}_error"].values).all(), name


def test_the_load_of_a_contact_fraction_is_within_its_error():
    """Edges of a triangular wave and of a series move farther than their heights alone say."""
    for surface in (Cosines(np.arange(1, 48, 2) ** -2.0, list(range(1, 48, 2))), THREE_WAVES):
        loads = np.geomspace(1e-3, 0.9, 4) * surface.full_contact_load
        found = weier.find_load(surface, contact_fraction=patches.curve(surface, loads, 1e-12).contact_fraction)
        assert np.all(abs(found.mean_pressure.values - loads) <= found.mean_pressure_error.values)


def test_a_resistance_within_a_drop_has_the_load_of_the_birth():
    births = weier.events(TWO, 1e-3, 1.0)
    birth = births.mean_pressure.values[births.birth.values][0]
    before, after = weier.solve(TWO, birth * np.array([1 - 1e-6, 1 + 1e-6]), "patches").resistance.values
    assert before > 1.1 * after
    with pytest.warns(UserWarning, match=r"the resistance drops past the wanted value where a contact is born"):
        found = weier.find_load(TWO, resistance=(before + after) / 2)
    assert abs(found.mean_pressure.item() - birth) <= found.mean_pressure_error.item() + 1e-9 * birth


REFUSED = [
    (
        {"resistance": 1e4},
        r"between 692.\d* g_0/p_0\*, under the lightest load of 1e-300 p_0\*, and 0 g_0/p_0\*, from full contact "
        r"under 2.4759\d p_0\* on, got 10000 g_0/p_0\*$",
    ),
    ({"compliance": 0.01}, r"strictly between 0.0175\d* g_0, under .*, and 1.299\d* g_0, from .*, got 0.01 g_0$"),
    (
        {"compliance": TWO.total_amplitude},
        r"strictly between 0.0175\d* g_0, under .*, and (1.299\d*) g_0, from .*, got \1 g_0$",
    ),
    (
        {"contact_fraction": 1.0},
        "contact_fraction must lie strictly between 2.1953e-151, under .*, and 1, from .*, got 1$",
    ),
    ({"resistance": 1.0, "compliance": 1.0}, "got resistance and compliance"),
    ({"resistance": 1.0, "profile": weier.Profile(1.5, 2, math.inf)}, "the finest wave must fit"),
]


@pytest.mark.parametrize(("wanted", "message"), REFUSED)
def test_what_no_load_gives_is_refused_in_a_sentence(wanted, message):
    with pytest.raises(ValueError, match=message):
        weier.find_load(**{"profile": TWO} | wanted)


def test_the_order_of_the_values_is_kept():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = weier.find_load(TWO, compliance=[1.0, 0.2, 1.0])
    assert found.compliance.values == pytest.approx([1.0, 0.2, 1.0], rel=1e-10)
    assert found.mean_pressure_error.dims == ("mean_pressure",)
    assert found.mean_pressure_error.attrs["normalised_by"] == "p_0*"
