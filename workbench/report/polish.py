"""The chapter on gains per amplitude as the simulated step has them, beside those of the closed form."""

import numpy as np

from workbench.design.polish import Polished
from workbench.plant import Plant
from workbench.report import numbers
from workbench.report.contents import Chapter, Figure, Paragraph, Table
from workbench.report.drawing import AFTER, BEFORE, MUTED, decades, svg
from workbench.verification.promise import Promise

ROWS = 9


def polish_chapter(polished: Polished, held: Promise, plant: Plant) -> Chapter:
    """Gains and times of the closed form, of the nominal and of the robust optimum on simulated steps."""
    small = int((~held.read).sum())
    missed = int((~np.isfinite(held.simulated - held.promised)).sum())
    kept = (
        f"the axis does over three encoder phases to within {numbers.scaled(held.deviation, 's')}."
        if not missed
        else f"the axis does not at {missed} of {held.promised.size} amplitudes: under an encoder's counts it comes to no rest there."
    )
    text = (
        f"What gains that were optimised on a simulated step promise for the nominal plant, {kept} The closed form knows neither delay nor the drive's limit in the course of a step, nor how friction changes along it. "
        "From its optimum on, Kp and Kd of each amplitude are optimised on the simulated step itself: 1 % time about the own "
        "final value, rise time and error with the study's weights, overshoot and |S| of the exact sampled loop within their "
        "limits; once for the nominal plant, once for the worst of the study's factors on friction and inertia. "
        + (
            f"{small} small amplitudes were run without counts, of which one would be more than their band leaves."
            if small
            else ""
        )
    )
    return Chapter(
        "Gains per amplitude, on the simulated step",
        (Paragraph(text), _figure(polished, plant), _table(polished, plant)),
    )


def _price_sentence(polished: Polished) -> str:
    """Say what robustness costs, as a number."""
    price = polished.price
    if np.allclose(price, 1.0):
        return "Inertia and friction are stated to be known, so the robust gains are the nominal ones"
    return (
        f"Robust gains take {numbers.number(float(np.median(price)))} times as long on the nominal plant as nominal ones, "
        f"{numbers.number(float(price.min()))} to {numbers.number(float(price.max()))} over amplitude"
    )


def _figure(polished: Polished, plant: Plant) -> Figure:
    """Kp, Kd and time over amplitude."""
    heading = _price_sentence(polished)
    linear, amplitude = polished.linear, polished.linear.amplitude

    def draw(axes):
        for name, kp, kd, time, style in (
            ("closed form, as promised", linear.kp, linear.kd, linear.time, {"color": MUTED, "ls": ":"}),
            ("simulated step, nominal", polished.nominal.kp, polished.nominal.kd, polished.nominal.nominal.time, {"color": BEFORE, "ls": "--"}),
            ("simulated step, robust", polished.robust.kp, polished.robust.kd, polished.robust.nominal.time, {"color": AFTER}),
        ):  # fmt: skip
            for axis, values in zip(axes, (kp, kd, 1e3 * time), strict=True):
                axis.loglog(amplitude, values, label=name, lw=1.1, **style)
        for axis, name, unit in (
            (axes[0], "Kp", f"{plant.effort}/{plant.displacement}"),
            (axes[1], "Kd", f"{plant.effort}*s/{plant.displacement}"),
        ):
            axis.set_ylabel(numbers.label(name, numbers.unit(unit)))
        axes[2].set_ylabel("1 % time (ms)")
        axes[2].set_xlabel(numbers.label("amplitude A", numbers.unit(plant.displacement)))
        for axis in axes:
            decades(axis.xaxis)
            decades(axis.yaxis)
        axes[0].legend(loc="lower left")

    return Figure(
        "gains_on_simulated_steps",
        lambda: svg(heading, draw, rows=3, height=5.4, share=True),
        "Gains and 1 % times over amplitude, on the nominal plant.",
        f"Three graphs over amplitude. {heading}.",
    )


def _table(polished: Polished, plant: Plant) -> Table:
    """Some of the amplitudes in figures."""
    kp, kd = (numbers.unit(f"{plant.effort}{t}/{plant.displacement}") for t in ("", "*s"))
    n, r = polished.nominal, polished.robust
    rows = tuple(
        (
            numbers.scaled(float(n.amplitude[i]), plant.displacement),
            *(numbers.number(float(v[i])) for v in (n.kp, n.kd)),
            numbers.scaled(float(n.nominal.time[i]), "s"),
            numbers.scaled(float(n.nominal.rise[i]), "s"),
            numbers.percent(float(n.nominal.overshoot[i])),
            numbers.scaled(float(n.nominal.error[i]), plant.displacement),
            numbers.number(float(n.sensitivity_peak[i])),
            *(numbers.number(float(v[i])) for v in (r.kp, r.kd)),
            numbers.scaled(float(r.nominal.time[i]), "s"),
            numbers.scaled(float(r.worst.time[i]), "s"),
        )
        for i in np.unique(np.linspace(0, n.kp.size - 1, ROWS).astype(int))
    )
    columns = (
        "amplitude", f"Kp ({kp})", f"Kd ({kd})", "1 % time", "rise", "overshoot", "error", "Ms", "robust Kp", "robust Kd",
        "1 % time", "worst",
    )  # fmt: skip
    return Table(columns, rows, "Nominal optimum, and the robust one beside it.", "r" * len(columns))


def as_table(polished: Polished) -> dict[str, object]:
    """What results.json holds: all amplitudes, both optima."""

    def held(s):
        figures = {n: list(v) for n, v in vars(s.nominal).items()} | {
            f"worst_{n}": list(v) for n, v in vars(s.worst).items()
        }
        return {"kp": list(s.kp), "kd": list(s.kd), "sensitivity": list(s.sensitivity_peak), **figures}

    return {
        "amplitude": list(polished.linear.amplitude),
        "closed_form": {
            "kp": list(polished.linear.kp),
            "kd": list(polished.linear.kd),
            "time": list(polished.linear.time),
        },
        "nominal": held(polished.nominal),
        "robust": held(polished.robust),
        "price_of_robustness": list(polished.price),
    }
