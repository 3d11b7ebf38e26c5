"""Where bodies were: as many derivatives as are asked for, whatever maps a reading went through."""

from pathlib import Path

import numpy as np
import pytest

from workbench.definition import find
from workbench.errors import UnsoundRecord
from workbench.inverse.bodies import derivatives_in
from workbench.inverse.dynamics import InverseDynamics
from workbench.motion import motion
from workbench.plant import TWO_MASS, Plant
from workbench.record import Record, Source

DT, BAND, COUNT = 1e-3, 100.0, 2e-5


def inverse() -> InverseDynamics:
    """Two encoders, 2 s at 1 kHz."""
    t = DT * np.arange(2000)
    q = 0.8 * np.sin(2.1 * t) + 0.1 * np.sin(17.0 * t)
    channels = {"torque": np.cos(5.0 * t), "position": q, "load_position": q - 1e-3 * np.cos(5.0 * t)}
    counts = {"position": COUNT, "load_position": 0.2 * COUNT}
    return InverseDynamics(
        motion(Record("r", "identification", t, channels, {}, Source(Path("r"), "", "", {}), counts), BAND)
    )


MAPS = {
    "none": (),
    "encoder": (find("encoder_eccentricity")(at="sensor.position", sine=1e-4),),
    "joint": (
        find("kinematic_error")(at="joint", sine=1e-4, order=30.0),
        find("backlash")(at="joint", half_width=1e-4),
    ),
}


@pytest.mark.parametrize("place", ["motor", "load", "joint"])
@pytest.mark.parametrize("maps", MAPS)
def test_a_body_with_fewer_derivatives_has_the_bits_of_the_whole_one(place, maps):
    plant = Plant(TWO_MASS, MAPS[maps])
    whole = inverse().bodies.body(plant, place)[1]
    for derivatives in (0, 1):
        found = inverse().bodies.body(plant, place, derivatives)[1]
        np.testing.assert_array_equal(found[: 3 + derivatives], whole[: 3 + derivatives])


def test_signals_say_how_often_a_position_is_differentiated():
    assert [derivatives_in(reads) for reads in ((), ("q", "dq", "t"), ("v", "dir"), ("a", "v"))] == [0, 0, 1, 2]


def test_a_record_of_which_its_filter_leaves_nothing_is_refused_with_its_file():
    t = DT * np.arange(105)
    short = Record("r", "identification", t, {"torque": t, "position": t}, {}, Source(Path("r.csv"), "", "", {}))
    with pytest.raises(UnsoundRecord, match=r"r\.csv: the record lasts 0\.104 s, and of it 5 samples count"):
        motion(short, BAND)
