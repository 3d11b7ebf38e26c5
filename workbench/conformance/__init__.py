"""What an effect claims, checked: one named check an (effect, property), for the catalogue and for effects of one's own.

check_effect(effect)   every check that applies, run: a tuple of results, each a sentence with its numbers
checks(effect)         the same, not yet run: give them to pytest.mark.parametrize("check", ..., ids=str)
"""

from workbench.conformance.suite import PROPERTIES, Check, Result, check_effect, checks

__all__ = ["PROPERTIES", "Check", "Result", "check_effect", "checks"]
