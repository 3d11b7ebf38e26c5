"""A bank of elements from long records in blocks: the same as from the tall regressor, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import nnls

from workbench.definition import find
from workbench.effects.hysteresis import maxwell_slip
from workbench.errors import WorkbenchError
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.long_records.bank import identify_bank
from workbench.motion import motion
from workbench.plant import Plant
from workbench.record import Record, Source

SLIPS = (2e-5, 1e-4, 4e-4, 2e-3)
STIFF = np.array([40.0, 0.0, 25.0, 3.0])
DT, BAND = 1e-3, 60.0


def elements(x: np.ndarray) -> np.ndarray:
    """Return (n, m), each element by the textbook's recursion on its own deflection."""
    columns = []
    for slip in SLIPS:
        column, value = [], 0.0
        for moved in np.diff(x, prepend=x[0]):
            value = min(max(value + moved, -slip), slip)
            column.append(value)
        columns.append(column)
    return np.array(columns).T


def slow(seed: int, name: str = "slow", viscous: float = 0.4, offset: float = -0.02, n: int = 12_000) -> Record:
    rng, t = np.random.default_rng(seed), np.arange(n) * DT
    x = 4e-3 * np.sin(2 * np.pi * 0.3 * t) * np.sin(2 * np.pi * 0.07 * t) + 5e-4 * np.sin(2 * np.pi * 1.1 * t)
    u = elements(x) @ STIFF + viscous * np.gradient(x, DT) + offset + 1e-4 * rng.normal(size=n)
    return Record(name, "identification", t, {"position": x, "torque": u}, {}, Source(Path("x"), "", "none", {}))


def plant() -> Plant:
    return Plant("one mass", (find("viscous_friction"), find("constant_offset"), maxwell_slip(SLIPS)))


def weights(p: Plant) -> np.ndarray:
    return np.array([p["maxwell_slip"].parameters[f"k{i}"].value for i in range(1, 5)])


def test_weights_and_what_is_linear_beside_them_are_found():
    fit = identify_bank(plant(), [motion(slow(0), BAND)], block=777)
    np.testing.assert_allclose(weights(fit.plant), STIFF, atol=0.2)
    assert weights(fit.plant).min() >= 0.0
    assert fit.plant["viscous_friction"].parameters["viscous"].value == pytest.approx(0.4, rel=2e-3)
    assert fit.plant["constant_offset"].parameters["offset"].value == pytest.approx(-0.02, rel=2e-3)
    assert fit.residual == pytest.approx(1e-4, rel=0.05)


def test_several_records_are_one_least_squares_on_the_samples_that_count():
    made = [slow(1), slow(2, "second", offset=-0.02)]
    motions = [motion(r, BAND) for r in made]
    fit = identify_bank(plant(), motions)
    phi, y = [], []
    for r, m in zip(made, motions, strict=True):
        x = np.cumsum(m.dq)
        phi.append(np.column_stack([m.v, -m.v, np.ones(x.size), -np.ones(x.size), elements(x)])[m.keep])
        y.append(r.drive[m.keep])
    tall = nnls(np.concatenate(phi), np.concatenate(y))[0]
    np.testing.assert_allclose(weights(fit.plant), tall[4:], atol=1e-8 * tall.max())
    assert fit.plant["viscous_friction"].parameters["viscous"].value == pytest.approx(tall[0] - tall[1], rel=1e-8)


def test_it_agrees_with_identify_where_both_can():
    record = slow(3)
    by_blocks, whole = (
        identify_bank(plant(), [motion(record, BAND)]),
        identify(plant(), inverse_dynamics([record], BAND)),
    )
    curve = [np.minimum.outer(np.array([1e-4, 1e-3]), np.array(SLIPS)) @ weights(f.plant) for f in (by_blocks, whole)]
    np.testing.assert_allclose(curve[0], curve[1], rtol=0.02)


def test_what_is_fixed_goes_to_the_measured_side():
    held = find("viscous_friction")(viscous=0.4, fixed=True)
    fit = identify_bank(plant().swap(held), [motion(slow(4), BAND)])
    assert fit.plant["viscous_friction"].parameters["viscous"].value == 0.4
    np.testing.assert_allclose(weights(fit.plant), STIFF, atol=0.2)


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (find("coulomb_friction"), "'coulomb_friction' is no force without memory"),
        (find("stribeck_friction"), "no force without memory"),
        (find("actuator_lag"), "'actuator_lag' is no force"),
    ],
)
def test_an_effect_that_needs_the_whole_record_is_refused(extra, said):
    with pytest.raises(WorkbenchError, match=said):
        identify_bank(plant() + extra, [motion(slow(5), BAND)])


def test_a_value_beyond_its_bounds_and_no_record_are_sentences():
    record = slow(6, viscous=-0.4)
    with pytest.raises(WorkbenchError, match=r"viscous_friction: .* beyond its bounds 0 to inf"):
        identify_bank(plant(), [motion(record, BAND)])
    with pytest.raises(WorkbenchError, match="no record"):
        identify_bank(plant(), [])
    with pytest.raises(WorkbenchError, match="maxwell_slip"):
        identify_bank(replace(plant(), effects=plant().effects[:2]), [motion(record, BAND)])


def test_elements_that_never_slip_are_said_to_be_one():
    slips = (*SLIPS, 8e-3, 2e-2)
    wide = Plant("one mass", (find("viscous_friction"), find("constant_offset"), maxwell_slip(slips)))
    (finding,) = identify_bank(wide, [motion(slow(7), BAND)]).findings
    assert "k5, k6 never slip" in finding.sentence and finding.evidence["reach"] < 8e-3
    assert identify_bank(plant(), [motion(slow(7), BAND)]).findings == ()
