"""Models of a harmonic drive on records that can decide what a review says of them.

On the carried records one part of the model is exchanged at a time, from the declared model with a kinematic error. What those
records do not hold is asked of four axes that do. Each statement becomes a verdict with its numbers.
"""

import numpy as np

from workbench.campaign import load
from workbench.definition import find
from workbench.identification.fit import fitted_on, identify
from workbench.identification.problem import Problem
from workbench.inverse.dynamics import inverse_dynamics
from workbench.kernel.step import build
from workbench.record import VALIDATION
from workbench.report import drawing
from workbench.report.contents import Chapter, Figure, Marked, Paragraph, Table
from workbench.report.numbers import percent
from workbench.residual.orders import order_spectrum
from workbench.study.outcome import Outcome
from workbench.tracing.tracing import trace

from . import carried, decided
from .axes import axes
from .carried import LOCKED
from .rivals import judged
from .saying import BORNE_OUT, EQUAL, NOT_BORNE_OUT, NOT_HELD, decisive

ONLY = (
    "backlash",
    "cogging",
    "coulomb_asymmetry",
    "inertia",
    "kinematic_error",
    "stribeck_friction",
    "transport_delay",
)
SHADES = {BORNE_OUT: "good", NOT_BORNE_OUT: "bad", NOT_HELD: "quiet"}


def elastic(effect, x) -> np.ndarray:
    """Return the torque (n,) of a force without memory over deflections x (n,)."""
    values = {n: p.value for n, p in effect.parameters.items()}
    return np.array([values[n] for n in effect.linear]) @ build(effect).run({"q": x}, values)[: len(effect.linear)]


def figures(fits, base, inverses, largest: float) -> tuple[Figure, ...]:
    """Draw the torsion loop, the stiffness over torque, and what is left over the motor's angle."""
    seen, x = base.series[LOCKED], np.linspace(0.0, 1.02 * largest, 200)
    curves = {}
    for (family, model), fit in fits.items():
        if family == "stiffness":
            torque = sum(elastic(e, x) for e in fit.plant.effects if e.name.endswith(("stiffness", "compliance")))
            curves[model] = (torque, np.gradient(torque, x))

    def loop(axes):
        own = slice(seen.keep.start, seen.keep.stop, 16)
        axes[0].plot(
            1e3 * seen.position[own], seen.measured[own], color=drawing.MEASURED, linewidth=3, label="measured"
        )
        axes[0].plot(1e3 * seen.position[own], seen.predicted[own], color=drawing.AFTER, linewidth=0.9, label="model")
        axes[0].set(xlabel="deflection, output locked (mrad)", ylabel="torque (N·m)")
        axes[0].legend()

    def stiffness(axes):
        for (model, (t, k)), colour, style in zip(curves.items(), drawing.SERIES, drawing.STYLES, strict=False):
            axes[0].plot(t, k, color=colour, linestyle=style, label=model)
        axes[0].set(xlabel="torque of the stiffness (N·m)", ylabel="dT/dθ (N·m/rad)", ylim=(0, None))
        axes[0].legend()

    def left(axes):
        both = (("none", drawing.BEFORE), ("trigonometric, one wave", drawing.AFTER))
        chosen = [p for p in inverses if p.motion.record.role == VALIDATION]
        for model, colour in both:
            own = [fits["kinematic error", model].series[p.motion.record.name] for p in chosen]
            rest = [
                np.where((n := np.arange(s.time.size)) >= s.keep.start, s.residual, 0) * (n < s.keep.stop) for s in own
            ]
            orders, height = order_spectrum(chosen, rest)
            shown = (orders > 3) & (orders < 200)
            axes[0].plot(
                *drawing.envelope(orders[shown], 1e3 * height[shown]), color=colour, label=f"kinematic error: {model}"
            )
        axes[0].set(xlabel="order (waves per turn of the output)", ylabel="residual (mN·m)", ylim=(0, None))
        axes[0].legend()

    cubic = curves["linear and cubic"][1]
    wave = [fits["kinematic error", m].validation for m in ("none", "trigonometric, one wave")]
    said = (
        (f"The modelled loop leaves {percent(base.nrmse[LOCKED])} of the locked record's torque", loop, "torsion_loop",
         "Drive torque over deflection with the output locked; the loop's width is friction of motor and joint."),
        (f"The joint hardens from {cubic[0]:.0f} to {cubic[-1]:.0f} N·m/rad", stiffness, "stiffness_over_torque",
         "Slope of the fitted stiffness part, hysteresis apart, up to the largest deflection of the locked record."),
        (f"With its wave the validation error falls from {percent(wave[0])} to {percent(wave[1])}", left, "left_over_angle",
         "Spectrum of the validation residual over the motor's angle: what is left is the stochastic part."),
    )  # fmt: skip
    return tuple(Figure(n, drawing.svg(t, d), c, f"{t}. {c}") for t, d, n, c in said)


def run(study, say) -> Outcome:
    """Trace what the declared model lacks, fit every family beside the base, and ask the axes what these records do not hold."""
    campaign = load(study.campaign)
    inverses = inverse_dynamics(campaign.records, campaign.bandwidth)
    found = trace(campaign.plant, inverses, say, most=1, only=ONLY)
    say("fitting the base")
    wave = find("kinematic_error")(at="joint", sine=1e-5, cosine=1e-5)(
        order=2 * campaign.plant.geometry.gear_ratio, fixed=True
    )
    wave = wave.free("sine", "cosine")
    base = identify(identify(found.before.plant + wave, inverses).plant, inverses)
    base = identify(base.plant.swap(base.plant["kinematic_error"].free("order")), inverses)
    fits, loads, rows, numbers = _fitted(base, inverses, say)
    say("judging")
    said = _carried_statements(base, inverses, fits, loads, found.floor[VALIDATION])
    say("logging four axes")
    seen = {axis: judged(axis, made, say) for axis, made in axes().items()}
    said = decisive([*said, *decided.statements(seen)])
    count = {w: sum(s.verdict == w for s in said) for w in SHADES}
    largest = float(np.abs(base.series[LOCKED].position).max())
    order = base.plant["kinematic_error"].parameters["order"].value
    return Outcome(
        plant=campaign.plant,
        campaign=campaign.title,
        bandwidth=campaign.bandwidth,
        trace=found,
        records=campaign.records,
        figures=found.figures | {
            "identification_error_base": base.identification,
            "validation_error_base": base.validation,
            "statements": float(len(said)),
            "borne_out": float(count[BORNE_OUT]),
            "not_in_these_records": float(count[NOT_HELD]),
            "kinematic_order_deviation": abs(order - 2 * base.plant.geometry.gear_ratio),
            "held_over_floor": decided.over_floor(seen),
            "held_deviation": max(decided.deviations(seen).values()),
        },
        chapters=(
            Chapter("Models on the same records", (Paragraph(_method()), _families(rows), *figures(fits, base, inverses, largest))),
            Chapter("Models on axes that hold an effect", (Paragraph(_held(seen)), decided.table(seen))),
            Chapter("What is borne out", (Paragraph(_borne(count)), _review(said))),
        ),
        findings=(*campaign.findings, *found.findings, *found.after.findings),
        tables={
            "models": numbers,
            "held": [{"axis": a, "model": m, "identification": f.identification, "validation": f.validation, "floor": j.floor}
                     for a, j in seen.items() for m, f in j.fits.items()],
            "verdicts": [{"said": s.said, "records": s.records, "verdict": s.verdict, "numbers": s.numbers} for s in said],
        },
    )  # fmt: skip


def _fitted(base, inverses, say):
    """Return ((family, model) -> fit, -> error of the load's balance, rows of the table, the same as numbers)."""
    fits, loads, rows, numbers = {}, {}, [], []
    for family, models in carried.families(base.plant).items():
        for model, plant in models.items():
            say(f"fitting {family}: {model}")
            fit = base if plant is base.plant else identify(plant, inverses)
            fits[family, model], problem = fit, Problem(plant, fitted_on(inverses))
            free = len(problem.free_linear) + len(problem.free_shape)
            loads[family, model] = carried.load_error(inverses, fit.plant, VALIDATION)
            errors = (fit.identification, fit.validation, loads[family, model])
            rows.append((family, Marked(model, "strong") if fit is base else model, str(free), *map(percent, errors)))
            numbers.append({"family": family, "model": model, "free": free, "identification": errors[0],
                            "validation": errors[1], "load_balance": errors[2]})  # fmt: skip
    return fits, loads, rows, numbers


def _carried_statements(base, inverses, fits, loads, floor: float):
    amplitudes = {
        p.motion.record.name: carried.amplitude_of(base.plant, p)
        for p in fitted_on(inverses)
        if not p.motion.record.locked
    }
    largest = float(np.abs(base.series[LOCKED].position).max())
    k, k3 = (
        base.plant[n].parameters[q].value for n, q in (("linear_stiffness", "stiffness"), ("cubic_stiffness", "k3"))
    )
    return carried.statements(fits, loads, base, floor, amplitudes, (k, k + 3 * k3 * largest**2))


def _method() -> str:
    return (
        "One part of the model is exchanged at a time and everything is fitted anew, each family from the base: the declared "
        "model with a kinematic error. A model counts as better or worse where its validation error differs by more than "
        f"{100 * EQUAL:.0f} %. The trace was asked about {len(ONLY)} effects only ({', '.join(n.replace('_', ' ') for n in ONLY)}). "
        "The records come from an independent high-rate simulator of such an axis, whose joint is a hardening spring with "
        "Maxwell-slip hysteresis: that these two families fit is no finding. What is shown is how far the others fall behind."
    )


def _families(rows) -> Table:
    return Table(
        ("Family", "Model", "Free", "Identification", "Validation", "Load's balance"), tuple(rows),
        "Errors over the drive's rms; the base in bold. Load's balance: on the validation record, over the same rms.", "lprrrr",
    )  # fmt: skip


def _held(seen) -> str:
    off = decided.deviations(seen)
    return (
        f"The records above hold a gear's wave and hysteresis, but no {', '.join(list(seen)[:-1])} or {list(seen)[-1]}. So the study logs "
        "four axes like that one on its own simulator, each with one of them at a size of catalogues. That the model with an effect fits "
        "an axis that has it is no finding; what is shown is that records like these determine it, and what is paid where it is left out or "
        f"simplified. Fits begin a fifth off; the size of the effect is found within {percent(max(off.values()))} of what was simulated. "
        "The last axis is validated with its output locked, where it is the joint that is asked about; the others on moves."
    )


def _borne(count) -> str:
    return (
        f"Of {sum(count.values())} statements of a review on such models these records bear out {count[BORNE_OUT]} and not "
        f"{count[NOT_BORNE_OUT]}; of {count[NOT_HELD]} they cannot tell, since none of them holds such an effect."
    )


def _review(said) -> Table:
    cells = tuple((s.said, s.records, Marked(s.verdict, SHADES[s.verdict]), s.numbers) for s in said)
    return Table(("What reviews say", "Records", "Verdict", "Numbers"), cells, "Statements, judged.", "pplp")
