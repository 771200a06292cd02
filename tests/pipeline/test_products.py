"""Products are made of curves, entries of the scene and code; stamps say of which. Keys of scenes: test_freshness."""

import shutil
from pathlib import Path

import pytest

from weier.pipeline import products
from weier.pipeline.products import STAMPS, files_of, remove_older, stamp_of

FILES = files_of("one")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder of a scene with a figure. Digests are given in place of curves."""
    monkeypatch.setattr(products, "made_of", lambda curves, product: curves)
    assert stamp_of("a", tmp_path, "one") == ("one/a", False)
    fill(tmp_path, "job", "one/a")
    return tmp_path


def fill(folder, job, stamp):
    """Make the files of the figure and their stamp, as the rules do."""
    made = folder / STAMPS / job / stamp
    for file in FILES:
        for path in (folder / file, made / Path(file).name):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(file)
    remove_older(folder / STAMPS / job, "one")


def test_a_stamp_with_its_files_counts_also_in_a_copy(folder, tmp_path):
    copy = shutil.copytree(folder, tmp_path / "copy")
    assert stamp_of("a", copy, "one") == stamp_of("a", folder, "one") == ("job/one/a", True)
    assert stamp_of("b", folder, "one") == ("one/b", False)


@pytest.mark.parametrize("change", [Path.unlink, lambda path: path.write_text("edited")])
def test_an_edited_file_asks_for_a_stamp_that_is_missing(folder, change):
    """Each time by another name, and a file that a killed job has not put into its place, too."""
    (folder / STAMPS / "job/two").mkdir()  # of another product, which is kept
    names = {"one/a"}
    for job, file in enumerate(FILES):
        change(folder / file)
        stamp, fresh = stamp_of("a", folder, "one")
        assert (stamp.startswith("one/a."), fresh) == (True, False)
        assert stamp_of("a", folder, "one")[0] == stamp  # in each plan the same one
        fill(folder, f"job {job}", stamp)
        assert stamp_of("a", folder, "one") == (f"job {job}/{stamp}", True)
        names.add(stamp)
    assert len(names) == 1 + len(FILES)
    left = {path.relative_to(folder / STAMPS).as_posix() for path in (folder / STAMPS).glob("*/*")}
    assert left == {"job/two", f"job {len(FILES) - 1}/one"}
