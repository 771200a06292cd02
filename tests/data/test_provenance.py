"""The commit that files name as their origin."""

import subprocess

from weier.data import provenance


def test_the_commit_of_a_checkout_is_named_with_its_changes_and_not_by_a_tag(tmp_path, monkeypatch):
    def git(*arguments):
        own = ["-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false", "-c", "tag.gpgsign=false"]
        done = subprocess.run(["git", "-C", tmp_path, *own, *arguments], check=True, capture_output=True, text=True)
        return done.stdout.strip()

    monkeypatch.setattr(provenance, "PACKAGE", tmp_path / "weier")
    commit = provenance.commit.__wrapped__
    (tmp_path / "weier").mkdir()
    (tmp_path / "weier/one.py").touch()
    assert commit() == ""
    git("init")
    git("add", ".")
    git("commit", "-m", "first")
    git("tag", "-a", "v1", "-m", "first")
    assert commit() == git("rev-parse", "HEAD")
    (tmp_path / "weier/one.py").write_text("1")
    assert commit() == f"{git('rev-parse', 'HEAD')} with changes"
