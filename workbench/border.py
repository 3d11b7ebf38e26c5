"""Parameters that are written otherwise than they are fitted, and what is held of them.

A weight is written as mgl and phase, and fitted as two amplitudes, which are linear. What is held of it is what is written: where
one of the two is held and the other free, the amplitudes are neither, and the effect is taken as it is written.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace

from workbench.errors import WorkbenchError
from workbench.parameter import Parameter

NUDGE = 1e-3  # relative change of what is written, by which it is seen what inside depends on it


@dataclass(frozen=True)
class Border:
    """How parameters are written outside (campaigns, reports) where that differs from the linear form inside.

    parameters: outside name -> Parameter. inward(outside values) -> inside values, outward the reverse, both dictionaries
    of floats (example: a = x0**-d; mgl, phase = sine and cosine amplitudes). linear: outside names that enter linearly, none of a map; where they
    are given, inward is of elementary functions, and an effect of which some is held and some is free stays as it is written.
    """

    parameters: Mapping[str, Parameter]
    inward: Callable[[Mapping[str, float]], Mapping[str, float]]
    outward: Callable[[Mapping[str, float]], Mapping[str, float]]
    linear: tuple[str, ...] | None = None


@dataclass(frozen=True)
class AsWritten:
    """The step of an effect over its parameters as they are written. step: over those inside. names: of what is written."""

    step: Callable
    inward: Callable[[Mapping[str, float]], Mapping[str, float]]
    names: tuple[str, ...]

    def __call__(self, s, z, p):
        return self.step(s, z, SimpleNamespace(**self.inward({n: getattr(p, n) for n in self.names})))


def inside(
    border: Border,
    parameters: Mapping[str, Parameter],
    out: Mapping[str, Parameter],
    held: Mapping[str, bool],
    given: Collection[str],
    where: str,
) -> dict[str, Parameter] | None:
    """Return the parameters inside with what a campaign writes, None where it stays as it is written.

    parameters: inside. out: those that are written, with their values. held: which of them are fixed. given: those that were written at all.
    where: file and effect. Raises WorkbenchError for a value that is outside its physical bounds inside.
    """
    values = border.inward({n: p.value for n, p in out.items()})
    changed = _changed_by(border, out)
    found = {}
    for name, p in parameters.items():
        if not p.lower <= values[name] <= p.upper:
            written = ", ".join(f"{n} = {q.value:g}" for n, q in out.items() if n in given or not given)
            raise WorkbenchError(
                f"{where} with {written} has a {p.meaning} of {values[name]:g}, outside its physical "
                f"bounds {p.lower:g} to {p.upper:g}; check the value and its unit."
            )
        if name in out:
            hold = held[name] if name in given else p.fixed
        else:
            written = changed[name] & {*given}
            # what is held by itself inside moves nothing: beside a stiffness that is held a rest is the preload's
            of = {held[n] for n in written if not (held[n] and n in parameters)}
            if border.linear is not None and len(of) == 2:
                return None
            hold = bool(written) and False not in of
        found[name] = replace(p.at(float(values[name]), where=f"{where}.{name}"), fixed=hold)
    return found


def as_written(border: Border, out: Mapping[str, Parameter], held: Mapping[str, bool]) -> dict[str, Parameter]:
    """Return the parameters as they are written, each held or free; what does not enter linearly is searched. Arguments as of `inside`."""
    return {
        n: replace(p, fixed=held[n], scale=p.scale if n in border.linear else p.scale or "number")
        for n, p in out.items()
    }


def _changed_by(border: Border, out: Mapping[str, Parameter]) -> dict[str, set[str]]:
    """Return, by each parameter inside, the names outside that change it."""
    base = {n: p.value or 1.0 for n, p in out.items()}
    about = border.inward(base)
    found: dict[str, set[str]] = {n: set() for n in about}
    for name, value in base.items():
        for n, moved in border.inward({**base, name: value * (1.0 + NUDGE)}).items():
            if moved != about[n]:
                found[n].add(name)
    return found
