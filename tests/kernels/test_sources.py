"""Which files a rule depends on."""

from weier.kernels.sources import PACKAGE, sources


def test_a_module_depends_on_all_that_it_imports():
    found = sources("weier.pipeline.bounds")
    assert "weier/pipeline/bounds.py" in found
    assert "weier/theory/bounds.py" in found
    assert not any("scene" in path for path in found)


def test_an_import_that_is_left_out_is_not_followed():
    found = sources("weier.methods.solve", without=["registry"])
    assert "weier/methods/settings.py" in found
    assert not any("registry" in path or "archard" in path for path in found)


def test_solving_depends_on_every_kernel_and_on_no_figure():
    found = sources("weier.pipeline.batch")
    kernels = [path for path in PACKAGE.rglob("*.py") if "@kernel" in path.read_text()]
    assert {str(path.relative_to(PACKAGE.parent)) for path in kernels} - {"weier/kernels/jit.py"} <= set(found)
    assert not any("figures" in path or "claims" in path for path in found)
    assert "weier/scene/cases.py" in found
    assert "weier/scene/file.py" not in found  # what a scene says is in the digest of its batches


def test_paths_are_files_beside_the_package():
    assert all(
        (PACKAGE.parent / path).is_file() for path in sources("weier.pipeline.batch", "weier.figures.compliance")
    )
