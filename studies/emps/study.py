"""The EMPS benchmark: its printed figures by its own protocol, and beside them what the workbench makes of its records."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench import readers
from workbench.control import Controller, Law
from workbench.definition import Effect, find
from workbench.finding import capital, title
from workbench.identification.by_role import refitted
from workbench.identification.fit import identify
from workbench.identification.result import Fit
from workbench.inverse.dynamics import InverseDynamics, inverse_dynamics
from workbench.motion import Motion
from workbench.output_error.free_run import START, Half, carried_over, free_run, refine_free_run
from workbench.output_error.refine import refine
from workbench.output_error.rerun import rerun
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, ROLES, VALIDATION, Record
from workbench.report.contents import BAD, GOOD, Callout, Chapter, Equation, Items, Paragraph, Table
from workbench.report.steps import hundredths, steps_table, tried_table
from workbench.residual.attainable import attainable
from workbench.simulation import Loop
from workbench.study.configuration import Study
from workbench.study.outcome import Outcome
from workbench.tracing import hypotheses
from workbench.tracing.power_up import calibrate
from workbench.tracing.result import Trace
from workbench.tracing.steps import steps
from workbench.tracing.tracing import trace

FURTHER = ("rig", "published")
COLUMNS = {"time": "t", "position": "qm", "reference": "qg", "force": "vir"}
PULSES = {"injected": "pulses_N"}  # volts, as vir is
MOTIONS = {IDENTIFICATION: "point to point", VALIDATION: "point to point, with pulses of force"}
ERROR = {"identification_error": "1", "validation_error": "1"}
GAINS = {"drive": "gtau", "position": "kp", "velocity": "kv"}  # N/V, 1/s, V*s/m
OFFERED = ("viscous_asymmetry", "film_friction", "presliding_length")  # beside what is traced anyway
SUBSTEPS = 10  # from here on the loop's errors change by less than 0.1 %
LEVEL = (
    "coulomb_friction",
    "constant_offset",
)  # what of the friction a day changes, beside which nothing else is fitted
NUDGE = 0.05  # N, of the offset; half or twice of it changes the error per newton by 2 % at most
SYMMETRIC = {"mass": "kg", "viscous": "N*s/m", "coulomb": "N", "offset": "N"}
ASYMMETRIC = {"mass": "kg"} | {f"{n}_{d}": u for n, u in (("viscous", "N*s/m"), ("coulomb", "N")) for d in ("forward", "backward")}  # fmt: skip


def rig(study: Study):
    """Return the table of study.toml that says what is known of the rig."""
    return study.table.table("rig", ("bandwidth", "resolution", "revolution"))


def gains(study: Study, role: str) -> dict[str, float]:
    """Return the gains that a measured file states."""
    return {n: x.item() for n, x in readers.read(study.measured(role), GAINS)[0].items()}


def record(study: Study, role: str) -> Record:
    """Return the measured record of a role."""
    path = study.measured(role)
    measured = readers.read(path, COLUMNS | (PULSES if role == VALIDATION else {}))
    channels, source = dict(measured[0]), measured[1]
    time, volts = channels.pop("time"), gains(study, role)["drive"]
    channels |= {n: volts * channels[n] for n in ("force", "injected") if n in channels}
    return Record(
        name=path.stem,
        role=role,
        time=time,
        channels=channels,
        units={n: "N" if n in ("force", "injected") else "m" for n in channels},
        source=source,
        resolution={"position": rig(study).quantity("resolution", "m", above=0.0)},
        motion=MOTIONS[role],
    )


# --- the published protocol ------------------------------------------------------------------------------------------


def regression(record: Record, asymmetric: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return columns (n, parameters) and force (n,) as Janot, Gautier and Brunot form them, every 10 ms."""
    from scipy import signal

    low_pass = signal.butter(4, 100.0 * 2 * record.dt)
    q = signal.filtfilt(*low_pass, record.channels["position"], padlen=12)
    v = np.gradient(q, record.dt)  # central differences, one-sided at the ends
    a = np.gradient(v, record.dt)
    if asymmetric:
        forward, backward = v > 0, v < 0
        columns = [a, v * forward, v * backward, 1.0 * forward, -1.0 * backward]
    else:
        columns = [a, v, np.sign(v), np.ones(v.size)]
    kept = decimated(np.column_stack([*columns, record.channels["force"]]))
    return kept[:, :-1], kept[:, -1]


def decimated(columns: np.ndarray) -> np.ndarray:
    """Return columns (n, k) without the first 49 samples, as MATLAB's decimate makes them of every tenth."""
    from scipy import signal

    # its padding is three samples shorter than SciPy's own, which shows in the last digits
    return signal.filtfilt(*signal.cheby1(8, 0.05, 0.8 / 10), columns[49:], axis=0, padlen=24)[1::10]


def protocol_error(record: Record, prediction: np.ndarray) -> float:
    """Return |e|/|y| of a prediction of the force (n,) as the published errors are taken."""
    y, predicted = decimated(np.column_stack([record.channels["force"], prediction])).T
    return float(np.linalg.norm(y - predicted) / np.linalg.norm(y))


def published(records: dict[str, Record], asymmetric: bool) -> dict[str, float]:
    """Return parameters and relative errors |e|/|y|, fitted on the identification record alone."""
    sets = {role: regression(records[role], asymmetric) for role in ROLES}
    found = np.linalg.lstsq(*sets[IDENTIFICATION], rcond=None)[0]
    errors = {f"{r}_error": float(np.linalg.norm(y - x @ found) / np.linalg.norm(y)) for r, (x, y) in sets.items()}
    return dict(zip(ASYMMETRIC if asymmetric else SYMMETRIC, found.tolist(), strict=True)) | errors


def compared(study: Study, obtained: dict[str, dict[str, float]]) -> list[tuple[str, str, str, float, float]]:
    """Return (model, quantity, unit, printed, obtained) of every printed figure."""
    top = study.table.table("published", (*obtained, "closed_loop", "free_run"))
    rows = []
    for model, units in (("symmetric", SYMMETRIC | ERROR), ("asymmetric", ASYMMETRIC | ERROR)):
        printed = top.table(model, optional=tuple(units))
        rows += [(model, n, u, printed.quantity(n, u), obtained[model][n]) for n, u in units.items() if n in printed]
    return rows


# --- the workbench's own identification ------------------------------------------------------------------------------


def ripple(turn: float) -> Effect:
    """Return a ripple that repeats every `turn` m."""
    wave = find("cogging")
    order = replace(wave.parameters["order"], value=2 * pi / turn, fixed=True)
    return replace(wave, parameters={**wave.parameters, "order": order})


def explanations(turn: float) -> dict[str, Effect]:
    """Return the explanations that are published or usual for such an axis, each an effect with the value it is tried at."""
    asymmetry = find("coulomb_asymmetry")
    held = {n: replace(p, fixed=n == "viscous_difference") for n, p in asymmetry.parameters.items()}
    return {
        "a difference of Coulomb friction too": replace(asymmetry, parameters=held, label="dry"),
        "static friction above Coulomb friction (Stribeck)": find("stribeck_friction")(speed=0.01),
        "friction that grows with speed squared": find("nonlinear_viscous_friction"),
        "friction in proportion to the force carried": find("load_dependent_friction"),
        "friction that drifts within the record": find("friction_drift"),
        "a torque constant that falls with current": find("torque_constant_saturation")(fall=1e-6),
        "a delay beside the lag": find("transport_delay")(delay=1e-4),
        "a spring to the frame": find("cable_spring"),
        "a ripple once a motor revolution": ripple(turn)(label="turn"),
    }


# --- the loop of the records -----------------------------------------------------------------------------------------


def velocity_loop(s, z, p):
    """Return the states and the force of position over velocity, the velocity from positions averaged over two samples."""
    velocity = 0.5 * (s.y - z.second) / s.dt
    return {"before": s.y, "second": z.before}, p.drive * p.velocity * (p.position * s.e - velocity)


LAW = Law("position over velocity", tuple(GAINS), velocity_loop, ("before", "second"),
          start=lambda target, reading: {"before": reading, "second": reading})  # fmt: skip


def asked(record: Record, gain: dict[str, float]) -> np.ndarray:
    """Return the force that the law asks for on the recorded positions, from the third sample on."""
    q, r = (record.channels[n] for n in ("position", "reference"))
    velocity = 0.5 * (q[2:] - q[:-2]) / record.dt
    return gain["drive"] * gain["velocity"] * (gain["position"] * (r - q)[2:] - velocity)


def commanded(record: Record, gain: dict[str, float]) -> float:
    """Return how far the law on the recorded positions is from the recorded force, |e|/|F|, with what was injected."""
    own = record.channels["force"]
    force = asked(record, gain) + record.channels.get("injected", np.zeros(own.size))[2:]
    return float(np.linalg.norm(own[2:] - force) / np.linalg.norm(own[2:]))


def pulse_height(record: Record, gain: dict[str, float]) -> float:
    """Return the height of the pulses over the stated one: what the recorded force has more than the law asks for."""
    pulses = record.channels["injected"][2:]
    return float(pulses @ (record.channels["force"][2:] - asked(record, gain)) / (pulses @ pulses))


def simulated(models: dict[str, Plant], motions: dict[str, Motion], loop: Loop, law: Controller):
    """Return model -> role -> error of the simulated force, |e|/|F|, unfiltered as the printed ones are."""
    return {n: {r: rerun(plant, m, loop, law).raw["drive"] for r, m in motions.items()} for n, plant in models.items()}


def without_hold(plant: Plant, dt: float) -> Plant:
    """Return the plant with the half sample taken off its lag by which a held command is late: the loop holds it itself.

    Identification takes the recorded command as a line from sample to sample, and finds hold and current loop as one lag.
    """
    if "actuator_lag" not in plant:
        return plant
    lag = plant["actuator_lag"]
    own = max(lag.parameters["time_constant"].value - 0.5 * dt, lag.parameters["time_constant"].lower)
    return plant.with_values({lag.key: {"time_constant": own}})


def printed_plant(obtained: dict[str, float], declared: Plant) -> Plant:
    """Return the symmetric model with the printed parameters."""
    names = {
        "inertia": "mass",
        "viscous_friction": "viscous",
        "coulomb_friction": "coulomb",
        "constant_offset": "offset",
    }
    return declared.with_values({e.key: {next(iter(e.linear)): obtained[names[e.name]]} for e in declared.effects})


def printed_asymmetric(obtained: dict[str, float], declared: Plant) -> Plant:
    """Return the asymmetric model with the printed parameters: means of both directions, and half their differences."""
    mean, half = (
        {n: 0.5 * (obtained[f"{n}_forward"] + sign * obtained[f"{n}_backward"]) for n in ("viscous", "coulomb")}
        for sign in (1.0, -1.0)
    )
    values = {"mass": obtained["mass"], **mean, "offset": half["coulomb"]}
    return printed_plant(values, declared) + find("viscous_asymmetry")(viscous_difference=half["viscous"])


# --- the free run ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Run:
    """A model's free run: role -> rms of the position error in m; fitted: to which free run, if any."""

    model: str
    fitted: str
    errors: dict[str, float]


def on_the_way(declared: Plant, found: Trace) -> dict[str, Plant]:
    """Return the declared model and what the trace made of it, effect by effect in the order in which it added them."""
    models, plant = {"symmetric, as declared": declared}, declared
    for cause in found.causes[:-1]:
        if cause.effect in found.after.plant and cause.effect not in plant:
            plant = plant + found.after.plant[cause.effect]
            models[f"traced up to {title(cause.effect)}"] = plant
    return models | {"as traced": found.after.plant}


def level_alone(plant: Plant) -> Plant:
    """Return the plant with everything fixed but the level of its friction (LEVEL)."""
    for e in plant.effects:
        plant = plant.swap(
            replace(e, parameters={n: replace(p, fixed=e.name not in LEVEL) for n, p in e.parameters.items()})
        )
    return plant


@dataclass(frozen=True)
class Wander:
    """Level of friction within DATA_EMPS. halves: as `carried_over` has them; per_newton: rms position error in m of 1 N of offset."""

    halves: tuple[Half, Half]
    per_newton: float

    @property
    def own(self) -> float:
        """Rms error in m with the level of the half that runs."""
        return rms([h.own for h in self.halves])

    @property
    def other(self) -> float:
        """Rms error in m with the level of the other half."""
        return rms([h.other for h in self.halves])

    def level(self, effect: str) -> tuple[float, float]:
        """Return Coulomb friction or offset in N, half by half."""
        return tuple(next(iter(h.plant[effect].parameters.values())).value for h in self.halves)


def rms(x) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def wander(plant: Plant, motion: Motion) -> Wander:
    """Return what the level of friction does within a record, all else held as the whole record has it."""
    offset = plant["constant_offset"]
    (name, p), = offset.parameters.items()  # fmt: skip
    less, more = (free_run(plant.with_values({offset.key: {name: p.value + d}}), motion) for d in (-NUDGE, NUDGE))
    per_newton = rms((more.simulated - less.simulated)[START:]) / (2 * NUDGE)
    return Wander(carried_over(level_alone(plant), motion), per_newton)


def free_runs(
    models: dict[str, Plant], printed: dict[str, Plant], inverses: dict[str, InverseDynamics]
) -> tuple[list[Run], Wander]:
    """Return free runs: printed parameters, identified models, these fitted to DATA_EMPS's free run; last the chosen three.

    The chosen model is that of the lowest error on DATA_EMPS. It comes as fitted there; with the level of its friction from
    PULSES; and with everything from PULSES: what the last two gain is for nobody to have who has DATA_EMPS alone. With
    them, what the chosen model's level of friction does within DATA_EMPS.
    """

    def ran(name: str, fitted: str, plant: Plant) -> Run:
        return Run(name, fitted, {r: free_run(plant, p.motion).error for r, p in inverses.items()})

    one, other = (inverses[role] for role in ROLES)
    refined = {name: refine_free_run(plant, [one]) for name, plant in models.items()}
    runs = [ran(name, "", plant) for name, plant in (printed | models).items()]
    fits = {name: ran(name, "DATA_EMPS", plant) for name, plant in refined.items()}
    best = min(fits, key=lambda name: fits[name].errors[IDENTIFICATION])
    day = refine_free_run(level_alone(refined[best]), [other])
    own = refine_free_run(refined[best], [other])
    last = fits[best], ran(best, "friction's level to PULSES", day), ran(best, "PULSES", own)
    return [*runs, *fits.values(), *last], wander(refined[best], one.motion)


def run(study: Study, say) -> Outcome:
    """Reproduce the printed figures, identify and trace the symmetric model, and simulate the records' loops."""
    records = {role: record(study, role) for role in ROLES}
    height = pulse_height(records[VALIDATION], gains(study, VALIDATION))
    records[VALIDATION] = with_pulses(records[VALIDATION], height)
    bandwidth = rig(study).quantity("bandwidth", "Hz", above=0.0)
    say("reproducing the printed figures")
    obtained = {model: published(records, model == "asymmetric") for model in ("symmetric", "asymmetric")}
    rows = compared(study, obtained)
    inverses = inverse_dynamics(list(records.values()), bandwidth)
    moving = Plant(ONE_MASS, tuple(map(find, ("inertia", "viscous_friction", "coulomb_friction"))), rotary=False)
    declared = moving + find("constant_offset")
    found = trace(declared, inverses, say, own=tuple(map(find, OFFERED)))
    turn = rig(study).quantity("revolution", "m", above=0.0)
    say("trying the explanations that were published")
    tried = hypotheses.tried(found.after.plant, inverses, explanations(turn), say)
    floors = attainable(found.after, inverses)
    days = refitted(found.after.plant, inverses)
    say("fitting asymmetric friction")
    # Without the offset: in motion it cannot be told from a difference of Coulomb friction between the directions.
    asymmetric = identify(moving + find("coulomb_asymmetry"), inverses)
    lagging = identify(asymmetric.plant + find("actuator_lag"), inverses)
    rippled = identify(lagging.plant + ripple(turn), inverses)
    alone = calibrate(rippled.plant, "cogging@axis", inverses, rippled.validation)
    ripples = [(p.record, p.amplitude.value, p.phase.value, p.half) for p in alone.phases]
    own = {
        "workbench, symmetric as declared": found.before,
        "workbench, asymmetric without offset": asymmetric,
        "the same, with an actuator lag": lagging,
        "the same, with a ripple once a motor revolution": rippled,
        "as traced": found.after,
    }
    say("simulating the loops of the records")
    motions = {p.motion.record.role: p.motion for p in inverses}
    law = Controller(LAW.name, LAW, gains(study, IDENTIFICATION))
    one = records[IDENTIFICATION]
    loop = Loop(one.dt, SUBSTEPS, resolution=one.resolution["position"])
    models = {
        "the same parameters, simulated here": printed_plant(obtained["symmetric"], declared),
        "symmetric, by the workbench": found.before.plant,
        "the same, by output error": refine(found.before.plant, inverses, loop, law).plant,
        "as traced": without_hold(found.after.plant, one.dt),
    }
    closed = simulated(models, motions, loop, law)
    say("letting the records run free")
    identified = {n: without_hold(identify(p, inverses).plant, one.dt) for n, p in on_the_way(declared, found).items()}
    printed = {
        "symmetric, published parameters": printed_plant(obtained["symmetric"], declared),
        "asymmetric, published parameters": printed_asymmetric(obtained["asymmetric"], declared),
    }
    free, within = free_runs(identified, printed, {p.motion.record.role: p for p in inverses})
    figures = {f"{m}_{n}_deviation": abs(o - p) for m, n, _, p, o in rows}
    first, *_, last = closed.values()
    figures |= {f"closed_loop_error_{role}": e for role, e in first.items()}
    figures |= {f"closed_loop_error_{role}_after": e for role, e in last.items()}
    chosen, day, own_run = free[-3:]
    free_figures = {f"free_run_error_{role}": chosen.errors[role] for role in ROLES}
    free_figures |= {
        "free_run_error_level_of_the_day": day.errors[VALIDATION],
        "free_run_error_own": own_run.errors[VALIDATION],
        "free_run_error_half": within.own,
        "free_run_error_other_half": within.other,
    }
    figures |= free_figures
    figures |= {f"controller_error_{role}": commanded(r, gains(study, role)) for role, r in records.items()}
    figures |= {f"repeat_floor_{role}": floors.within[role] for role in ROLES} | {"record_floor": floors.across}
    figures |= {"validation_error_own": days[VALIDATION].identification}
    figures |= {"pulse_height": height}
    figures |= {
        f"{role}_error_by_protocol": protocol_error(r, found.after.predictions[r.name]) for role, r in records.items()
    }
    fits = {"asymmetric": asymmetric, "lag": lagging, "ripple": rippled}
    figures |= {f"validation_error_{name}": fit.validation for name, fit in fits.items()}
    return Outcome(
        plant=declared,
        campaign="electro-mechanical positioning system (EMPS)",
        bandwidth=bandwidth,
        trace=found,
        records=tuple(records.values()),
        figures=found.figures | figures,
        units={f"{m}_{n}_deviation": u for m, n, u, *_ in rows} | dict.fromkeys(free_figures, "m"),
        chapters=(
            printed_chapter(rows),
            protocols_chapter(study, figures, closed, free),
            evidence_chapter(found, {role: figures[f"{role}_error_by_protocol"] for role in ROLES}),
            explanations_chapter(tried, found.after),
            attainable_chapter(floors, days, found.after),
            own_chapter(obtained, own, bandwidth),
            loop_chapter(study, closed, figures),
            free_run_chapter(free, within),
            ripple_chapter(ripples, turn),
        ),
        findings=(*found.findings, *found.after.findings),
        tables={
            "published": [dict(zip(("model", "figure", "unit", "printed", "obtained"), r, strict=True)) for r in rows],
            "closed_loop": [{"model": name, **errors} for name, errors in closed.items()],
            "free_run": [{"model": r.model, "fitted": r.fitted, **r.errors} for r in free],
            "evidence": [vars(s) for s in steps(found)],
            "explanations": [vars(t) for t in tried],
            "ripple": [dict(zip(("record", "amplitude", "phase", "half_interval"), r, strict=True)) for r in ripples],
        },
    )


def with_pulses(record: Record, height: float) -> Record:
    """Return the record with pulses of this height over the stated one. No fit sees them; a simulated loop does."""
    return replace(record, channels={**record.channels, "injected": height * record.channels["injected"]})


# --- chapters --------------------------------------------------------------------------------------------------------


def printed_chapter(rows) -> Chapter:
    """The table of printed against obtained figures."""
    cells, same = [], 0
    for model, name, unit, printed, obtained in rows:
        scale, shown = (100.0, "%") if unit == "1" else (1.0, unit.replace("*", "·"))
        texts = [f"{scale * x:.4f}".replace("-", "−") for x in (printed, obtained)]
        same += texts[0] == texts[1]
        off = f"{scale * (obtained - printed):+.1e}".replace("-", "−")
        cells.append((model, name.replace("_", " "), *texts, off, shown))
    said = f"{same} of {len(cells)} printed figures are reproduced to their last digit."
    protocol = (
        "The protocol is that of Janot, Gautier and Brunot (2019): position through a fourth-order Butterworth low pass at "
        "100 Hz, forwards and backwards; velocity and acceleration by central differences; 49 samples dropped at the start; "
        "columns and force decimated by 10; ordinary least squares on the identification record. Asymmetric friction has "
        "its own viscous and Coulomb coefficient in each direction, and no offset. An error is |e|/|y| of the force."
    )
    table = Table(
        ("Friction", "Figure", "Printed", "Obtained", "Deviation", "Unit"),
        tuple(cells),
        "Printed and obtained figures, both models fitted to the identification record alone.",
        "llrrrl",
    )
    law = Equation(
        'F = M dot.double(q) + F_v dot(q) + F_c "sign"(dot(q)) + "offset"',
        "Force equals mass times acceleration plus viscous friction, Coulomb friction and an offset",
    )
    tone = GOOD if same == len(cells) else BAD
    return Chapter("The printed figures", (Callout(said, tone), law, Paragraph(protocol), table))


def millimetres(error: float) -> str:
    return f"{1e3 * error:.2f} mm"


FREE = {
    "dynonet": "dynoNet, a network (Forgione and Piga 2021)",
    "ltc": "ASIA, liquid time constants (2026)",
    "pnarx": "pNARX (Champneys et al. 2024)",
    "linear": "linear state space (Champneys et al. 2024)",
    "arx": "ARX (Champneys et al. 2024)",
}


def protocols_chapter(study: Study, figures: dict[str, float], closed, free: list[Run]) -> Chapter:
    """The three protocols by which errors on this benchmark are published, side by side."""
    top = study.table.table("published", optional=tuple(study.table.values["published"]))
    stated = {n: top.table(n, optional=tuple(study.table.values["published"][n])) for n in ("symmetric", "closed_loop")}
    ours = {name: errors for name, errors in closed.items() if name == "as traced"}
    first, second, third = "force that the motion needs", "force, loop simulated", "position, free run"
    who = "symmetric (Janot, Gautier, Brunot 2019)"
    rows = [
        (first, who, *(hundredths(stated["symmetric"].quantity(n, "1")) for n in ERROR)),
        (first, "as traced", *(hundredths(figures[f"{r}_error_by_protocol"]) for r in ROLES)),
        (second, who, *(hundredths(stated["closed_loop"].quantity(n, "1")) for n in ERROR)),
        *((second, name, *(hundredths(e[r]) for r in ROLES)) for name, e in ours.items()),
    ]
    published = top.table("free_run", tuple(FREE))
    rows += [(third, said, "", millimetres(published.quantity(n, "m"))) for n, said in FREE.items()]
    shown = {
        "DATA_EMPS": "",
        "friction's level to PULSES": "; friction's level from PULSES",
        "PULSES": "; all from PULSES",
    }
    rows += [(third, r.model + shown[r.fitted], *(millimetres(r.errors[role]) for role in ROLES)) for r in free[-3:]]
    text = (
        "Errors on this benchmark are published by three protocols, and no publication that we know reports all of them. Two "
        "are of the force, |e|/|F|: of the force that the measured motion needs (filtered, every 10 ms), and of the force in a "
        "simulated loop (not filtered). The benchmark's own is of the position: the recorded force alone moves the model, from the place and "
        f"speed that the first {START} samples show, and the error is rms. All models are fitted to DATA_EMPS alone, but for the "
        "last two rows, which say what a model could do that knew the friction of the other day."
    )
    table = Table(("Protocol", "Model", "DATA_EMPS", "PULSES"), tuple(rows), "Three protocols side by side.", "llrr")
    return Chapter("Three protocols", (Paragraph(text), table))


def wandering(within: Wander) -> Table:
    """The level of friction half by half, and what the level of the other half leaves."""
    (first, then), (coulomb, offset) = within.halves, (within.level(effect) for effect in LEVEL)
    before = ("the first half", first.own, then.other)
    after = ("the second half", then.own, first.other)
    rows = [
        (name, f"{c:.2f} N", f"{o:+.2f} N".replace("-", "−"), millimetres(own), millimetres(other))
        for (name, own, other), c, o in zip((before, after), coulomb, offset, strict=True)
    ]
    head = ("Free run of", "Coulomb friction", "Offset", "Error with this level", "With the other half's")
    return Table(head, tuple(rows), "The chosen model on the halves of DATA_EMPS, all but the level held.", "prrrr")


def foretold(within: Wander) -> str:
    """What DATA_EMPS says of another record's free run before there is one."""
    moved = np.ptp(within.level("constant_offset"))
    return (
        f"So much is foretold by DATA_EMPS alone. With the level of its own half the chosen model runs free to {millimetres(within.own)}, "
        f"with the other half's to {millimetres(within.other)}, in half the time that PULSES takes: from half to half the offset moves by "
        f"{moved:.2f} N, less than a hundredth of the force, and {1e3 * within.per_newton:.0f} mm of error in a free run of the whole record "
        "go with each newton of it, for an offset drifts one way and no reversal takes it back. Two levels that DATA_EMPS bears out as "
        "well are thus several millimetres apart on PULSES, and which of them is nearer is no merit of a model."
    )


def free_run_chapter(free: list[Run], within: Wander) -> Chapter:
    """The free run of every model, what DATA_EMPS says of it, and what of its error is the day's friction."""
    *runs, chosen, day, own = free
    fitted = [r for r in runs if r.fitted]
    spans = {role: sorted(r.errors[role] for r in fitted) for role in ROLES}
    by_one, by_other = (sorted(fitted, key=lambda r, role=role: r.errors[role]) for role in ROLES)
    left, gone = (chosen.errors[VALIDATION], 1.0 - (day.errors[VALIDATION] / chosen.errors[VALIDATION]) ** 2)
    told = (
        f"Free run: {millimetres(chosen.errors[IDENTIFICATION])} on DATA_EMPS, {millimetres(left)} on PULSES. With Coulomb friction "
        f"and offset of the day, fitted to PULSES itself, {millimetres(day.errors[VALIDATION])}: {100 * gone:.0f} % of the error's "
        "power is the day's friction."
    )
    text = (
        "Nothing holds the axis here, so a force that is lacking is integrated: 1 N of friction more than the model's moves the "
        "axis by 5 mm every second. What no model of DATA_EMPS can know therefore counts most: how much friction the axis has at "
        "another time. Each model was fitted to the free run of DATA_EMPS by output error, from its identified values, and the one with "
        "the lowest error there was chosen; PULSES had no part in it. The choice is a weak one: the fitted models lie between "
        f"{millimetres(spans[IDENTIFICATION][0])} and {millimetres(spans[IDENTIFICATION][-1])} on DATA_EMPS, and between "
        f"{millimetres(spans[VALIDATION][0])} and {millimetres(spans[VALIDATION][-1])} on PULSES, in {'the same' if by_one == by_other else 'another'} "
        "order. A lower figure on PULSES can be had by choosing among such fits with PULSES in hand; it would say nothing of a third day. Fitted to "
        f"PULSES itself the model leaves {millimetres(own.errors[VALIDATION])} there, and {millimetres(own.errors[IDENTIFICATION])} on DATA_EMPS."
    )
    rows = [(r.model, r.fitted or "not", *(millimetres(r.errors[role]) for role in ROLES)) for r in (*runs, day, own)]
    table = Table(
        ("Model", "Free run fitted to", "DATA_EMPS", "PULSES"), tuple(rows),
        f"Rms of the position error of the free run, without the first {START} samples.", "plrr",
    )  # fmt: skip
    contents = (Callout(told, GOOD), Paragraph(text), table, Paragraph(foretold(within)), wandering(within))
    return Chapter("The free run, and the friction of the day", contents)


def evidence_chapter(found: Trace, protocol: dict[str, float]) -> Chapter:
    """Each effect that the trace added, with its evidence, and what it means on this axis."""
    values = {(e.effect, e.parameter): e.value for e in found.after.estimates}
    meanings = {
        "viscous_asymmetry": "{0} drags more backward than forward, by twice {1:.0f} N·s/m, over the whole range of speeds.",
        "actuator_lag": "{0} of {2:.2f} ms is a half sample of the hold (0.5 ms) and what the current loop takes.",
        "film_friction": "{0} rises by {3:.1f} N over the first {4:.0f} mm/s, at the stops within a move as at the reversals: "
        "friction is lowest at rest, the opposite of Stribeck's.",
        "presliding_hysteresis": "{0} of {5:.1f} N builds up over {6:.0f} µm after a reversal, beside Coulomb friction that "
        "does so at once: balls that roll before they slide.",
    }
    numbers = (
        -values.get(("viscous_asymmetry", "viscous_difference"), np.nan),
        1e3 * values.get(("actuator_lag", "time_constant"), np.nan),
        values.get(("film_friction", "limit"), np.nan),
        1e3 * values.get(("film_friction", "speed"), np.nan),
        values.get(("presliding_hysteresis", "h0"), np.nan),
        1e6 / values.get(("presliding_hysteresis", "a"), np.nan),
    )
    said = tuple(meanings[n].format(capital(title(n)), *numbers) for n in found.added if n in meanings)
    before, after = found.before.validation, found.after.validation
    lower = "Each effect lowers the error on the pulses, which no fit has seen"
    told = f"{lower}: {100 * before:.2f} % to {100 * after:.2f} %."
    falling = all(c.share_validation > 0 for c in found.causes)
    text = (
        "The trace starts from the symmetric model. Beside the effects of the catalogue that it always tries, it was offered "
        "three: asymmetry of the viscous part alone, friction of a lubricant film with a limiting shear stress, and a length "
        "over which Coulomb friction builds up. Measured as the printed errors are, the traced model leaves "
        f"{100 * protocol[IDENTIFICATION]:.2f} % on DATA_EMPS (printed: 4.08 %) and {100 * protocol[VALIDATION]:.2f} % on the record "
        "with pulses (printed: 5.98 %)."
    )
    return Chapter(
        "What symmetric friction lacks, step by step",
        (*((Callout(told, GOOD),) if falling else ()), Paragraph(text), steps_table(found), Items(said)),
    )


def explanations_chapter(tried, traced) -> Chapter:
    """The explanations that are published or usual, and what the data say of them."""
    text = (
        "Each of these was added alone to the traced model and fitted again on the identification record. Published is "
        "friction with a viscous and a Coulomb coefficient of its own in each direction; a difference of Coulomb friction "
        "cannot be told from the constant offset except within the reversals themselves. A ripple is in the record, and "
        "belongs to it alone (below)."
    )
    return Chapter("Explanations that the data do not bear out", (Paragraph(text), tried_table(tried, traced)))


def sliding(plant: Plant, speed: float) -> float:
    """Return the friction in N at a constant speed in m/s, mean of both directions, far from any reversal."""
    at = {e.name: {n: p.value for n, p in e.parameters.items()} for e in plant.effects}
    force = at["viscous_friction"]["viscous"] * speed + at.get("coulomb_friction", {}).get("coulomb", 0.0)
    if "film_friction" in at:
        force += at["film_friction"]["limit"] * np.tanh(speed / at["film_friction"]["speed"])
    curve = at.get("hysteresis_bank", {})
    held = sum(value * curve[f"slip{name[1:]}"] for name, value in curve.items() if name.startswith("k"))
    return force + held + at.get("presliding_hysteresis", {}).get("h0", 0.0)


def attainable_chapter(floors, days: dict[str, Fit], traced: Fit) -> Chapter:
    """What part of the validation error no model of the identification record can take away."""
    values = {r: {(e.effect, e.parameter): e for e in fit.estimates} for r, fit in days.items()}
    rows = []
    for (effect, parameter), e in values[IDENTIFICATION].items():
        o = values[VALIDATION][effect, parameter]
        shown = [f"{x.value:.4g} ± {(x.high - x.low) / 2:.2g}".replace("-", "−") for x in (e, o)]
        rows.append((capital(title(effect)), parameter.replace("_", " "), *shown, e.unit.replace("*", "·")))
    own = days[VALIDATION].identification
    top = float(np.abs(traced.series[next(iter(traced.series))].velocity).max())
    friction = {role: sliding(fit.plant, top) for role, fit in days.items()}
    mass = {role: fit.plant["inertia"].parameters["inertia"].value for role, fit in days.items()}
    text = (
        f"Where DATA_EMPS meets a state of motion again (position, speed and acceleration), its force differs by "
        f"{100 * floors.within[IDENTIFICATION]:.2f} % of its rms; in the record with pulses by {100 * floors.within[VALIDATION]:.2f} %. "
        "So much is noise. But the two records differ from each other by more: taken as measured, what the traced model "
        f"leaves on DATA_EMPS would leave {100 * floors.across:.2f} % on the pulses in the same states. The traced model leaves "
        f"{100 * traced.validation:.2f} % there, and {100 * own:.2f} % if it is fitted to the record with the pulses itself. "
        "What lies between is another state of the axis, not another law: with the pulses friction at "
        f"{1e3 * top:.0f} mm/s is {100 * (friction[VALIDATION] / friction[IDENTIFICATION] - 1):+.1f} %, the mass that the force "
        f"shows {100 * (mass[VALIDATION] / mass[IDENTIFICATION] - 1):+.1f} %, and the ripple has another phase."
    ).replace("-", "−")
    table = Table(
        ("Effect", "Parameter", "DATA_EMPS alone", "PULSES alone", "Unit"),
        tuple(rows),
        "The traced model fitted to each record alone, with half its 95 % interval.",
        "llrrl",
    )
    return Chapter("What can be attained", (Paragraph(text), table))


def own_chapter(obtained, own, bandwidth) -> Chapter:
    """The errors of the workbench's identification beside those of the published protocol."""
    models = (
        ("published protocol, symmetric", *(obtained["symmetric"][n] for n in ERROR)),
        ("published protocol, asymmetric", *(obtained["asymmetric"][n] for n in ERROR)),
        *((name, fit.identification, fit.validation) for name, fit in own.items()),
    )
    text = (
        f"The workbench compares below {bandwidth:g} Hz, through a filter without phase that both sides pass, and sees every "
        "sample; its errors are therefore near the published ones and not the same. The ripple is there to show what does not "
        "carry over. The validation record holds pulses of force, and every model leaves more on it."
    )
    rows = tuple((n, f"{100 * a:.2f} %", f"{100 * b:.2f} %") for n, a, b in models)
    table = Table(("Model", "Identification error", "Validation error"), rows, "Errors on both records.", "prr")
    return Chapter("Beside the published protocol", (Paragraph(text), table))


def loop_chapter(study: Study, closed: dict[str, dict[str, float]], figures: dict[str, float]) -> Chapter:
    """Errors of the force when the records' loops are simulated, beside the printed ones."""
    published = study.table.table("published", optional=tuple(study.table.values["published"]))
    stated = published.table("closed_loop", tuple(ERROR))
    printed = {r: stated.quantity(f"{r}_error", "1") for r in ROLES}
    errors = {"symmetric, published parameters and error": printed} | closed
    lower = all(error <= printed[r] for r, error in next(iter(closed.values())).items())
    said = "With the published parameters the simulated force is " + ("nearer to" if lower else "farther from")
    text = (
        "Here the reference goes in, and motion and force come out: the controller is the position over velocity loop that "
        "the files give the gains of, its velocity the difference of positions that are averaged over two samples. Put on "
        f"the recorded positions, that law gives the recorded force to {100 * figures[f'controller_error_{IDENTIFICATION}']:.2f} %, "
        f"and to {100 * figures[f'controller_error_{VALIDATION}']:.2f} % with the pulses. The file states their height in whole "
        f"volts; by the law it is {figures['pulse_height']:.4f} times that, which is what is simulated. The traced lag holds the half "
        "sample by which a held command is late; the loop holds its command itself, so that half is taken off here. "
        "An error is |e|/|F| of the unfiltered force. How the printed simulation integrated the friction and took the "
        "velocity is not stated, so its figures are a bound here and not digits to be reproduced."
    )
    rows = tuple((n, *(f"{100 * e[r]:.2f} %" for r in ROLES)) for n, e in errors.items())
    table = Table(("Model", "Identification record", "Validation record"), rows,
                  "Error of the force in the simulated loop of each record.", "prr")  # fmt: skip
    callout = Callout(f"{said} the measured one than the printed simulation's.", GOOD if lower else BAD)
    return Chapter("The loop, simulated", (callout, Paragraph(text), table))


def ripple_chapter(ripples, turn: float) -> Chapter:
    """Why a ripple that is there in both records does not carry over from one to the other."""
    text = (
        f"A ripple once a motor revolution, {1e3 * turn:g} mm of travel, is there in each record when it is fitted to that "
        "record alone, and its phase is another one, as it would be where an incremental encoder counts from the place of "
        "the axis at power-on. So a ripple that was identified on one record does not lower the error on the other; to be "
        "compensated, it needs a position that is counted from an index pulse."
    )
    rows = tuple((n, f"{a:.2f} N", f"{p:.2f} ± {h:.2f} rad".replace("-", "−")) for n, a, p, h in ripples)
    table = Table(
        ("Record", "Amplitude", "Phase"), rows, "First harmonic of the ripple, 95 % interval of its phase.", "lrr"
    )
    return Chapter("A ripple of one motor revolution", (Paragraph(text), table))
