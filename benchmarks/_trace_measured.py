"""What is known of measured axes, by independent fits, and whether a trace says so."""

from collections.abc import Callable

MEMORY = {
    "presliding_hysteresis",
    "lugre_friction",
    "fading_memory",
}  # names of friction that gives way before it slips


def values(said: dict, effect: str) -> dict[str, float]:
    """Parameters, in SI, of an effect that was added; empty where it was not."""
    return next((c["parameters"] for c in said["causes"] if c["effect"].partition(" ")[0] == effect), {})


def late(said: dict) -> str:
    """KUKA KR300: the link encoder is stamped 2.6 to 3.3 ms late, and that is named first."""
    if said["verdict"] != "cause" or said["ranked"][:1] != ["clock_skew"] or "clock_skew" not in said["added"]:
        return "clock_skew is not first"
    at = next(c["at"] for c in said["causes"] if c["effect"].startswith("clock_skew"))
    ms = 1e3 * values(said, "clock_skew")["offset"]
    if at != "sensor.load_position" or not 2.6 <= ms <= 3.3:
        return f"clock_skew of {at}, {ms:.2f} ms, where the link encoder is 2.6 to 3.3 ms late"
    return ""


def pendulum(said: dict) -> str:
    """XL330 with an arm: gravity of 0.45 to 0.49 N*m, and nothing else."""
    if said["verdict"] != "cause" or said["added"] != ["gravity"]:
        return "gravity alone is missing"
    mgl = values(said, "gravity")["mgl"]
    return "" if 0.45 <= abs(mgl) <= 0.49 else f"gravity of {mgl:.3f} N*m, where it is 0.45 to 0.49"


def banded(said: dict) -> str:
    """Banded rotary friction device: friction with memory behind a gap; errors as its own fit leaves them."""
    after = said["after"]
    if said["verdict"] != "cause" or not MEMORY & set(said["added"]):
        return "friction with memory is not named"
    if "backlash" not in said["added"]:
        return "its gap is not named"
    if after["validation"] > 0.205 or after["identification"] > 0.11:
        return f"leaves {100 * after['identification']:.1f} and {100 * after['validation']:.1f} %, where 11 and 20.5 % can be had"
    return ""


AXES: dict[str, Callable[[dict], str]] = {
    "kr300_axis1": late, "kr300_axis1_JmJl": late, "kr300_axis3": late, "kr300_axis3_JmJl": late, "xl330": pendulum, "brfd": banded,
}  # fmt: skip


def judged_axis(name: str, said: dict) -> dict:
    """Whether an axis is right, and what is wrong of it; a fixed value that moved unnamed makes any wrong."""
    wrong = AXES[name](said)
    if said["moved"] and not wrong:
        wrong = f"moved {', '.join(said['moved'])}, which is fixed"
    return {"of": "measured", "right": not wrong, "wrong": wrong, "moved": said["moved"]}
