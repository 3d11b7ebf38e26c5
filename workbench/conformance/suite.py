"""The checks, which effects each is for, and how they are run."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from workbench.conformance import arithmetic, memory, physics, prediction, recovery, slopes, written
from workbench.conformance.result import Result
from workbench.definition import FORCE, Effect
from workbench.errors import WorkbenchError


def _always(effect: Effect) -> bool:
    return True


def _claims(word: str) -> Callable[[Effect], bool]:
    return lambda effect: word in effect.holds


def _has_neutral(effect: Effect) -> bool:
    """Forces by their linear parameters; maps, where all that is free may be zero."""
    if effect.port == FORCE:
        return bool(effect.linear)
    return all(p.fixed or p.scale == "order" or arithmetic.may_vanish(effect, n) for n, p in effect.parameters.items())


def _can_be_described(effect: Effect) -> bool:
    return "masing" in effect.holds and effect.virgin is not None


PROPERTIES: dict[str, tuple[Callable[[Effect], bool], Callable[[Effect], tuple[bool, str]]]] = {
    "described": (_always, written.described),
    "units": (_always, written.units),
    "linear": (lambda e: bool(e.linear), written.linear),
    "neutral": (_has_neutral, arithmetic.neutral),
    "bits": (_always, arithmetic.bits),
    "derivatives": (_always, slopes.derivatives),
    "single precision": (_always, arithmetic.single),
    "passive": (_claims("passive"), physics.passive),
    "rate independent": (_claims("rate independent"), physics.rate_independent),
    "odd": (_claims("odd"), physics.odd),
    "even": (_claims("even"), physics.even),
    "conservative": (_claims("conservative"), physics.conservative),
    "masing": (_claims("masing"), memory.masing),
    "wiping out": (_claims("masing"), memory.wiping_out),
    "virgin curve": (lambda e: e.virgin is not None, memory.virgin_curve),
    "describing function": (_can_be_described, memory.describing),
    "prediction": (_always, prediction.sees_no_drive),
    "recovered": (_always, recovery.recovered),
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
