"""A product is fresh if its files are those in its stamp. What it is made of: test_freshness."""

import shutil
from pathlib import Path

from weier.pipeline import products
from weier.pipeline.products import STAMPS, files_of, remove_older, stamp_of

FILES = files_of("one")


def fill(folder, job, stamp):
    """Make the files of the figure and their stamp, as the rules do."""
    made = folder / STAMPS / job / stamp
    for file in FILES:
        for path in (folder / file, made / Path(file).name):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(file)
    remove_older(folder / STAMPS / job, "one")


def test_stamps_count_with_their_files_also_in_a_copy_and_an_edit_asks_for_one_of_another_name(tmp_path, monkeypatch):
    monkeypatch.setattr(products, "made_of", lambda curves, product: curves)  # digests in place of curves
    folder, stamps = tmp_path / "scene", {"one/a"}
    assert stamp_of("a", folder, "one") == ("one/a", False)
    fill(folder, "job", "one/a")
    (folder / STAMPS / "job/two").mkdir()  # of another product, which is kept
    copy = shutil.copytree(folder, tmp_path / "copy")
    assert stamp_of("a", copy, "one") == stamp_of("a", folder, "one") == ("job/one/a", True)
    assert stamp_of("b", folder, "one") == ("one/b", False)
    edits = [Path.unlink, lambda path: path.write_text("edited")]
    for number, (file, edit) in enumerate((file, edit) for file in FILES for edit in edits):
        edit(folder / file)
        stamp, fresh = stamp_of("a", folder, "one")
        assert (stamp.startswith("one/a."), fresh) == (True, False)
        assert stamp_of("a", folder, "one")[0] == stamp  # in each plan the same one
        fill(folder, f"job {number}", stamp)
        assert stamp_of("a", folder, "one") == (f"job {number}/{stamp}", True)
        stamps.add(stamp)
    assert len(stamps) == 1 + 2 * len(FILES)
    left = {path.relative_to(folder / STAMPS).as_posix() for path in (folder / STAMPS).glob("*/*")}
    assert left == {"job/two", f"job {number}/one"}
