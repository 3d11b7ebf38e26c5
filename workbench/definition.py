"""One physical effect: declarative data and one short function, from which everything else is derived.

An effect is made by a function decorated with `@effect` in one file of `workbench/effects/`; `catalogue()` finds it.
Its `step(s, z, p)` is written once in CasADi SX (workbench.effects.elementary has the functions that kernels may hold):
`s` the declared signals, `z` the states, `p` the parameters (after `derive`, where there is one), all by name. It
returns ({state: next value}, output); what the output means is fixed by the port (docs/architecture/effects.md).
"""

import importlib
import pkgutil
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cache, cached_property
from math import inf
from types import MappingProxyType, SimpleNamespace

from workbench.border import AsWritten, Border, as_written, inside
from workbench.errors import WorkbenchError, nearest
from workbench.finding import title
from workbench.parameter import Parameter

FORCE, ANGLE, COMMAND, SENSOR, TIME = "force", "angle", "command", "sensor", "time"
PORTS = (FORCE, ANGLE, COMMAND, SENSOR, TIME)
CHANNELS = ("temperature", "normal")  # signals that are there where a record has a channel of that name
# fixed: an effect reads these and no others
SIGNALS = (*"q dq v a dt t u tau tau_inertia dir motor_q load_q ratio pole_pairs locked".split(), *CHANNELS)
PLACES = ("axis", "motor", "joint", "load", "command", "sensor", "drive")
DRIVE_CHANNELS = ("sensor.torque", "sensor.force")
TWO_COUNTS = "two counts"  # of the encoder: a length below which no record tells an operator's memory from none


@dataclass(frozen=True)
class Effect:
    """See the module. motions: kinds of axis on which it exists. `linear` parameters enter the output linearly and no state. traced:
    offered as what a model may lack (False: another spelling of an effect that is, or one that a study has to offer). stated: places at
    which it is declared and not offered, because another effect is traced there that says the same. beside: place -> (effect, parameter):
    where that effect is not declared there, this one is offered with the parameter held at its value, not at all if that is "". free_at:
    parameter -> places at which it may be free; elsewhere it is held, because it changes nothing there. signed_at: parameter -> places at which it may be negative; elsewhere it may not. harmonic: parameter of which a
    second effect of this name at its place has twice the value. rare: where it explains no more than another effect as simple, a trace names the other one. label: tells effects of one name at one place apart, as two
    resonances. An effect that can be at a joint and at a sensor is the same map of both, and takes its port from `at`.
    family: class of causes, of which the law is a second question (docs/architecture/ has the list). reduces: parameter ->
    (neutral value, name of the simpler effect that it then is, "" for none): a number, or TWO_COUNTS for a length of no more
    than that. parts: names of the simpler effects that a composite joins. knots: parameters that are held by definition, as
    where a table has its values; no data sheet gave them, so none is wrong. nearest: traced effect of its class in whose place, and
    under whose name, a law is asked where that one leads or validation does not carry it; one that is traced itself bears that name, too.
    counted_in: effect whose data-sheet value counts this one in: it is offered where that is declared and fixed.
    """

    name: str
    cause: str
    formula: str
    source: str
    port: str
    parameters: Mapping[str, Parameter]
    step: Callable
    linear: tuple[str, ...] = ()
    states: Mapping[str, int] = field(default_factory=dict)
    reads: tuple[str, ...] = ()
    provides: tuple[str, ...] = ()
    derive: Callable | None = None
    virgin: Callable | None = None
    holds: tuple[str, ...] = ()
    places: tuple[str, ...] = ("axis", "motor", "load")
    motions: tuple[str, ...] = ("rotary", "linear")
    at: str = "axis"
    border: Border | None = None
    traced: bool = True
    nearest: str = ""
    counted_in: str = ""
    stated: tuple[str, ...] = ()
    beside: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    free_at: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    signed_at: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    harmonic: str = ""
    rare: bool = False
    label: str = ""
    family: str = ""
    reduces: Mapping[str, tuple[float | str, str]] = field(default_factory=dict)
    parts: tuple[str, ...] = ()
    knots: tuple[str, ...] = ()

    def __post_init__(self):
        if not re.fullmatch(r"[\w-]*", self.label):
            raise WorkbenchError(f"effect '{self.name}': label '{self.label}' must be letters, digits, '-' or '_'.")
        if {"joint", "sensor"} <= set(self.places):
            object.__setattr__(self, "port", SENSOR if self.at.startswith("sensor") else ANGLE)
        if self.at in DRIVE_CHANNELS:  # a map of what is a torque or a force there
            there = {n: replace(p, unit=re.sub(r"\bx\b", "F", p.unit)) for n, p in self.parameters.items()}
            object.__setattr__(self, "parameters", there)
        held = {
            n: replace(self.parameters[n], fixed=True) for n, places in self.free_at.items() if self.at not in places
        }
        lowest = {n: (0.0, -inf) if self.at in places else (-inf, 0.0) for n, places in self.signed_at.items()}
        signed = {  # a bound that a search has drawn closer stays
            n: replace(self.parameters[n], lower=to) for n, (of, to) in lowest.items() if self.parameters[n].lower == of
        }
        object.__setattr__(self, "parameters", {**self.parameters, **held, **signed})
        for name in ("parameters", "states", "beside", "free_at", "signed_at", "reduces"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        if self.port not in PORTS:
            raise WorkbenchError(f"effect '{self.name}': unknown port '{self.port}'; {nearest(self.port, PORTS)}")
        for signal in (*self.reads, *self.provides):
            if signal not in SIGNALS:
                raise WorkbenchError(f"effect '{self.name}': unknown signal '{signal}'; {nearest(signal, SIGNALS)}")
        for what, names in {"linear": self.linear, "reducing": self.reduces, "held": self.knots}.items():
            for name in names:
                if name not in self.parameters:
                    raise WorkbenchError(
                        f"effect '{self.name}': {what} parameter '{name}' is not declared; {nearest(name, self.parameters)}"
                    )

    def __reduce__(self):
        """An effect of the catalogue goes by its name, so that it has the catalogue's own step wherever it is unpickled."""
        held = {f.name: getattr(self, f.name) for f in fields(self)}
        known = catalogue().get(self.name)
        if known is None or known.step is not self.step:
            return _anew, ("", held)
        return _anew, (self.name, {n: v for n, v in held.items() if v is not getattr(known, n)})

    @cached_property
    def key(self) -> str:
        """Name, with its label, and place: unique in a plant."""
        return f"{self.named}@{self.at}"

    @property
    def title(self) -> str:
        """Name as it is read: "Stribeck friction"."""
        return title(self.name)

    @cached_property
    def named(self) -> str:
        """Name, with its label where it has one: "flexible_mode second"."""
        return f"{self.name} {self.label}" if self.label else self.name

    @cached_property
    def shape(self) -> tuple[str, ...]:
        """Parameters that are searched: all that are not linear."""
        return tuple(n for n in self.parameters if n not in self.linear)

    def __call__(
        self, *, at: str | None = None, fixed: bool | None = None, label: str | None = None, **values: float
    ) -> "Effect":
        """Return this effect with inside values set (with fixed=, all of those held or freed), at another place, labelled."""
        there = self if at is None else self._moved(at)
        parameters = dict(there.parameters)
        for name, value in values.items():
            if name not in parameters:
                raise WorkbenchError(f"effect '{self.name}': unknown parameter '{name}'; {nearest(name, parameters)}")
            parameters[name] = parameters[name].at(value, fixed=fixed, where=f"{self.name}.{name}")
        return replace(there, parameters=parameters, label=self.label if label is None else label)

    def _moved(self, at: str) -> "Effect":
        """Return this effect at another place; what was held where it came from alone is free there, unless that place holds it, too."""
        freed = {n: replace(self.parameters[n], fixed=False) for n, of in self.free_at.items() if self.at not in of}
        return replace(self, at=at, parameters={**self.parameters, **freed})

    def free(self, *names: str) -> "Effect":
        """Return this effect with the named inside parameters no longer fixed."""
        return replace(
            self, parameters={n: replace(p, fixed=False) if n in names else p for n, p in self.parameters.items()}
        )

    @property
    def outside(self) -> Mapping[str, Parameter]:
        """Parameters as a campaign writes them, with this effect's values."""
        if self.border is None:
            return self.parameters
        values = self.border.outward({n: p.value for n, p in self.parameters.items()})
        fixed = all(p.fixed for p in self.parameters.values())
        return {n: replace(p, value=float(values[n]), fixed=fixed) for n, p in self.border.parameters.items()}

    def declared(self, values: Mapping[str, float], fixed: Mapping[str, bool], where: str) -> "Effect":
        """Return this effect with values as a campaign writes them (SI); what is absent keeps its default.

        Raises WorkbenchError for an unknown name (nearest names) and a value outside its physical bounds.
        """
        known = self.outside
        for name in values:
            if name not in known:
                raise WorkbenchError(f"{where}: effect '{self.name}' has no parameter '{name}'; {nearest(name, known)}")
        held = {n: fixed.get(n, p.fixed) for n, p in known.items()}
        out = {n: p.at(values.get(n, p.value), where=f"{where}: {self.name}.{n}") for n, p in known.items()}
        if self.border is None:
            return replace(self, parameters={n: replace(p, fixed=held[n]) for n, p in out.items()})
        parameters = inside(self.border, self.parameters, out, held, values, f"{where}: {self.name}")
        if parameters is not None:
            return replace(self, parameters=parameters)
        step = AsWritten(self.step, self.border.inward, tuple(out))
        written = as_written(self.border, out, held)
        return replace(self, parameters=written, linear=self.border.linear, step=step, border=None)


def _anew(name: str, changed: Mapping[str, object]) -> Effect:
    """Return an effect that was pickled: the catalogue's with these fields, or one of all of them."""
    return replace(catalogue()[name], **changed) if name else Effect(**changed)


def namespace(**values) -> SimpleNamespace:
    """Signals, states or parameters by name, as a step sees them."""
    return SimpleNamespace(**values)


_factories: dict[str, Callable[[], Effect]] = {}


def effect(make: Callable[..., Effect]) -> Callable[..., Effect]:
    """Decorator: put the effect that `make()` returns, named as the function, into the catalogue."""
    if make.__name__ in _factories and _factories[make.__name__].__module__ != make.__module__:
        raise WorkbenchError(f"effect '{make.__name__}' is defined twice in the catalogue.")
    _factories[make.__name__] = make
    return make


@cache
def catalogue() -> Mapping[str, Effect]:
    """Every effect, by name, in the order of their names. Imports all of workbench.effects."""
    import workbench.effects as package

    for module in pkgutil.iter_modules(package.__path__):
        importlib.import_module(f"workbench.effects.{module.name}")
    return MappingProxyType({name: _factories[name]() for name in sorted(_factories)})


def find(name: str, where: str = "effect") -> Effect:
    """Return an effect of the catalogue; WorkbenchError with the nearest names where there is none."""
    known = catalogue()
    if name not in known:
        raise WorkbenchError(f"{where}: unknown effect '{name}'; {nearest(name, known)}")
    return known[name]
