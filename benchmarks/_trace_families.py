"""Families of campaigns whose answers are known, each traced and judged alike.

c: the folder campaigns under WORKBENCH_DATA with its truth.json; d, and any other letter or word X: campaigns_X, of an author each;
measured: its axes, judged by a table of their own; carried: campaigns of other authors that brought a rule, benchmarks/carried; rig: the
rig's older campaigns; bench: its benches. X:half, X:noise, X:swapped, X:less and X:wrong are copies of a folder's campaigns (`_trace_copies`).
"""

import json
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks._trace_copies import COPIES, DECLARED, copied, lack_nothing
from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE, Spec, specs
from benchmarks._trace_measured import AXES, judged_axis
from benchmarks._trace_run import one as one_of_rig
from benchmarks._trace_run import place_right, ranges, seen, traced

FOLDERS = {"c": "campaigns", "measured": "measured"}
CARRIED = Path(__file__).parent / "carried"
AUTHOR = "campaigns_"  # and a name, of any other author's folder
DRAWN = ("rig", "bench")
FAMILIES = ("c", "d", "carried", *DRAWN, "measured")
BELOW = 0.9  # of the stated floor: an error below this is an alarm. Halving asks for nothing; doubling alarms at every good fit


@dataclass(frozen=True)
class Case:
    """One campaign: its family, name, and what it is made of (a Spec of the family as a dict; empty for a folder)."""

    family: str
    name: str
    spec: tuple[tuple[str, object], ...] = ()

    @property
    def key(self) -> str:
        return sha256(json.dumps([self.family, self.name, self.spec]).encode()).hexdigest()[:12]


def folder(family: str) -> Path | None:
    """Return the folder of a family that is not drawn, or of its copies; None where it is not here."""
    family = family.partition(":")[0]
    if family == CARRIED.name:
        return CARRIED
    root = os.environ.get("WORKBENCH_DATA")
    found = Path(root) / FOLDERS.get(family, AUTHOR + family) if root else None
    return found if found is not None and found.is_dir() else None


def known(family: str) -> bool:
    """Whether there is such a family, here or on another machine, and such copies of it."""
    of, copies, how = family.partition(":")
    if copies and (how not in {**COPIES, **DECLARED} or of in (*DRAWN, "measured")):
        return False
    return of in FAMILIES or folder(of) is not None


def cases(families: Sequence[str], campaigns: int, seed: int) -> list[Case]:
    """The campaigns of these families; campaigns: how many are drawn of a family that is drawn. A family that is not here has none."""
    found: list[Case] = []
    for family in families:
        if family not in DRAWN:
            root = folder(family)
            names = sorted(p.parent.name for p in root.glob("*/campaign.toml")) if root else []
            if root and family.partition(":")[2] in DECLARED:
                names = sorted({*names} & lack_nothing(root / "truth.json"))
            found += [Case(family, n) for n in names if family != "measured" or n in AXES]
        elif family == "rig":
            found += [Case(family, s.key, tuple(asdict(s).items())) for s in specs(campaigns, seed)]
        else:
            from rig.bench import drawn

            found += [Case(family, f"b{s.seed}", tuple(asdict(s).items())) for s in drawn(campaigns, seed)]
    return found


def kind_of(missing: Sequence[str]) -> str:
    """The class of a campaign by what it lacks."""
    return NONE if not missing else OUTSIDE if list(missing) == ["unknown"] else PAIR if len(missing) > 1 else SINGLE


def judged(truth: dict, said: dict, place: bool | None) -> dict:
    """What the ledger counts of one campaign: truth as truth.json has it, said as `traced` returns it."""
    of, missing = kind_of(truth["missing"]), truth["missing"]
    known = missing if of in (SINGLE, PAIR) else []
    after, share = said["after"]["validation"], None
    if known:  # of what no name fits an author may know no true structure
        before, best = truth["nrmse_declared"], truth["nrmse_true"]
        share = max(-1.0, min(1.0, (before - after) / (before - best))) if before > 1.1 * best else None
    if share is not None and not set(known) & set(said["added"]):
        share = min(share, 0.0)
    return {
        "of": of,
        "first": bool(known) and said["verdict"] == "cause" and said["ranked"][:1] != [] and said["ranked"][0] in known,
        "both": bool(known) and set(known) <= set(said["added"]),
        "false": [n for n in said["added"] if n not in known],
        "alarm": of == NONE and (said["verdict"] != "nothing_missing" or bool(said["added"])),
        "nothing": of != NONE and said["verdict"] == "nothing_missing",
        "unknown": said["verdict"] == "unknown",
        "place": place,
        "share": share,
        "worse": after > 1.02 * said["before"]["validation"],
        "moved": said["moved"],
        "below": said["after"]["identification"] < BELOW * said["floor"]["identification"],
    }


def placed(truth: dict, said: dict, campaign) -> bool | None:
    """Whether an unknown cause's place is right; None where none is stated, or in words alone."""
    if not truth.get("where") or isinstance(truth["where"], str) or not said["unknown"]:
        return None
    coordinate, spans = truth["where"]
    if coordinate == "time":
        spans = (
            seen(spans, campaign.records)
            if len(spans) == 1
            else [x for s in spans for x in seen([s], campaign.records)]
        )
    return place_right((coordinate, spans), said["unknown"], ranges(campaign), 1.0)


def read(case: Case, path: Path, truth: dict) -> dict:
    """Trace the campaign of a folder and judge it."""
    from workbench.campaign import load

    campaign, truth = copied(load(path), case.family.partition(":")[2], truth, case.name)
    said = traced(campaign)
    if case.family == "measured":
        return {"said": said, "judged": judged_axis(case.name, said), "truth": {}}
    return {"said": said, "judged": judged(truth, said, placed(truth, said, campaign)), "truth": truth}


def of_rig(spec: dict) -> dict:
    """One of the rig's older campaigns, in the words of the others."""
    result = one_of_rig(Spec(**{**spec, "missing": tuple(spec["missing"])}))
    said, old, truth = result["said"], result["judged"], result["truth"]
    as_truth = {
        "missing": truth["missing"],
        "nrmse_declared": said["before"]["validation"],
        "nrmse_true": truth["floor"]["validation"],
    }
    allowed = set(truth["also"])
    meant = said | {k: [n for n in said[k] if n in truth["missing"] or n not in allowed] for k in ("added", "ranked")}
    return {"said": said, "judged": judged(as_truth, meant, old["place"]), "truth": truth}


def one(case: Case) -> dict:
    """Make, trace and judge one campaign; a failure is a result too."""
    spec, head = dict(case.spec), {"key": case.key, "family": case.family, "name": case.name, "spec": case.spec}
    try:
        if case.family == "rig":
            found = of_rig(spec)
        elif case.family == "bench":
            from rig.bench import campaign

            with TemporaryDirectory() as made:
                truth = campaign(Path(made), spec["seed"], spec["missing"], kind=spec["kind"])
                found = read(case, Path(made), json.loads(json.dumps(truth, default=float)))
        else:
            root = folder(case.family)
            file = root / "truth.json"
            truth = json.loads(file.read_text(encoding="utf-8")).get(case.name, {}) if file.is_file() else {}
            found = read(case, root / case.name, truth)
    except Exception as wrong:  # the others go on, and the ledger counts it
        return {**head, "failed": f"{type(wrong).__name__}: {wrong}"}
    return {**head, **found}
