"""The constants of error and cost models, measured again."""

import pytest

from tests.trade import small_trade
from weier.accuracy.tradeoff.fit import constants
from weier.methods import bem, patches


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    return small_trade(tmp_path_factory.mktemp("scene"))


def test_shipped_constants_bound_what_is_measured(measured):
    found = {constant.name: constant for constant in constants(measured)}
    assert {"BEM_COMPLIANCE", "PATCHES_RESISTANCE", "DEMELIO", "SECONDS_NODE bem", "SECONDS_CONTACT"} <= found.keys()
    bounds = [constant for name, constant in found.items() if not name.startswith("SECONDS")]
    assert [constant for constant in bounds if not constant.measured <= constant.shipped] == []
    # And not by far: this is of order 2 on any grid and profile.
    assert found["BEM_COMPLIANCE"].measured > found["BEM_COMPLIANCE"].shipped / 5


def test_a_fit_finds_the_constants_that_made_the_data(measured):
    seconds = measured["seconds"].copy(deep=True)
    for at, method in enumerate(measured["solution_method"].values.tolist()):
        for case in range(2):
            points, contacts = measured["points"].values[case, at], measured["patch_count"].values[case, at]
            if method == "bem":
                start, load = bem.error_model.seconds(points, contacts)
                seconds.values[case, at] = start + load.sum()
            if method == "patches":
                waves = [1, 3][case]
                seconds.values[case, at] = (
                    patches.error_model.SECONDS_START + patches.error_model.seconds(waves, contacts).sum()
                )
    found = {each.name: each for each in constants(measured.assign(seconds=seconds))}
    for name in ("SECONDS_LOAD bem", "SECONDS_NODE bem"):
        assert found[name].measured == pytest.approx(found[name].shipped, rel=1e-6)


def test_nothing_is_said_of_methods_that_were_not_run(measured):
    only = measured.isel(variant=measured["solution_method"].values == "demelio")
    found = {each.name: each.measured for each in constants(only)}
    assert found["DEMELIO"] > 0
    assert found["LAYER"] != found["LAYER"]
    assert found["SECONDS_WAVE"] != found["SECONDS_WAVE"]
