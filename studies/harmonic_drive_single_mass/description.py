"""Equivalent stiffness and loss of the friction, beside their closed forms."""

from math import pi

import numpy as np

from workbench.description import equivalent
from workbench.plant import Plant
from workbench.report.contents import Chapter, Equation, Figure, Paragraph
from workbench.report.drawing import AFTER, BEFORE, decades, svg


def closed_forms(h0: float, a: float, amplitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return k_e and c_e w of h0 (1 - exp(-a x)) in Bessel functions: z = a A/2, 2 h0 a e^-z I1(z)/z and
    (4 h0 a/pi) e^-z i1(z), i1 the modified spherical one."""
    from scipy.special import ive

    z = a * amplitude / 2
    return 2 * h0 * a * ive(1, z) / z, 4 * h0 * a / pi * np.sqrt(pi / (2 * z)) * ive(1.5, z)


def equivalents_chapter(plant: Plant, amplitudes: np.ndarray) -> tuple[Chapter, dict[str, float]]:
    """The equivalent parameters as the paper means them, beside their closed forms, and the printed formula."""
    effect = plant["presliding_hysteresis"]
    h0, a = effect.outside["h0"].value, effect.outside["a"].value
    q = equivalent(effect, amplitudes)
    exact = closed_forms(h0, a, amplitudes)
    off = max(float(np.max(np.abs(x / y - 1))) for x, y in zip((q.stiffness, q.loss), exact, strict=True))
    i = int(np.argmax(q.loss))
    heading = f"The loss is largest, {q.loss[i]:.2f} N·m/rad, at {1e3 * amplitudes[i]:.2f} mrad; stiffness falls from {q.stiffness[0]:.0f} N·m/rad"

    def draw(axes):
        for axis, values, known, name in zip(axes, (q.stiffness, q.loss), exact, ("kₑ", "cₑω"), strict=True):
            axis.loglog(amplitudes, values, "-", color=AFTER, label="integrals")
            axis.loglog(amplitudes[::6], known[::6], "o", ms=3, color=BEFORE, label="closed form")
            axis.set_ylabel(f"{name} (N·m/rad)")
            decades(axis.xaxis)
            decades(axis.yaxis)
        axes[0].legend(loc="lower left")
        axes[1].set_xlabel("amplitude A, zero to peak (rad)")

    figure = Figure(
        "equivalent_parameters",
        lambda: svg(heading, draw, rows=2, height=4.0, share=True),
        "Counterpart of Fig. 7, of the identified friction.",
        f"Two graphs over amplitude. {heading}.",
    )
    text = (
        "The printed loss has the wrong sign and the wrong limit: at A = 1 mrad and the printed h0 and a it gives −9.2 × 10⁵ "
        f"N·m/rad instead of 9.46. As derived (Masing's rule, A zero to peak) both agree with their closed forms to {off:.0e}:"
    )
    blocks = (
        Paragraph(text),
        Equation("k_e = (2 h_0 a e^(-z) I_1(z)) / z, quad c_e omega = (4 h_0 a) / pi e^(-z) i_1(z), quad z = (a A) / 2",
                 "k e is 2 h0 a e to the minus z times I one of z over z; c e omega is 4 h0 a over pi e to the minus z i one of z"),
        figure,
    )  # fmt: skip
    return Chapter("Equivalent parameters of the friction", blocks), {"closed_form_deviation": off}
