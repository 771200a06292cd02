"""The modules in the digest of curves are all that solving them runs. What changes digests: test_freshness."""

import subprocess
import sys
from pathlib import Path

from weier.data.variables import Status
from weier.digests import CURVES, is_in

# Modules that solving curves imports and numerics leave out, each with the reason why no number changes with it.
REASONS = {
    "keys of a scene": "scene/models scene/trace_keys scene/file",
    "which cases there are, and what is drawn of them": "scene/cases scene/figure",
    "loads and modulus are in the name of the kind": "data/bodies data/curves data/si",
    "words about variables; the numbers of Status are tested below": "data/variables",
    "how and when files are written": "data/files data/provenance data/markdown",
    "what is said meanwhile": "api/progress",
}
LEFT_OUT = {f"{name}.py" for names in REASONS.values() for name in names.split()}
READERS = "surface/measured/"  # the digest of a trace is that of its final heights
# What runs of them while curves are solved: progress, and files that are written whole.
RUN = {"api/progress.py", "data/files.py"}
SOLVED = """
import sys
from pathlib import Path
from weier.digests import PACKAGE, numerics
from weier.pipeline.needed_curves import Curves
from weier.pipeline.jobs import solve
from weier.pipeline.store import Store
from weier.scene import load

run = set()
def noted(frame, event, argument):
    run.add(frame.f_code.co_filename)

def of_weier(files):
    return sorted({path.relative_to(PACKAGE).as_posix() for path in map(Path, files) if PACKAGE in path.parents})

for path in map(Path, sys.argv[1:]):
    curves = Curves(load(path), Store(path.with_suffix(""), numerics()))
    lacking = curves.store.lacking(curves.parts_for())
    sys.setprofile(noted)
    solve(lacking, curves.store, "test", lambda line: None)
    sys.setprofile(None)
print(*sorted({part.kind.method for part in lacking}))
print(*of_weier(getattr(module, "__file__", None) or "" for module in list(sys.modules.values())))
print(*of_weier(run))
"""
SCENE = """
title: by each method
loads: [{loads}]
methods: [{methods}]
interface: {{mu_1: 80 GPa, mu_2: 80 GPa, nu_1: 0.3, nu_2: 0.3, rho_1: 1.0e-7, rho_2: 1.0e-7,
  lambda_0: 1 mm, g_0: 1 um}}
studies:
  series: {{product: {{D: 1.25, gamma: "5/2", m: [1, 2], seed: 1}}}}
  infinite: {{product: {{D: 1.25, gamma: 5, m: .inf}}, methods: [demelio, layer, persson]}}
  line: {{trace: {{file: line.csv, length: 1.0e-3, height_unit: um, shortest: 3.0e-4}}, methods: [bem, patches]}}
"""


def test_all_that_solving_curves_runs_is_in_their_numerics(tmp_path, monkeypatch):
    """Of a share of each method, of a trace, in p_0* and in SI units, in a fresh process."""
    from weier.methods import registry

    names = sorted(method.name for method in registry.METHODS)
    scenes = {tmp_path / "normalised.yaml": "0.1, 1.0", tmp_path / "si.yaml": "1 MPa, 10 MPa"}
    for path, loads in scenes.items():
        path.write_text(SCENE.format(loads=loads, methods=", ".join(names)))
    (tmp_path / "line.csv").write_text("\n".join(map(str, [0, 1, 0.5, -1, 2, 0.25, -0.5, 1.5] * 2)))
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    done = subprocess.run([sys.executable, "-c", SOLVED, *scenes], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    solved, imported, run = map(str.split, done.stdout.splitlines())
    assert solved == sorted([*names, "surface"])
    outside = {name for name in imported if not is_in(name, CURVES) and Path(name).name != "__init__.py"}
    assert {name for name in outside if not name.startswith(READERS)} == LEFT_OUT
    assert {name for name in run if not is_in(name, CURVES)} <= RUN


def test_the_numbers_of_status_are_those_in_stored_curves():
    names = ["solved", "not_requested", "not_applicable", "not_converged"]
    assert [status.name for status in sorted(Status)] == names
