"""An encoder that loses counts is told from a body that is pushed, from a glitch and from a joint that yields."""

from dataclasses import replace

import numpy as np
import pytest

from workbench.encoders.lost_counts import lost_counts, shifts_of
from workbench.encoders.wording import lost_finding
from workbench.record import IDENTIFICATION, Record

COUNT, DT, N = 1e-5, 1e-3, 6000
AT = (700, 1500, 2300, 3400, 4100, 5200)
TIME = DT * np.arange(N)


def made(name: str = "sine", seed: int = 0) -> Record:
    """Return a record of a sine of two frequencies whose joint yields by the acceleration, both encoders quantised."""
    noise = np.random.default_rng(seed).standard_normal((2, N))
    q = 0.4 * np.sin(2 * np.pi * 0.7 * TIME) + 0.02 * np.sin(2 * np.pi * 6.0 * TIME)
    load = q + 1e-5 * np.gradient(np.gradient(q, DT), DT)
    read = [COUNT * np.round((x + 0.3 * COUNT * e) / COUNT) for x, e in zip((q, load), noise, strict=True)]
    channels = {"torque": np.cos(TIME), "position": read[0], "load_position": read[1]}
    return Record(name, IDENTIFICATION, TIME, channels, resolution={"position": COUNT, "load_position": COUNT})


def losing(record: Record, counts: float, at=AT) -> Record:
    """Return a record whose load encoder falls behind by so many counts at each of these samples."""
    x = record.channels["load_position"].copy()
    way = np.sign(np.gradient(x))
    for k in at:
        x[k:] -= counts * COUNT * way[k]
    return replace(record, channels={**record.channels, "load_position": x})


def test_sound_encoders_lose_nothing_however_their_joint_yields():
    assert lost_counts([made("a"), made("b", 1)]) is None


def test_what_is_lost_is_found_to_the_sample_and_put_back():
    sound, other = made("a"), made("b", 1)
    lost = lost_counts([losing(sound, 20.0), losing(other, 30.0), made("c", 2)])
    assert lost.channel == "load_position"
    assert [s.sample for s in lost.shifts["a"]] == list(AT)
    assert [abs(s.size) / COUNT for s in lost.shifts["b"]] == pytest.approx([30.0] * len(AT), abs=1.5)
    back = lost.mended(losing(sound, 20.0)).channels["load_position"]
    assert np.max(np.abs(back - sound.channels["load_position"])) < 5.0 * COUNT
    said = lost_finding(lost).sentence
    assert "12 times in 2 of 3 records" in said and "record 'a' at 0.7000 s" in said


def test_a_glitch_that_comes_back_and_a_push_that_is_felt_are_no_lost_counts():
    record = made()
    glitched = record.channels["load_position"].copy()
    glitched[list(AT)] += 40 * COUNT
    pushed = record.channels["load_position"] + sum(
        30 * COUNT * (TIME > TIME[k]) * (1.0 - np.exp(-(TIME - TIME[k]) / 0.01)) for k in AT
    )
    for x in (glitched, pushed):
        assert shifts_of(replace(record, channels={**record.channels, "load_position": x}), "load_position") == ()


def test_a_slip_or_two_of_a_log_are_no_encoder_that_loses_counts():
    assert lost_counts([losing(made("a"), 20.0, AT[:2]), losing(made("b", 1), 20.0, AT[:2])]) is None
    assert len(shifts_of(losing(made("a"), 20.0, AT[:2]), "load_position")) == 2


def test_a_load_that_is_held_loses_nothing():
    assert lost_counts([replace(losing(made(), 20.0), locked=True)]) is None
