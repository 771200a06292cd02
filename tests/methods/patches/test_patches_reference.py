"""Contact patches against the reference values, Westergaard and higher precision."""

import numpy as np
import pytest

from tests.reference import REFERENCES
from weier import Profile
from weier.methods import patches, westergaard
from weier.methods.patches import given_edges


@pytest.mark.parametrize("direct", [True, False])
@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_reference_values(reference, direct, monkeypatch):
    """Directly as few contacts are solved, and by conjugate gradients with fast sums as many are."""
    monkeypatch.setattr(given_edges, "MAX_DIRECT", np.inf if direct else 0)
    curve = patches.curve(reference.profile, reference.mean_pressure)
    h = np.abs(curve.compliance - reference.compliance).max()
    area = np.abs(curve.contact_fraction - reference.contact_fraction).max()
    pressed = reference.resistance > 0
    ratio = curve.resistance[pressed] / reference.resistance[pressed]
    print(f"{reference}: h {h:.0e}, R {np.abs(ratio - 1).max():.0e}, contact {area:.0e}")
    assert h < 1e-10  # the digits of the reference values
    assert area < 1e-10
    assert np.abs(ratio - 1).max() < 1e-9
    np.testing.assert_array_equal(curve.resistance[~pressed], 0)
    np.testing.assert_array_equal(curve.patch_count, reference.patches)


def test_one_wave_is_westergaard():
    xi = np.array([1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.3, 0.6, 0.9, 0.999, 1 - 1e-6, 1.0, 2.0])
    curve = patches.curve(Profile(1.5, 3, 1, 0.7), xi)
    np.testing.assert_allclose(curve.indentation, westergaard.compliance(xi), rtol=1e-12)
    np.testing.assert_allclose(curve.resistance, westergaard.resistance(xi), rtol=1e-9)
    width = 2 / np.pi * np.arcsin(np.sqrt(np.minimum(xi, 1)))
    np.testing.assert_allclose(curve.contact_fraction, width, rtol=1e-12)
    np.testing.assert_array_equal(curve.patch_count, xi < 1)


@pytest.mark.parametrize(
    ("load", "indentation", "half_width"),
    [(1e-12, 3.271035334976019e-11, 4.1403245696248826e-08), (1e-7, 2.11974275912246e-06, 1.309285973967359e-05)],
)
def test_light_loads_keep_ten_digits(load, indentation, half_width):
    """One contact at the crest, collocated with Gauss and Chebyshev's nodes by mpmath in 40 digits."""
    curve = patches.curve(Profile(1.25, 5, 3, (0.3, 1.0, 2.0)), load)
    assert curve.indentation[0] == pytest.approx(indentation, rel=1e-11)
    assert curve.contact_fraction[0] == pytest.approx(2 * half_width, rel=1e-11)
