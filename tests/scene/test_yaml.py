"""YAML as people write it; what means harm is in test_fuzz.py."""

import pytest

from weier.scene.yaml import parse_yaml


def test_plain_values_and_merged_keys_are_read():
    text = "base: &b {D: 1.5, m: 2}\nother: {<<: *b, m: 3}\nlist: [1, .inf, 5/2]"
    found = parse_yaml(text)
    assert found["other"] == {"D": 1.5, "m": 3}
    assert found["list"] == [1, float("inf"), "5/2"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        *[("1e-3", 1e-3), ("-1E5", -1e5), ("1.e2", 100.0), ("1.5e-3", 1.5e-3), ("12", 12)],
        *[("1e", "1e"), ("e5", "e5"), ("1e5x", "1e5x"), ("'1e5'", "1e5")],
        # By YAML 1.1 these are 10, 90 and true.
        *[("012", 12), ("1:30", "1:30"), ("on", "on")],
        *[("-.5", -0.5), ("3.", 3.0), ("-.inf", -float("inf")), ("true", True), ("~", None), ("", None)],
    ],
)
def test_numbers_are_those_of_people(text, value):
    found = parse_yaml(f"a: {text}")["a"]
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: {a: 1, a: 2}", 'line 2: found duplicate key "a" with value "2"'),
        ("a: [1", "expected"),
    ],
)
def test_what_is_not_plain_is_refused(text, message):
    with pytest.raises(ValueError, match=message):
        parse_yaml(text)
