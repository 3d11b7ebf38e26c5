"""Numbers and units as a reader expects them: no more digits than the interval holds, a true minus sign, SI."""

import re
from math import floor, inf, isfinite, log10

MINUS, TIMES, NARROW = "\u2212", "\u00d7", "\u202f"
SUPERSCRIPT = str.maketrans("0123456789-", "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079\u207b")
TINY = 1e-300  # what is smaller is zero
SMALLEST, LARGEST = -3, 5  # decades that are written out; outside them a power of ten is split off
EXACT = 1e-7  # relative width from which an interval says nothing more
PREFIXES = {-12: "p", -9: "n", -6: "\u00b5", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
READABLE = {"N*m*s^2/rad": "kg*m^2", "N*s^2/m": "kg"}


def _exponent(value: float, figures: int = 3) -> int:
    """Return the decade of a number as it will be rounded: 0.0999 to two figures lies in the decade of 0.1."""
    return int(f"{abs(value):.{figures - 1}e}".split("e")[1]) if abs(value) > TINY else 0


def _power(e: int) -> str:
    """Return "× 10⁻⁶"."""
    return f"{TIMES} 10{str(e).translate(SUPERSCRIPT)}"


def placed(value: float, places: int) -> str:
    """Return a number with so many decimals (none where negative), groups of three from 10 000 on."""
    text = f"{abs(round(value, places)):.{max(places, 0)}f}"
    whole, point, rest = text.partition(".")
    if len(whole) > 4:
        whole = f"{int(whole):,}".replace(",", NARROW)
    negative = value < 0 and any(c in "123456789" for c in text)
    return (MINUS if negative else "") + whole + point + rest


def split(decade: int) -> int:
    """Return the power of ten, a multiple of three, that is split off a number of this decade; 0 for none."""
    return 0 if SMALLEST <= decade < LARGEST else 3 * floor(decade / 3)


def named(value: float) -> str:
    """Return what a number that is not finite is called."""
    return "not determined" if value != value else ("\u221e" if value > 0 else f"{MINUS}\u221e")


def number(value: float, figures: int = 3) -> str:
    """Return a number with so many significant figures: "0.0213", "−1.50", "12.3 × 10⁻⁶"."""
    value = float(value)
    if not isfinite(value):
        return named(value)
    decade = _exponent(value, figures)
    e = split(decade)
    text = placed(value / 10.0**e, figures - 1 - (decade - e))
    return f"{text} {_power(e)}" if e else text


def exact(value: float, figures: int = 6) -> str:
    """Return a number that was declared, without zeros at its end: "60", "0.11"."""
    value = float(f"{value:.{figures - 1}e}")
    least = next((k for k in range(1, figures) if float(f"{value:.{k - 1}e}") == value), figures)
    return number(value, max(least, min(_exponent(value, figures) + 1, LARGEST) if value else 1))


def count(value: int) -> str:
    """Return a whole number."""
    return placed(float(value), 0)


def _shared(value: float, half: float, figures: int) -> tuple[int, int]:
    """Return (power of ten split off, decimals) for a value known to `half`, whose last `figures` digits count."""
    half = max(half, EXACT * abs(value))
    e = split(max(_exponent(value), _exponent(half, figures)))
    return e, figures - 1 - (_exponent(half, figures) - e)


def plus_minus(value: float, half: float, figures: int = 2) -> str:
    """Return "1.234 ± 0.012": the half width to two figures, the value to the same decimal."""
    if not (isfinite(value) and isfinite(half)) or half <= EXACT * abs(value):
        return number(value, 8 if 0 < half < inf else 3)
    e, places = _shared(value, half, figures)
    text = f"{placed(value / 10.0**e, places)} \u00b1 {placed(half / 10.0**e, places)}"
    return f"({text}) {_power(e)}" if e else text


def _estimate(value: float, half: float, text: str) -> str:
    """Return "0.0551 ± 0.0008 N·m"."""
    shown = unit(text)
    return f"{plus_minus(value, half)}\u00a0{shown}" if shown else plus_minus(value, half)


def with_interval(value: float, low: float, high: float, figures: int = 2) -> tuple[str, str]:
    """Return (value, "low to high"), all to the decimal that the narrower half of the interval holds.

    The interval is "" where it has no width (a value held, or on its bound), and says so where it is not finite.
    """
    halves = [h for h in (high - value, value - low) if h > 0]
    if not all(map(isfinite, (value, low, high))):
        return number(value), "not determined"
    if not halves:
        return number(value, 4), ""
    e, places = _shared(value, min(halves), figures)
    low, value, high = (placed(v / 10.0**e, places) for v in (low, value, high))
    end = f" {_power(e)}" if e else ""
    return value + end, (f"({low} to {high}){end}" if e else f"{low} to {high}")


def percent(ratio: float, figures: int = 2) -> str:
    """Return a ratio in per cent: "8.9 %", "0.94 %", "100 %"."""
    if not isfinite(ratio):
        return named(ratio)
    value = 100.0 * ratio
    return f"{placed(value, max(0, figures - 1 - _exponent(value, figures)))}\u00a0%"


def unit(text: str) -> str:
    """Return a unit as it is printed: "N*m*s/rad" is "N·m·s/rad", "m^2" is "m²"; "" for a number without unit."""
    text = READABLE.get(text, text)
    if text in ("", "1"):
        return ""
    text = re.sub(r"\^(-?\d+)(?![\d.])", lambda m: m.group(1).translate(SUPERSCRIPT), text)
    return text.replace("*", "\u00b7")


def prefixed(largest: float, text: str) -> tuple[float, str]:
    """Return (factor, unit) so that `largest` times the factor lies in 1 to 1000: (1000.0, "mN·m") for 0.021 N*m."""
    shown = unit(text)
    if not shown or shown.startswith(("1", "kg", "%")) or not isfinite(largest) or largest == 0:
        return 1.0, shown
    e = min(max(3 * floor(log10(abs(largest)) / 3), min(PREFIXES)), max(PREFIXES))
    return 10.0**-e, PREFIXES[e] + shown


def quantity(value: float, text: str, figures: int = 3) -> str:
    """Return a number with its unit: "0.0213 N·m"; a ratio stays a number."""
    shown = unit(text)
    return f"{number(value, figures)}\u00a0{shown}" if shown else number(value, figures)


def scaled(value: float, text: str, figures: int = 3) -> str:
    """Return a number with a prefixed unit: "21.3 mN·m"."""
    factor, shown = prefixed(value, text)
    return f"{number(value * factor, figures)}\u00a0{shown}" if shown else number(value, figures)


def label(name: str, shown: str) -> str:
    """Return the label of an axis or a column: "speed (rad/s)"."""
    return f"{name} ({shown})" if shown else name
