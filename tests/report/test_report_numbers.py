"""Numbers are printed with the digits that their intervals hold."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.report import numbers

NARROW, NBSP = "\u202f", "\u00a0"


@pytest.mark.parametrize(
    ("value", "figures", "text"),
    [
        (0.0213, 3, "0.0213"), (-1.5, 3, "\u22121.50"), (0.0, 3, "0.00"), (-0.0, 3, "0.00"), (99.96, 3, "100"), (12345.6, 3, f"12{NARROW}300"),
        (120000.0, 3, "120 \u00d7 10\u00b3"), (1.234e-5, 3, "12.3 \u00d7 10\u207b\u2076"), (9.9996e-4, 3, "0.00100"), (math.nan, 3, "not determined"),
        (math.inf, 3, "\u221e"), (-math.inf, 3, "\u2212\u221e"), (1e-320, 3, "0.00"), (2.5, 1, "2"),
    ],
)  # fmt: skip
def test_a_number_has_the_figures_asked_for(value, figures, text):
    assert numbers.number(value, figures) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (60.0, "60"),
        (125.0, "125"),
        (0.11, "0.11"),
        (0.0, "0"),
        (500, "500"),
        (2000.5, "2000.5"),
        (12345, f"12{NARROW}345"),
    ],
)
def test_a_declared_number_keeps_its_digits_and_no_zeros(value, text):
    assert numbers.exact(value) == text


@pytest.mark.parametrize(
    ("value", "half", "text"),
    [
        (1.23456, 0.0123, "1.235 \u00b1 0.012"), (1.23456, 0.0996, "1.23 \u00b1 0.10"), (-0.5, 0.25, "\u22120.50 \u00b1 0.25"),
        (1.234e-4, 1.7e-6, "(123.4 \u00b1 1.7) \u00d7 10\u207b\u2076"), (1.5, 0.0, "1.50"), (0.003, 12.0, "0 \u00b1 12"), (-0.003, 12.0, "0 \u00b1 12"),
        (1.5, math.inf, "1.50"), (1.23456789012, 1e-12, "1.2345679"), (1e6, 2e4, "(1.000 \u00b1 0.020) \u00d7 10\u2076"),
    ],
)  # fmt: skip
def test_a_value_ends_where_its_half_width_does(value, half, text):
    assert numbers.plus_minus(value, half) == text


@pytest.mark.parametrize(
    ("given_", "texts"),
    [
        ((1.23456, 1.22, 1.25), ("1.235", "1.220 to 1.250")),
        ((-1.0, -1.3, -0.9), ("\u22121.00", "\u22121.30 to \u22120.90")),
        ((1.2e-5, 1.1e-5, 1.3e-5), ("12.0 \u00d7 10\u207b\u2076", "(11.0 to 13.0) \u00d7 10\u207b\u2076")),
        ((0.5, 0.5, 0.5), ("0.5000", "")),
        ((0.5, -math.inf, math.inf), ("0.500", "not determined")),
    ],
)
def test_an_interval_has_the_decimals_of_its_narrower_half(given_, texts):
    assert numbers.with_interval(*given_) == texts


@given(st.floats(-1e12, 1e12), st.floats(1e-12, 1e12))
def test_what_is_printed_is_the_value_to_within_a_tenth_of_its_half_width(value, half):
    text = numbers.plus_minus(value, half).split(" \u00b1 ")[0].strip("(").replace("\u2212", "-").replace(NARROW, "")
    e = 0
    if numbers.TIMES in numbers.plus_minus(value, half):
        power = numbers.plus_minus(value, half).split("10")[-1]
        e = int(power.translate(str.maketrans({v: chr(k) for k, v in numbers.SUPERSCRIPT.items()})))
    shown = float(text.split(f" {numbers.TIMES}")[0]) * 10.0**e
    assert abs(shown - value) <= 0.1 * max(half, 1e-6 * abs(value))


@pytest.mark.parametrize(
    ("ratio", "text"),
    [(0.0891, "8.9"), (0.0094, "0.94"), (1.0, "100"), (0.0, "0.0"), (-0.02, "\u22122.0"), (0.0996, "10")],
)
def test_per_cent(ratio, text):
    assert numbers.percent(ratio) == f"{text}{NBSP}%"


@pytest.mark.parametrize(
    ("unit", "text"),
    [("N*m*s/rad", "N\u00b7m\u00b7s/rad"), ("1", ""), ("", ""), ("kg*m^2", "kg\u00b7m\u00b2"), ("N*m*s^2/rad", "kg\u00b7m\u00b2"), ("1/rad^0.8", "1/rad^0.8"), ("1/s^-2", "1/s\u207b\u00b2")],
)  # fmt: skip
def test_units_are_set_with_dots_and_powers(unit, text):
    assert numbers.unit(unit) == text


def test_a_prefix_brings_a_number_between_one_and_a_thousand():
    assert numbers.scaled(0.0213, "N*m") == f"21.3{NBSP}mN\u00b7m"
    assert numbers.scaled(1e-6, "rad") == f"1.00{NBSP}\u00b5rad"
    assert numbers.scaled(-2500.0, "N") == f"\u22122.50{NBSP}kN"
    assert numbers.scaled(0.002, "kg*m^2") == f"0.00200{NBSP}kg\u00b7m\u00b2"
    assert numbers.scaled(0.0, "rad") == f"0.00{NBSP}rad"
    assert numbers.label("speed", "rad/s") == "speed (rad/s)"
    assert numbers.label("order", "") == "order"
