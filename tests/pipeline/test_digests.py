"""Digests that are kept: right ones, whatever has become of the sources, of the file and of its folder."""

import json
import os
from pathlib import Path

import pytest

from weier.kernels.definitions import definitions
from weier.pipeline import digests

NAME = "weier.theory.bounds.compliance_bounds"


@pytest.fixture
def file(monkeypatch, tmp_path):
    """Where the digests of this test are kept, while no source changes."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    start_anew()
    yield digests._file(digests._read_sources())
    start_anew()


def start_anew():
    """Forget what is in memory, as another process does."""
    digests._known.cache_clear()
    digests._sources.cache_clear()


def refuse(*_, **__):
    raise AssertionError("definitions were looked for")


def test_another_process_finds_what_one_has_kept(file, monkeypatch):
    found = digests.digest_of_definitions(NAME)
    assert found == digests.digest(definitions(NAME))
    start_anew()
    monkeypatch.setattr(digests, "definitions", refuse)
    assert digests.digest_of_definitions(NAME) == found
    with pytest.raises(AssertionError, match="looked for"):
        digests.digest_of_definitions(NAME, without=["weier.theory.bounds.MARGIN"])


def test_after_an_edit_all_are_found_anew_and_two_checkouts_keep_theirs(file, monkeypatch):
    found = digests.digest_of_definitions(NAME)
    before = file.read_bytes()
    texts = digests.texts_of_modules()
    changed = texts | {"theory/bounds.py": texts["theory/bounds.py"] + "\nMORE = 1\n"}
    start_anew()
    monkeypatch.setattr(digests, "texts_of_modules", lambda: changed)
    monkeypatch.setattr(digests, "definitions", lambda *names, without: {NAME: "edited"})
    again = digests.digest_of_definitions(NAME)
    assert again == digests.digest({NAME: "edited"}) != found
    (new,) = set(file.parent.iterdir()) - {file}
    assert list(json.loads(new.read_text()).values()) == [again]
    assert file.read_bytes() == before


def test_sources_that_are_edited_while_they_are_parsed_keep_nothing(file, monkeypatch):
    texts = {"one.py": "before"}

    def parse(*names, without):
        texts["one.py"] = "after"
        return {NAME: "before"}

    monkeypatch.setattr(digests, "texts_of_modules", lambda: texts)
    monkeypatch.setattr(digests, "definitions", parse)
    assert digests.digest_of_definitions(NAME) == digests.digest({NAME: "before"})
    assert not file.parent.exists()


def test_old_files_go(file, monkeypatch):
    """Each state of the sources is newer than the one before; the file of a kernel is none of these."""
    file.parent.mkdir()
    (file.parent / "kernels").touch()
    monkeypatch.setattr(digests, "definitions", lambda *names, without: {NAME: "edited"})
    kept = []
    for number in range(digests.MAX_FILES + 3):
        monkeypatch.setattr(digests, "texts_of_modules", lambda number=number: {"one.py": str(number)})
        start_anew()
        digests.digest_of_definitions(NAME)
        kept.append(digests._file(digests._sources()))
        os.utime(kept[-1], (number, number))
    os.utime(kept[-1])
    assert sorted(file.parent.iterdir()) == sorted([*kept[-digests.MAX_FILES :], file.parent / "kernels"])


@pytest.mark.parametrize("text", ["", "[]", "1", '"text"', "\x00"])
def test_a_damaged_file_counts_as_none(text, file):
    file.parent.mkdir()
    file.write_text(text)
    found = digests.digest_of_definitions(NAME)
    assert found == digests.digest(definitions(NAME))
    assert list(json.loads(file.read_text()).values()) == [found]


def test_where_nothing_can_be_kept_digests_are_found_each_time(file):
    file.parent.write_text("a file, not a folder")
    assert digests.digest_of_definitions(NAME) == digests.digest(definitions(NAME))


def test_a_user_without_a_home_keeps_nothing(file, monkeypatch):
    """As in a container, where nobody has the number of the user."""

    def no_home():
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(Path, "home", no_home)
    assert digests.digest_of_definitions(NAME) == digests.digest(definitions(NAME))
