"""What halving and doubling each criterion does: stored evidence decided again, without a simulation.

Expected: `workbench.tracing.criteria.Criteria`, a frozen dataclass whose fields have defaults, and
`workbench.tracing.decide.decide(evidence, criteria)`, a pure function whose answer has `verdict`, `ranked` and `added`.
Evidence is what trace.json holds under `evidence`.
"""

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from typing import get_type_hints

from benchmarks._trace_draw import NONE, OUTSIDE, PAIR, SINGLE
from benchmarks._trace_families import judged
from benchmarks._trace_ledger import families, markdown, share

FACTORS = (0.5, 2.0)


class NotYet(Exception):
    """What a sweep needs is not there."""


def interface() -> tuple[type, Callable]:
    """Return Criteria and decide; NotYet where this version has none."""
    try:
        from workbench.tracing.criteria import Criteria
        from workbench.tracing.decide import decide
    except ImportError as e:
        raise NotYet(f"this version of the trace has no criteria that could be swept ({e}).") from e
    return Criteria, decide


def restored(decide: Callable, stored: object) -> object:
    """Evidence as `decide` takes it, from what a trace stored."""
    import msgspec

    wanted = get_type_hints(decide).get("evidence")
    return stored if wanted is None or wanted is dict else msgspec.convert(stored, wanted)


def varied(criteria: object) -> Iterator[tuple[str, float, object]]:
    """(field, factor, criteria) with one number halved or doubled; whole numbers stay whole and above zero."""
    for f in dataclasses.fields(criteria):
        value = getattr(criteria, f.name)
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        for factor in FACTORS:
            other = max(1, round(value * factor)) if isinstance(value, int) else value * factor
            yield f.name, factor, dataclasses.replace(criteria, **{f.name: other})


def name(x: object) -> str:
    """The effect's name of a name, or of what has one."""
    return str(getattr(x, "effect", x)).partition(" ")[0]


def again(result: dict, decide: Callable, criteria: object) -> dict:
    """A result judged by what is decided with these criteria; errors are those of the first decision."""
    found = decide(restored(decide, result["said"]["evidence"]), criteria)
    said = result["said"] | {
        "verdict": found.verdict, "ranked": [name(x) for x in found.ranked], "added": [name(x) for x in found.added],
    }  # fmt: skip
    return result | {"said": said, "judged": judged(result["truth"], said, result["judged"]["place"])}


def figures(results: Sequence[dict]) -> list[str]:
    j = [r["judged"] for r in results]
    known, none = [x for x in j if x["of"] in (SINGLE, PAIR)], [x for x in j if x["of"] == NONE]
    own, some = [x for x in j if x["of"] == OUTSIDE], [x for x in j if x["of"] != NONE]
    counted = (
        (known, "first"), (j, "false"), (none, "alarm"), (some, "nothing"), (own, "unknown"),
    )  # fmt: skip
    return [share(sum(bool(x[key]) for x in asked), len(asked)) for asked, key in counted]


def sweep(results: Sequence[dict]) -> str:
    """A row a criterion, a factor and a family, with how many verdicts changed. Where there is nothing to sweep, a sentence."""
    try:
        kind, decide = interface()
    except NotYet as e:
        return f"No sweep: {e}"
    usable = [
        r for r in results if "judged" in r and r["family"] != "measured" and r["said"].get("evidence") is not None
    ]
    if not usable:
        return "No sweep: no kept result holds evidence; run the campaigns once with this version."
    rows = []
    for field, factor, criteria in [("(as it is)", 1.0, kind()), *varied(kind())]:
        for family, of in families(usable).items():
            now = [again(r, decide, criteria) for r in of]
            changed = sum(
                (a["said"]["verdict"], a["said"]["added"]) != (b["said"]["verdict"], b["said"]["added"])
                for a, b in zip(of, now, strict=True)
            )
            rows.append([field, f"{factor:g}", family, str(changed), *figures(now)])
    head = (
        "criterion",
        "times",
        "family",
        "answers changed",
        "first cause right",
        "a false cause",
        "false alarm",
        "false 'nothing'",
        "unknown right",
    )
    return "\n".join(markdown(head, rows))
