"""Every method has its place in each table of methods: who adds one is told which are left."""

import numpy as np
import pytest

from weier import Profile, solve
from weier.accuracy.extremes.cases import extremes
from weier.accuracy.extremes.verdicts import NOISE
from weier.accuracy.tradeoff.contenders import contenders
from weier.cli import options
from weier.figures import style, work_precision
from weier.methods import laws
from weier.methods.registry import NUMERICAL, PLANNED
from weier.methods.solve import METHODS, NotApplicableError
from weier.pipeline import curves

ONE_WAVE = "westergaard"
THREE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
TABLES = {
    "weier/methods.py NUMERICAL or weier/curves.py ESTIMATES": {*NUMERICAL, *curves.ESTIMATES, ONE_WAVE, PLANNED},
    "weier/figures/style.py METHODS": set(style.METHODS),
    "weier/figures/work_precision.py FAMILIES": {*work_precision.FAMILIES, ONE_WAVE, PLANNED},
    "weier/tradeoff/contenders.py": {*(each.method for each in contenders(THREE)), ONE_WAVE, PLANNED},
    "weier/extremes/cases.py": {each.method for each in next(extremes()).contenders},  # of one wave, which all take
    "weier/extremes/verdicts.py NOISE": set(NOISE),
    # A plan takes Demelio's estimate rather than Archard's, which is no cheaper and no closer.
    "weier/laws.py SECONDS_START": {*laws.SECONDS_START} - {"endless"} | {"archard", PLANNED},
    "weier/laws.py SECONDS_LOAD": {*laws.SECONDS_LOAD} - {"endless"} | {"archard", PLANNED},
}


@pytest.mark.parametrize("table", TABLES)
def test_every_method_is_in(table):
    assert TABLES[table] == set(METHODS)


def test_no_method_is_both_numerical_and_an_estimate():
    assert not set(NUMERICAL) & set(curves.ESTIMATES)


@pytest.mark.parametrize("method", METHODS)
def test_what_solves_the_series_itself_wants_a_finite_one(method):
    """And the help tells which methods take an endless one."""
    (m,) = (option for option in _options() if option.name == "m")
    endless = Profile(1.25, 5, np.inf)
    if method in (*NUMERICAL, ONE_WAVE):
        with pytest.raises(NotApplicableError):
            solve(endless, [0.1], method)
    else:
        assert np.isfinite(solve(endless, [0.1], method).compliance).all()
    assert (method in m.help) == (method not in (*NUMERICAL, ONE_WAVE))


def _options():
    command = options.of_one_profile(lambda: None)
    return command.__click_params__


def test_no_two_methods_look_alike():
    """But for the numerical ones: the second is drawn as points beside the first."""
    names = [name for name in METHODS if name not in NUMERICAL[1:]]
    looks = {(str(style.METHODS[name].color), str(style.METHODS[name].linestyle)) for name in names}
    assert len(looks) == len(names)
