"""The firmware's page: its table, what rounding does to every number and to the loop, size, instructions, and checks."""

from collections.abc import Mapping, Sequence

import numpy as np

from workbench.design.regret import Regret
from workbench.firmware import quantisation
from workbench.firmware.comparison import COUNTS, Comparison
from workbench.firmware.summary import Summary
from workbench.report import numbers
from workbench.report.contents import BAD, GOOD, Chapter, Heading, Items, Marked, Paragraph, Table

CHECKS = (
    "Host C, a Cortex-M4 and a RISC-V core command the bits of Python's reference in each of 1000 vectors (reversals, limits, "
    "first and last knot, denormals, wrap) and along whole motions; with one sign wrong they do not.",
    "The loader refuses every single flipped bit, every truncation, and a wrong version, byte order, law, plant or sample time, "
    "each with a code of its own.",
    "A million calls of loader and step with arbitrary input under the address and undefined-behaviour sanitizers.",
    "Every line and branch of what is written by hand is run.",
)


def firmware_chapter(
    made: Mapping[str, tuple[Sequence[Summary], str]], held: Mapping[str, Regret] | None = None
) -> Chapter:
    """Return the chapter on firmware. made: controller -> (in each arithmetic, where its files are), the recommended one first.
    held: regrets of the gain table over its ladder, of the law and of what was compiled of it."""
    blocks = []
    for i, (name, (found, folder)) in enumerate(made.items()):
        blocks += [Heading(f"Beside it: {name}")] if i else []
        blocks += _of_one(("The recommended controller, " if i == 0 else "") + name, found, folder)
    if held:
        blocks += [Heading("The gain table over every move, as compiled"), _held(held)]
    return Chapter(
        "Firmware", (*blocks, Heading("What the tests of the workbench hold of such firmware"), Items(CHECKS))
    )


def _held(regrets: Mapping[str, Regret]) -> Table:
    """The worst regret of the gain table over its ladder, by who computes it."""
    rows = tuple(
        (name, *(numbers.number(x) for x in r.worst[:2]), numbers.percent(r.worst[2])) for name, r in regrets.items()
    )
    caption = (
        "Worst regret of the gain table over its ladder of moves, against the same references. The firmware is asked for whole counts of the "
        "encoder, so that up to half a count of its error is the command's."
    )
    return Table(("computed", "time", "error", "overshoot"), rows, caption, "lrrr")


def _of_one(name: str, made: Sequence[Summary], folder: str) -> list:
    """Return the blocks on one controller's firmware."""
    first, beside = made[0].made, made[0].made.compensation
    text = (
        f"{name}, as C: the instructions that were simulated, in float32 and in fixed point, with a table "
        f"of {len(first.numbers.values)} numbers"
        + (f" and {first.numbers.knots.size} knots" if first.numbers.knots.size else "")
        + f", for a sample time of {numbers.scaled(first.numbers.sample_time, 's')} and an encoder of "
        f"{numbers.number(first.numbers.count)} a count. Sources and tables (C, binary, Intel HEX, JSON, A2L) lie in {folder}."
    )
    if beside:
        keys = ", ".join(e.name.replace("_", " ") for e in beside.made.compensator.forces)
        text += (
            f" Its compensation of {keys} is a firmware beside it, with a table of {beside.source.size} numbers; the loop is run with "
            "both. RAM counts both; table, code, instructions and rounding are the law's."
        )
    blocks = [Paragraph(text), _sizes(made), Heading("What rounding does"), _rounded(made)]
    blocks += [_signals(s) for s in made if quantisation.grains(s.made)]
    return blocks


def _sizes(made: Sequence[Summary]) -> Table:
    """One row an arithmetic."""
    rows = []
    for s in made:
        m, run = s.measured, s.moved
        rows.append(
            (
                s.arithmetic,
                str(len(s.made.image.bytes())),
                str(s.ram),
                *((str(m.code), str(m.worst), str(m.mean)) if m else ("not measured", "–", "–")),
                numbers.number(s.gain, 2),
                numbers.number(s.sensitivity, 2),
                *(
                    (_error(run), numbers.scaled(run.time_1pct, "s", 2), _bits(run))
                    if run
                    else ("no C compiler here", "–", "–")
                ),
            )  # fmt: skip
        )
    columns = (
        "arithmetic", "table (bytes)", "RAM (bytes)", "code (bytes)", "instructions, worst", "mean", "gain's error", "|S| moves by",
        "lands elsewhere (counts)", "1 % time differs", "bits",
    )  # fmt: skip
    caption = (
        "Code and instructions of one step on a Cortex-M4 at -O2, encoder and velocity filter included. The axis lands elsewhere, and "
        "later or sooner, than under the law in float64, at most, over the task's scenarios; bits: samples in which C and Python agree. "
        "Where float64 lands is a span, since friction that differs by 1 × 10⁻⁷ sets an axis down elsewhere, too; counts are those outside it. "
        "The gain's error is the largest of any number; |S| moves by no more than that times Ms (1 + Ms)."
    )
    return Table(columns, tuple(rows), caption, "lrrrrrrrrrr")


def _error(run: Comparison):
    text = numbers.number(run.final_error, 2) if np.isfinite(run.final_error) else "one does not rest"
    return Marked(text, GOOD if run.final_error <= COUNTS else BAD)


def _bits(run):
    return Marked(f"{run.same} of {run.samples}", GOOD if run.same == run.samples else BAD)


def _rounded(made: Sequence[Summary]) -> Table:
    """Every number: as wanted, and its relative error in each arithmetic."""
    each = [quantisation.numbers(s.made) for s in made]
    rows = tuple(
        (q[0].name.replace("_", " "), numbers.unit(q[0].unit), numbers.number(q[0].wanted, 4), *(numbers.number(x.error, 2) for x in q))
        for q in _named(each)
    )  # fmt: skip
    columns = ("number", "unit", "wanted", *(f"error, {s.arithmetic}" for s in made))
    return Table(columns, rows, "Relative errors; of a column of gains, at the knot where float32's is largest.", "llr" + "r" * len(made))  # fmt: skip


def _named(each):
    """Numbers of all arithmetics side by side; the knot of the worst gain may differ between them."""
    return zip(*each, strict=True)


def _signals(s: Summary) -> Table:
    """The least unit of every signal in fixed point."""
    rows = tuple(
        (
            g.name.replace("_", " ").replace(".", ": "),
            numbers.unit(g.unit),
            numbers.number(g.least, 2),
            numbers.number(g.largest, 3),
        )
        for g in quantisation.grains(s.made)
    )
    return Table(("signal", "unit", "least unit", "largest"), rows, "Signals in fixed point.", "llrr")


def as_table(name: str, made: Sequence[Summary]) -> dict:
    """What results.json holds."""
    return {
        "controller": name,
        "arithmetics": {
            s.arithmetic: {
                "table_bytes": len(s.made.image.bytes()),
                "ram_bytes": s.ram,
                "gain_error": s.gain,
                "sensitivity_change": s.sensitivity,
                "cortex_m4": vars(s.measured) if s.measured else None,
                "beside_float64": vars(s.moved) if s.moved else None,
                "quantisation": quantisation.table(s.made),
            }
            for s in made
        },
        "checks": list(CHECKS),
    }
