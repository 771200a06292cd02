"""Digests that are kept: right ones, whatever has become of the sources, of the file and of its folder."""

import json

import pytest

from weier.kernels.definitions import definitions
from weier.pipeline import digests

NAME = "weier.theory.bounds.compliance_bounds"


@pytest.fixture
def file(monkeypatch, tmp_path):
    """Where the digests of this test are kept."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    start_anew()
    yield tmp_path / "cache" / "digests.json"
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


def test_after_an_edit_all_are_found_anew(file, monkeypatch):
    found = digests.digest_of_definitions(NAME)
    texts = digests.texts_of_modules()
    changed = texts | {"theory/bounds.py": texts["theory/bounds.py"] + "\nMORE = 1\n"}
    start_anew()
    monkeypatch.setattr(digests, "texts_of_modules", lambda: changed)
    monkeypatch.setattr(digests, "definitions", lambda *names, without: {NAME: "edited"})
    again = digests.digest_of_definitions(NAME)
    assert again == digests.digest({NAME: "edited"}) != found
    assert list(json.loads(file.read_text())["digests"].values()) == [again]


def test_sources_that_are_edited_meanwhile_keep_nothing(file, monkeypatch):
    texts = iter([{"one.py": "before"}, {"one.py": "after"}])
    monkeypatch.setattr(digests, "texts_of_modules", lambda: next(texts))
    assert digests.digest_of_definitions(NAME) == digests.digest(definitions(NAME))
    assert not file.exists()


@pytest.mark.parametrize("text", ["", "[]", '{"sources": 1}', '{"sources": "SOURCES", "digests": 3}', "\x00"])
def test_a_damaged_file_counts_as_none(text, file):
    file.parent.mkdir()
    file.write_text(text.replace("SOURCES", digests._sources()))
    assert digests.digest_of_definitions(NAME) == digests.digest(definitions(NAME))
    assert json.loads(file.read_text())["sources"] == digests._sources()


def test_where_nothing_can_be_kept_digests_are_found_each_time(file):
    file.parent.write_text("a file, not a folder")
    assert digests.digest_of_definitions(NAME) == digests.digest(definitions(NAME))
