"""What each rule of the trace buys: campaigns traced again without it, and what is then said held against the truth.

A rule is a function that may make a trace say something else than it would without it. What stands for it says what its lack is:
its argument as it came, or no answer. A rule says something on a campaign where its answer is not that of what stands for it; there,
and nowhere else, the campaign is traced again without it.
"""

import importlib
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from benchmarks._trace_private import said

TRUTH = "truth.json"  # beside the campaigns of a family


def _as_it_came(x, *_, **__):
    return x


def _second(_, x, *__, **___):
    return x


def _first_of(x, *_, **__):
    return x[0]


def _always(answer) -> Callable:
    return lambda *_, **__: answer


_NONE, _NO, _NOTHING = _always(None), _always(False), _always(0.0)

RULES: dict[str, Callable] = {
    # what is asked before the search
    "mending.mended": _NONE,
    "slow_log.slow_log": _NONE,
    "sticking.sticking": _NONE,
    "skew.skew_of": _NONE,
    "smooth_turn.smooth_turn": _NONE,
    # how a candidate is held against others
    "starting.at_own_starts": _as_it_came,
    "scale_of_joint.beside": lambda present, problem, solution, errors: (errors, solution.cost),
    "near_law.lengthened": _as_it_came,
    "discs.on_the_motor": _NONE,
    "discs.of_the_disc": _always(""),
    "discs.on_the_shaft": _always(""),
    "discs.once_a_turn": _NO,
    "discs.behind_the_gear": _NO,
    # the order of a round
    "one_sided.one_sided": _as_it_came,
    "one_sided.asked_freely": lambda best, judgements: [best],
    "ranking.absurd": _NO,
    "ranking._sound": _first_of,
    "ranking._of_less": _first_of,
    "ranking._plainest_first": _as_it_came,
    "orders.stranger": _NO,
    "orders.any_curve": _NO,
    "reducing.reduced_to": _NONE,
    # what is added in a round
    "greedy.promised": _NONE,
    "greedy.spent": _NO,
    "free_law.steadier": _NONE,
    "free_law.otherwise_spelled": _NONE,
    "free_law._curve_of": _NONE,
    "free_law._beside_curve": _NO,
    "spellings.better_spelled": _NONE,
    "spellings.commoner": _NONE,
    "spellings.no_wave": _second,
    "spellings.as_of_a_spring": _as_it_came,
    "spellings.special_cases": lambda j: set(),
    "waves.two_say_it": _NO,
    # what becomes of an answer
    "pruning.pruned": _as_it_came,
    "pruning._alone": _NONE,
    "pruning._named_after": _as_it_came,
    "judge.still_earns": _always(True),
    "slack.bent_gap": _NO,
    "composing.composed": _as_it_came,
    "composing.decomposed": _as_it_came,
    "composing.of_one_disc": _as_it_came,
    "composing.of_the_axis": _as_it_came,
    # what whole records bear out
    "by_validation.by_validation": _as_it_came,
    "sound.soundly": _as_it_came,
    "otherwise.otherwise": _as_it_came,
    "otherwise.as_a_curve": _as_it_came,
    "otherwise.in_place_of_two": _as_it_came,
    "further.foretold": _second,
    "in_turn.later": lambda added, verdict: [],
    "weighing.as_they_end": lambda added, *_: list(added),
    "weighing._phased": _as_it_came,
    # the decision
    "unexplained.traded": _NONE,
    "unexplained.instead": _NONE,
    "unexplained._say_more": _NONE,
    "neighbours.gain_over_time": _NOTHING,
    "neighbours.payload_over_time": _NOTHING,
    "explainable._over_place": _NOTHING,
    "decide._but_near_laws": _second,
    "decide._lost_most": _NO,
    "decide._lesser": _second,
    "dressing.less_than_places": _NO,
    "dressing.changes": _NO,
}


def rule(name: str) -> Callable:
    """Return the function of a rule, "module.function"."""
    module, _, function = name.partition(".")
    return getattr(importlib.import_module(f"workbench.tracing.{module}"), function)


@contextmanager
def in_its_place(function: Callable, other: Callable) -> Iterator[None]:
    """While it lasts, another function stands for this one wherever it was imported to."""
    modules = [m for key, m in sys.modules.items() if key.startswith("workbench.")]
    held = [(m, name) for m in modules for name, x in list(vars(m).items()) if x is function]
    try:
        for m, name in held:
            setattr(m, name, other)
        yield
    finally:
        for m, name in held:
            setattr(m, name, function)


@contextmanager
def listening() -> Iterator[set[str]]:
    """While it lasts, the rules that say something are noted."""
    heard: set[str] = set()

    def asked(name: str, function: Callable, without: Callable) -> Callable:
        def call(*given, **named):
            answer = function(*given, **named)
            if name not in heard and not same(answer, without(*given, **named)):
                heard.add(name)
            return answer

        return call

    with ExitStack() as held:
        for name, without in RULES.items():
            held.enter_context(in_its_place(rule(name), asked(name, rule(name), without)))
        yield heard


def same(one: object, other: object) -> bool:
    """Whether two answers are one: the same object, or additions as they were weighed, lists and values that are."""
    weighed = [getattr(x, "weighed", None) for x in (one, other)]
    if None not in weighed and not same(*map(list, weighed)):
        return False
    one, other = (getattr(x, "added", x) if not isinstance(x, str) else x for x in (one, other))
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    plain = isinstance(one, str | bool | int | float | set) and isinstance(other, str | bool | int | float | set)
    return one is other or (plain and one == other)


def right(truth: dict | None, verdict: str, added: Sequence[str]) -> bool | None:
    """Whether a verdict is right with all that was added; None where nobody knows."""
    if truth is None:
        return None
    missing = truth["missing"]
    if missing == ["unknown"]:
        return verdict == "unknown" and not added
    return set(added) == set(missing) if missing else verdict == "nothing_missing"


def sweep(folders: Sequence[Path]) -> Iterator[dict]:
    """A row a campaign and rule that says something there: what is said without it, and whether either is right."""
    for folder in folders:
        file = folder.parent / TRUTH
        truth = json.loads(file.read_text(encoding="utf-8")).get(folder.name) if file.is_file() else None
        with listening() as heard:
            base = said(folder)
        for name in sorted(heard):
            with in_its_place(rule(name), RULES[name]):
                try:
                    other = said(folder)
                except Exception as wrong:  # what comes of its lack is a result, too
                    other = (type(wrong).__name__, (), ())
            rights = {"right": right(truth, *base[:2]), "right without": right(truth, *other[:2])}
            yield {"campaign": folder.name, "rule": name, "says": base, "without": other} | rights


def main(folders: Sequence[Path]) -> None:
    """Print every row in which the lack of a rule says something else, and last what each rule buys."""
    rows: dict[str, list[dict]] = {name: [] for name in RULES}
    for row in sweep(folders):
        rows[row["rule"]].append(row)
        if row["says"] != row["without"]:
            print(json.dumps(row), flush=True)
    print("\n| rule | says something | decides | right by it | wrong by it |\n|---|---|---|---|---|")
    for name, found in rows.items():
        other = [r for r in found if r["says"] != r["without"]]
        by, against = (sum(r["right"] is a and r["right without"] is not a for r in other) for a in (True, False))
        print(f"| `{name}` | {len(found)} | {len(other)} | {by} | {against} |")
