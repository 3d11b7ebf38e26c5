"""Which additions only bend the law of a larger one, so that they are no further cause."""

import pytest

from workbench.plant import ONE_MASS, TWO_MASS
from workbench.tracing.candidates import ADDITION, CORRECTION
from workbench.tracing.evidence import Weighed
from workbench.tracing.weighing import bends


@pytest.mark.parametrize(
    ("larger", "lesser", "kind", "same"),
    [
        (("actuator_lag", "command"), ("clock_skew", "sensor.position"), ONE_MASS, True),  # what is late is one thing
        (("actuator_lag", "command"), ("clock_skew", "sensor.load_position"), TWO_MASS, False),
        (("cubic_stiffness", "joint"), ("piecewise_stiffness", "joint"), TWO_MASS, True),
        (("gravity", "axis"), ("cogging", "axis"), ONE_MASS, False),
        (("presliding_hysteresis", "motor"), ("fading_memory", "load"), TWO_MASS, False),
    ],
)
def test_of_one_curve_a_place_has_one_law(larger, lesser, kind, same):
    sizes = ((0.3, 0.1), (0.1, 0.05))
    pair = [
        Weighed(effect, at, ADDITION, *({"identification": x, "validation": x} for x in size))
        for (effect, at), size in zip((larger, lesser), sizes, strict=True)
    ]
    assert bends(pair[1], pair, kind) is same
    assert not bends(pair[0], pair, kind)


def test_a_corrected_value_bends_no_law():
    errors = {"identification": 0.3, "validation": 0.3}, {"identification": 0.1, "validation": 0.1}
    less = {"identification": 0.05, "validation": 0.05}
    added = Weighed("presliding_hysteresis", "axis", ADDITION, *errors)
    corrected = Weighed("presliding_hysteresis", "axis", CORRECTION, errors[1], less)
    assert not bends(corrected, [added, corrected], ONE_MASS)
