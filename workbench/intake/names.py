"""What the name of a column says: the quantity, whether it is a set value, and the unit."""

import re
from dataclasses import dataclass

from workbench.units.registry import legible, root, same, tidy

# Words of English and German logs, in lower case. One word may be a quantity or qualify one.
QUANTITIES = {
    "time": "t time zeit timestamp clock elapsed uhrzeit",
    "current": "i iq cur curr current strom motorstrom amps ampere",
    "torque": "torque torq trq tq tau moment drehmoment",
    "force": "force frc f kraft thrust",
    "voltage": "u volt volts voltage spannung vir",
    "position": "p pos position q qm x angle ang theta phi enc encoder lage winkel weg istlage",
    "velocity": "v vel velocity speed spd omega w dq qd drehzahl geschwindigkeit",
    "temperature": "temp temperature temperatur housing",
    "normal": "normal normalkraft",
}
QUALITIES = {
    "reference": "ref reference set setpoint soll sollwert sp cmd command commanded target demand desired des qg qr goal",
    "measured": "act actual ist istwert meas measured fb feedback",
    "load": "load second secondary last abtrieb",
    "error": "err error dev deviation following lag schlepp schleppfehler",
}
SPELT = {
    "count": "cnt cnts counts inc incs incr increment increments ink inkr inkremente tick ticks pulse pulses lsb digits",
    "s": "sec secs second seconds sek",
    "ms": "msec millisec",
    "us": "usec µsec",
    "A": "amp amps arms apk",
    "N*m": "nm newtonmeter",
    "mN*m": "mnm",
    "deg": "degree degrees grad",
    "rev": "revs turns rot",
    "rpm": "u/min 1/min min-1",
    "percent": "pct prozent",
}
UNIT_OF = {word: unit for unit, words in SPELT.items() for word in words.split()}
KIND_OF_UNIT = {
    "s": "time", "A": "current", "N*m": "torque", "N": "force", "V": "voltage", "rad": "position", "m": "position",
    "count": "position", "rad/s": "velocity", "m/s": "velocity", "K": "temperature",
}  # fmt: skip


@dataclass(frozen=True)
class Meaning:
    """What a name says. kind: a key of QUANTITIES or "". unit: as this project writes it or "". quality: as QUALITIES."""

    kind: str
    unit: str
    quality: frozenset[str]


def meaning(name: str, stated: str = "") -> Meaning:
    """Return what a column's name says. stated: the unit that the file itself gives the column, which comes first."""
    words, text = parted(name)
    bare = [w for w in words if not (text and w == text.lower())] or words
    kind = next((k for w in bare for k, known in QUANTITIES.items() if w in known.split()), "")
    quality = frozenset(q for w in bare for q, known in QUALITIES.items() if w in known.split())
    unit = unit_of(stated, kind) or unit_of(text, kind)
    if not unit and len(words) > 1:
        tail = re.split(r"[\s_/.]+", name.strip())[-1]
        unit = unit_of(tail, kind) if len(tail) > 1 or tail in "AVNsm" else ""
    elif not unit and not kind:
        unit = unit_of(name)
    if unit and not kind:
        kind = kind_of(unit)
    if unit and kind and not fits(unit, kind):
        unit = ""
    return Meaning(kind, unit, quality)


def parted(name: str) -> tuple[list[str], str]:
    """Return (words in lower case, text in brackets) of a column's name: "Iq_act [A]" gives (["iq", "act"], "A")."""
    bracketed = re.search(r"[\[(]([^\])]*)[\])]", name)
    text = bracketed.group(1).strip() if bracketed else ""
    rest = name[: bracketed.start()] + name[bracketed.end() :] if bracketed else name
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", rest)
    return [w.lower() for w in re.findall(r"[^\W\d_]+", spaced)], text


def unit_of(text: str, kind: str = "") -> str:
    """Return the unit that a text means, "" where it means none. Lower-case "nm" is a length where a position is meant."""
    text = text.strip()
    if text in ("Nm", "mNm") or (text == "nm" and kind == "torque"):
        return {"Nm": "N*m", "mNm": "mN*m", "nm": "N*m"}[text]
    if tidy(text) != "1" and legible(tidy(text)):
        return tidy(text)
    return "" if text == "nm" else UNIT_OF.get(text.lower(), "")


def kind_of(unit: str) -> str:
    """Return the quantity that a unit belongs to, or ""."""
    return next((k for si, k in KIND_OF_UNIT.items() if same(root(unit)[1], root(si)[1])), "")


def is_length(unit: str) -> bool:
    return same(root(unit)[1], root("m")[1])


def fits(unit: str, kind: str) -> bool:
    """Whether a quantity of this kind may be logged in this unit: drives log all they have in percent, too."""
    drive = ("torque", "force", "current", "voltage")
    found = kind_of(unit)
    if found == "":
        return kind in drive and unit in ("percent", "permille")
    return (
        found == kind
        or (found == "force" and kind == "normal")
        or (found in drive and kind in drive)
        or (unit == "count" and kind == "time")
    )
