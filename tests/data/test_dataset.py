"""Files of datasets: whole or not at all, and read by others."""

import numpy as np
import pytest

from tests.scenes import blank, read
from weier.data import dataset
from weier.data.variables import Status

METHODS = ["westergaard", "demelio", "bem"]


@pytest.fixture
def waves(tmp_path_factory):
    """Three cases, as if they were solved, read from a file."""
    data = blank(3, METHODS, np.array([0.01, 0.1, 1.0]), 2)
    random = np.random.default_rng(0)
    for name in ("compliance", "resistance", "work", "residual"):
        data[name].values[:] = random.random(data[name].shape)
    data["key"].values[:] = "a", "b", "c"
    data["m"].values[:] = 1, 2, np.inf
    data["status"].values[:] = Status.solved
    path = tmp_path_factory.mktemp("waves") / "waves.nc"
    dataset.write(data, path, "test")
    return read(path).drop_vars("case")


def test_a_written_file_is_read_back_and_written_the_same(waves, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")  # or the seconds of a clock would differ
    first, second = tmp_path / "a.nc", tmp_path / "b.nc"
    dataset.write(waves, first, "test")
    dataset.write(read(first).drop_vars("case"), second, "test")
    assert first.read_bytes() == second.read_bytes()
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["a.nc", "b.nc"]


def test_a_file_that_cannot_be_finished_is_not_there(waves, tmp_path):
    broken = waves.assign(bad=("case", np.array([object(), 1, 2], dtype=object)))
    with pytest.raises(ValueError, match="mixed native types: int, object"):
        dataset.write(broken, tmp_path / "a.nc", "test")
    assert list(tmp_path.iterdir()) == []


def test_a_truncated_or_missing_file_is_refused_in_one_sentence(waves, tmp_path):
    path = tmp_path / "a.nc"
    dataset.write(waves, path, "test")
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(ValueError, match=r"not a whole netCDF file .*, and weier made it, move it away"):
        read(path)
    with pytest.raises(FileNotFoundError, match=r"there is no file .*none\.nc"):
        read(tmp_path / "none.nc")
