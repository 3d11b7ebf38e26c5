"""Units at the border: SI comes out, and another dimension or an unknown name is refused with its mend."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from workbench.errors import WorkbenchError
from workbench.units import EXAMPLES, effect_unit, scaled, to_si
from workbench.units.registry import BASE, DERIVED, NAMES, root, tidy

WHERE = "c/campaign.toml: channels.torque.unit"


def refused(unit, expected, value=1.0):
    with pytest.raises(WorkbenchError) as caught:
        to_si(value, unit, expected, WHERE)
    sentence = str(caught.value)
    assert sentence.startswith(WHERE) and sentence.endswith(".")
    return sentence


@pytest.mark.parametrize(
    ("value", "unit", "expected", "si"),
    [
        (1.0, "N*m", "N*m", 1.0),
        (3.0, "mN*m", "N*m", 3e-3),
        (2.0, "lbf*in", "N*m", 2 * 4.4482216152605 * 0.0254),
        (180.0, "deg", "rad", np.pi),
        (3600.0, "arcsec", "rad", np.pi / 180),
        (0.5, "rev", "rad", np.pi),
        (1.0, "1/deg", "1/rad", 180 / np.pi),
        (1.0, "1/deg^0.8", "1/rad^0.8", (180 / np.pi) ** 0.8),
        (1.0, "1/rad^0.333333", f"1/rad^{1 / 3:g}", 1.0),
        (1.0, "N*m*s/rad", "N*m*s/rad", 1.0),
        (1.0, "N*m/(rad/s)", "N*m*s/rad", 1.0),
        (1.0, "N*m/rpm", "N*m*s/rad", 30 / np.pi),
        (5.0, "kg*m**2", "kg*m^2", 5.0),
        (5.0, "g*cm^2", "kg*m^2", 5e-7),
        (5.0, "N*m*s^2/rad", "kg*m^2", 5.0),
        (7.0, "um", "m", 7e-6),
        (7.0, "µm", "m", 7e-6),
        (2.0, "kHz", "Hz", 2000.0),
        (60.0, "rpm", "rad/s", 2 * np.pi),
        (20.0, "degC", "K", 293.15),
        (32.0, "degF", "K", 273.15),
        (20.0, "K", "K", 20.0),
        (20.0, "N*m/degC", "N*m/K", 20.0),
        (50.0, "%", "1", 0.5),
        (0.7, "", "1", 0.7),
        (0.7, "-", "1", 0.7),
        (1.0, "N·m", "N*m", 1.0),
        (1.0, " kg · m² ", "kg*m^2", 1.0),
    ],
)
def test_a_value_becomes_si(value, unit, expected, si):
    assert to_si(value, unit, expected, WHERE) == pytest.approx(si, rel=1e-12)
    assert np.allclose(to_si(np.full(3, value), unit, expected, WHERE), si, rtol=1e-12, atol=0)


@pytest.mark.parametrize("unit", EXAMPLES)
def test_si_is_left_as_it_is_to_the_last_bit(unit):
    values = np.array([0.1, -1e300, 5e-324, 1 / 3])
    assert np.array_equal(to_si(values, unit, unit, WHERE), values)


def test_an_encoder_step_has_no_offset():
    assert to_si(0.1, "degC", "K", WHERE, step=True) == 0.1
    assert to_si(0.9, "degF", "K", WHERE, step=True) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("unit", "expected", "mend"),
    [
        ("Nm", "N*m", "write 'N*m'"),
        ("mNm", "N*m", "write 'mN*m'"),
        ("Ncm", "N*m", "write 'N*cm'"),
        ("N m", "N*m", "write 'N*m'"),
        ("Nms/rad", "N*m*s/rad", "write 'N*m*s/rad'"),
        ("Nm/rad", "N*m/rad", "write 'N*m/rad'"),
        ("kgm2", "kg*m^2", "write 'kg*m^2'"),
        ("1/rad0.8", "1/rad^0.8", "write '1/rad^0.8'"),
        ("degs", "rad", "did you mean 'deg'"),
        ("Hzz", "Hz", "did you mean 'Hz'"),
        ("Mm", "m", "did you mean 'mm'"),
        ("furlongs", "m", "A length is needed, such as 'm'"),
        ("m" * 50, "N*m", "A torque is needed"),
    ],
)
def test_an_unknown_unit_is_answered_with_the_mend(unit, expected, mend):
    sentence = refused(unit, expected)
    assert f"unit '{unit}'" in sentence and mend in sentence


@pytest.mark.parametrize("run", ["Nm", "Ns", "NM", "Mm", "Ms"])
def test_run_together_names_never_find_a_meaning(run):
    for expected in EXAMPLES:
        assert "unknown" in refused(run, expected)


@pytest.mark.parametrize(
    ("unit", "expected", "given", "need"),
    [
        ("nm", "N*m", "is a length", "a torque is needed, such as 'N*m'"),
        ("N", "N*m", "is a force", "a torque is needed"),
        ("", "rad", "is a number without unit", "an angle is needed, such as 'rad'"),
        ("s", "rad", "is a time", "an angle is needed"),
        ("m", "rad", "is a length", "an angle is needed"),
        ("rad", "m", "is an angle", "a length is needed"),
        ("1/s", "Hz", "is a rate", "'Hz' or 'kHz'"),
        ("rad/s", "Hz", "is an angular velocity", "1 Hz is 2*pi rad/s"),
        ("Hz", "rad/s", "is a frequency", "an angular velocity is needed"),
        ("Hz", "1/s", "is a frequency", "a rate is needed"),
        ("N*m*s", "N*m*s/rad", "does not fit", "such as 'N*m*s/rad'"),
        ("1/rad", "1/rad^0.8", "does not fit", "'1/rad^0.8' is needed"),
        ("1/m", "1/rad", "does not fit", "'1/rad' is needed"),
        ("kg*m^2", "kg", "is a moment of inertia", "a mass is needed"),
        ("degC", "1", "is a temperature", "a number without unit is needed"),
    ],
)
def test_another_dimension_is_refused_with_what_is_needed(unit, expected, given, need):
    sentence = refused(unit, expected)
    assert f"unit '{unit}' {given}" in sentence and need in sentence


@pytest.mark.parametrize(
    "unit", ["m^^2", "m^9^9", "m^99", "(m", "m)", "*m", "m/", "2*m", "()", "(m)(m)", "m+m", "m\n;"]
)
def test_what_is_no_unit_is_refused(unit):
    assert "cannot be read; join names by * / ^ and brackets." in refused(unit, "m")


def test_a_unit_that_is_no_text_and_a_value_that_is_no_number_are_refused():
    assert "a text is needed, such as 'N*m'" in refused(3, "N*m")
    assert "'3,5'; a number is needed" in refused("N*m", "N*m", "3,5")
    assert "too large" in refused("km", "m", 1e307)


@pytest.mark.parametrize(
    ("template", "rotary", "linear"),
    [
        ("F", "N*m", "N"),
        ("x", "rad", "m"),
        ("x/s", "rad/s", "m/s"),
        ("F*s^2/x", "kg*m^2", "kg"),
        ("F*s**2/x", "kg*m^2", "kg"),
        ("F*s/x", "N*m*s/rad", "N*s/m"),
        ("F/x^3", "N*m/rad^3", "N/m^3"),
        ("1/x", "1/rad", "1/m"),
        ("1/F", "1/(N*m)", "1/N"),
        ("1/x^d", "1/rad^d", "1/m^d"),
        ("s", "s", "s"),
        ("1", "1", "1"),
        ("rad", "rad", "rad"),
    ],
)
def test_a_template_is_written_for_its_axis(template, rotary, linear):
    assert (effect_unit(template, True), effect_unit(template, False)) == (rotary, linear)


def test_the_exponent_of_a_template_takes_its_value():
    assert effect_unit("1/x^d", True, {"d": 0.8}) == "1/rad^0.8"
    assert effect_unit("1/x^d", True, {"d": 1.0}) == "1/rad"
    assert effect_unit("1/x^d", False, {"d": 1 / 3}) == "1/m^0.333333"


def test_the_unit_of_a_template_is_its_own_si():
    for template in ("F", "x", "x/s", "F*s^2/x", "F*s/x", "F/x^3", "1/x", "1/F", "F*s^2/x^2"):
        for rotary in (True, False):
            unit = effect_unit(template, rotary)
            assert to_si(2.0, unit, unit, WHERE) == 2.0 and root(tidy(unit))[0] == 1.0


@pytest.mark.parametrize(("unit", "loaded"), [("m", False), ("mm", True)])
def test_pint_is_imported_only_when_a_unit_is_read_that_is_not_the_one_expected(unit, loaded):
    code = (
        f"import sys, workbench.units as u; u.to_si(1., '{unit}', 'm', ''); assert ('pint' in sys.modules) == {loaded}"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


FACTORS = [(name, factor, root) for root, group in DERIVED.items() for name, factor in group.items()]


@given(
    st.floats(-1e12, 1e12),
    st.sampled_from(FACTORS),
    st.integers(1, 3) | st.floats(0.3, 2.0).map(lambda x: round(x, 3)),
)
@settings(suppress_health_check=[HealthCheck.too_slow])  # of a machine that is busy
def test_there_and_back_again(value, one, power):
    name, factor, root = one
    unit, expected = f"1/{name}^{power}", f"1/({root or 1})".replace("**", "^")
    if power == 1:
        si = to_si(value, unit, expected, WHERE)
        assert si == pytest.approx(value / factor, rel=1e-12)
    if root in BASE:
        si = to_si(value, unit, f"1/{root}^{power}", WHERE)
        assert si * factor**power == pytest.approx(value, rel=1e-12)


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=70) | st.lists(st.sampled_from([*NAMES, *"*/^()-.12 9"]), max_size=9).map("".join))
@example("g0")
@example("N*m^0")
def test_any_text_is_a_unit_or_is_refused_with_a_sentence(text):
    for expected in ("N*m", "rad", "1/rad^0.8", "Hz", "K", "1"):
        try:
            assert np.isfinite(to_si(1.0, text, expected, WHERE))
        except WorkbenchError as e:
            assert str(e).startswith(WHERE) and str(e).endswith(".")


@pytest.mark.parametrize(
    ("unit", "by", "expected", "said"),
    [
        ("A", "Nm/A", "N*m", "write 'N*m/A'"),
        ("mA", "mNm/mA", "N*m", "write 'mN*m/mA'"),
        ("count", "counts/rev", "rad", "did you mean 'count'"),
        ("count", "counts", "m", "'m/count' is needed"),
        ("A", "N*m", "N*m", "'N*m/A' would"),
        ("N*m", "N*m/A", "N*m", "'N*m/(N*m)' would"),
        ("counts", "count/rev", "rad", "unit 'counts' is unknown"),
        ("A", "", "N*m", "'N*m/A' would"),
    ],
)
def test_a_scale_that_does_not_fit_is_answered_with_one_that_does(unit, by, expected, said):
    with pytest.raises(WorkbenchError) as refused:
        scaled(unit, by, expected, "campaign.toml: channels.torque.scale.unit")
    assert said in str(refused.value) and str(refused.value).startswith("campaign.toml")


@settings(max_examples=50, deadline=None)
@given(st.text(max_size=12), st.text(max_size=12))
def test_whatever_is_written_as_a_scale_is_read_or_refused_with_a_sentence(unit, by):
    try:
        scaled(unit, by, "N*m", "campaign.toml")
    except WorkbenchError as e:
        assert str(e).startswith("campaign.toml")
