"""300 generated bad inputs: no traceback, no hang, nothing half written, no file outside of the output folder.

`make fuzz` tries 10 000 (tests/fuzz.py).
"""

import fuzz
import pytest

EACH = 25
CASES = 300


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return fuzz.made(tmp_path_factory.mktemp("fuzz") / "bench")


@pytest.mark.parametrize("first", range(0, CASES, EACH))
def test_bad_inputs_end_in_a_sentence(bench, first):
    assert [wrong for k in range(first, first + EACH) if (wrong := fuzz.case(bench, k))] == []


# of the 10 000: a null character in a path, a study named ".", a run that returns nothing, a draw and a gain too large, a band too small
@pytest.mark.parametrize("number", [2549, 3095, 3347, 3427, 3572, 3693, 3960])
def test_what_once_ended_in_a_traceback_ends_in_a_sentence(bench, number):
    assert fuzz.case(bench, number) is None
