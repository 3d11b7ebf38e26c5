"""An effect described over amplitude: the linear spring and loss that answer a cosine as its first harmonic does.

Three ways, which are held against each other by tests: the describing-function integrals, for effects that hold Masing's
rule (`integrals`); the closed form of a bank of stop operators (`bank`); the settled cycle of any force (`harmonic`).
"""

from workbench.description.bank import bank_equivalent
from workbench.description.friction import equivalent_of, friction_of
from workbench.description.harmonic import first_harmonic
from workbench.description.integrals import described, equivalent, expressions
from workbench.description.result import Equivalent

__all__ = [
    "Equivalent",
    "bank_equivalent",
    "described",
    "equivalent",
    "equivalent_of",
    "expressions",
    "first_harmonic",
    "friction_of",
]
