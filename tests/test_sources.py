"""Which files a rule depends on."""

from pathlib import Path

from weier.sources import sources


def test_a_module_depends_on_all_that_it_imports():
    found = sources("weier.study")
    assert "weier/study.py" in found
    assert "weier/bounds.py" in found
    assert "weier/scene.py" not in found


def test_solving_depends_on_every_kernel_and_on_no_figure():
    found = sources("weier.batch")
    kernels = [str(path) for path in Path("weier").rglob("*.py") if "@kernel" in path.read_text()]
    assert set(kernels) - {"weier/jit.py"} <= set(found)
    assert not any("figures" in path or "claims" in path for path in found)


def test_paths_are_files_of_the_checkout():
    assert all(Path(path).is_file() for path in sources("weier.batch", "weier.figures.compliance"))
