"""How a report was computed, and from which bytes."""

from importlib.metadata import version

from workbench import __version__
from workbench.report import numbers
from workbench.report.contents import CODE, Chapter, Equation, Items, Marked, Paragraph, StudyResult, Table

LIBRARIES = "casadi cvxpy matplotlib numba numpy osqp scikit-learn scipy typst".split()

METHODS = (
    "G. H. Golub, V. Pereyra: The differentiation of pseudo-inverses and nonlinear least squares problems whose variables "
    "separate, SIAM Journal on Numerical Analysis 10, 1973 (linear parameters inside, shape parameters outside).",
    "K.-Y. Liang, S. L. Zeger: Longitudinal data analysis using generalized linear models, Biometrika 73, 1986 (intervals that "
    "hold under correlated residuals).",
    "J. G. MacKinnon, M. O. Nielsen, M. D. Webb: Fast and reliable jackknife and bootstrap methods for cluster-robust inference, "
    "Journal of Applied Econometrics 38, 2023 (the same of few blocks).",
    "F. Al-Bender, W. Symens, J. Swevers, H. Van Brussel: Theoretical analysis of the dynamic behavior of hysteresis elements "
    "in mechanical systems, International Journal of Non-Linear Mechanics 39, 2004 (equivalent stiffness and loss).",
)


def method(result: StudyResult) -> Chapter:
    """The method in brief, with its equations and sources."""
    f = numbers.exact(result.bandwidth)
    blocks = [
        Paragraph(
            "Motion is measured, so the model is read backwards: from position, velocity and acceleration to the drive that it "
            "needs. Velocity and acceleration are derivatives of the measured position behind a low pass without phase; effects "
            "with memory follow the raw position."
        ),
        Paragraph(
            f"Measured and needed drive then pass the same filter, which has no phase either; its bandwidth is {f} Hz:"
        ),
        Equation('F(f) = 1 / (1 + (f \\/ f_"c")^8)', "F of f is one over one plus, f over f c, to the power of eight"),
        Paragraph(
            "The residual is what is left between the drive as the actuator applies it, u\u2032, and the sum of what the effects "
            "need. Parameters minimise its squares over the identification records; the error that is reported is its size in "
            "units of the filtered drive u."
        ),
        Equation(
            'e = F lr([ u\' - sum_i T_i (q, dot(q), dot.double(q)) ]), quad "error" = "rms"(e) \\/ "rms"(F u)',
            "e is F of u prime less the sum of T i of q, its velocity and its acceleration; the error is the rms of e over the "
            "rms of F u",
        ),
        Paragraph(
            "Parameters that enter linearly are solved for inside, by bounded least squares; all others are searched outside. "
            "Intervals of 95 % are robust against residuals that are correlated within blocks of a record. The first and the last "
            "50 ms of each record are left out of every error."
        ),
    ]
    if result.equivalent:
        blocks += _integrals()
    return Chapter("How it was computed", (*blocks, Paragraph("Sources:"), Items(_sources(result))))


def _integrals() -> list:
    return [
        Paragraph(
            "An effect that holds Masing's rule (after a reversal its curve is the virgin curve y stretched by two) has its "
            "equivalent stiffness and loss in closed form; all other effects are described by the first harmonic of their settled "
            "cycle."
        ),
        Equation(
            "k_e = - 4 / (pi A) integral_0^pi y (A / 2 (1 - cos t)) cos t dif t",
            "k e is minus four over pi A, times the integral from zero to pi of y of A half times one minus cosine t, times "
            "cosine t",
        ),
        Equation(
            "c_e omega = 8 / (pi A^2) integral_0^A lr((y(u) - y(A) / 2)) dif u",
            "c e omega is eight over pi A squared, times the integral from zero to A of y of u less half of y of A",
        ),
    ]


def _sources(result: StudyResult) -> tuple[str, ...]:
    """Return the sources of the method and of every effect in the last model, each once, in a fixed order."""
    cited = {}
    for effect in result.trace.after.plant.effects:
        if effect.source:
            cited.setdefault(effect.source, []).append(effect.title)
    methods = METHODS if result.equivalent else METHODS[:-1]
    return (*methods, *(f"{source} ({', '.join(names)})." for source, names in cited.items()))


def provenance(result: StudyResult) -> Chapter:
    """Which bytes the report was computed from, the model that came out, and at the end all that makes it again."""
    files = {r.file: r.sha256 for r in result.records}
    rows = tuple((name, Marked(digest, CODE)) for name, digest in files.items())
    text = (
        f"The command below, with {'this file' if len(rows) == 1 else 'these files'} and versions, gives these pages again to the "
        "same bytes. A file is the one that was used if its checksum is the one in the table."
    )
    table = Table(("file", "SHA-256"), rows, "The measured files and their checksums.", "lp")
    return Chapter("How to make this report again", (Paragraph(text), table, _again(result)))


def _again(result: StudyResult) -> Table:
    """Command, versions and digests."""
    own = result.tuned or result.trace.after.plant.digest
    digests = [("digest of the plant that gains were tuned for" if result.tuned else "digest of the last model", own)]
    if result.inputs:
        digests.append(("digest of study, data and code", result.inputs))
    rows = [("command", result.command or "workbench"), ("versions", _versions()), *digests]
    caption = "What makes this report again. The digest of a plant holds every parameter to nine digits" + (
        "; every file of gains/ carries it." if result.tuned else "."
    )
    return Table(("what", "value"), tuple((Marked(a, "strong"), Marked(b, CODE)) for a, b in rows), caption, "lp")


def _versions() -> str:
    """Return this package's version and those of the libraries that numbers and drawings come from."""
    found = [f"{name} {version(name)}" for name in LIBRARIES]
    return ", ".join([f"workbench {__version__}", *found])
