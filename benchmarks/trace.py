"""Traces of campaigns whose answers are known, family by family, beside two peers on the same residuals.

`make bench-trace` (or python -m benchmarks.trace --help) prints the ledger of all families as Markdown; `--details` the table
of the rig's older campaigns, with confusion and power; `--sweep` what halving and doubling each criterion does. What is done
is kept, by the sources' digest, and not done again. `make bench` runs a few, with short records.
"""

import argparse
import json
import multiprocessing
import os
import sys
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path

from benchmarks._trace_draw import Spec, specs
from benchmarks._trace_families import FAMILIES, Case, cases, known
from workbench.campaign import FILE as CAMPAIGN

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "reports" / "bench_trace"
FEW, MANY, SEED, WORKERS = 8, 200, 1, 2
MASSES = {"any": None, "one": False, "two": True}


def sources() -> str:
    """Digest of what results depend on: the package, the rig, and how a campaign is judged."""
    paths = [p for part in ("workbench", "tests/rig") for p in sorted((ROOT / part).rglob("*.py"))]
    paths += [ROOT / "benchmarks" / f"_trace_{part}.py" for part in ("families", "measured", "peers", "run")]
    return sha256(b"".join(p.read_bytes() for p in paths)).hexdigest()[:10]


def attempt(spec: Spec) -> dict:
    """One campaign; a failure of ours is a result too."""
    from benchmarks._trace_run import one

    try:
        return one(spec)
    except Exception as wrong:  # the sweep goes on, and says so at its end
        return {"key": spec.key, "failed": f"{spec.missing} on {spec.base}: {type(wrong).__name__}: {wrong}"}


def read(kept: Path) -> dict[str, dict]:
    """Return key -> result of what is kept; a line that a kill cut short is passed over."""
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.is_file() else []
    return {r["key"]: r for r in map(json.loads, filter(lambda line: line.endswith("}}"), lines))}


def every_family(case: Case) -> dict:
    """One campaign of any family."""
    from benchmarks._trace_families import one

    return one(case)


def sweep(wanted: list, kept: Path, workers: int = WORKERS, work: Callable[..., dict] = attempt) -> list[dict]:
    """Return the results of all, in their order; each is appended to `kept` as soon as it is there."""
    kept.parent.mkdir(parents=True, exist_ok=True)
    done = read(kept)
    left = [s for s in wanted if s.key not in done]
    context = multiprocessing.get_context("spawn")
    many = min(workers, max(len(left), 1))
    # a process a campaign: the peak of its memory is that campaign's own
    with kept.open("a", encoding="utf-8") as file, context.Pool(many, maxtasksperchild=1) as pool:
        file.write("\n")
        for number, result in enumerate(pool.imap_unordered(work, left, chunksize=1), 1):
            done[result["key"]] = result
            if "failed" not in result:
                file.write(json.dumps(result) + "\n")
                file.flush()
            print(f"\r{number} of {len(left)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return [done[s.key] for s in wanted]


def main(
    campaigns: int = FEW, seed: int = SEED, two_mass: bool | None = None, short: bool = True, run: bool = True
) -> None:
    """Print what a sweep comes to; run: false prints what is kept of it."""
    from benchmarks._trace_table import table

    os.environ.setdefault("OMP_NUM_THREADS", "1")
    workers = int(os.environ.get("WORKERS", WORKERS))
    wanted, kept = specs(campaigns, seed, two_mass, short), KEPT / f"{sources()}.jsonl"
    done = read(kept)
    results = sweep(wanted, kept, workers) if run else [done[s.key] for s in wanted if s.key in done]
    print(table([r for r in results if "failed" not in r]))
    for r in results:
        if "failed" in r:
            print(f"  failed: {r['key']} {r['failed']}")


def by_family(
    families: Sequence[str],
    campaigns: int,
    seed: int,
    run: bool = True,
    swept: bool = False,
    workers: int | None = None,
) -> None:
    """Print the ledger of these families; swept: what halving and doubling each criterion does to it."""
    from benchmarks._trace_ledger import ledger
    from benchmarks._trace_sweep import sweep as sweep_of

    os.environ.setdefault("OMP_NUM_THREADS", "1")
    wanted, kept = cases(families, campaigns, seed), KEPT / f"{sources()}.families"
    for family in families:
        if not any(c.family == family for c in wanted):
            print(f"Family '{family}' is not here: set WORKBENCH_DATA.")
    done = read(kept)
    workers = workers or int(os.environ.get("WORKERS", WORKERS))
    results = sweep(wanted, kept, workers, every_family) if run else [done[c.key] for c in wanted if c.key in done]
    print(
        f"Drawn families: {campaigns} campaigns of seed {seed}. Counts with Clopper and Pearson's 95 % intervals, in per cent."
    )
    print(f"\n{sweep_of(results) if swept else ledger(results)}")


def again(key: str) -> None:
    """Do one campaign of the kept results once more, and print all that is known of it."""
    from benchmarks._trace_run import one

    for file in KEPT.glob("*.families"):
        if r := read(file).get(key):
            print(json.dumps(every_family(Case(r["family"], r["name"], tuple((k, v) for k, v in r["spec"]))), indent=1))
            return
    for file in KEPT.glob("*.jsonl"):
        if r := read(file).get(key):
            print(json.dumps(one(Spec(**{**r["spec"], "missing": tuple(r["spec"]["missing"])})), indent=1))
            return
    sys.exit(f"bench-trace: no kept campaign has the key '{key}'.")


def folder(given: str) -> Path:
    """Return a campaign's folder: as it is named, or below WORKBENCH_DATA. Ends the program where there is none."""
    data = os.environ.get("WORKBENCH_DATA")
    places = [Path(given), *([Path(data, given)] if data else [])]
    found = next((p for p in places if (p / CAMPAIGN).is_file()), None)
    if found is None:
        beside = f", nor does {places[1]}" if data else "; if it is measured data, set WORKBENCH_DATA"
        sys.exit(f"bench-trace: '{given}' holds no {CAMPAIGN}{beside}.")
    return found


def asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="bench-trace", description=__doc__.split("\n")[0])
    parser.add_argument(
        "--families",
        default=",".join(FAMILIES),
        help="which, with commas between; X, too, of a folder campaigns_X, and X:half, X:noise, X:swapped, X:less, X:wrong, its copies (%(default)s)",
    )
    parser.add_argument("--campaigns", type=int, default=MANY, help="how many of a family that is drawn (%(default)s)")
    parser.add_argument("--seed", type=int, default=SEED, help="of what is drawn (%(default)s)")
    parser.add_argument(
        "--sweep", action="store_true", help="halve and double each criterion, on the evidence that is kept"
    )
    parser.add_argument(
        "--details", action="store_true", help="the rig's older campaigns alone, with confusion and power"
    )
    parser.add_argument(
        "--masses", choices=MASSES, default="any", help="details: machines of one mass, of two, or both"
    )
    parser.add_argument("--short", action="store_true", help="details: records of a third of the length")
    parser.add_argument("--kept", action="store_true", help="run nothing: the table of what is kept")
    parser.add_argument(
        "--private", nargs="+", metavar="FOLDER",
        help="halve and double every private number of the trace on these campaigns, one row each (a minute and more a campaign)",
    )  # fmt: skip
    parser.add_argument(
        "--rules", nargs="+", metavar="FOLDER",
        help="leave out each rule that says something on these campaigns, and hold what is then said against their truth.json",
    )  # fmt: skip
    parser.add_argument("--again", metavar="KEY", help="do one campaign of the kept results once more, and print it")
    given = parser.parse_args()
    given.families = given.families.split(",")
    if unknown := [f for f in given.families if not known(f)]:
        parser.error(f"there is no family '{unknown[0]}', nor a folder for it; known: {', '.join(FAMILIES)}.")
    return given


if __name__ == "__main__":
    given = asked()
    if given.again:
        again(given.again)
    elif given.private:
        from benchmarks._trace_private import main as private

        private([folder(x) for x in given.private])
    elif given.rules:
        from benchmarks._trace_rules import main as rules

        rules([folder(x) for x in given.rules])
    elif given.details:
        main(given.campaigns, given.seed, MASSES[given.masses], given.short, not given.kept)
    else:
        by_family(given.families, given.campaigns, given.seed, not given.kept, given.sweep)
