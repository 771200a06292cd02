"""What a run survives: after each fault the next one ends with the same bytes, or says in one sentence what to do."""

import os
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.checkouts import copied, environment, snakemake

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [archard, demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""
PATIENCE = 120  # seconds
PAUSE = Path(__file__).parent / "pause"
OPTIONS = ["--cores", "1", "--config", "scenes=test"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A copy of the checkout with a finished run."""
    folder = copied(tmp_path_factory.mktemp("undisturbed"), SCENE, "profiles")
    assert run(folder)[0] == 0
    return folder


@pytest.fixture
def checkout(undisturbed, tmp_path):
    """The same, to be disturbed."""
    return shutil.copytree(undisturbed, tmp_path / "checkout")


def run(checkout, *arguments):
    """Exit code and all that was said."""
    done = snakemake(checkout, *OPTIONS, *arguments)
    return done.returncode, done.stdout + done.stderr


def made(checkout):
    """The products, and no file that should not be left."""
    known = (".made_of", ".solved", ".snakemake_timestamp")
    assert [path for path in checkout.rglob("results/**/.*") if path.name not in known] == []
    return [(checkout / "results/test" / name).read_bytes() for name in ("contact.nc", "claims.md")]


def assert_the_next_run_is_undisturbed(checkout, undisturbed):
    code, said = run(checkout)
    assert code == 0, said
    assert made(checkout) == made(undisturbed)


@contextmanager
def paused(checkout, at, folder, *options):
    """Snakemake, and the number of its worker that stands still with the file `at` written and not yet in place."""
    here, end = folder / "here", time.monotonic() + PATIENCE
    here.touch()
    variables = environment(PAUSE_AT=at, PAUSE_FILE=str(here), PYTHONPATH=str(PAUSE))
    with (folder / "said").open("w") as said:
        command = ["snakemake", *OPTIONS, *options]
        process = subprocess.Popen(
            command, cwd=checkout, env=variables, stdout=said, stderr=said, start_new_session=True
        )
    try:
        while process.poll() is None and not here.read_text():
            assert time.monotonic() < end
            time.sleep(0.02)
        yield process, int(here.read_text())
    finally:
        here.unlink(missing_ok=True)
        process.wait(PATIENCE)


def test_what_is_stopped_or_killed_leaves_a_run_that_the_next_one_ends(checkout, undisturbed, tmp_path, ctrl_c):
    """Ctrl-C, then a kill of Snakemake, with a segment written and not in place, then of a job that runs again."""
    results = checkout / "results"
    shutil.rmtree(results)
    with paused(checkout, ".npz", tmp_path) as (process, _):
        os.killpg(process.pid, signal.SIGINT)
    assert process.returncode != 0
    assert "Traceback" not in (tmp_path / "said").read_text()
    assert [*results.rglob(".*.npz.*")] == []

    shutil.rmtree(results / "curves", ignore_errors=True)
    with paused(checkout, ".npz", tmp_path) as (process, worker):
        code, said = run(checkout)
        assert (code != 0, "can be removed with the --unlock argument" in said) == (True, True)
        process.kill()
        process.wait(PATIENCE)
        assert run(checkout, "--unlock")[0] == 0
        assert run(checkout)[0] == 0
        os.kill(worker, 0)  # it still stands there: what it is writing is its own
    assert_the_next_run_is_undisturbed(checkout, undisturbed)

    shutil.rmtree(results)
    with paused(checkout, "page.html", tmp_path, "--retries", "1") as (process, worker):
        os.kill(worker, signal.SIGKILL)
    assert process.returncode == 0
    assert made(checkout) == made(undisturbed)


@contextmanager
def mounted(folder, *options):
    done = subprocess.run(["mount", *options, folder], capture_output=True, text=True)
    if done.returncode:  # a developer may be no root; in a container, these tests run
        pytest.skip(f"only root may mount a disk to fill or to close: {done.stderr.strip()}")
    try:
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


@pytest.mark.slow
@pytest.mark.parametrize("room", [0, 100])
def test_a_run_that_filled_the_disk_goes_on_once_there_is_room(checkout, undisturbed, room):
    """With so many kB left: it fails sooner or later, and goes on from there."""
    shutil.rmtree(checkout / "results")
    (checkout / "results").mkdir()
    with mounted(checkout / "results", "-t", "tmpfs", "-o", "size=64k", "tmpfs"):
        subprocess.run(["mount", "-o", f"remount,size={room + 4}k", checkout / "results"], check=True)
        code, said = run(checkout)
        assert code != 0
        assert "No space left on device" in said
        subprocess.run(["mount", "-o", "remount,size=10m", checkout / "results"], check=True)
        assert_the_next_run_is_undisturbed(checkout, undisturbed)


def test_a_run_is_planned_in_a_folder_closed_to_writing(checkout):
    results = checkout / "results"
    for name in ("contact.nc", "claims.md"):
        (results / "test" / name).unlink()
    for folder in (results, results / "test"):
        with mounted(folder, "--bind", folder):
            subprocess.run(["mount", "-o", "remount,ro,bind", folder], check=True)
            code, said = run(checkout, "-n")
        assert code == 0, said
        assert "results/test/contact.nc" in said
