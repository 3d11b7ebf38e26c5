"""What a trace returns."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from workbench.definition import Effect, find
from workbench.finding import Finding, title
from workbench.identification.result import Estimate, Fit
from workbench.notebook import page
from workbench.plant import Plant
from workbench.record import IDENTIFICATION, VALIDATION
from workbench.tracing.calibration import Calibration
from workbench.tracing.criteria import Criteria
from workbench.tracing.decide import CAUSE, NOTHING, UNKNOWN
from workbench.tracing.evidence import ADDITION, Evidence
from workbench.tracing.smallest import Smallest

__all__ = ["CAUSE", "NOTHING", "UNKNOWN"]


@dataclass(frozen=True)
class CandidateScore:
    """One effect that was tried jointly with the declared model.

    effect, at: its name and place ("inertia at axis" where a fixed parameter was set free: kind "correction", else
    "addition"). gain: relative reduction of the held-out squared error by blocked cross-validation (1 is all of it).
    scatter: one standard error of that gain over blocks. held_out: nrmse on held-out blocks. nrmse: on what was fitted.
    earns: whether it would be added.
    """

    effect: str
    at: str
    kind: str
    gain: float
    scatter: float
    held_out: float
    nrmse: float
    earns: bool
    sentence: str

    @property
    def title(self) -> str:
        """Name of its effect as it is read."""
        return title(self.effect)


@dataclass(frozen=True)
class Refinement:
    """What is too small to be a cause, or what a declared law is only nearly right about.

    kind: "addition", "correction" (the value stays as declared) or "law". size: what it takes away on identification, as a cause's.
    was: parameter -> the fixed value that stays.
    """

    effect: str
    at: str
    kind: str
    sentence: str
    parameters: tuple[Estimate, ...] = ()
    size: float = 0.0
    was: Mapping[str, float] = field(default_factory=dict)


def physical_cause(law: Effect, name: str) -> str:
    """Return what makes a law that bears another effect's name: its own words where it says more of it than that one (a composite, another
    spelling, a curve), else that one's (without a gear an encoder errs, by the gear's law)."""
    named = name.partition(" ")[0]  # without its label
    return law.cause if law.parts or not law.traced or law.name == named else find(named).cause


@dataclass(frozen=True)
class Cause:
    """One effect that was added: where it acts, its parameters, and the share of the residual's power that it explains.

    kind: "addition", or "correction" of a fixed value. was: parameter -> the fixed value that was corrected. law: "catalogue",
    or "free form" where no formula of its class comes near; form: name of that free form (`effect` is the nearest formula), or of the
    composite that a missing part makes with what is declared.
    size: what it takes away on identification, over the drive's rms; behind: or, where it shows most in the load's balance, over that of the
    joint's torque. also: further parts of that composite that are missing.
    """

    effect: str
    at: str
    sentence: str
    parameters: tuple[Estimate, ...]
    share_identification: float
    share_validation: float
    rivals: tuple[str, ...] = ()
    experiment: str = ""
    kind: str = ADDITION
    was: Mapping[str, float] = field(default_factory=dict)
    law: str = "catalogue"
    size: float = 0.0
    behind: bool = False
    form: str = ""
    also: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """Key of its effect in the extended plant."""
        return f"{self.form or self.effect}@{self.at}"

    @property
    def title(self) -> str:
        """Name of its effect as it is read."""
        return title(self.effect)


@dataclass(frozen=True, eq=False)
class Trace:
    """verdict: "cause", "nothing_missing" or "unknown". ranked: candidates, best first, of the first step.

    steps: the ranked candidates of every step (one list an addition tried). before, after: fits of the declared and of
    the extended plant; in both, declared friction that turns over a speed does so. floor: role -> nrmse that encoder resolution and torque noise alone would leave. unknown: where what
    no effect explains lives. smallest: of each kind, the smallest effect that the records could have shown. refinements: what is
    too small to be a cause. evidence, criteria: what the decision rests on. calibrations: of periodic causes whose phase is a power-up's.
    """

    verdict: str
    sentence: str
    ranked: tuple[CandidateScore, ...]
    steps: tuple[tuple[CandidateScore, ...], ...]
    causes: tuple[Cause, ...]
    before: Fit
    after: Fit
    floor: Mapping[str, float]
    findings: tuple[Finding, ...] = ()
    unknown: Mapping[str, object] = field(default_factory=dict)
    smallest: tuple[Smallest, ...] = ()
    refinements: tuple[Refinement, ...] = ()
    evidence: Evidence | None = None
    criteria: Criteria = Criteria()
    calibrations: tuple[Calibration, ...] = ()

    @property
    def located(self) -> dict[str, object]:
        """What is unknown and where it lives, with the unit of its coordinate."""
        x = self.before.plant.displacement
        unit = {"position": x, "velocity": f"{x}/s", "time": "s", "frequency": "Hz"}.get(self.unknown.get("coordinate"))
        return {**self.unknown, **({"unit": unit} if unit else {})}

    @property
    def extended(self) -> Fit | None:
        """Fit of the extended plant; None where nothing was added."""
        return self.after if self.causes else None

    @property
    def added(self) -> tuple[str, ...]:
        """Names of the effects in the extended model that the declared one lacks, as the catalogue has them, each once."""
        return tuple(dict.fromkeys(n for c in self.causes for n in (c.effect.partition(" ")[0], *c.also)))

    @property
    def figures(self) -> dict[str, float | str]:
        """Figures by which a trace may be judged."""
        return {
            "verdict": self.verdict,
            "first_cause": self.ranked[0].effect.partition(" ")[0] if self.causes else "none",
            "added": ", ".join(sorted(self.added)) or "none",  # which was found first says nothing
            "identification_error_before": self.before.identification,
            "identification_error_after": self.after.identification,
            "identification_floor": self.floor[IDENTIFICATION],
            "validation_error_before": self.before.validation,
            "validation_error_after": self.after.validation,
            "validation_floor": self.floor[VALIDATION],
        }

    @property
    def every_finding(self) -> tuple[Finding, ...]:
        """Of the search, and of the last fit."""
        return (*self.findings, *self.after.findings)

    @property
    def plant(self) -> Plant:
        """The extended plant, fitted: the declared one where nothing was added."""
        return self.after.plant

    def _repr_html_(self) -> str:
        """The verdict, the candidates of the first step as a table, and the errors before and after as a drawing."""
        rows = ((f"{c.effect}@{c.at}", c.kind, c.gain, c.scatter, "added" if c.earns else "") for c in self.ranked)
        return page(self.sentence, ("candidate", "kind", "gain", "standard error", ""), rows, self._draw)

    def _draw(self, axes) -> None:
        (one,) = axes
        names = sorted(self.before.nrmse)
        for shift, fit, label in ((-0.2, self.before, "as declared"), (0.2, self.after, "extended")):
            one.bar([i + shift for i in range(len(names))], [fit.nrmse[n] for n in names], 0.4, label=label)
        one.set_xticks(range(len(names)), names)
        one.set_ylabel("rms of the residual\nover rms of the drive")
        one.legend()
