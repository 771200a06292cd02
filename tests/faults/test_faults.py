"""What a run survives: after each fault the next one ends with the same bytes, or says in one sentence what to do."""

import os
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.snakemakes import snakemake
from weier.digests import PACKAGE

SCENE = """
title: test
loads: [0.01, 0.1, 1.0]
methods: [archard, demelio]
studies:
  one: {product: {D: 1.25, gamma: 5, m: 2}}
"""
PRODUCTS = ("contact.nc", "claims.md")
PATIENCE = 120  # seconds
PAUSE = Path(__file__).parent / "pause"
OPTIONS = ["--cores", "2", "--config", "scenes=test"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A copy of the checkout with a finished run."""
    folder = tmp_path_factory.mktemp("undisturbed")
    for path in (Path("Snakefile"), Path("config"), Path("rules"), Path("profiles"), PACKAGE):
        copy = shutil.copytree if path.is_dir() else shutil.copy2
        copy(path, folder / path.name)
    (folder / "config/scenes/test.yaml").write_text(SCENE)
    assert run(folder)[0] == 0
    return folder


@pytest.fixture
def checkout(undisturbed, tmp_path):
    """The same, to be disturbed."""
    return shutil.copytree(undisturbed, tmp_path / "checkout")


def environment(checkout, **more):
    fixed = {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(checkout), "SOURCE_DATE_EPOCH": "1000000000"}
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return kept | fixed | more


def run(checkout, *arguments):
    """Exit code and all that was said."""
    done = snakemake(*OPTIONS, *arguments, cwd=checkout, env=environment(checkout))
    return done.returncode, done.stdout + done.stderr


def assert_the_next_run_is_undisturbed(checkout, undisturbed):
    code, said = run(checkout)
    assert code == 0, said
    for name in PRODUCTS:
        assert (checkout / "results/test" / name).read_bytes() == (undisturbed / "results/test" / name).read_bytes()
    assert leftovers(checkout) == []


def leftovers(checkout):
    known = (".made_of", ".drafts", ".solved", ".snakemake_timestamp")
    return [path for path in checkout.rglob("results/**/.*") if path.name not in known]


def forget(checkout, *names):
    for name in names:
        (checkout / "results/test" / name).unlink()


@contextmanager
def paused(checkout, at, tmp_path):
    """Snakemake, and the number of its worker that stands still with the file `at` written and not yet in place."""
    here = tmp_path / "here"
    more = {"PAUSE_AT": at, "PAUSE_FILE": str(here), "PYTHONPATH": f"{PAUSE}:{checkout}"}
    with (tmp_path / "said").open("w") as said:
        process = subprocess.Popen(
            ["snakemake", *OPTIONS],
            cwd=checkout,
            env=environment(checkout, **more),
            stdout=said,
            stderr=said,
            start_new_session=True,
        )
    try:
        wait(lambda: process.poll() is not None or (here.exists() and here.read_text()))
        yield process, int(here.read_text())
    finally:
        here.unlink(missing_ok=True)
        process.wait(PATIENCE)


def wait(until):
    end = time.monotonic() + PATIENCE
    while not until():
        assert time.monotonic() < end
        time.sleep(0.02)


def parent(process):
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])


def gone(process):
    """Whether a process has ended, also as a zombie."""
    status = Path(f"/proc/{process}/status")
    return not status.exists() or "State:\tZ" in status.read_text()


def test_after_a_worker_is_killed_the_next_run_makes_the_same_files(checkout, undisturbed, tmp_path):
    forget(checkout, *PRODUCTS)
    with paused(checkout, "contact.nc", tmp_path) as (process, worker):
        os.kill(worker, signal.SIGKILL)
    assert process.returncode != 0
    assert not (checkout / "results/test/contact.nc").exists()
    assert_the_next_run_is_undisturbed(checkout, undisturbed)


def test_what_a_killed_job_was_writing_is_removed_a_day_later(checkout, undisturbed, tmp_path):
    shutil.rmtree(checkout / "results")
    with paused(checkout, ".npz", tmp_path) as (_, worker):
        os.kill(worker, signal.SIGKILL)
    (segment,) = leftovers(checkout)
    os.utime(segment, (time.time() - 25 * 3600,) * 2)
    (young := segment.with_name(".a.npz.here.1")).touch()
    code, said = run(checkout)
    assert code == 0, said
    assert leftovers(checkout) == [young]


def test_nothing_works_on_after_a_kill_of_snakemake(checkout, undisturbed, tmp_path):
    """But the job that it had begun: its curves are kept, and no other job begins."""
    shutil.rmtree(checkout / "results")
    with paused(checkout, ".npz", tmp_path) as (process, worker):
        process.kill()
        process.wait(PATIENCE)
        assert not gone(worker)
    wait(lambda: not processes_of(process.pid))
    assert list((checkout / "results/curves").rglob("*.npz"))
    assert not any((checkout / "results/test" / name).exists() for name in PRODUCTS)
    assert run(checkout, "--unlock")[0] == 0
    assert_the_next_run_is_undisturbed(checkout, undisturbed)


def processes_of(session):
    """The numbers of all processes of a session that have not ended."""
    states = [text.rpartition(")")[2].split() for text in all_states()]
    return [state for state in states if int(state[3]) == session and state[0] != "Z"]


def all_states():
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has ended since
            yield path.read_text()


def test_ctrl_c_ends_a_run_whose_curves_are_kept(checkout, undisturbed, tmp_path, ctrl_c):
    shutil.rmtree(checkout / "results")
    with paused(checkout, ".npz", tmp_path) as (process, _):
        os.killpg(process.pid, signal.SIGINT)
    assert process.returncode != 0
    assert "Traceback" not in (tmp_path / "said").read_text()
    assert_the_next_run_is_undisturbed(checkout, undisturbed)


@pytest.mark.slow
def test_a_second_run_is_refused_and_a_killed_one_harms_no_later_one(checkout, undisturbed, tmp_path):
    forget(checkout, *PRODUCTS)
    with paused(checkout, "contact.nc", tmp_path) as (process, worker):
        code, said = run(checkout)
        assert code != 0
        assert "can be removed with the --unlock argument" in said
        process.kill()
        process.wait(PATIENCE)
        code, said = run(checkout)
        assert code != 0
        assert "can be removed with the --unlock argument" in said
        assert run(checkout, "--unlock")[0] == 0
        assert_the_next_run_is_undisturbed_beside(worker, checkout, undisturbed)
    wait(lambda: gone(worker))
    assert_the_next_run_is_undisturbed(checkout, undisturbed)


def assert_the_next_run_is_undisturbed_beside(worker, checkout, undisturbed):
    """The worker of the killed run still stands there: what it is writing is its own."""
    assert_the_next_run_is_undisturbed(checkout, undisturbed)
    assert not gone(worker)


@pytest.mark.parametrize("name", ["results/test/contact.nc", "results/curves/demelio"])
def test_what_is_damaged_is_made_again_or_named(checkout, undisturbed, name):
    """A product is made again; a segment is named, and its curves are solved again once it is moved away."""
    (path,) = [path for path in checkout.rglob("results/**/*.n*") if str(path.relative_to(checkout)).startswith(name)]
    path.write_bytes(path.read_bytes()[:500])
    if path.suffix == ".npz":
        code, said = run(checkout)
        assert code != 0
        assert f"weier: {path.relative_to(checkout)} is damaged" in said
        path.rename(checkout / "away.npz")
        forget(checkout, *PRODUCTS)
    assert_the_next_run_is_undisturbed(checkout, undisturbed)


@contextmanager
def mounted(folder, *options):
    done = subprocess.run(["mount", *options, folder], capture_output=True, text=True)
    if done.returncode:  # a developer may be no root; in a container, these tests run
        pytest.skip(f"only root may mount a disk to fill or to close: {done.stderr.strip()}")
    try:
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


FULL = ("-t", "tmpfs", "-o", "size=64k", "tmpfs")


@pytest.mark.slow
@pytest.mark.parametrize("room", [0, 20, 100, 200])
def test_a_run_that_filled_the_disk_goes_on_once_there_is_room(checkout, undisturbed, room):
    """With so many kB left: it fails sooner or later, and goes on from there."""
    shutil.rmtree(checkout / "results")
    (checkout / "results").mkdir()
    with mounted(checkout / "results", *FULL):
        subprocess.run(["mount", "-o", f"remount,size={room + 4}k", checkout / "results"], check=True)
        code, said = run(checkout)
        assert code != 0
        assert "No space left on device" in said
        subprocess.run(["mount", "-o", "remount,size=10m", checkout / "results"], check=True)
        assert_the_next_run_is_undisturbed(checkout, undisturbed)


def test_results_closed_to_writing_are_named_and_made_once_they_are_open(checkout, undisturbed):
    forget(checkout, *PRODUCTS)
    results = checkout / "results"
    with mounted(results, "--bind", results):
        subprocess.run(["mount", "-o", "remount,ro,bind", results], check=True)
        code, said = run(checkout)
        planned = run(checkout, "-n")
    assert code != 0
    assert "is closed to writing): name another file, in a folder that you can write to" in said
    assert planned[0] == 0, planned[1]
    assert "test: the data and the claims" in planned[1]
    assert_the_next_run_is_undisturbed(checkout, undisturbed)
