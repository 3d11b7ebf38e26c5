"""The assumed plant of two masses, and the records that the study logs with its output locked."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench.control import fixed_pd
from workbench.definition import find
from workbench.plant import ONE_MASS, TWO_MASS, Geometry, Limits, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.simulation import Loop, Scenario, ScenarioArrays, open_loop, simulate
from workbench.simulation.recorded import record_of
from workbench.study.configuration import Study

KEYS = (
    "motor", "load", "torque", "speed", "ratio", "k1", "k2", "t1", "damping", "hysteresis", "stroke", "h0", "a", "at_motor",
    "gear_error",
)  # fmt: skip
PER_RECORD = 4  # control samples a logged one
KEPT = ("bandwidth_of_torque", "torque", "duration", "noise", "bandwidth", "free", "frequency")  # of [records]
PERIODS, LOGGING = (
    3,
    (250.0, 5.0),
)  # of the slow sine with the output free; Kp and Kd of the loop that it is logged through


@dataclass(frozen=True)
class Assumed:
    """plant: of two masses. rigid: the same as one mass, with the friction of both. damping: of the joint, N*m*s/rad.
    stiffnesses: of the joint, softest and stiffest, N*m/rad. load: kg*m^2."""

    plant: Plant
    rigid: Plant
    damping: float
    stiffnesses: tuple[float, float]
    load: float


def assumed(study: Study) -> Assumed:
    """Return the plant that study.toml assumes."""
    one = study.table.table("plant", KEYS)
    k1, k2 = (one.quantity(k, "N*m/rad", above=0.0) for k in ("k1", "k2"))
    motor, load = (one.quantity(k, "kg*m^2", above=0.0) for k in ("motor", "load"))
    h0, x0, share = one.quantity("h0", "N*m"), 1.0 / one.number("a", above=0.0), one.number("at_motor")
    hysteresis, stroke = one.quantity("hysteresis", "N*m"), one.quantity("stroke", "rad", above=0.0)
    damping, ratio = one.quantity("damping", "N*m*s/rad"), one.number("ratio", above=0.0)
    inertia, friction = find("inertia"), find("presliding_hysteresis")
    limits = Limits(one.quantity("torque", "N*m", above=0.0), one.quantity("speed", "rad/s", above=0.0))
    plant = Plant(
        TWO_MASS,
        (
            inertia(inertia=motor, at="motor", fixed=True),
            inertia(inertia=load, at="load", fixed=True),
            find("piecewise_stiffness")(k1=k1, k2=k2 - k1, threshold=one.quantity("t1", "N*m", above=0.0) / k1),
            find("linear_damping")(damping=damping, at="joint"),
            friction(h0=hysteresis, x0=stroke, at="joint"),
            friction(h0=share * h0, x0=x0, at="motor"),
            friction(h0=(1.0 - share) * h0, x0=x0, at="load"),
            find("kinematic_error")(sine=one.quantity("gear_error", "rad"), order=2.0 * ratio, at="joint"),
        ),
        geometry=Geometry(gear_ratio=ratio),
        limits=limits,
    )
    ground = friction(h0=h0, x0=x0)
    return Assumed(plant, rigid_of(plant, ground), damping, (k1, k2 + hysteresis / stroke), load)


def rigid_of(plant: Plant, ground) -> Plant:
    """Return the axis of two masses as one, with friction to ground."""
    mass = sum(e.parameters["inertia"].value for e in plant.effects if e.name == "inertia")
    one = (find("inertia")(inertia=mass), ground)
    return Plant(ONE_MASS, one, geometry=plant.geometry, limits=plant.limits)


def identified(fitted: Plant, known: Assumed) -> Assumed:
    """Return what was identified, with the joint's damping as assumed: torque up to 1 Hz does not show it."""
    spring, joint = fitted["piecewise_stiffness"].parameters, fitted["presliding_hysteresis@joint"].parameters
    ground = [fitted[f"presliding_hysteresis@{at}"].parameters for at in ("motor", "load")]
    plant = fitted + known.plant["linear_damping"]
    whole = sum(g["h0"].value for g in ground)
    stroke = whole / sum(
        g["h0"].value / g["x0"].value for g in ground
    )  # both in parallel, as stiff as the two at first
    friction = find("presliding_hysteresis")(h0=whole, x0=stroke, d=ground[0]["d"].value)
    soft = spring["k1"].value
    stiff = soft + max(spring["k2"].value, 0.0) + joint["h0"].value / joint["x0"].value
    return Assumed(plant, rigid_of(plant, friction), known.damping, (soft, stiff), known.load)


def declared(known: Plant) -> Plant:
    """Return what the paper identifies: inertia from the catalogue, and one hysteretic spring in the joint, values unknown."""
    spring = known["piecewise_stiffness"](k1=300.0, k2=300.0, threshold=1e-3)
    hysteresis = known["presliding_hysteresis@joint"](h0=0.1, x0=1e-3)
    masses = tuple(e for e in known.effects if e.name == "inertia")
    return Plant(TWO_MASS, (*masses, spring, hysteresis), geometry=known.geometry, limits=known.limits)


def random_torque(seed: int, rms: float, band: float, dt: float, samples: int) -> np.ndarray:
    """Return (samples,) of a torque with a flat spectrum from one period of the record up to `band`, N*m."""
    whole = samples * dt
    lines = np.arange(1, int(band * whole) + 1)
    phase = np.random.default_rng(seed).uniform(0.0, 2 * pi, lines.size)
    t = dt * np.arange(samples)
    wave = np.sum(np.cos(2 * pi * lines / whole * t[:, None] + phase), axis=1)
    ramp = np.minimum(t / 1.0, 1.0)  # from rest
    return ramp * rms * wave / np.sqrt(np.mean(wave**2))


def with_ground(fitted: Plant) -> Plant:
    """Return a plant of one hysteretic spring with friction on the motor's side beside it, values unknown."""
    return fitted + find("presliding_hysteresis")(h0=0.1, x0=1.0 / 400.0, at="motor")


def with_gear(fitted: Plant) -> Plant:
    """Return a plant with friction on both sides and the gear's error beside, values unknown but two waves a turn: what an output
    that is free shows."""
    load = find("presliding_hysteresis")(h0=0.02, x0=1.0 / 400.0, at="load")
    waves = find("kinematic_error")(order=2.0 * fitted.geometry.gear_ratio, at="joint")
    order = replace(waves.parameters["order"], fixed=True)
    return with_ground(fitted) + load + replace(waves, parameters={**waves.parameters, "order": order})


def free(study: Study, loop: Loop, known: Plant) -> Record:
    """Log a slow sine with the output free: what slides then is friction to ground."""
    asked = study.table.table("records", KEPT)
    size, frequency = asked.quantity("free", "rad", above=0.0), asked.quantity("frequency", "Hz", above=0.0)
    duration = PERIODS / frequency
    t = loop.sample_time * np.arange(int(round(duration / loop.sample_time)))
    reference = size * np.sin(2 * pi * frequency * t)[:, None]
    scenario = ScenarioArrays(1, target=reference[-1], noise=asked.quantity("noise", "N*m"), seed=3, phase=0.5)
    run = simulate(
        known, replace(loop, velocity_filter=8.0 * loop.sample_time), fixed_pd(*LOGGING, motor_speed=True), scenario, duration,
        ("motor.y", "load.y", "u"), every=PER_RECORD, reference=reference,
    ).trajectories  # fmt: skip
    channels = {"torque": run["u"][:, 0], "position": run["motor.y"][:, 0], "load_position": run["load.y"][:, 0]}
    counts = {"position": loop.resolution, "load_position": loop.load_resolution}
    said = f"output free, {frequency:g} Hz sine of {size:.3g} rad"
    return record_of("id_free", IDENTIFICATION, known, run.time, channels, counts, said)


def locked(study: Study, loop: Loop, known: Plant) -> tuple[tuple[Record, ...], float]:
    """Log random torque with the output locked, once to identify and once to validate; return (records, bandwidth)."""
    asked = study.table.table("records", KEPT)
    samples = int(round(asked.quantity("duration", "s", above=0.0) / loop.sample_time))
    rms, band = asked.quantity("torque", "N*m", above=0.0), asked.quantity("bandwidth_of_torque", "Hz", above=0.0)
    drive = np.stack([random_torque(s, rms, band, loop.sample_time, samples) for s in (1, 2)], axis=1)
    scenarios = [Scenario(locked=1.0, noise=asked.quantity("noise", "N*m"), seed=s, phase=0.5) for s in (1, 2)]
    run = open_loop(
        known, drive, loop.sample_time, loop.substeps, scenarios=scenarios, resolution=loop.resolution,
        load_resolution=loop.load_resolution,
    )  # fmt: skip
    records = tuple(
        record_of(
            name,
            role,
            known,
            run.time[::PER_RECORD],
            {
                "torque": drive[::PER_RECORD, k],
                "position": run["y"][::PER_RECORD, k],
                "load_position": run["load.y"][::PER_RECORD, k],
            },
            {"position": loop.resolution, "load_position": loop.load_resolution},
            f"output locked, random torque up to {band:g} Hz",
            locked=True,
        )
        for k, (name, role) in enumerate((("id_locked", IDENTIFICATION), ("val_locked", VALIDATION)))
    )
    return records, asked.quantity("bandwidth", "Hz", above=0.0)
