"""What happens once a sample: reading, velocity, reversals, the law, and the running metrics.

The reading is res floor(q/res + phase); the velocity a filtered backward difference. A reversal is found where the reading
has come back by more than `back` from its furthest point since the last one; from rest, any motion by as much is a start.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from workbench.control.law import JOINT, Law
from workbench.definition import namespace
from workbench.effects.elementary import absolute, clip, maximum, where
from workbench.plant import SENSORS, TWO_MASS
from workbench.simulation.bodies import BODIES
from workbench.simulation.dynamics import Symbols, call, fixed_signals, sensor_maps
from workbench.simulation.given import INJECTED, REFERENCE

AMPLITUDE = "amplitude"
FOLLOWING = "following"  # largest distance from a reference over time; no row without one
READ = ("y", "motor.y", "load.y")
PREFIX = dict(zip(SENSORS, BODIES[TWO_MASS].values(), strict=True))  # channel -> before the names of its body's rows


@dataclass(frozen=True)
class Sensing:
    """kind: of the plant. feedback: the channel that closes the loop. quantised: channels that are read in counts."""

    kind: str
    feedback: str
    quantised: tuple[str, ...]


def _encoder(effects, symbols: Symbols, channel: str, *, quantised: bool) -> tuple[ca.SX, dict[str, ca.SX]]:
    """Return (reading of one channel, next states of its sensor maps)."""
    body = PREFIX[channel]
    after: dict[str, ca.SX] = {}
    signals = fixed_signals(symbols) | {"v": symbols.state(f"{body}v"), "dt": symbols.constant("sample_time")}
    y = symbols.state(f"{body}q")
    for e in sensor_maps(effects, channel):
        # as in identification, a sensor's map knows one position: that of the body that it reads
        same, nothing = ("q", "motor_q", "load_q"), ca.SX(0.0)
        at_zero = call(e, dict.fromkeys((*signals, *same), nothing), symbols)[1]  # where the encoder was set to zero
        moved, y, _ = call(e, signals | dict.fromkeys(same, y), symbols)
        y -= at_zero
        after |= moved
    if quantised:
        count = symbols.constant(f"{channel}.count")
        y = count * ca.floor(y / count + symbols.constant("phase"))
    return y, after


def reading(effects, symbols: Symbols, sensing: Sensing) -> dict[str, ca.SX]:
    """Return name -> value: "y", which closes the loop, with two masses "motor.y" and "load.y", and sensor maps' states."""
    values, after = {}, {}
    for channel in SENSORS[: len(BODIES[sensing.kind])]:
        values[channel], moved = _encoder(effects, symbols, channel, quantised=channel in sensing.quantised)
        after |= moved
    after["y"] = values[sensing.feedback]
    if sensing.kind == TWO_MASS:
        after |= {"motor.y": values["position"], "load.y": values["load_position"]}
    return after


def _velocity(symbols: Symbols, y: ca.SX, body: str = "", moved: ca.SX | None = None) -> dict[str, ca.SX]:
    """vh <- vh + (1 - exp(-Ts/tf)) ((y - y_before)/Ts - vh), of the reading of one body ("motor." or "load."), or of y.

    moved: y - y_before where that is known otherwise, as in a firmware that counts.
    """
    vh = symbols.state(f"{body}vh")
    rate = (y - symbols.state(f"{body}y") if moved is None else moved) * symbols.constant("sample_rate")
    return {f"{body}vh": vh + symbols.constant("smoothing") * (rate - vh)}


def followed(law: Law | None, values: dict[str, ca.SX]) -> ca.SX:
    """The reading whose reversals count: y, or the relative displacement of the two encoders."""
    return values["motor.y"] - values["load.y"] if law is not None and law.follows == JOINT else values["y"]


def _reversals(symbols: Symbols, y: ca.SX) -> tuple[dict[str, ca.SX], ca.SX]:
    """Return name -> next state of the detector (furthest, way, turned, share, reversals), and 1 where one is found.

    way: -1, 0 (at rest), 1. turned: the reading at the last reversal, at first the first reading. share: 1 from rest and
    1/2 after a reversal, the amplitude of the equivalent motion over the stroke.
    """
    furthest, way, turned, share, count = (
        symbols.state(n) for n in ("furthest", "way", "turned", "share", "reversals")
    )
    delta = y - furthest
    onward = way * delta > 0.0
    other = ca.logic_and(way * delta <= 0.0, symbols.constant("back") < absolute(delta))
    found = ca.logic_and(other, way != 0.0)
    after = {
        "furthest": where(ca.logic_or(onward, other), y, furthest),
        "way": where(
            other, where(delta > 0.0, 1.0, -1.0), way
        ),  # back is not negative, so that delta is not zero there
        "turned": where(other, furthest, turned),
        "share": where(found, 0.5, share),
        "reversals": count + found,
    }
    return after, found


def inputs(symbols: Symbols, shared: tuple[str, ...], own: tuple[str, ...]) -> dict[str, ca.SX]:
    """Return name -> value of what is given over time: clocks where it is shared, rows where it is each scenario's own.

    Without a reference over time it is the scenario's target.
    """
    found = {n: symbols.clock(n) for n in shared} | {n: symbols.state(n) for n in own}
    return {REFERENCE: symbols.constant("target")} | found


def _control_signals(law: Law, symbols: Symbols, values: Mapping[str, ca.SX], r: ca.SX) -> dict[str, ca.SX]:
    """What a law reads. values: name -> row of a reading or velocity; r: the reference."""
    y = values["y"]
    constants = {n: symbols.constant(n) for n in ("limit", "count", "back")}
    more = {n: values[n.replace("_", ".")] for n in law.reads}
    return {"r": r, "y": y, "vh": values["vh"], "e": r - y, "dt": symbols.constant("sample_time"), **constants, **more}


def _law_parts(law: Law, symbols: Symbols):
    """Return the law's states and parameters as namespaces."""
    z = namespace(**{n: symbols.state(f"law.{n}") for n in law.states})
    return z, namespace(**{n: symbols.constant(f"law.{n}") for n in law.parameters})


def sense(
    effects, law: Law | None, symbols: Symbols, sensing: Sensing, driven: Mapping[str, ca.SX]
) -> dict[str, ca.SX]:
    """Reading, velocity, reversals and, for a law with a table, where to look up."""
    out = observed(law, symbols, reading(effects, symbols, sensing), driven)
    if AMPLITUDE in out:
        out[AMPLITUDE] = clip(out[AMPLITUDE], symbols.constant("knot.first"), symbols.constant("knot.last"))
    return out


def observed(
    law: Law | None, symbols: Symbols, out: dict[str, ca.SX], driven: Mapping[str, ca.SX], moved: ca.SX | None = None
) -> dict[str, ca.SX]:
    """What follows from readings ("y", and "motor.y", "load.y"): `sense` without encoders and the ends of the table."""
    out = dict(out)
    out |= _velocity(symbols, out["y"], moved=moved)
    for body in dict.fromkeys(n.removesuffix("vh").replace("_", ".") for n in (law.reads if law else ()) if "vh" in n):
        out |= _velocity(symbols, out[f"{body}y"], body)
    at = followed(law, out)
    walked, found = _reversals(symbols, at)
    out |= walked
    if law is not None and law.amplitude is not None:
        z, p = _law_parts(law, symbols)
        signals = _control_signals(law, symbols, out, driven[REFERENCE])
        signals |= {"stroke": absolute(at - walked["turned"]), "share": walked["share"], "reversal": found}
        states, amplitude = law.amplitude(namespace(**signals), z, p)
        out |= {f"law.{n}": v for n, v in states.items()}
        out[AMPLITUDE] = amplitude
    return out


def command(law: Law, symbols: Symbols, driven: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """The law's command and what is added to it, limited to the drive's torque, and its next states."""
    z, p = _law_parts(law, symbols)
    rows = ("y", "vh", *(n.replace("_", ".") for n in law.reads))
    signals = _control_signals(law, symbols, {n: symbols.state(n) for n in rows}, driven[REFERENCE])
    signals |= {n: symbols.state(f"gain.{n}") for n in law.columns}
    states, u = law.step(namespace(**signals), z, p)
    limit = symbols.constant("limit")
    u = u + driven[INJECTED] if INJECTED in driven else u
    return {"u_c": clip(u, -limit, limit), **{f"law.{n}": v for n, v in states.items()}}


def metrics(symbols: Symbols, position: str, driven: Mapping[str, ca.SX]) -> dict[str, ca.SX]:
    """Running metrics of one sample; workbench.simulation.metrics says what they become.

    position: the row that they are about. `aim` is the value that the band is about: the target, or in a second pass the final value.
    """
    r = driven[REFERENCE]
    k, window = symbols.clock("k"), symbols.clock("window")
    q, u = symbols.state(position), symbols.state("u_c")
    error = symbols.constant("aim") - q
    outside = symbols.constant("band") < absolute(error)
    was = symbols.state("outside")
    astray = symbols.constant("hold_band") < absolute(r - symbols.state("y"))
    k_astray = where(astray, k, symbols.state("k_astray"))
    settled = symbols.state("k_settled")
    held = ca.logic_and(symbols.constant("hold") <= k - k_astray, settled < 0.0)
    moving = REFERENCE in symbols.states or REFERENCE in symbols.clocks
    following = {FOLLOWING: maximum(symbols.state(FOLLOWING), absolute(r - q))} if moving else {}
    return following | {
        "outside": outside,
        "k_outside": where(outside, k, symbols.state("k_outside")),
        "e_outside": where(outside, error, symbols.state("e_outside")),
        "e_inside": where(was, error, symbols.state("e_inside")),
        "k_astray": k_astray,
        "k_settled": where(held, k_astray, settled),
        "peak": maximum(symbols.state("peak"), q * symbols.constant("step_sign")),
        "peak_speed": maximum(symbols.state("peak_speed"), absolute(symbols.state("v"))),
        "peak_torque": maximum(symbols.state("peak_torque"), absolute(u)),
        "final_error": maximum(symbols.state("final_error"), window * absolute(r - q)),
        "sum_u": symbols.state("sum_u") + window * u,
        "sum_uu": symbols.state("sum_uu") + window * (u * u),
    }
