"""The checks, which effects each is for, and how they are run."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from workbench.conformance import arithmetic, memory, physics, prediction, recovery, slopes, written
from workbench.conformance.result import Result
from workbench.definition import FORCE, Effect
from workbench.errors import WorkbenchError


def always(effect: Effect) -> bool:
    return True


def claims(word: str) -> Callable[[Effect], bool]:
    return lambda effect: word in effect.holds


def has_neutral(effect: Effect) -> bool:
    """Forces by their linear parameters; maps, where all that is free may be zero."""
    if effect.port == FORCE:
        return bool(effect.linear)
    return all(p.fixed or p.scale == "order" or arithmetic.may_vanish(effect, n) for n, p in effect.parameters.items())


def can_be_described(effect: Effect) -> bool:
    return "masing" in effect.holds and effect.virgin is not None


PROPERTIES: dict[str, tuple[Callable[[Effect], bool], Callable[[Effect], tuple[bool, str]]]] = {
    "described": (always, written.described),
    "units": (always, written.units),
    "linear": (lambda e: bool(e.linear), written.linear),
    "neutral": (has_neutral, arithmetic.neutral),
    "bits": (always, arithmetic.bits),
    "derivatives": (always, slopes.derivatives),
    "single precision": (always, arithmetic.single),
    "passive": (claims("passive"), physics.passive),
    "rate independent": (claims("rate independent"), physics.rate_independent),
    "odd": (claims("odd"), physics.odd),
    "even": (claims("even"), physics.even),
    "conservative": (claims("conservative"), physics.conservative),
    "masing": (claims("masing"), memory.masing),
    "wiping out": (claims("masing"), memory.wiping_out),
    "virgin curve": (lambda e: e.virgin is not None, memory.virgin_curve),
    "describing function": (can_be_described, memory.describing),
    "prediction": (always, prediction.sees_no_drive),
    "recovered": (always, recovery.recovered),
}


@dataclass(frozen=True, eq=False)
class Check:
    """One property of one effect, not yet checked: call it. str() is its name in a test's report."""

    effect: Effect
    property: str

    def __str__(self) -> str:
        return f"{self.effect.name}-{self.property.replace(' ', '_')}"

    def __call__(self) -> Result:
        try:
            passed, sentence = PROPERTIES[self.property][1](self.effect)
        except WorkbenchError as error:
            passed, sentence = False, str(error)
        except Exception as error:  # an effect of one's own may raise anything; that is its result
            passed, sentence = False, f"It cannot be evaluated: {type(error).__name__}, {error}"
        return Result(self.effect.name, self.property, passed, f"{self.effect.name}, {self.property}: {sentence}")


def checks(effect: Effect) -> Iterator[Check]:
    """Yield every check that applies to an effect; two of one effect differ in their property."""
    for name, (applies, _) in PROPERTIES.items():
        if applies(effect):
            yield Check(effect, name)


def check_effect(effect: Effect) -> tuple[Result, ...]:
    """Return the results of every check that applies; the effect holds what it says where all have passed."""
    return tuple(check() for check in checks(effect))
