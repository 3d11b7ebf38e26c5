"""One campaign of the trace's benchmark: made, traced, given to the peers, and judged against what the rig knows."""

import resource
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

from benchmarks._trace_draw import LEVEL, NONE, OUTSIDE, SIZES, WEAKEST, Spec, campaign
from benchmarks._trace_peers import answers

WITHIN = 0.1  # of the range, in which a place or time is right
DRAWS, APART = 6, 10**6  # of a machine, at most, and between their seeds


def made(folder: Path, s: Spec) -> dict:
    """Write the campaign of a spec, and return the rig's truth.

    Where an effect cannot be made large enough to count (coarse encoders see little of a joint), another machine is drawn.
    """
    options = {
        k: v
        for k, v in asdict(s).items()
        if k in ("base", "noise", "memory", "count", "rate", "band", "ratio", "short")
    }
    for again in range(DRAWS):
        truth = campaign(folder, s.seed + again * APART, s.missing, s.over / LEVEL, **options)
        if all(size >= WEAKEST * SIZES[0] for size in truth["sizes"]):
            break
    return truth


def ranges(campaign) -> dict[str, tuple[float, float]]:
    """Return coordinate -> (low, high) over the identification records; velocity by differences."""
    import numpy as np

    records = [r for r in campaign.records if r.role == "identification"]
    q = [r.channels["position"] for r in records]
    v = [np.gradient(np.convolve(x, np.ones(9) / 9, "same"), r.time)[20:-20] for x, r in zip(q, records, strict=True)]
    signals = {"position": q, "velocity": v, "time": [r.time for r in records]}
    return {name: (min(x.min() for x in xs), max(x.max() for x in xs)) for name, xs in signals.items()}


def seen(spans, records) -> list[tuple[float, float]]:
    """Return spans of time as far as records show them: what happens between two records, nobody can say."""
    shown = []
    for low, high in spans:
        within = [r.time[(r.time >= low) & (r.time <= high)] for r in records if r.role == "identification"]
        if any(t.size for t in within):
            shown.append((min(float(t[0]) for t in within if t.size), max(float(t[-1]) for t in within if t.size)))
    return shown


def place_right(where, unknown: dict, span: dict[str, tuple[float, float]], length: float) -> bool | None:
    """Whether a stated place is the true one within WITHIN of the coordinate's range; None where there is none.

    Each end has to be right. Of moments that recur every one that is stated must be, within a quarter of what is between
    them, else any would do; and half of them must be stated, because some fall where nothing shows them.
    """
    coordinate, spans = where
    if not spans:
        return None
    if unknown.get("coordinate") != coordinate:
        return False
    reach = WITHIN * (span[coordinate][1] - span[coordinate][0])
    recur = coordinate == "time" and len(spans) > 1
    if recur:
        reach = min(reach, 0.25 * min(b[0] - a[0] for a, b in pairwise(spans)))
    scale = 1.0 if coordinate == "time" else length

    def near(said, true) -> bool:
        return all(abs(a - scale * b) <= reach for a, b in zip(said, true, strict=True))

    if not recur:
        return any(near((unknown["low"], unknown["high"]), true) for true in spans)
    met = sum(any(near(said, true) for said in unknown["spans"]) for true in spans)
    return 2 * met >= len(spans) and all(any(near(said, true) for true in spans) for said in unknown["spans"])


def judged(s: Spec, truth: dict, said: dict, right_place: bool | None) -> dict:
    """Return what the table counts."""
    missing, also = truth["missing"], truth["also"]
    ranked, added = ([n for n in said[k] if n in missing or n not in also] for k in ("ranked", "added"))
    known = [] if s.of in (NONE, OUTSIDE) else missing
    before, after, floor = said["before"], said["after"], truth["floor"]
    achievable = before["validation"] - floor["validation"]
    share = (before["validation"] - after["validation"]) / achievable if achievable > 0.0 else 0.0
    hit = bool(set(known) & set(added))
    return {
        "first": bool(known) and said["verdict"] == "cause" and ranked[:1] != [] and ranked[0] in known,
        "both": bool(known) and set(known) <= set(added),
        "rival": bool(known) and bool(set(known) & ({*ranked[:1]} | set(said["rivals"]))),
        "alarm": s.of == NONE and said["verdict"] != "nothing_missing",
        "unknown": said["verdict"] == "unknown",
        "place": right_place,
        "spurious": len([n for n in added if n not in known]),
        "share": min(share, 1.0) if hit else 0.0,
        "worse": after["validation"] > 1.001 * before["validation"],
    }


def peers(campaign, before) -> dict[str, list[str]]:
    """What the peers make of the residual of the declared model. Presliding hysteresis is, to them, friction that they know."""
    series = [s for s in before.series.values() if s.role == "identification"]
    geometry, effects = campaign.plant.geometry, campaign.plant.effects
    ratio, pole_pairs = geometry.gear_ratio or 1.0, geometry.pole_pairs or 1.0
    declared = {e.name for e in effects if not all(p.fixed for p in e.parameters.values())}
    declared |= {"coulomb_friction"} if "presliding_hysteresis" in declared else set()
    return answers(series, campaign.bandwidth, (ratio, 2.0 * ratio, ratio * pole_pairs), declared)


def moved(before, after, added) -> list[str]:
    """Return "effect at place: parameter" of each value that is declared fixed, came out otherwise, and is not named."""
    held = {(e.effect, e.at, e.parameter): e.value for e in before.estimates if e.fixed}
    now = {(e.effect, e.at, e.parameter): e.value for e in after.estimates}
    return [
        f"{effect} at {at}: {parameter}"
        for (effect, at, parameter), value in held.items()
        if effect not in added and abs(now.get((effect, at, parameter), value) - value) > 1e-9 * abs(value)
    ]


def evidence(found) -> object:
    """What a trace decided from, as trace.json holds it; None of a version that keeps none."""
    from workbench.tracing.output import as_dict

    return as_dict(found, {}).get("evidence")


def traced(campaign, *, beside: bool = True) -> dict:
    """Trace a campaign; return what it says, and what it cost. beside: whether the peers say something, too."""
    from workbench.tracing.of_campaign import trace_campaign

    start = process_time()
    found = trace_campaign(campaign)
    seconds = process_time() - start
    megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # before the peers, who need their own
    both = lambda fit: {"identification": fit.identification, "validation": fit.validation}  # noqa: E731
    return {
        "verdict": found.verdict,
        "ranked": list(dict.fromkeys(c.effect.partition(" ")[0] for c in found.ranked))[:6],
        "gains": [round(float(c.gain), 4) for c in found.ranked[:6]],
        "added": list(found.added),
        "rivals": [r.partition("@")[0].partition(" at ")[0] for c in found.causes for r in c.rivals],
        "before": both(found.before),
        "after": both(found.after),
        "floor": dict(found.floor),
        "unknown": dict(found.unknown),
        "causes": [
            {"effect": c.effect, "at": c.at, "parameters": {e.parameter: float(e.value) for e in c.parameters}}
            for c in found.causes
        ],
        "moved": moved(found.before, found.after, set(found.added)),
        "evidence": evidence(found),
        "peers": peers(campaign, found.before) if beside else {},
        "seconds": seconds,
        "megabytes": megabytes,
    }


def one(s: Spec, *, beside: bool = True) -> dict:
    """Make, trace and judge one campaign. beside: whether the peers say something, too."""
    from workbench.campaign import load

    with TemporaryDirectory() as folder:
        truth = made(Path(folder), s)
        loaded = load(Path(folder))
        said = traced(loaded, beside=beside)
        length = 1.0
        right = None
        if truth["where"] is not None and said["unknown"]:
            length = truth["metres"]
            coordinate, spans = truth["where"]
            if coordinate == "time" and len(spans) == 1:
                spans = seen(spans, loaded.records)
            right = place_right((coordinate, spans), said["unknown"], ranges(loaded), length)
    kept = {k: truth[k] for k in ("missing", "effects", "also", "at", "sizes", "parameters", "floor", "where")}
    return {"key": s.key, "spec": asdict(s), "truth": kept, "said": said, "judged": judged(s, truth, said, right)}
