"""Products are made of curves, entries of the scene and code; stamps say of which. Keys of scenes: test_freshness."""

import pytest

from tests.pipeline.test_freshness import ALL, digests_of
from weier import digests
from weier.pipeline import products
from weier.pipeline.products import DATA, files_of, fill_stamp, stamp_of


def test_data_of_another_date_are_other_data(tmp_path, monkeypatch):
    """Figures and the explorer have no dates."""
    found = []
    for date in ("", "1000000000", "2000000000"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", date)
        found.append(digests_of(tmp_path))
    assert len({one[DATA] for one in found}) == 3
    assert all(len({one[name] for one in found}) == 1 for name in ALL - {DATA})


@pytest.mark.parametrize(
    ("parts", "expected"),
    [
        (("figures",), ALL - {DATA}),
        (("data",), ALL),
        (("pipeline",), ALL),
        (digests.CURVES, ALL),
        (("cli", "accuracy"), set()),
    ],
)
def test_other_code_makes_again_what_it_makes(tmp_path, monkeypatch, parts, expected):
    before, usual = digests_of(tmp_path), digests.digest_of_modules

    def edited(*asked, **options):
        return usual(*asked, **options)[::-1] if {*asked} & {*parts} else usual(*asked, **options)

    for module in (digests, products):
        monkeypatch.setattr(module, "digest_of_modules", edited)
    after = digests_of(tmp_path)
    assert {name for name in ALL if before[name] != after[name]} == expected


@pytest.fixture
def made(tmp_path):
    """A folder with a figure, and a function that asks for its stamp."""
    for file in files_of("one"):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_text(file)

    def ask(digest="a"):
        stamp, fresh = stamp_of(tmp_path, "one", digest)
        return stamp, stamp.exists(), fresh

    return ask


def begin(stamp):
    stamp.parent.mkdir(parents=True, exist_ok=True)
    stamp.touch()


def test_a_stamp_goes_from_missing_to_empty_to_filled(made, tmp_path):
    stamp, exists, fresh = made()
    assert (stamp, exists, fresh) == (tmp_path / ".made_of/one/a", False, False)
    begin(stamp)
    assert made() == (stamp, True, False)  # as a job leaves it that is killed before the product
    fill_stamp(stamp)
    assert made() == (stamp, True, True)
    other, *state = made("b")
    assert (other.name, state) == ("b", [False, False])
    begin(other)
    fill_stamp(other)
    assert [path.name for path in stamp.parent.iterdir()] == ["b"]  # so that the way back makes it again
    assert made("a")[1:] == (False, False)


@pytest.mark.parametrize("file", files_of("one"))
@pytest.mark.parametrize("lost", [False, True])
def test_an_edited_file_asks_for_a_stamp_that_is_missing(made, tmp_path, file, lost):
    stamp = made()[0]
    begin(stamp)
    fill_stamp(stamp)
    (tmp_path / file).unlink() if lost else (tmp_path / file).write_text("edited")
    edited, exists, fresh = made()
    assert (edited.name.partition(".")[0], exists, fresh) == ("a", False, False)
    assert made()[0] == edited  # in each plan the same one
    begin(edited)
    assert made() == (edited, True, False)
    (tmp_path / file).write_text(file)
    fill_stamp(edited)
    assert made() == (edited, True, True)
    (tmp_path / file).write_text("edited again")
    assert made()[0] not in (stamp, edited)


def test_a_stamp_that_was_copied_with_its_files_counts(made, tmp_path):
    stamp = made()[0]
    begin(stamp)
    fill_stamp(stamp)
    copy = tmp_path / "copy"
    for path in (stamp, *(tmp_path / file for file in files_of("one"))):
        (copy / path.relative_to(tmp_path)).parent.mkdir(parents=True, exist_ok=True)
        (copy / path.relative_to(tmp_path)).write_bytes(path.read_bytes())
    assert stamp_of(copy, "one", "a") == (copy / ".made_of/one/a", True)
