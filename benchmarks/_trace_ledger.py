"""The ledger of a run, as a table in Markdown: a row a family, counts with exact 95 % intervals, and what was wrong."""

from collections.abc import Callable, Sequence
from statistics import median

from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE
from benchmarks._trace_table import interval

COLUMNS = (
    "family", "campaigns", "first cause right", "pairs whole", "a false cause", "false alarm", "false 'nothing'", "unknown right",
    "place right", "mean share", "made worse", "fixed value moved", "below the floor", "no trace",
)  # fmt: skip


def share(k: int, n: int) -> str:
    """k of n with Clopper and Pearson's interval, in per cent."""
    if n == 0:
        return "-"
    low, high = interval(k, n)
    return f"{k}/{n} [{100 * low:.0f}, {100 * high:.0f}]"


def count(rows: Sequence[dict], holds: Callable[[dict], object], of: Sequence[str]) -> str:
    asked = [r["judged"] for r in rows if r["judged"]["of"] in of]
    return share(sum(bool(holds(j)) for j in asked), len(asked))


def row(family: str, results: Sequence[dict]) -> list[str]:
    rows, failed = [r for r in results if "judged" in r], [r for r in results if "failed" in r]
    known, every = (SINGLE, PAIR), (SINGLE, PAIR, NONE, OUTSIDE)
    shares = [r["judged"]["share"] for r in rows if r["judged"].get("share") is not None]
    asked = [r["judged"] for r in rows if r["judged"]["of"] == OUTSIDE and r["judged"]["place"] is not None]
    return [
        family, str(len(results)), count(rows, lambda j: j["first"], known), count(rows, lambda j: j["both"], (PAIR,)),
        count(rows, lambda j: j["false"], every), count(rows, lambda j: j["alarm"], (NONE,)),
        count(rows, lambda j: j["nothing"], (SINGLE, PAIR, OUTSIDE)), count(rows, lambda j: j["unknown"], (OUTSIDE,)),
        share(sum(bool(j["place"]) for j in asked), len(asked)), f"{sum(shares) / len(shares):.3f}" if shares else "-",
        count(rows, lambda j: j["worse"], every), count(rows, lambda j: j["moved"], every), count(rows, lambda j: j["below"], every),
        share(len(failed), len(results)),
    ]  # fmt: skip


def markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows)]


def families(results: Sequence[dict]) -> dict[str, list[dict]]:
    found: dict[str, list[dict]] = {}
    for r in results:
        found.setdefault(r["family"], []).append(r)
    return found


def peers(results: Sequence[dict]) -> list[str]:
    """The same residuals, given to the peers. Neither ever says "unknown"."""
    rows = []
    for family, of in families([r for r in results if "judged" in r and r["family"] != "measured"]).items():
        for name in dict.fromkeys(n for r in of for n in r["said"]["peers"]):
            asked = [
                (r["judged"]["of"], r["truth"]["missing"], r["said"]["peers"][name])
                for r in of
                if name in r["said"]["peers"]
            ]
            known = [
                picked[:1] != [] and picked[0] in missing for kind, missing, picked in asked if kind in (SINGLE, PAIR)
            ]
            pairs = [set(missing) <= set(picked) for kind, missing, picked in asked if kind == PAIR]
            none = [bool(picked) for kind, _, picked in asked if kind == NONE]
            false = [bool(set(picked) - set(missing)) for _, missing, picked in asked]
            rows.append([family, name, *(share(sum(x), len(x)) for x in (known, pairs, none, false))])
    head = ("family", "peer", "first cause right", "pairs whole", "false alarm", "a false cause")
    return ["", *markdown(head, rows)] if rows else []


def costs(results: Sequence[dict]) -> list[str]:
    """CPU seconds and memory of a trace, over all that were traced."""
    said = [r["said"] for r in results if "judged" in r]
    if not said:
        return []
    seconds, memory = [s["seconds"] for s in said], [s["megabytes"] for s in said]
    return [
        "",
        f"A trace takes {median(seconds):.1f} s of CPU in the median, {max(seconds):.1f} at most, and {max(memory):.0f} MB at most.",
    ]


def axes(results: Sequence[dict]) -> list[str]:
    """Measured axes, one by one."""
    rows = [
        [
            r["name"],
            "yes" if r["judged"]["right"] else "no",
            r["said"]["verdict"],
            ", ".join(r["said"]["added"]) or "-",
            r["judged"]["wrong"] or "-",
        ]
        for r in results
        if r["family"] == "measured" and "judged" in r
    ]
    return ["", *markdown(("axis", "right", "verdict", "added", "what is wrong"), rows)] if rows else []


def wrong(results: Sequence[dict]) -> list[str]:
    """One line a campaign that is not right in all."""
    said = []
    for r in results:
        if "failed" in r:
            said.append(f"- {r['family']} {r['name']}: no trace. {r['failed']}")
            continue
        j, s = r["judged"], r["said"]
        if j["of"] == "measured":
            continue
        right = {NONE: not j["alarm"], OUTSIDE: j["unknown"] and not j["false"]}.get(
            j["of"], j["first"] and j["both"] and not j["false"]
        )
        if right and not j["moved"] and not j["worse"]:
            continue
        lacks = "+".join(r["truth"]["missing"]) or "nothing"
        law = ", ".join(r["truth"].get("laws", ()))
        line = f"- {r['family']} {r['name']} lacks {lacks}{f' ({law})' if law else ''}: {s['verdict']}, first {s['ranked'][:1]}, added {s['added']}"
        said.append(line + (f", moved {j['moved']}" if j["moved"] else "") + (", made worse" if j["worse"] else ""))
    return ["", "Not right in all:", "", *said] if said else []


def ledger(results: Sequence[dict]) -> str:
    """The whole of a run in Markdown."""
    rows = [row(f, of) for f, of in families(results).items() if f != "measured"]
    table = markdown(COLUMNS, rows) if rows else []
    measured = [r for r in results if r["family"] == "measured"]
    if measured:
        good = sum("judged" in r and r["judged"]["right"] for r in measured)
        table += ["", f"Measured axes right: {share(good, len(measured))}."]
    return "\n".join([*table, *axes(results), *costs(results), *peers(results), *wrong(results)])
