"""`workbench verify`: a study's axes driven by its firmware."""

import argparse
import sys
from pathlib import Path

from workbench.verbs import NOT_MET


def declare(verbs) -> None:
    verify = verbs.add_parser(
        "verify",
        help="drive a study's axes by its compiled firmware",
        description="Write the firmware of a study's controllers in float32 and in fixed point, compile it for this machine, "
        "and let it drive the study's axes beside the law in float64.",
    )
    verify.add_argument("study", help="a study's folder, its name under studies/, or the folder of its outputs")
    verify.add_argument("--firmware", action="store_true", required=True, help="the compiled C as controller")
    verify.add_argument("--draws", type=int, default=20, help="axes, besides the worst that the study kept (20)")
    verify.add_argument("--controller", help="one controller by its name; all that [robustness] names where absent")


def _outputs(study: str) -> Path:
    """Return the folder of a study's outputs, by that folder itself, the study's folder or its name."""
    given = Path(study)
    if (given / "robustness").is_dir():
        return given
    if (given / "study.toml").is_file():
        return given.resolve().parent.parent / "reports" / given.resolve().name
    return Path("reports") / study


def do(given: argparse.Namespace) -> int:
    from workbench.errors import WorkbenchError
    from workbench.firmware.verification import FILE, FOLDER, verify

    if given.draws < 1:
        raise WorkbenchError(f"--draws is {given.draws}; at least one axis is needed.")
    place = _outputs(given.study)
    found = verify(place, given.draws, given.controller, lambda line: print(line, file=sys.stderr))
    wide = max(len(c.controller) for c in found)
    for c in found:
        bits = "equal" if c.same == c.samples else f"{c.samples - c.same} of {c.samples} differ"
        print(
            f"{c.controller:{wide}}  {c.arithmetic:8} {c.axes} axes, {c.scattered} scattered: final error {c.final_error:.2f} "
            f"counts, 1 % time {1e3 * c.time_1pct:.2g} ms, overshoot {100.0 * c.overshoot:.2g} %; bits {bits}"
        )
    if any(c.scattered for c in found):
        print(
            "Scattered: float64 itself lands more than two counts elsewhere where friction is changed by 1e-7 at most."
        )
    print(
        f"Largest differences from float64 over the axes, final errors from the span of where it lands; sources, tables and figures: {place / FOLDER / FILE}"
    )
    return 0 if all(c.good for c in found) else NOT_MET
