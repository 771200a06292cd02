"""Files that appear whole or not at all."""

import os

import pytest

from weier.data.files import replacing, write_text


def test_a_file_appears_when_all_went_well(tmp_path):
    with replacing(tmp_path / "a") as beside:
        beside.write_text("new")
        assert list(tmp_path.iterdir()) == [beside]
    assert [path.read_text() for path in tmp_path.iterdir()] == ["new"]


def test_a_file_stays_as_it_was_when_something_went_wrong(tmp_path):
    (tmp_path / "a").write_text("old")
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "a") as beside:
        (beside / "of no folder").write_text("new")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_a_text_makes_its_folder(tmp_path):
    write_text(tmp_path / "new" / "a", "p → 0")
    assert [path.read_bytes().decode("utf-8") for path in (tmp_path / "new").iterdir()] == ["p → 0"]


@pytest.mark.parametrize(
    ("name", "why"), [("a", "it is a folder"), ("file/b", "Not a directory"), ("pipe", "it is a device")]
)
def test_an_unwritable_file_is_reported_by_its_own_name(tmp_path, name, why):
    """The file beside it is nobody's concern."""
    (tmp_path / "a").mkdir()
    (tmp_path / "file").touch()
    os.mkfifo(tmp_path / "pipe")
    path = tmp_path / name
    with pytest.raises(OSError, match=why) as refused, replacing(path) as beside:
        beside.write_text("new")
    assert str(refused.value).startswith(f"{path} cannot be written (")
    assert {path.name for path in tmp_path.rglob("*")} == {"a", "file", "pipe"}


def test_a_link_is_followed(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "folder" / "file")
    write_text(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "folder" / "file").read_text() == "new"
