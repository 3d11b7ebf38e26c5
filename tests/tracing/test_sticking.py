"""Where an axis sticks its drive passes from one level of dry friction to the other: that is no residual of a model."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import measured

from workbench.campaign import load
from workbench.definition import find
from workbench.identification.fit import identify
from workbench.inverse.dynamics import inverse_dynamics
from workbench.kernel.step import build
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.tracing import preparing
from workbench.tracing import sticking as sticking_module
from workbench.tracing.of_campaign import trace_campaign
from workbench.tracing.sticking import holds_a_load, sticking
from workbench.tracing.tracing import trace

DT, BAND, COUNT = 2e-3, 50.0, 1e-6
INERTIA, VISCOUS, COULOMB = 2.0, 4.0, 30.0
STOP = 0.03  # s, at every reversal


def recorded(name: str, role: str, period: float, stop: float = STOP) -> Record:
    """Return moves to and fro that stop at each end, the drive there on a straight line; a count and noise."""
    t = DT * np.arange(6000)
    run = 0.5 * period - stop
    phase = np.mod(t, period)
    forth = phase < 0.5 * period
    s = np.clip(np.where(forth, phase, phase - 0.5 * period) / run, 0.0, 1.0)
    way, w = np.where(forth, 1.0, -1.0), np.pi / run
    q = 0.05 * np.where(forth, (1.0 - np.cos(np.pi * s)) / 2.0, (1.0 + np.cos(np.pi * s)) / 2.0)
    v, a = way * 0.025 * w * np.sin(np.pi * s), way * 0.025 * w**2 * np.cos(np.pi * s)
    drive = INERTIA * a + VISCOUS * v + COULOMB * way
    rests = s >= 1.0
    steps = np.flatnonzero(np.diff(np.concatenate([[False], rests, [False]]).astype(int)))
    for first, last in zip(steps[::2], steps[1::2], strict=True):
        if 0 < first and last < t.size:
            drive[first:last] = np.linspace(drive[first - 1], drive[last], last - first)
    drive = drive + 0.1 * np.random.default_rng(1).standard_normal(t.size)
    return Record(
        name, role, t, {"force": drive, "position": COUNT * np.round(q / COUNT)}, resolution={"position": COUNT}
    )


def declared() -> Plant:
    plant = Plant(ONE_MASS, rotary=False)
    for name in ("inertia", "viscous_friction", "coulomb_friction"):
        plant += find(name)
    return plant


def test_samples_at_rest_count_in_no_error_where_they_hold_most_of_the_residual():
    inverses = inverse_dynamics([recorded("a", IDENTIFICATION, 0.6), recorded("b", VALIDATION, 0.8)], BAND)
    found = sticking(declared(), inverses)
    assert found is not None and found.power > 0.8 and found.samples < 0.4
    whole, moving = identify(declared(), inverses), identify(declared(), found.inverses)
    assert moving.identification < 0.02 < 0.1 < whole.identification
    value = moving.plant["coulomb_friction@axis"].parameters["coulomb"].value
    assert value == pytest.approx(COULOMB, rel=0.02)
    assert moving.plant["inertia@axis"].parameters["inertia"].value == pytest.approx(INERTIA, rel=0.05)


def test_an_axis_that_does_not_stop_counts_everywhere():
    inverses = inverse_dynamics([recorded("a", IDENTIFICATION, 0.6, stop=0.0)], BAND)
    assert sticking(declared(), inverses) is None


def test_an_encoder_so_coarse_that_an_axis_always_rests_tells_nothing_of_rest():
    coarse = {"position": 0.02}
    records = [recorded(n, r, p) for n, r, p in (("a", IDENTIFICATION, 0.6), ("b", VALIDATION, 0.8))]
    read = lambda q: 0.02 * np.round(q / 0.02)  # noqa: E731
    records = [
        replace(r, channels=r.channels | {"position": read(r.channels["position"])}, resolution=coarse) for r in records
    ]
    assert sticking(declared(), inverse_dynamics(records, 20.0)) is None


def test_friction_with_memory_has_a_prediction_at_rest():
    plant = Plant(ONE_MASS, rotary=False) + find("inertia") + find("presliding_hysteresis")
    assert sticking(plant, inverse_dynamics([recorded("a", IDENTIFICATION, 0.6)], BAND)) is None


def test_friction_that_gives_way_over_many_counts_is_no_sticking():
    """A pad on slow sines stays within a count at every reversal, and builds up its force over forty."""
    t = DT * np.arange(6000)
    q = 2e-3 * np.sin(2.0 * np.pi * 0.4 * t)
    yields = find("presliding_hysteresis")(h0=COULOMB, x0=40.0 * COUNT)
    force = build(yields).run(
        {"dq": np.diff(q, prepend=q[0]), "dt": DT}, {n: p.value for n, p in yields.parameters.items()}
    )[0]
    noise = 0.1 * np.random.default_rng(1).standard_normal(t.size)
    channels = {"force": force + noise, "position": COUNT * np.round(q / COUNT)}
    record = Record("a", IDENTIFICATION, t, channels, resolution={"position": COUNT})
    assert sticking(declared(), inverse_dynamics([record], BAND)) is None


def test_a_trace_names_nothing_of_an_axis_that_only_sticks():
    inverses = inverse_dynamics([recorded("a", IDENTIFICATION, 0.6), recorded("b", VALIDATION, 0.8)], BAND)
    names = ("transport_delay", "stribeck_friction", "coulomb_asymmetry", "constant_offset", "sensor_trend")
    found = trace(declared(), inverses, only=names)
    assert found.verdict == "nothing_missing"
    assert [f.kind for f in found.findings].count("sticks") == 1


def pulled(record: Record, stiffness: float) -> Record:
    """Return a record whose axis has a spring to ground beside all else."""
    drive = record.channels["force"] + stiffness * record.channels["position"]
    return Record(
        record.name,
        record.role,
        record.time,
        {**record.channels, "force": drive},
        resolution=record.resolution,
    )


@pytest.mark.parametrize("stop", [0.15, 0.2])
def test_what_a_load_holds_at_rest_is_no_frictions(stop):
    """An axis that stands most of its time between two stops, with a spring that nobody declared, and without: friction then holds there, always
    the same way, what a spring would, and in motion it does not."""
    stuck = [recorded(n, r, p, stop=stop) for n, r, p in (("a", IDENTIFICATION, 0.6), ("b", VALIDATION, 0.8))]
    assert not holds_a_load(declared(), inverse_dynamics(stuck, BAND))
    assert holds_a_load(declared(), inverse_dynamics([pulled(r, 3000.0) for r in stuck], BAND))


@pytest.mark.parametrize("bandwidth", [7.0, 9.0])
def test_a_servo_that_stands_most_of_the_time_shows_the_arm_that_it_holds(bandwidth):
    """Where it moves alone, in 15 % of its samples, a weight and a spring are one."""
    campaign = load(measured("measured", "xl330"))
    found = trace_campaign(replace(campaign, bandwidth=bandwidth))
    assert [c.effect for c in found.causes] == ["gravity"]
    mgl = next(p.value for p in found.causes[0].parameters if p.parameter == "mgl")
    assert 0.45 < mgl < 0.49


def test_what_is_missing_may_hide_that_an_axis_sticks_and_a_search_begins_anew_beside_it():
    """With a spring that leaves more than rest does the declared model does not show it; with the spring found it does."""
    records = [pulled(recorded(n, r, p), 1500.0) for n, r, p in (("a", IDENTIFICATION, 0.6), ("b", VALIDATION, 0.8))]
    inverses = inverse_dynamics(records, BAND)
    assert sticking(declared(), inverses) is None
    said: list[str] = []
    names = ("cable_spring", "transport_delay", "flexible_mode", "gravity")
    found = trace(declared(), inverses, said.append, only=names)
    assert found.verdict == "cause" and found.added == ("cable_spring",)
    first = said[: said.index("searching once more, where the axis moves")]
    assert (
        first.count("trying transport_delay@command") == 1
    )  # it ends with its first effect: the next one dresses rest
    stuck = [f for f in found.findings if f.kind == "sticks"]
    assert len(stuck) == 1 and "found beside it" in stuck[0].sentence
    assert found.after.identification < 0.01


def test_a_search_ends_with_the_second_effect_where_the_axis_sticks_beside_both():
    """Cogging of twice as much as the spring hides rest until both are found."""
    records = [pulled(recorded(n, r, p), 1500.0) for n, r, p in (("a", IDENTIFICATION, 0.6), ("b", VALIDATION, 0.8))]
    wave = [80.0 * np.sin(2.0 * np.pi * r.channels["position"] / 0.012) for r in records]
    records = [
        replace(r, channels={**r.channels, "force": r.channels["force"] + w})
        for r, w in zip(records, wave, strict=True)
    ]
    said: list[str] = []
    names = ("cable_spring", "cogging", "transport_delay")
    found = trace(declared(), inverse_dynamics(records, BAND), said.append, only=names)
    assert found.verdict == "cause" and set(found.added) == {"cable_spring", "cogging"}
    first = said[: said.index("searching once more, where the axis moves")]
    assert first.count("trying transport_delay@command") == 2
    assert found.after.identification < 0.01


def test_rest_is_asked_once_of_each_set_of_effects(monkeypatch):
    asked = []
    monkeypatch.setattr(preparing, "sticking", lambda plant, inverses: asked.append(plant))
    rest = preparing.Rest(preparing.Declared(declared(), declared(), ()))
    spring = declared() + find("cable_spring")
    stiffer = spring.swap(spring["cable_spring@axis"](stiffness=2.0))
    assert not any(rest(p) for p in (declared(), spring, stiffer))
    assert len(asked) == 2


@pytest.mark.parametrize(
    ("fitted", "validation", "sticks"),
    [
        ((0.9, 8.0), (0.1, 8.0), True),
        ((0.3, 8.0), (0.9, 8.0), True),  # moves rest more than what was fitted
        ((0.3, 8.0), (0.3, 8.0), False),
        ((0.9, 3.2), (0.9, 5.3), False),  # an encoder so coarse that rest is motion
        ((0.3, 8.0), (0.9, 3.2), False),
    ],
)
def test_rest_counts_no_more_where_it_is_most_of_either_roles_residual(monkeypatch, fitted, validation, sticks):
    def held(problem, found, rest, inverses):
        share, density = validation if problem.inverses[0].motion.record.role == VALIDATION else fitted
        moving = (1.0 - share) * 100
        return sticking_module._Held(share, 1.0, 100, 100 + round(density * moving / share))

    monkeypatch.setattr(sticking_module, "_held", held)
    monkeypatch.setattr(sticking_module, "_giving_way", lambda *_: None)
    inverses = inverse_dynamics([recorded("a", IDENTIFICATION, 0.6), recorded("b", VALIDATION, 0.8)], BAND)
    assert (sticking(declared(), inverses) is not None) is sticks
