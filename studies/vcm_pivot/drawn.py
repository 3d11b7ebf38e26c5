"""The study's figures."""

import numpy as np

from workbench.hysteresis import Bank
from workbench.report.contents import Figure
from workbench.report.drawing import AFTER, BEFORE, MEASURED, MUTED, SERIES, decades, svg

from .actuator import Actuator
from .compensated import SHOWN, SIZES, TEN, Compensated, linearity, modelled, relative
from .identified import Ladder
from .limits import LINES
from .loop import CALIBRATED, K0
from .machine import Machine
from .records import MILLI, settled
from .responses import decibel, linear_sensitivity


def figure(name: str, heading: str, draw, caption: str, kind: str, **layout) -> Figure:
    """Return a figure whose drawing's title is the finding."""
    return Figure(name, lambda: svg(heading, draw, **layout), caption, f"{kind} {heading}.")


def actuator(seen: Actuator) -> Figure:
    heading = "The modal fit gives eq. (2) back from a noisy response"
    f = seen.response.frequency

    def draw(axes):
        fitted = seen.modes.at(f) / K0
        axes[0].semilogx(f, decibel(seen.response.value / K0), ".", ms=1.5, color=MEASURED, label="measured")
        axes[0].semilogx(f, decibel(fitted), color=AFTER, label="modal fit")
        axes[1].semilogx(f, np.degrees(np.unwrap(np.angle(-seen.response.value))), ".", ms=1.5, color=MEASURED)
        axes[1].semilogx(f, np.degrees(np.unwrap(np.angle(-fitted))), color=AFTER)
        axes[0].set_ylabel("s² x/u over K₀ (dB)")
        axes[1].set_ylabel("phase (°)")
        axes[1].set_xlabel("frequency (Hz)")
        axes[0].legend(loc="upper left")

    return figure("actuator", heading, draw, "Counterpart of Fig. 1, relative to the double integrator K₀/s², at 48 kHz.",
                  "Magnitude and phase over frequency.", rows=2, height=3.6, share=True)  # fmt: skip


def drive_over_position() -> Figure:
    heading = "The loops of u over x are not ellipses, and not alike at any two amplitudes"

    def draw(axes):
        for axis, size in zip(axes, (0.25, 0.5, 1.5), strict=True):
            seen = settled(Machine(CALIBRATED), 10.0, size, 1)
            axis.plot(seen["x"][0], MILLI * seen["u"][0], color=AFTER)
            axis.set_xlabel("x (V)")
        axes[0].set_ylabel("u (mV)")

    return figure("drive_over_position", heading, draw, "Counterpart of Fig. 3: one settled period of 10 Hz each.",
                  "Three closed loops.", columns=3, height=2.4)  # fmt: skip


def operators() -> Figure:
    heading = "A play follows with a gap, a creep operator with a lag; both remember"

    def draw(axes):
        t = np.linspace(0.0, 1.0, 2001)
        x = np.sin(2 * np.pi * 2 * t) * (0.4 + 0.6 * t)
        for axis, bank in zip(
            axes, (Bank(0.0, (0.25,), (1.0,), (), ()), Bank(0.0, (), (), (10.0,), (1.0,))), strict=True
        ):
            axis.plot(x, x - bank.run(x, t[1]), color=AFTER)
            axis.set_xlabel("x (V)")
        axes[0].set_ylabel("operator (V)")

    return figure("operators", heading, draw, "Counterpart of Fig. 5: play of radius 0.25 V, and creep of 10 1/s, under a sine that "
                  "grows.", "Two loops.", columns=2, height=2.4)  # fmt: skip


def friction_loops(fits: Ladder) -> Figure:
    heading = "A dense passive bank follows friction at each amplitude"

    def draw(axes):
        bank = fits.dense.bank
        weights = np.concatenate([[bank.stiffness], bank.springs, bank.creeps])
        for k, e in enumerate(fits.seen):
            r = e.record
            y = r.columns(bank.radii, bank.rates) @ weights
            t = MILLI * r.dt * np.arange(r.x.size)
            axes[k].plot(r.x, r.f, color=MEASURED, linewidth=2.6, label="got out")
            axes[k].plot(r.x, y, color=AFTER, linewidth=0.9, label="model")
            axes[k].set_xlabel("x (V)")
            axes[k + 3].plot(t, r.f, color=MEASURED, linewidth=2.6)
            axes[k + 3].plot(t, y, color=AFTER, linewidth=0.9)
            axes[k + 3].plot(t, r.f - y, "--", color=BEFORE, label="what is left")
            axes[k + 3].set_xlabel("time (ms)")
        for a in (axes[0], axes[3]):
            a.set_ylabel("friction (mV)")
        axes[0].legend(loc="upper left")
        axes[3].legend(loc="lower left")

    return figure("friction_loops", heading, draw, "Counterparts of Figs. 6 and 7, records with noise, 50 periods averaged.",
                  "Three loops and three time traces.", rows=2, columns=3, height=4.2)  # fmt: skip


def rivals(fits: Ladder) -> Figure:
    heading = "Preload and two slopes fit the amplitude that they were fitted to, and no other"

    def draw(axes):
        for axis, e in zip(axes, fits.seen[:2], strict=True):
            r = e.record
            axis.plot(r.x, r.f, color=MEASURED, linewidth=2.6, label="got out")
            axis.plot(r.x, fits.smallest.run(r), "--", color=BEFORE, label="preload and two slopes")
            axis.set_xlabel("x (V)")
        axes[0].set_ylabel("friction (mV)")
        axes[0].legend(loc="upper left")

    return figure("rivals", heading, draw, "Counterpart of Figs. 9 and 10: fitted to the smaller amplitude.", "Two loops.",
                  columns=2, height=2.6)  # fmt: skip


def over_frequency(axes, below: str, ncols: int = 1) -> None:
    """Label two graphs over frequency, of the response over the double integrator's and of something below it."""
    axes[0].set_ylabel("x/u over K₀/s² (dB)")
    axes[1].set_ylabel(below)
    axes[1].set_xlabel("frequency (Hz)")
    axes[0].legend(loc="lower right", ncols=ncols)


def responses(found: Compensated, bank: Bank, smallest) -> Figure:
    heading = "Operators hold the response at every amplitude; preload and two slopes at none"

    def draw(axes):
        for k, size in enumerate(SHOWN):
            seen = found.before[size]
            for force, style, label in ((bank, "-", "operators"), (smallest, ":", "preload")):
                ratio = modelled(seen, force)
                axes[0].semilogx(seen.frequency, relative(ratio, seen.omega), style, color=SERIES[k],
                                 label=label if k == 0 else None)  # fmt: skip
                axes[1].semilogx(seen.frequency, np.degrees(np.angle(-ratio)), style, color=SERIES[k])
            axes[0].semilogx(
                seen.frequency, seen.over_integrator, "o", ms=3, color=SERIES[k], label=f"stepped, {size:g} V"
            )
            axes[1].semilogx(seen.frequency, np.degrees(np.angle(-seen.plant)), "o", ms=3, color=SERIES[k])
        over_frequency(axes, "phase − 180° (°)", ncols=2)

    return figure("responses", heading, draw, "Counterpart of Fig. 8. Dots: sines through the loop of the pivot; lines: describing "
                  "functions of what was identified.", "Magnitude and phase over frequency.", rows=2, height=4.4, share=True)  # fmt: skip


def best_linear_figure(found: Compensated) -> Figure:
    heading = "From phase to phase the response scatters by as much as the friction is nonlinear"

    def draw(axes):
        omega = 2 * np.pi * LINES
        for b, color, label in zip(found.linear, (BEFORE, AFTER), ("before", "after compensation"), strict=True):
            axes[0].semilogx(LINES, relative(b.value, omega), ".", ms=3, color=color, label=label)
            axes[1].loglog(LINES, b.total / np.abs(b.value), ".", ms=3, color=color)
        over_frequency(axes, "scatter")
        decades(axes[1].yaxis)

    return figure("best_linear", heading, draw, "Best linear approximation, eight multisines of random phases, odd lines, without "
                  "noise; scatter: standard deviation over |x/u|.", "Two graphs over frequency.", rows=2, height=3.6, share=True)  # fmt: skip


def compensated_responses(found: Compensated) -> Figure:
    off = max(abs(found.after[a].over_integrator[TEN:]).max() for a in SIZES[:-1])
    heading = (
        f"Compensated, the actuator is the double integrator within {off:.1f} dB from 10 Hz and from 0.25 to 1.5 V"
    )

    def draw(axes):
        for k, size in enumerate(SIZES):
            for seen, style in ((found.before[size], ":"), (found.after[size], "-")):
                axes[0].semilogx(seen.frequency, seen.over_integrator, style, color=SERIES[k],
                                 label=f"{size:g} V" if style == "-" else None)  # fmt: skip
                axes[1].semilogx(seen.frequency, np.degrees(np.angle(-seen.plant)), style, color=SERIES[k])
        over_frequency(axes, "phase − 180° (°)", ncols=2)

    return figure("compensated_responses", heading, draw, "Counterparts of Figs. 13 and 14. Dotted: before compensation. Above zero is "
                  "too much of it.", "Magnitude and phase over frequency.", rows=2, height=4.4, share=True)  # fmt: skip


def sensitivities(found: Compensated) -> Figure:
    falls, rises = (f(float(g(found.change(a))) for a in (0.25, 1.5)) for f, g in ((max, lambda c: c[TEN]), (max, max)))
    heading = f"At 10 Hz the error falls by {-falls:.0f} dB or more; above 40 Hz it rises by up to {rises:.1f} dB"

    def draw(axes):
        for axis, size in zip(axes, (0.25, 1.5), strict=True):
            before, after = found.before[size], found.after[size]
            axis.semilogx(before.frequency, decibel(before.sensitivity), ":", color=BEFORE, label="before")
            axis.semilogx(after.frequency, decibel(after.sensitivity), "-", color=AFTER, label="compensated")
            axis.semilogx(before.frequency, decibel(linear_sensitivity(CALIBRATED, before.frequency)), "--", color=MUTED,
                          label="no friction")  # fmt: skip
            axis.set_xlabel(f"frequency (Hz), {size:g} V")
        axes[0].set_ylabel("|S| (dB)")
        axes[1].legend(loc="lower right")

    return figure("sensitivities", heading, draw, "Counterpart of Fig. 15: error over reference.", "Two graphs over frequency.",
                  columns=2, height=3.0)  # fmt: skip


def straightened(found: Compensated) -> Figure:
    before, after = (linearity(*c) for c in found.cosine)
    heading = f"At 50 Hz and 1 V, {100 * before:.0f} % of the drive is no multiple of x before compensation, {100 * after:.1f} % after"

    def draw(axes):
        for axis, (x, u), said in zip(axes, found.cosine, ("before", "compensated"), strict=True):
            axis.plot(x, MILLI * u, color=AFTER)
            axis.set_xlabel(f"x (V), {said}")
        axes[0].set_ylabel("controller's own u (mV)")

    return figure("straightened", heading, draw, "Counterpart of Fig. 12.", "Two loops.", columns=2, height=2.6)


def limits_figure(found: Compensated) -> Figure:
    heading = "A gain that is 10 % off leaves 20 log(0.1) of the friction; a delay of a few samples hardly matters"

    def draw(axes):
        for off, color, label in ((found.off_small, BEFORE, "0.25 V"), (found.off, AFTER, "1.5 V")):
            for axis, word in zip(axes, ("gain", "delay"), strict=True):
                points = [(float(n.split()[-1]), v) for n, v in off.items() if n.startswith(word)]
                axis.plot(*zip(*points, strict=True), "o-", ms=3, color=color, label=label)
        axes[0].set_xlabel("gain of the compensation")
        axes[1].set_xlabel("delay (samples)")
        axes[0].set_ylabel("change of |S| at 10 Hz (dB)")
        axes[0].legend(loc="lower right")

    return figure(
        "limits",
        heading,
        draw,
        "Error over reference, relative to no compensation.",
        "Two graphs.",
        columns=2,
        height=2.8,
    )
