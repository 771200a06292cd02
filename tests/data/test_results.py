"""Opened files: labelled selection, read where asked for, and joined without being held in memory."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import weier
from weier.data import dataset

METHODS = ["demelio", "bem"]
LOADS = np.geomspace(1e-3, 4, 40)
CASES = [
    (1.25, 5, 2, (0, 1)),
    (1.5, 5, 2, (0, 1)),
    (1.5, 2.5, 3, (0, 1, 1)),
    (1.5, 5, np.inf, ()),
    (1.5, 5, 2, (1, 2)),
]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("opened") / "contact.nc"
    data = dataset.blank(len(CASES), METHODS, LOADS, 3)
    for row, (D, gamma, m, phase) in enumerate(CASES):
        for name, value in {"key": f"case{row}", "D": D, "gamma": gamma, "m": m}.items():
            data[name].values[row] = value
        data["phase"].values[row, : len(phase)] = phase
        data["compliance"].values[row] = 10 * row + np.arange(2)[:, None] + LOADS / 10
    dataset.write(data, path, "test")
    return path


def selected(path, **labels):
    with weier.open(path) as contact:
        return contact.sel(**labels).data["key"].values.tolist()


@pytest.mark.parametrize(
    ("labels", "rows"),
    [
        ({"D": 1.25}, [0]),
        ({"D": 1.5}, [1, 2, 3, 4]),
        ({"D": [1.25, 1.5], "gamma": 5}, [0, 1, 3, 4]),
        ({"gamma": "5/2"}, [2]),
        ({"m": np.inf}, [3]),
        ({"m": 2, "phase": 1.0}, [0, 1]),
        ({"m": 2, "phase": [1, 2]}, [4]),
        ({"phase": [0, 1, 1]}, [2, 3]),
        ({}, [0, 1, 2, 3, 4]),
    ],
)
def test_selection_by_labels(path, labels, rows):
    assert selected(path, **labels) == [f"case{row}" for row in rows]


def test_method_is_a_label(path):
    with weier.open(path) as contact:
        bem = contact.sel(solution_method="bem", D=1.25)["compliance"]
        assert bem.dims == ("case", "mean_pressure")
        assert bem.values[0] == pytest.approx(1 + LOADS / 10)
        assert contact.sel(solution_method=["bem"]).data.sizes["solution_method"] == 1
        assert float(
            contact.sel(solution_method="bem", mean_pressure=4.0, m=np.inf)["compliance"][0]
        ) == pytest.approx(31.4)


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ({"D": 1.3}, r"no case has D = 1.3: choose from 1.25, 1.5"),
        ({"D": slice(1, 2)}, "D must be a number, got slice"),
        ({"gamma": "x"}, "gamma must be a finite number or a fraction such as \"5/2\", got 'x'"),
        ({"solution_method": "bme"}, "solution_method must be one of demelio, bem, got 'bme'"),
        ({"phases": 3.0, "m": 2}, "no case has phases = 3.0"),
        ({"phases": [0, 1, 2, 3]}, "at most 3 numbers, got 4"),
        ({"mean_pressure": 2.0}, r"no mean_pressure 2.0: choose from 0.001, .*\.\.\."),
    ],
)
def test_an_unknown_label_says_what_is_there(path, labels, message):
    with pytest.raises(ValueError, match=message):
        selected(path, **labels)


def test_nothing_is_read_before_it_is_asked_for(path):
    with weier.open(path) as contact:
        one = contact.sel(solution_method="bem")
        assert not one.data["compliance"].variable._in_memory
        assert one["compliance"].values.shape == (5, 40)


PART = 500
MEMORY = 70  # MB, for 166 or 1660 MB of curves: a part of it, block by block, and the caches of the files
MEMORY_KEYS = 3e-4  # MB a case: where each key belongs

GATHER = """
import resource, sys
from pathlib import Path
from weier.pipeline.gather import gather
folder, count = Path(sys.argv[1]), int(sys.argv[2])
files = sorted(folder.glob("part*.nc"))
gather(files, [f"{key:06}" for key in range(100)], folder / "few.nc", "few")
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
gather(files, [f"{key:06}" for key in range(count)], folder / "many.nc", "many")
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
"""

LOOK = """
import resource, sys
import weier
weier.open(sys.argv[2]).sel(D=1.25, solution_method="bem")["compliance"].values
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
found = weier.open(sys.argv[1]).sel(D=[1.25 + 7 / 2**20, 1.25 + 9998 / 2**20], solution_method="bem")
found = found["compliance"].values
assert found.shape[0] == 2, found.shape
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
"""


def peak(program, *arguments):
    """What a program prints: MB that it took more than for a small part of the same."""
    command = [sys.executable, "-c", program, *map(str, arguments)]
    return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@pytest.fixture(scope="module", params=[10_000, pytest.param(100_000, marks=pytest.mark.slow)])
def count(request):
    return request.param


def dimensions(start, count):
    """D of so many cases, each another one, to the last digit."""
    return 1.25 + np.arange(start, start + count) / 2**20


@pytest.fixture(scope="module")
def many(count, tmp_path_factory):
    folder = tmp_path_factory.mktemp("many")
    data = dataset.blank(PART, ["archard", "demelio", "layer", "bem"], LOADS, 3)
    random = np.random.default_rng(1)
    for values in data.data_vars.values():
        if values.dtype.kind == "f":
            values.values[:] = random.random(values.shape).round(2)
    data["gamma"].values[:], data["m"].values[:], data["points"].values[:] = 5, 3, 1600
    for start in range(0, count, PART):
        data["key"].values[:] = [f"{key:06}" for key in range(start, start + PART)]
        data["D"].values[:] = dimensions(start, PART)
        dataset.write(data, folder / f"part{start:06}.nc", "part")
    return folder


def test_many_cases_are_gathered_and_read_in_little_memory(many, count):
    assert peak(GATHER, many, count) < MEMORY + MEMORY_KEYS * count
    assert peak(LOOK, many / "many.nc", many / "part000000.nc") < MEMORY + MEMORY_KEYS * count
    last = many / f"part{count - PART:06}.nc"
    with xr.open_dataset(many / "many.nc") as data, xr.open_dataset(last) as part:
        assert data.sizes["case"] == count
        assert data["D"].values.tolist() == dimensions(0, count).tolist()
        for name in ("compliance", "status", "settings"):
            assert data[name][-PART:].equals(part[name].drop_vars(())), name
        raw = sum(
            data[name].nbytes for name in data.data_vars if data[name].ndim == 3 and data[name].dtype.kind == "f"
        )
        assert raw > 2 * MEMORY * 2**20
