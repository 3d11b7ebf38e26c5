"""What the paper printed beside what this study obtains, and what is wrong with, or missing from, the print."""

from math import inf

from workbench.report.contents import Chapter, Heading, Items, Paragraph
from workbench.report.reproduction import INPUT, Printed, as_table, counted, places_table, reproduction_table

from .compensated import Compensated
from .identified import Identified
from .ladder import EVALUATIONS, PRINTED, RADII
from .loop import CALIBRATED, TS, margins
from .loop import PRINTED as AS_PRINTED

__all__ = ["as_table", "chapter", "counted", "rows"]

GAIN = (
    "eqs. (1) and (2) as printed are 12.7 dB too low in gain; the loop that was measured held a factor that they do not, of a "
    "driver or a converter"
)
PHASE = "with the gain for which the crossover is the printed one; no reading of eq. (1) gives all three figures"
ONE_FREQUENCY = "one settled frequency determines four or five of the ten parameters; the others are where the search happened to stop"
OTHER_PIVOT = "of another pivot: ours is synthetic"

PLACES = (
    ("Fig. 1, eq. (2), the actuator's response", "The actuator, measured again"),
    ("Fig. 2, eq. (1), the loop", "The loop, as printed and as it must have been"),
    ("Fig. 3, u over x", "Friction, got out of the records"),
    ("Fig. 4, the actuator with F(x)", "Friction, got out of the records"),
    ("Fig. 5, eqs. (3) to (11), operators", "Operators, and every way to their weights"),
    ("Figs. 6 and 7, eqs. (12) to (14), friction and model", "Operators, and every way to their weights"),
    ("Fig. 8, responses over amplitude", "Responses of a loop that is not linear"),
    ("Figs. 9 and 10, eq. (15), preload and two slopes", "Operators, and every way to their weights"),
    ("Figs. 11 to 15, compensation", "The friction, compensated"),
)

ERRATA = {
    "E1": "The sampling time is 83.3 µs, not 83.3 ms: that has a Nyquist frequency of 6 Hz, below the 10 Hz of the test, and at "
    "12 kHz the filter is a notch at 4200.0 Hz with damping ratios of 0.05 and 0.10, exactly P_res's first mode.",
    "E2": "Controller times plant, as printed, cross over at 274 Hz with 23.7° and 21.2 dB, not at 945 Hz with 49° and 8.7 dB. With "
    "4.32 times the gain they do at 945 Hz, with 41.4° and 8.5 dB; 7.6° are not explained.",
    "E3": "The weights have no unit. In mV/V they put the actuator's resonance on its pivot at 107 Hz, where the figures have it; in "
    "V/V it would be at 3.4 kHz.",
    "E4": "The amplitudes 0.5, 1 and 3 V are called amplitudes and peak-to-peak values. With radii of half of them, the second "
    "reading leaves the last play dead in all records, and every play dead in the smallest.",
    "E5": "The rates of the creep operators are not printed, and a settled record of 10 Hz cannot give them.",
    "E6": "‖T_ex‖∞ is the ratio of energies along one trajectory, with a unit: a lower bound of an induced gain, which the record of the "
    "largest force rules.",
    "E7": "“After 2000 iterations” is the search's default limit for ten parameters, and no minimum: where it stops depends on its "
    "start.",
    "E8": "The two-slope law lacks sgn(x) in its second branch: as printed it jumps at x = −s. Nor is sgn(0) defined in eq. (15).",
    "E9": "The differential equation of the play lacks the sign of the velocity: as printed it would pull back. Eq. (9) is right.",
    "E10": "Negative weights of plays and creep operators are the passive ones, springs that slip or creep; the two positive ones, "
    "0.1667 and 0.4403, give energy.",
    "E11": "How u_a was got from x is not said, and decides: differencing twice leaves errors of twice the friction.",
    "E12": "The compensation's delay and filter, what position drives it, and where S is measured are not said; for disturbances of "
    "force, or seen by the loop alone, it is worth nothing.",
    "E13": "The model is judged on the records that it was fitted to; at 50 Hz there is a picture and no error.",
    "E14": "That any displacement from 0.5 V on is compensated follows from the smallest radius, 0.25 V.",
}


def rows(fits: Identified, held: Compensated) -> list[Printed]:
    """Return the reproduction table's rows."""
    literal, calibrated = margins(AS_PRINTED), margins(CALIBRATED)
    best = fits.amplitude.best_simplex
    a, wb, wc = best.bank.plays
    weights = zip(
        ("a", "wb1", "wb2", "wb3", "wc1", "wc2", "wc3"), (PRINTED["a"], *PRINTED["wb"], *PRINTED["wc"]), (a, *wb, *wc),
        strict=True,
    )  # fmt: skip
    return [
        Printed("sampling time", 83.3e-3, TS, 0.01, "s", reason="83.3 µs are meant (E1)", within=1001.0),
        Printed("crossover, as printed", 945.0, literal.crossover, 0.01, "Hz", reason=GAIN, within=4.5),
        Printed("phase margin, as printed", 49.0, literal.phase, 0.02, "deg", reason=GAIN, within=4.5),
        Printed("gain margin, as printed", 8.7, literal.gain, 0.05, "dB", reason=GAIN, within=4.5),
        Printed("crossover, calibrated", 945.0, calibrated.crossover, 0.01, "Hz"),
        Printed("phase margin, calibrated", 49.0, calibrated.phase, 0.02, "deg", reason=PHASE, within=1.25),
        Printed("gain margin, calibrated", 8.7, calibrated.gain, 0.05, "dB"),
        Printed("energy gain, simplex search, amplitudes", 0.08, best.gain, 0.1, "mV/V"),
        Printed(
            "energy gain, simplex search, peak to peak", 0.08, fits.peak.best_simplex.gain, 0.1, "mV/V",
            reason="with this reading the plays are dead (E4)", within=inf,
        ),
        Printed(
            "energy gain, as many passive operators", 0.08, fits.amplitude.passive.gain, 0.1, "mV/V",
            reason="it is less than half: radii are searched too, and weights solved for", within=4.0,
        ),
        *(Printed(f"weight {n}", p, o, 0.1, "mV/V", reason=ONE_FREQUENCY, within=inf) for n, p, o in weights),
        *(
            Printed(f"radius {i}, over the amplitude", r / size, 0.5, 0.01, kind=INPUT)
            for i, (r, size) in enumerate(zip(RADII, (0.5, 1.0, 3.0), strict=True), 1)
        ),
        Printed("evaluations of the search", 2000.0, float(min(best.evaluations, EVALUATIONS)), 0.01, "1", kind=INPUT,
                reason="that start met the tolerances before", within=4.0),
        Printed("|S| at 10 Hz, 0.5 V, that operator", -20.0, held.simplex[0.5], 0.25, "dB", reason=OTHER_PIVOT, within=inf),
        Printed("|S| at 10 Hz, 1 V, that operator", -20.0, held.simplex[1.0], 0.25, "dB", reason=OTHER_PIVOT, within=inf),
        Printed("|S| at 10 Hz, 3 V, that operator", -20.0, held.simplex[3.0], 0.25, "dB", reason=OTHER_PIVOT, within=inf),
        Printed(
            "|S| at 10 Hz, 0.25 V, that operator", -20.0, held.simplex[0.25], 0.25, "dB",
            reason="not satisfactory at 0.25 V in the paper either: no radius is below it", within=inf,
        ),
    ]  # fmt: skip


def chapter(printed: list[Printed]) -> Chapter:
    """The table, and the errata."""
    text = (
        "Tolerances: 1 % for frequencies, 2 % for phase, 5 % for decibels of margins, 10 % for the energy gain and the weights, and a "
        "quarter for “around 20 dB”. Rows of friction are of a synthetic pivot, chosen before they were computed."
    )
    return Chapter(
        "What was printed, and what is obtained",
        (
            Paragraph(text),
            places_table(PLACES),
            reproduction_table(printed, "Every printed number beside ours."),
            Heading("Errata and silences"),
            Items(tuple(f"{name}. {text}" for name, text in ERRATA.items())),
        ),
    )
