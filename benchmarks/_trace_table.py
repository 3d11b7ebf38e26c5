"""What a sweep of campaigns comes to, as text: shares with their intervals, confusion, power, and each failure."""

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence

from scipy.stats import binomtest

from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE, SIZES, WEAKEST

BINS = (0.0, 1.0, 3.0, 5.0, 8.0, 12.0, 1e9)  # size over the noise


def interval(k: int, n: int) -> tuple[float, float]:
    """Clopper and Pearson's 95 % interval of a share, k of n (Biometrika 26, 1934)."""
    found = binomtest(k, n).proportion_ci(0.95, method="exact")
    return float(found.low), float(found.high)


def share(k: int, n: int) -> str:
    if n == 0:
        return "none tried"
    low, high = interval(k, n)
    return f"{k:3d} of {n:3d}  {100 * k / n:5.1f} %  [{100 * low:.1f}, {100 * high:.1f}]"


def of(results: Sequence[dict], kind: str) -> list[dict]:
    return [r for r in results if r["spec"]["of"] == kind]


def count(results: Sequence[dict], holds: Callable[[dict], object]) -> str:
    return share(sum(bool(holds(r)) for r in results), len(results))


def mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else float("nan")


def faint(r: dict) -> bool:
    """Whether something that is missing could not be made as large as is asked for on any machine that was drawn.

    Coarse encoders see little of a joint. Such a campaign is counted in a line of its own.
    """
    return any(size < WEAKEST * SIZES[0] for size in r["truth"]["sizes"])


def reduction(r: dict) -> float:
    """Return the share of the achievable reduction of the validation error, whatever was named."""
    before, after = (r["said"][k]["validation"] for k in ("before", "after"))
    achievable = before - r["truth"]["floor"]["validation"]
    return min((before - after) / achievable, 1.0) if achievable > 0.0 else 0.0


def shares(results: Sequence[dict]) -> list[str]:
    single, pair, none, own = (of(results, kind) for kind in (SINGLE, PAIR, NONE, OUTSIDE))
    weak = [r for r in (*single, *pair) if faint(r)]
    single, pair = ([r for r in group if not faint(r)] for group in (single, pair))
    known = [*single, *pair]
    placed = [r for r in own if r["truth"]["where"][1]]
    j = lambda name: lambda r: r["judged"][name]  # noqa: E731
    said = lambda verdict: lambda r: r["said"]["verdict"] == verdict  # noqa: E731
    seconds = [r["said"]["seconds"] for r in results]
    return [
        f"{len(results)} campaigns, of which {len(single)} lack one effect, {len(pair)} two, {len(weak)} less than was asked for, "
        f"{len(none)} nothing, and {len(own)} something outside the catalogue. Intervals are Clopper and Pearson's, 95 %.",
        "",
        f"  one missing: named first        {count(single, j('first'))}",
        f"               added              {count(single, j('both'))}",
        f"               first or its rival {count(single, j('rival'))}",
        f"  two missing: one of them first  {count(pair, j('first'))}",
        f"               both added         {count(pair, j('both'))}",
        f"  smaller than asked: named first {count(weak, j('first'))}",
        f"  no effect found where one is    {count(known, said('nothing_missing'))}",
        f"  'unknown' where one is          {count(known, said('unknown'))}",
        f"  nothing missing: false alarms   {count(none, j('alarm'))}",
        f"  outside: 'unknown'              {count(own, j('unknown'))}",
        f"           place or time right    {count(placed, lambda r: r['judged']['unknown'] and r['judged']['place'])}",
        f"  validation error made worse     {count(results, j('worse'))}",
        f"  spurious additions              {sum(r['judged']['spurious'] for r in results):3d}",
        f"  mean share of the achievable reduction  {mean([r['judged']['share'] for r in known]):.3f}, none where the name is "
        f"wrong; {mean([reduction(r) for r in known]):.3f} whatever the name",
        f"  CPU seconds a campaign: mean {mean(seconds):.1f}, largest {max(seconds, default=0.0):.1f}; "
        f"largest memory {max((r['said']['megabytes'] for r in results), default=0.0):.0f} MB",
    ]


def peers(results: Sequence[dict]) -> list[str]:
    """The same counts for the peers. Neither ever says "unknown"; on nothing missing, anything picked is a false alarm."""
    names = list(dict.fromkeys(name for r in results for name in r["said"]["peers"]))
    lines = [
        "",
        "on the same residuals:    one missing, named first            pairs, both            none, false alarms   spurious",
    ]
    for name in names:
        said = [(r, r["said"]["peers"][name]) for r in results if name in r["said"]["peers"] and not faint(r)]
        single = [picked[:1] == r["truth"]["missing"] for r, picked in said if r["spec"]["of"] == SINGLE]
        pair = [set(r["truth"]["missing"]) <= set(picked) for r, picked in said if r["spec"]["of"] == PAIR]
        none = [bool(picked) for r, picked in said if r["spec"]["of"] == NONE]
        wrong = sum(len(set(picked) - set(r["truth"]["missing"])) for r, picked in said)
        counted = "   ".join(share(sum(x), len(x)) for x in (single, pair, none))
        lines.append(f"  {name:14}{counted}   {wrong:4d}")
    return lines


def power(results: Sequence[dict]) -> list[str]:
    """Share named first against the size of what is missing over the noise."""
    lines = ["", "share named first, against size over noise (one missing):"]
    for low, high in zip(BINS, BINS[1:], strict=False):
        inside = [r for r in of(results, SINGLE) if low <= r["truth"]["sizes"][0] < high]
        if inside:
            to = f"{high:g}" if high < 1e9 else "more"
            lines.append(f"  {low:4g} to {to:<5} {count(inside, lambda r: r['judged']['first'])}")
    return lines


def confusion(results: Sequence[dict]) -> list[str]:
    """What was named for each thing that was missing alone; a name is the first that was added."""
    named: dict[str, Counter] = defaultdict(Counter)
    for r in [*of(results, SINGLE), *of(results, NONE), *of(results, OUTSIDE)]:
        what = r["truth"]["effects"][0] if r["truth"]["effects"] else "(nothing)"
        said = r["said"]
        named[what][said["added"][0] if said["added"] else said["verdict"]] += 1
    lines = ["", "missing, and what was added first (or the verdict):"]
    for what in sorted(named):
        lines.append(f"  {what:36}" + ", ".join(f"{name} {n}" for name, n in named[what].most_common()))
    return lines


def right(r: dict) -> bool:
    j, kind = r["judged"], r["spec"]["of"]
    clean = not j["spurious"]
    if kind == NONE:
        return not j["alarm"]
    if kind == OUTSIDE:
        return j["unknown"] and clean and j["place"] is not False
    return j["first"] and j["both"] and clean


def failures(results: Sequence[dict]) -> list[str]:
    """One line a campaign that is not right in all: what it lacks, how large, what was said, and how to make it again."""
    lines = [
        "",
        "not right in all (spec by its key: python -m benchmarks.trace --again KEY makes and traces it again):",
    ]
    for r in sorted(results, key=lambda r: (r["spec"]["of"], r["truth"]["effects"])):
        if right(r):
            continue
        s, said, j = r["spec"], r["said"], r["judged"]
        sizes = "+".join(
            f"{name} {size:.1f}" for name, size in zip(r["truth"]["effects"], r["truth"]["sizes"], strict=True)
        )
        lines.append(
            f"  {r['key']} {s['of']:8}{sizes or '(nothing)':50} -> {said['verdict']:16}first {said['ranked'][0]:28}"
            f"added {'+'.join(said['added']) or '-'}"
        )
        rms = [said[k]["identification"] / r["truth"]["floor"]["identification"] for k in ("before", "after")]
        place = (
            f" said {said['unknown']} true {r['truth']['where'][0]} {r['truth']['where'][1][:2]}"
            if j["place"] is False
            else ""
        )
        lines.append(
            f"      {s['base']}, {s['rate']} Hz, count {s['count']:.1e}, noise {s['noise']:.1e} memory {s['memory']:.3f}, band "
            f"{s['band']:g}; id/floor {rms[0]:.2f} -> {rms[1]:.2f} (stated floor "
            f"{said['floor']['identification'] / r['truth']['floor']['identification']:.2f}); gains {said['gains'][:3]}{place}"
        )
    return lines


def table(results: Sequence[dict]) -> str:
    return "\n".join([*shares(results), *peers(results), *power(results), *confusion(results), *failures(results)])
