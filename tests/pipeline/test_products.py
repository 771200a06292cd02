"""Products are made of curves, entries of the scene and code; stamps say of which. Keys of scenes: test_freshness."""

import shutil
from pathlib import Path

import pytest

from weier.pipeline.products import files_of, stamp_of


@pytest.fixture
def made(tmp_path):
    """The folder of a scene with a figure as it was made, and its stamp."""
    stamp = stamp_of(tmp_path, "one", "a")[0]
    assert stamp == tmp_path / ".made_of/one/a"
    fill(stamp)
    return tmp_path, stamp


def fill(stamp):
    """Put files into a stamp, and copy them to their places, as the rules do."""
    stamp.mkdir(parents=True)
    for file in files_of("one"):
        path = stamp.parents[2] / file
        path.parent.mkdir(exist_ok=True)
        (stamp / path.name).write_text(file)
        path.write_text(file)


def test_a_stamp_with_its_files_counts_also_in_a_copy(made, tmp_path):
    folder, stamp = made
    assert stamp_of(folder, "one", "a") == (stamp, True)
    assert stamp_of(folder, "one", "b") == (stamp.with_name("b"), False)
    copy = shutil.copytree(folder, tmp_path / "copy")
    assert stamp_of(copy, "one", "a") == (copy / ".made_of/one/a", True)


@pytest.mark.parametrize("file", files_of("one"))
@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.write_text("edited")])
def test_an_edited_file_asks_for_a_stamp_that_is_missing(made, file, change):
    """Each time by another name, and a file that a killed job has not copied, too."""
    folder, first = made
    change(folder / file)
    second, fresh = stamp_of(folder, "one", "a")
    assert (second.name.partition(".")[0], second.exists(), fresh) == ("a", False, False)
    assert stamp_of(folder, "one", "a")[0] == second  # in each plan the same one
    shutil.rmtree(first)
    fill(second)
    assert stamp_of(folder, "one", "a") == (second, True)
    change(folder / file)
    assert stamp_of(folder, "one", "a")[0] not in (first, second)
