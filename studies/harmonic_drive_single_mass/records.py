"""The assumed plant, the records that the study logs on it, and the virgin curve that they hold."""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from workbench.control import fixed_pd
from workbench.definition import find
from workbench.identification.fit import fitted_on
from workbench.identification.intervals import covariance
from workbench.identification.problem import Problem
from workbench.identification.solve import solve
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.record import IDENTIFICATION, VALIDATION, Record
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, svg
from workbench.simulation import ScenarioArrays, simulate
from workbench.simulation.recorded import record_of
from workbench.study.configuration import Study
from workbench.study.control import Control

FIRST, SECOND = "fha_8c_50", "fha_8c_30"
EVERY = 4  # control samples a logged one


@dataclass(frozen=True)
class Logged:
    """records: the study's own. known: the assumed plant. declared: what its engineer believes before identification."""

    records: tuple[Record, ...]
    known: Plant
    declared: Plant
    bandwidth: float


def assumed(study: Study, actuator: str) -> Plant:
    """Return the plant that study.toml assumes: catalogue inertia and limits, printed friction."""
    every = study.table.table("actuators", (FIRST, SECOND))
    one = every.table(actuator, ("inertia", "torque", "speed"))
    printed = study.table.table("friction", ("h0", "a"))
    return Plant(
        ONE_MASS,
        (
            find("inertia")(inertia=one.quantity("inertia", "kg*m^2", above=0.0), fixed=True),
            find("presliding_hysteresis")(h0=printed.quantity("h0", "N*m"), x0=1.0 / printed.number("a", above=0.0)),
        ),
        limits=Limits(one.quantity("torque", "N*m", above=0.0), one.quantity("speed", "rad/s", above=0.0)),
    )


def logged(study: Study, control: Control, known: Plant) -> Logged:
    """Log slow sines on the assumed plant, through a stiff loop with the study's encoder."""
    asked = study.table.table("records", ("frequency", "amplitudes", "validation", "periods", "noise", "bandwidth"))
    frequency = asked.quantity("frequency", "Hz", above=0.0)
    sizes = np.array([*asked.numbers("amplitudes", (), "rad"), asked.quantity("validation", "rad", above=0.0)])
    loop = replace(control.loop, velocity_filter=8.0 * control.loop.sample_time)
    duration = asked.number("periods", above=0) / frequency
    t = loop.sample_time * np.arange(int(round(duration / loop.sample_time)))
    reference = sizes * np.sin(2 * pi * frequency * t)[:, None]
    scenarios = ScenarioArrays(
        sizes.size, target=reference[-1], noise=asked.quantity("noise", "N*m"), seed=1 + np.arange(sizes.size)
    )
    run = simulate(
        known, loop, fixed_pd(600.0, 2.0), scenarios, duration, ("y", "u"), every=EVERY, reference=reference
    ).trajectories
    records = tuple(
        record_of(
            f"{'val' if k == sizes.size - 1 else 'id'}_sine_{k + 1}",
            VALIDATION if k == sizes.size - 1 else IDENTIFICATION,
            known,
            run.time,
            {"torque": run["u"][:, k], "position": run["y"][:, k]},
            {"position": loop.resolution},
            f"{frequency:g} Hz sine of {size:.3g} rad",
        )
        for k, size in enumerate(sizes)
    )
    guess = known["presliding_hysteresis"](h0=0.1, x0=1.0 / 400.0)
    return Logged(records, known, known.swap(guess), asked.quantity("bandwidth", "Hz", above=0.0))


def correlation(plant: Plant, inverses) -> float:
    """Return the correlation of the estimates of h0 and a on some records."""
    problem = Problem(plant, fitted_on(inverses))
    names, cov, _, _ = covariance(problem, solve(problem))
    i, j = (next(k for k, n in enumerate(names) if n.parameter == p) for p in ("h0", "x0"))
    return -float(cov[i, j] / np.sqrt(cov[i, i] * cov[j, j]))  # a = 1/x0 turns the sign


def estimates_of(fit) -> dict:
    return {e.parameter: e for e in fit.estimates if e.effect == "presliding_hysteresis"}


def virgin_chapter(seen: Logged, fit, alone, inverses) -> tuple[Chapter, dict[str, float]]:
    """The loops and the virgin curve, and what the printed test by itself does not tell apart."""
    paper = correlation(seen.declared, inverses[:1])
    both = correlation(seen.declared, inverses)
    found, by_itself = estimates_of(fit), estimates_of(alone)
    size = float(np.max(np.abs(seen.records[0].channels["position"])))
    reached = 1.0 - np.exp(-found["a"].value * size)
    width = {n: (e.high - e.low) / (2 * e.value) for n, e in by_itself.items()}
    heading = f"A 0.2 Hz sine of {1e3 * size:.2f} mrad reaches {numbers.percent(reached)} of h0 from its middle"

    def draw(axes):
        first = seen.records[0]
        last = slice(-int(5.0 / first.dt), None)
        series = fit.series[first.name]
        axes[0].plot(1e3 * first.channels["position"][last], 1e3 * first.drive[last], ".", ms=1, color=MEASURED,
                     label="logged")  # fmt: skip
        axes[0].plot(1e3 * series.position[last], 1e3 * series.predicted[last], "-", color=AFTER, lw=1, label="model")
        x = np.linspace(0.0, size, 200)
        y = found["h0"].value * -np.expm1(-found["a"].value * x)
        axes[0].plot(1e3 * x, 1e3 * y, "--", color=BEFORE, label="virgin curve")
        axes[0].axhline(1e3 * found["h0"].value, color=MUTED, lw=0.8, ls=":")
        axes[0].set_xlabel("position (mrad)")
        axes[0].set_ylabel("torque (mN·m)")
        axes[0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3)

    figure = Figure(
        "virgin_curve",
        lambda: svg(heading, draw, height=3.0),
        "Counterpart of Fig. 6: the last cycle of the printed test (0.003 rad/s, 0.2 Hz) on the assumed plant of Fig. 5. "
        "Dotted: h0.",
        f"Torque over position, a closed loop. {heading}.",
    )
    text = (
        "The axis is one mass on a surface with friction (Fig. 5). All records are simulated by this study, with encoder, "
        "delay and torque noise; what identification finds is held against what was assumed. The printed test barely leaves "
        f"presliding: by itself it gives h0 and a with a correlation of {paper:.3f} and intervals of ±{numbers.percent(width['h0'])} "
        f"and ±{numbers.percent(width['a'])}; with a sine that slides the correlation is {both:.2f}."
    )
    return Chapter("Virgin curve from slow sines", (Paragraph(text), figure)), {
        "h0": found["h0"].value,
        "a": found["a"].value,
        "correlation_of_the_printed_test": abs(paper),
        "correlation": abs(both),
        "reached_by_the_printed_test": reached,
    }
