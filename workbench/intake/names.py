"""What the name of a column says: the quantity, whether it is a set value, and the unit."""

import difflib
import re
from dataclasses import dataclass

from workbench.units.registry import legible, root, same, tidy

# Words of English and German logs, in lower case. One word may be a quantity or qualify one.
QUANTITIES = {
    "time": "t time times zeit timestamp timestamps stamp datetime date clock elapsed uhrzeit zeitstempel ipoc",
    "current": "i iq cur curr current currents strom motorstrom amps ampere",
    "torque": "torque torques torq trq tq tau moment drehmoment effort efforts",
    "force": "force frc f kraft thrust",
    "voltage": "u volt volts voltage spannung vir",
    "position": "p pos posn position positions q qm x angle ang theta phi enc encoder lage lageistwert winkel weg istlage turns",
    "velocity": "v vel velocity velocities speed spd omega w dq qd drehzahl geschwindigkeit",
    "temperature": "temp temperature temperatur housing",
    "normal": "normal normalkraft",
}
ANGLES = {"ang", "angle", "theta", "phi", "winkel", "q", "qm"}
QUALITIES = {
    "reference": "ref reference set setpoint soll sollwert sp cmd command commanded target demand demanded desired des qg qr goal nominal",
    "measured": "act actual ist istwert istlage lageistwert meas measured fb feedback present estimate estimated est",
    "load": "load second secondary last abtrieb link",
    "error": "err error dev deviation following lag schlepp schleppfehler ferror",
}
SPELT = {
    "count": "cnt cnts counts inc incs incr increment increments ink inkr inkremente tick ticks pulse pulses lsb digits sample samples",
    "s": "sec secs second seconds sek",
    "ms": "msec millisec",
    "us": "usec µsec",
    "A": "amp amps arms apk",
    "N*m": "nm newtonmeter",
    "mN*m": "mnm",
    "N*cm": "ncm",
    "N*mm": "nmm",
    "kN*m": "knm",
    "lbf*in": "lbfin lbf*in lb*in lbin in*lb inlb",
    "ozf*in": "ozin oz*in ozf*in",
    "deg": "degree degrees grad",
    "rev": "revs turns rot",
    "rpm": "u/min 1/min min-1",
    "percent": "pct prozent",
    "permille": "‰ promille 0.1%",
    "degC": "celsius",
}
NO_UNITS = set(
    "raw filt filtered est cmd set ref fbk rms peak avg mean abs motor drive joint axis main aux x y z".split()
)
UNIT_OF = {word: unit for unit, words in SPELT.items() for word in words.split()}
USUAL = {
    "time": "s ms us ns min",
    "current": "A mA percent permille",
    "torque": "N*m mN*m N*cm N*mm kN*m lbf*in ozf*in A percent permille",
    "force": "N mN kN lbf kgf A percent permille",
    "voltage": "V mV",
    "position": "rad deg rev m mm um nm count mrad arcsec mdeg in",
}
KIND_OF_UNIT = {
    "s": "time", "A": "current", "N*m": "torque", "N": "force", "V": "voltage", "rad": "position", "m": "position",
    "count": "position", "rad/s": "velocity", "m/s": "velocity", "K": "temperature",
}  # fmt: skip


@dataclass(frozen=True)
class Meaning:
    """What a name says. kind: a key of QUANTITIES or "". unit: as this project writes it or "". quality: as QUALITIES.

    unknown: a unit that is stated and is none, or none of such a quantity. words: of the name, in lower case.
    """

    kind: str
    unit: str
    quality: frozenset[str]
    unknown: str = ""
    words: tuple[str, ...] = ()


def meaning(name: str, stated: str = "") -> Meaning:
    """Return what a column's name says. stated: the unit that the file itself gives the column, which comes first."""
    words, text = words_of(name)
    bare = [w for w in words if not (text and w == text.lower())] or words
    by_length = sorted(
        bare, key=lambda w: len(w) == 1
    )  # "x-output-current" is a current: a letter says less than a word
    kind = next((k for w in by_length for k, known in QUANTITIES.items() if w in known.split()), "")
    quality = frozenset(q for w in bare for q, known in QUALITIES.items() if w in known.split())
    unit = unit_of(stated, kind) or unit_of(text, kind)
    if not unit and len(words) > 1:
        tail = re.split(r"[\s_/.]+", name.strip())[-1]
        unit = unit_of(tail, kind) if len(tail) > 1 or tail in "AVNsm" else ""
        unit = "" if unit == "m" and ANGLES & set(words) else unit  # "theta_m" is the motor's
    elif not unit and not kind:
        unit = unit_of(name)
    if not unit and not kind and words and words[0] in ("ms", "us", "ns"):  # "ms_today"
        unit = words[0]
    if unit and not kind:
        kind = kind_of(unit)
    told = next((u for u in (stated.strip(), text) if _states_unit(u)), "")
    if unit and kind and not _fits(unit, kind):  # of "current_in" the tail is no inch
        unit = ""
    return Meaning(kind, unit, quality, "" if unit else told, tuple(words))


def _states_unit(text: str) -> bool:
    """Whether a text in brackets, or in a row of units, is meant as a unit: no number, no word, no remark."""
    words = re.findall(r"[^\W\d_]+", text.lower())
    known = {w for group in (QUANTITIES, QUALITIES) for line in group.values() for w in line.split()} - set(
        "a v n s m g".split()
    )
    remark = len(text) > 12 or " " in text or "=" in text or set(words) <= NO_UNITS | known
    return text not in ("", "-", "1") and not remark and (bool(words) or text in ("%", "°", "‰"))


def words_of(name: str) -> tuple[list[str], str]:
    """Return (words in lower case, text in brackets) of a column's name: "Iq_act [A]" gives (["iq", "act"], "A")."""
    bracketed = re.search(r"[\[(]([^\])]*)[\])]", name)
    text = bracketed.group(1).strip() if bracketed else ""
    rest = name[: bracketed.start()] + name[bracketed.end() :] if bracketed else name
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z]{2})", " ", rest)
    return [w.lower() for w in re.findall(r"[^\W\d_]+", spaced)], text


def unit_of(text: str, kind: str = "") -> str:
    """Return the unit that a text means, "" where it means none. Lower-case "nm" is a length where a position is meant."""
    text = re.sub(r"(?<=[A-Za-z])[.·\- ](?=[A-Za-z])", "*", text.strip())
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


def _fits(unit: str, kind: str) -> bool:
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


def alike(unit: str, kind: str) -> list[str]:
    """Return three usual units of a quantity, those that are spelt most like `unit` first."""
    usual = USUAL.get(kind, "s A N*m N rad mm count").split()
    bare = {u.replace("*", "").casefold(): u for u in usual}
    close = difflib.get_close_matches(re.sub(r"[^a-z]", "", unit.casefold()), bare, n=3, cutoff=0.5)
    return list(dict.fromkeys([*(bare[c] for c in close), *usual]))[:3]


def known_unit(unit: str) -> str:
    """Return a unit as a user writes it in this project's spelling; "" where it is not known."""
    return unit_of(unit)
