"""A made-up study, as a trace would return it: an axis whose Stribeck friction was not declared."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from workbench.definition import find
from workbench.description.result import Equivalent
from workbench.finding import Finding
from workbench.identification.result import Estimate, Fit, Series
from workbench.plant import ONE_MASS, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record, Source
from workbench.report.contents import Chapter, Check, Equation, Figure, Paragraph, Recorded, StudyResult, Table
from workbench.report.drawing import svg
from workbench.tracing.result import CAUSE, NOTHING, UNKNOWN, CandidateScore, Cause, Trace

RATE = 500.0
TRUE = {"inertia": 1.23e-3, "viscous": 0.0041, "coulomb": 0.182, "drop": 0.0553, "speed": 0.62}
MOTIONS = (
    ("sweep_slow", IDENTIFICATION, "sine, 0.5 to 4 Hz, 1 rad", 0.45, 1.0),
    ("steps_mixed", IDENTIFICATION, "smooth steps of 0.05 to 3 rad, at random", 1.1, 1.7),
    ("orbit", VALIDATION, "two sines that never repeat, up to 9 rad/s", 0.8, 1.4),
)


def motion(index: int, base: float, size: float) -> tuple[np.ndarray, ...]:
    """Return time, position, velocity and acceleration of one record."""
    t = np.arange(0, 9, 1 / RATE)
    rng = np.random.default_rng(index)
    q, v, a = np.zeros((3, t.size))
    for k in range(4):
        w, phase, amplitude = 2 * np.pi * base * (1 + 0.77 * k), rng.uniform(0, 6), size / (1 + k) ** 1.3
        q += amplitude * np.sin(w * t + phase)
        v += amplitude * w * np.cos(w * t + phase)
        a -= amplitude * w**2 * np.sin(w * t + phase)
    return t, q, v, a


def columns(v: np.ndarray, a: np.ndarray, stribeck: bool) -> np.ndarray:
    """Return the columns of the drive that is needed."""
    direction = np.tanh(v / 0.02)
    given = [a, v, direction]
    return np.stack([*given, np.exp(-((v / TRUE["speed"]) ** 2)) * direction] if stribeck else given, axis=1)


def records() -> list[Record]:
    """Return three records with coloured noise on the drive."""
    made = []
    for i, (name, role, words, base, size) in enumerate(MOTIONS):
        t, q, v, a = motion(i, base, size)
        noise = np.convolve(np.random.default_rng(10 + i).normal(0, 0.004, t.size), np.ones(5) / 5, "same")
        torque = columns(v, a, True) @ [TRUE[n] for n in ("inertia", "viscous", "coulomb", "drop")] + noise
        source = Source(Path("/somewhere/else", f"{name}.csv"), f"{i + 1}" * 64, "csv", {"torque": "T"})
        units = {"torque": "N*m", "position": "rad"}
        made.append(Record(name, role, t, {"torque": torque, "position": q}, units, source, motion=words))
    return made


def estimate(effect: str, parameter: str, value: float, half: float, fixed: bool = False) -> Estimate:
    p = find(effect).outside[parameter]
    unit = {"F": "N*m", "F*s/x": "N*m*s/rad", "F*s^2/x": "kg*m^2", "x/s": "rad/s"}[p.unit]
    return Estimate(effect, "axis", parameter, value, value - half, value + half, unit, p.meaning, fixed)


def fit(stribeck: bool) -> Fit:
    """Fit the declared or the extended model by least squares, and see it on all records."""
    rows = [(r, *motion(i, *MOTIONS[i][3:])) for i, r in enumerate(records())]
    inside = [(columns(v, a, stribeck), r.drive) for r, _, _, v, a in rows if r.role == IDENTIFICATION]
    c = np.linalg.lstsq(np.concatenate([m for m, _ in inside]), np.concatenate([u for _, u in inside]), rcond=None)[0]
    series, nrmse, power = {}, {}, {IDENTIFICATION: np.zeros(3), VALIDATION: np.zeros(3)}
    for r, t, q, v, a in rows:
        s = Series(r.name, r.role, t, q, v, np.array(r.drive), columns(v, a, stribeck) @ c, slice(25, t.size - 25))
        left, whole = s.residual[s.keep], s.measured[s.keep]
        series[r.name], nrmse[r.name] = s, float(np.sqrt(left @ left / (whole @ whole)))
        power[r.role] += left @ left, whole @ whole, left.size
    effects = [
        find("inertia")(inertia=c[0]),
        find("viscous_friction")(viscous=c[1]),
        find("coulomb_friction")(coulomb=c[2]),
    ]
    found = [
        estimate("inertia", "inertia", c[0], 1.7e-5),
        estimate("viscous_friction", "viscous", c[1], 0.0052 if not stribeck else 2.1e-4),
        estimate("coulomb_friction", "coulomb", c[2], 0.0021),
    ]
    findings = [Finding("not determined", "viscous_friction@axis.viscous", "viscous_friction: viscous coefficient is 0.0032 with a 95 % interval wider than its value; these records do not determine it.", {}, "record a motion in which this effect is a larger part of the drive")]  # fmt: skip
    if stribeck:
        effects.append(find("stribeck_friction")(drop=c[3], speed=TRUE["speed"]))
        found += [
            estimate("stribeck_friction", "drop", c[3], 0.0008),
            estimate("stribeck_friction", "speed", 0.6211, 0.014),
        ]
        findings = []
    error = {role: float(np.sqrt(p[0] / p[1])) for role, p in power.items()}
    rms = {role: float(np.sqrt(p[0] / p[2])) for role, p in power.items()}
    return Fit(Plant(ONE_MASS, tuple(effects)), tuple(found), error[IDENTIFICATION], error[VALIDATION], nrmse, rms, series, {}, tuple(findings))  # fmt: skip


def candidates() -> tuple[CandidateScore, ...]:
    names = {
        "stribeck_friction": (0.958, 0.021), "lugre_friction": (0.951, 0.024), "nonlinear_viscous_friction": (0.412, 0.038),
        "load_dependent_friction": (0.173, 0.045), "coulomb_asymmetry": (0.021, 0.012), "presliding_hysteresis": (0.014, 0.02),
        "cyclic_friction": (0.006, 0.009), "cogging": (0.003, 0.006), "gravity": (0.0009, 0.002), "inertia": (0.0004, 0.002),
        "transport_delay": (-0.0002, 0.001), "constant_offset": (-0.004, 0.003),
    }  # fmt: skip
    return tuple(
        CandidateScore(n, "command" if n == "transport_delay" else "axis", "correction" if n == "inertia" else "addition", g, s, 0.11 * (1 - g) ** 0.5, 0.105 * (1 - g) ** 0.5, g > 0.05 and g > 3 * s, f"Adding {n}.")
        for n, (g, s) in names.items()
    )  # fmt: skip


def trace(verdict: str = CAUSE) -> Trace:
    """Return a trace with one cause, with none, or with something unknown."""
    before, ranked = fit(False), candidates()
    floor = {IDENTIFICATION: 0.0085, VALIDATION: 0.0081}
    if verdict != CAUSE:
        quiet = tuple(replace(c, gain=0.02 * c.gain, earns=False) for c in ranked)
        place = {"coordinate": "velocity", "low": 0.1, "high": 0.4, "spans": [[0.1, 0.4]], "direction": "forward"}
        place |= {"share": 0.61, "size": 0.031, "times_calm": 3.1, "times_calm_outside": 1.1}
        unknown = place if verdict == UNKNOWN else {}
        words = "Nothing is missing: the residual is at the floor." if verdict == NOTHING else "Something is missing."
        return Trace(verdict, words, quiet, (quiet,), (), before, before, floor, (), unknown)
    after = fit(True)
    shares = [1 - (getattr(after, role) / getattr(before, role)) ** 2 for role in (IDENTIFICATION, VALIDATION)]
    cause = Cause(
        "stribeck_friction", "axis",
        "Stribeck friction at the axis is missing: the lubricant film that builds up with speed. It explains "
        f"{100 * shares[0]:.1f} % of the residual power on the identification records and {100 * shares[1]:.1f} % on the "
        "validation record.",
        after.estimates[-2:], *shares, ("lugre_friction",), "slow ramps through zero at several speeds below 1 rad/s",
    )  # fmt: skip
    sentence = (
        f"Stribeck friction is missing. With it, the validation error falls from {100 * before.validation:.2f} % to "
        f"{100 * after.validation:.2f} % and the identification error from {100 * before.identification:.2f} % to "
        f"{100 * after.identification:.2f} % (noise floor {100 * floor[IDENTIFICATION]:.2f} %)."
    )
    second = tuple(replace(c, gain=0.01, scatter=0.02, earns=False) for c in ranked[2:])
    return Trace(CAUSE, sentence, ranked, (ranked, second), (cause,), before, after, floor)


def equivalents() -> tuple:
    """Describe two curves h0 (1 - exp(-x/x0)) by the integrals that the report states."""
    made = []
    amplitude = np.geomspace(1e-6, 1e-1, 40)
    t = np.linspace(0, np.pi, 801)
    for name, h0, x0 in (("presliding_hysteresis", 0.182, 8e-4), ("coulomb_friction", 0.04, 2e-5)):
        y = lambda x, h0=h0, x0=x0: h0 * -np.expm1(-x / x0)  # noqa: E731
        a = amplitude[:, None]
        stiffness = -4 / (np.pi * amplitude) * np.trapezoid(y(a / 2 * (1 - np.cos(t))) * np.cos(t), t, axis=1)
        u = a * np.linspace(0, 1, 801)
        loss = 8 / (np.pi * amplitude**2) * np.trapezoid(y(u) - y(a) / 2, u, axis=1)
        made.append((find(name), Equivalent(amplitude, stiffness, loss)))
    return tuple(made)


def further() -> Chapter:
    """A chapter as a later study would add it, with every kind of block that the standard ones leave out."""
    draw = lambda: svg("The step settles in 40 ms", lambda a: (a[0].plot([0, 1], [0, 1]), a[0].set(xlabel="time (s)", ylabel="x (rad)")))  # fmt: skip # noqa: E731
    rows = tuple(
        (f"{i}", f"{i * i}", "a longer text that has to wrap in its column, more than once") for i in range(60)
    )
    return Chapter("Tuning", (
        Paragraph("A chapter of the study."), Equation("K_p = k_e + J omega^2", "K p is k e plus J omega squared"),
        Figure("tuning", draw, "The step.", "A step."), Table(("knot", "gain", "note"), rows, "A table over pages.", "crp"),
    ))  # fmt: skip


def study(verdict: str = CAUSE) -> StudyResult:
    """Return the result of the whole study."""
    found = trace(verdict)
    return StudyResult(
        name="bench_axis",
        title="What the model of the bench axis lacks",
        question="Which physical effect is missing from the declared model, and how much of the error does it explain?",
        campaign="Bench axis, winter campaign",
        records=tuple(map(Recorded.of, records())),
        plant=found.before.plant,
        bandwidth=60.0,
        trace=found,
        equivalent=equivalents(),
        checks=(
            Check("error on validation", found.after.validation, "1", "<= 0.11", True),
            Check("residual over the noise floor", 1.02, "1", "<= 1.5", True),
            Check("time of the trace", 12.4, "s", "<= 10", False),
        ),
        findings=(Finding("resampled", "orbit", "Record orbit was resampled to 500 Hz.", {}, ""),),
    )
