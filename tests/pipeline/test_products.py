"""Products are made of curves, entries of the scene and code; stamps say of which. Keys of scenes: test_freshness."""

import shutil
from pathlib import Path

import pytest

from weier.pipeline.products import files_of, remove_older, stamp_of

FILES = files_of("one")


@pytest.fixture
def made(tmp_path):
    """The folder of a scene with a figure as it was made, and its stamp."""
    assert stamp_of(tmp_path, "one", "a") == (Path("one/a"), False)
    return tmp_path, fill(tmp_path, Path(".made_of/job/one/a"))


def fill(folder, stamp):
    """Make the files of a figure and their stamp, as the rules do."""
    (folder / stamp).mkdir(parents=True)
    (folder / "figures").mkdir(exist_ok=True)
    for file in FILES:
        (folder / file).write_text(file)
        shutil.copy(folder / file, folder / stamp)
    return folder / stamp


def test_a_stamp_with_its_files_counts_also_in_a_copy(made, tmp_path):
    folder, stamp = made
    assert stamp_of(folder, "one", "a") == (stamp, True)
    assert stamp_of(folder, "one", "b") == (Path("one/b"), False)
    copy = shutil.copytree(folder, tmp_path / "copy")
    assert stamp_of(copy, "one", "a") == (copy / ".made_of/job/one/a", True)


@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.write_text("edited")])
def test_an_edited_file_asks_for_a_stamp_that_is_missing(made, file, change):
    """Each time by another name, and a file that a killed job has not put into its place, too."""
    folder, first = made
    change(folder / file)
    second, fresh = stamp_of(folder, "one", "a")
    assert (second.name.partition(".")[0], fresh) == ("a", False)
    assert second.name != first.name
    assert stamp_of(folder, "one", "a")[0] == second  # in each plan the same one
    stamp = fill(folder, Path(".made_of/next") / second)
    remove_older(stamp.parents[1], "one")
    assert [path.name for path in stamp.parents[2].iterdir()] == ["next"]
    assert stamp_of(folder, "one", "a") == (stamp, True)


def test_the_stamps_of_other_products_are_kept(made):
    """Products of one job become outdated one by one."""
    folder, first = made
    (first.parents[1] / "two").mkdir()
    stamp = fill(folder, Path(".made_of/next/one/b"))
    remove_older(stamp.parents[1], "one")
    assert (first.parents[1].exists(), first.parent.exists(), stamp.exists()) == (True, False, True)
