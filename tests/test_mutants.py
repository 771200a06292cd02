"""The list of mutants that change no result."""

from tests.mutants import every_mutant, known_equivalent


def test_mutants_that_are_listed_as_equivalent_are_of_code_that_is_there():
    """Else `python -m tests.mutants` ends at once."""
    assert known_equivalent(every_mutant())
