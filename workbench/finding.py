"""A result is a sentence with its numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field

PROPER = {"stribeck": "Stribeck", "coulomb": "Coulomb", "lugre": "LuGre"}
ORDINAL = {"2": "second ", "3": "third "}  # of effects that are there several times, told apart by a number

# Places that are readings, as they are read
READING = {
    "sensor.position": "encoder",
    "sensor.load_position": "load's encoder",
    "sensor.torque": "drive's report",
    "sensor.force": "drive's report",
}

# Kinds of findings that somebody asks for or that are said in several places; a kind of one sentence stands beside it.
ASSUMED_SCALE = "assumed scale"
BELOW_FLOOR = "below the floor"
CARRIES_NOTHING = "joint carries nothing"
CONSTRAINT_DROPPED = "constraint dropped"
CUT = "cut at gaps"
ENCODER_RESOLUTION = "encoder resolution"
GLITCH = "glitch"
HUM = "hum of the mains"
JITTER = "jitter of the clock"
KNOWN_TOGETHER = "known only together"
LOST_COUNTS = "lost counts"
MODE = "mode"
NOT_TUNED = "not tuned"
OTHER_UNIT = "unit"
RESAMPLED = "resampled"
RESPONSE_LIMITS = "response limits"
SAMPLING_RATE = "sampling rate"
SENSITIVITY_EXCEEDED = "sensitivity exceeded"
SOMETHING_ELSE = "something else"
SLOW_FORCE = "slow force"
START_TIME = "start time"
UNSTABLE = "unstable"


def title(effect: str) -> str:
    """Return the name of an effect as it is read: "Stribeck friction" of "stribeck_friction", "second cogging" of "cogging 2"."""
    name, _, label = effect.partition(" ")
    words = " ".join(PROPER.get(word, word) for word in name.split("_"))
    return f"{ORDINAL[label]}{words}" if label in ORDINAL else f"{words} {label}".rstrip()


def place(at: str) -> str:
    """Return a place as it is read: "load", "load's encoder" of "sensor.load_position"."""
    return READING.get(at, at)


def located(effect: str, at: str) -> str:
    """Return an effect with its place where that says anything: "gravity", "Coulomb friction at the load"."""
    return title(effect) if at in ("axis", "command") else f"{title(effect)} at the {place(at)}"


def capital(text: str) -> str:
    """Return text with a capital first letter; the rest stays."""
    return text[:1].upper() + text[1:]


def in_per_cent(share: float) -> str:
    """Return a share of samples in per cent, whole ones: "38 %"; "less than 1 %" of a few samples, which are more than none."""
    return "less than 1 %" if 0.0 < share < 0.005 else f"{100 * share:.0f} %"


@dataclass(frozen=True)
class Finding:
    """One thing that was found.

    kind: a short word to sort by ("not determined", "at bound", "resampled", "cause", "nothing missing", ...).
    subject: what it is about (a parameter's full name, a record, an effect).
    sentence: what a person reads. evidence: the numbers behind it, SI. remedy: what would change it, or "".
    """

    kind: str
    subject: str
    sentence: str
    evidence: Mapping[str, float] = field(default_factory=dict)
    remedy: str = ""

    def __str__(self) -> str:
        return self.sentence
