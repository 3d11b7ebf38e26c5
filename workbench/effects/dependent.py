"""Friction that depends on something beside the motion: on the load, on time, and on a measured temperature."""

from collections.abc import Mapping
from types import MappingProxyType

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import absolute, exp, expm1, where
from workbench.effects.settling import SINCE, counted, going_over, gone_over
from workbench.parameter import ROOM, Parameter

BEND = 1e-4  # 1/K: over 100 K half a per cent from a straight line


@effect
def load_dependent_friction() -> Effect:
    """T = mu |tau + share tau_inertia| dir: friction in proportion to the torque that the contact carries, as the model has it.

    Of two masses tau is the joint's torque. Of one mass it is what passes the gear at standstill (gravity, springs, a constant
    load), tau_inertia is the torque of inertia, and share how much of that lies behind the contact. Where the axis carries
    nothing at standstill only mu share is determined. The measured drive has no part in it: u = R + mu |load| dir is solved for u.
    """

    def step(s, z, p):
        return {}, p.mu * absolute(s.tau + p.share * s.tau_inertia) * s.dir

    return _rubbing(
        name="load_dependent_friction",
        cause="tooth and bearing contacts rub in proportion to the torque that they carry",
        formula="T = mu |tau + share tau_inertia| dir",
        step=step,
        free_at={"share": ("axis",)},
    )


@effect
def relieved_friction() -> Effect:
    """T = mu |tau + share tau_inertia - relief| dir: friction in proportion to what the contact carries, of which a constant is no part.

    Of one mass all that stands still counts as carried; but an offset of the drive, or a weight that is balanced before the gear, does not pass
    it. relief is that constant, with the sign of what the axis holds.
    """

    def step(s, z, p):
        return {}, p.mu * absolute(s.tau + p.share * s.tau_inertia - p.relief) * s.dir

    return _rubbing(
        name="relieved_friction",
        cause="tooth and bearing contacts rub in proportion to the torque that they carry, of which a constant offset is no part",
        formula="T = mu |tau + share tau_inertia - relief| dir",
        more={"relief": Parameter(0.0, "F", "what the axis holds and the contact does not carry", scale="load")},
        step=step,
        places=("axis",),
        traced=False,
        nearest="load_dependent_friction",
    )


def _rubbing(more: Mapping[str, Parameter] = MappingProxyType({}), **own) -> Effect:
    """Return the effect of friction in proportion to a load. more: parameters beside mu and share. own: what else is its own."""
    return Effect(
        **own,
        source="Bittencourt and Gunnarsson 2012; Amontons' law",
        port=FORCE,
        family="friction over load",
        reduces={"mu": (0.0, "")},
        parameters={
            "mu": Parameter(0.0, "1", "friction per torque carried", lower=0.0, upper=1.0),
            "share": Parameter(0.5, "1", "share of inertia behind the contact", lower=0.0, upper=1.0, scale="number"),
            **more,
        },
        linear=("mu",),
        reads=("tau", "tau_inertia", "dir"),
        holds=("passive",),
    )


@effect
def friction_drift() -> Effect:
    """T = r (1 - exp(-e (t - t0)))/e dir: Coulomb friction that goes over to another level, t on the bench clock that runs on from
    record to record.

    r is its rate at t0 (`since`), r/e what it comes to in the end; e -> 0 is a steady change. A bearing's or a gear's temperature settles
    as exp(-e t), and friction follows it.
    """

    def step(s, z, p):
        return {}, gone_over(p.rate, counted(s.t, p.since), p.settling) * s.dir

    return _drifting(
        name="friction_drift",
        cause="friction that drifts while the axis is measured: it warms up, or its grease is spread",
        formula="T = r (1 - exp(-e (t - t0)))/e dir",
        source="Simoni, Beschi, Legnani, Visioli 2015 (friction and temperature)",
        parameters=_of_time(1e-3) | SINCE,
        linear=("rate",),
        reads=("t", "dir"),
        step=step,
    )


@effect
def friction_run_in() -> Effect:
    """T = r (1 - exp(-e age))/e dir: Coulomb friction that goes over to another level after every rest, age the time since the record began.

    A seal's film, or grease in a bearing, builds up at rest and is wiped off in motion; between two records the axis rests. Beside one
    record it is a drift, under whose name it is traced.
    """

    def step(s, z, p):
        age = z.age + s.dt
        return {"age": age}, gone_over(p.rate, age, p.settling) * s.dir

    return _drifting(
        name="friction_run_in",
        cause="friction that drifts anew after every rest: a film or grease is wiped off, or spread, as the axis moves",
        formula="T = r (1 - exp(-e age))/e dir, age the time since the record began",
        source="Simoni, Beschi, Legnani, Visioli 2015 (friction and temperature); Armstrong-Helouvry, Dupont, Canudas de Wit 1994 (dwell)",
        parameters=_of_time(1e-1),
        linear=("rate",),
        states={"age": 1},
        reads=("dt", "dir"),
        step=step,
        rare=True,
        nearest="friction_drift",
    )


@effect
def warming_friction() -> Effect:
    """T = (r dir + w v) (1 - exp(-e (t - t0)))/e: Coulomb and viscous friction that go over to other levels together, t on the bench clock.

    A lubricant's viscosity falls faster with temperature than what rubs dry does: r and w are rates of their own, e is the housing's.
    """

    def step(s, z, p):
        return {}, gone_over(p.rate * s.dir + p.viscous_rate * s.v, counted(s.t, p.since), p.settling)

    return _drifting(
        name="warming_friction",
        cause="friction that warms up while the axis is measured: its lubricant thins, and what rubs dry changes by another share",
        formula="T = (r dir + w v) (1 - exp(-e (t - t0)))/e",
        source="Bittencourt and Gunnarsson 2012; Simoni, Beschi, Legnani, Visioli 2015 (friction and temperature)",
        parameters=_of_time(1e-3)
        | {"viscous_rate": Parameter(0.0, "F/x", "change of viscous friction per time at first")}
        | SINCE,
        linear=("rate", "viscous_rate"),
        reads=("t", "dir", "v"),
        step=step,
        traced=False,
        nearest="friction_drift",
    )


@effect
def thermal_friction() -> Effect:
    """T = (r dir + w v) (1 - exp(-b d))/b, d = temperature - reference: Coulomb and viscous friction over a temperature that was measured.

    r and w are the slopes at the reference, negative where warmth eases the axis; b bends both, for a lubricant's viscosity falls
    exponentially, b -> 0 is a straight line. At the reference, 20 degC unless declared, there is nothing of it: what is declared beside it
    is friction at that temperature.
    """

    def step(s, z, p):
        return {}, gone_over(p.rate * s.dir + p.viscous_rate * s.v, s.temperature - p.reference, p.bend)

    return _drifting(
        name="thermal_friction",
        cause="friction that goes with the temperature that was measured: its lubricant thins as it warms up",
        formula="T = (r dir + w v) (1 - exp(-b d))/b, d = temperature - reference",
        source="Bittencourt and Gunnarsson 2012; Simoni, Beschi, Legnani, Visioli 2015 (friction and temperature)",
        parameters={
            "rate": Parameter(0.0, "F/K", "change of Coulomb friction per kelvin at the reference"),
            "viscous_rate": Parameter(0.0, "F*s/(x*K)", "change of viscous friction per kelvin at the reference"),
            "bend": Parameter(0.02, "1/K", "share by which both changes fall per kelvin", lower=BEND, upper=0.5),
            "reference": Parameter(ROOM, "K", "temperature of what is declared beside it", fixed=True, lower=0.0),
        },
        linear=("rate", "viscous_rate"),
        reads=("temperature", "dir", "v"),
        step=step,
        nearest="friction_drift",
        knots=("reference",),
    )


@effect
def self_heating_friction() -> Effect:
    """T = (r h + s k) dir, h' = |v| - e h from each record's beginning, k = (1 - exp(-e t0)) exp(-e age): Coulomb friction that goes with the heat that
    friction itself makes, in proportion to the path, and that leaves at the rate e.

    k is what is left of the heat of what moved before the record began, at t0 of the bench clock: nothing on a cold bench. Where an axis moves all
    alike that is friction drift; after a rest it is cold again.
    """

    def step(s, z, p):
        left, begun = exp(-p.settling * s.dt), where(z.moved > 0.0, z.begun, s.t)
        heat = z.heat * left + absolute(s.v) * (1.0 - left) / p.settling
        before = -expm1(-p.settling * begun) * exp(-p.settling * (s.t - begun))
        return {"moved": 1.0, "begun": begun, "heat": heat}, (p.rate * heat + p.before * before) * s.dir

    return _drifting(
        name="self_heating_friction",
        cause="friction that warms its contact up, and cools with it when the axis rests",
        formula="T = (r h + s k) dir, h' = |v| - e h, k = (1 - exp(-e t0)) exp(-e age)",
        source="Simoni, Beschi, Legnani, Visioli 2015 (friction and temperature)",
        parameters=going_over("F/x", "change of Coulomb friction per path at first", 1e-1)
        | {"before": Parameter(0.0, "F", "change that earlier motion would have come to")},
        linear=("rate", "before"),
        states={"moved": 1, "begun": 1, "heat": 1},
        reads=("t", "dt", "v", "dir"),
        step=step,
        traced=False,
        nearest="friction_drift",
    )


def _drifting(**own) -> Effect:
    """Return an effect of friction that goes over to another level. own: what is its own."""
    return Effect(**own, port=FORCE, family="friction over time", reduces={"rate": (0.0, "")})


def _of_time(settling: float) -> dict[str, Parameter]:
    """Return the parameters of Coulomb friction that goes over in time. settling: start of its rate, 1/s."""
    return going_over("F/s", "change of Coulomb friction per time at first", settling)
