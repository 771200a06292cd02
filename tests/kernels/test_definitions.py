"""Which definitions a function is made of."""

from weier.kernels.definitions import definitions, modules_of


def test_a_function_is_made_of_what_it_names_through_imports_and_modules():
    found = definitions("weier.methods.bem.error_model.solution_error")
    assert "def solution_error" in found["weier.methods.bem.error_model.solution_error"]
    assert found["weier.methods.error_model.RESIDUAL_FACTOR"].startswith("RESIDUAL_FACTOR = ")  # imported by name
    assert "weier.theory.profile.Profile" in found  # of an annotation: its methods may be called
    assert "weier.methods.bem.error_model.SECONDS_NODE" not in found
    through_a_package = definitions("weier.methods.hybrid.truncation_bounds.bounds")
    assert "weier.methods.bem.error_model.COMPLIANCE" in through_a_package
    assert "weier.methods.bem.solver.curve" in through_a_package


def test_what_runs_on_import_counts():
    assert "add_implicit_resolver" in definitions("weier.data.yaml.number")["weier.data.yaml."]


def test_a_name_left_out_is_not_followed():
    listed = "weier.methods.registry.METHODS"
    found = definitions("weier.methods.registry.find_method", without=[listed])
    assert listed not in found
    assert not any("archard" in name for name in found)
    assert "weier.methods.archard.compliance" in definitions("weier.methods.registry.find_method")


def test_a_module_is_all_that_it_defines():
    found = definitions("weier.theory.bounds")
    assert {"weier.theory.bounds.compliance_bounds", "weier.theory.bounds.resistance_bounds"} <= found.keys()


def test_comments_do_not_count_and_names_of_no_module_are_nothing():
    name = "weier.methods.bem.error_model.PAIRS"
    assert definitions(name)[name] == "PAIRS = 14"
    assert definitions("numpy.linalg.solve") == {}


def test_the_modules_of_a_package():
    found = modules_of("weier.figures")
    assert found[0] == "weier.figures"
    assert {"weier.figures.compliance", "weier.figures.page", "weier.figures.page.plans"} <= set(found)
