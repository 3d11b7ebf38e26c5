"""Bad inputs, generated: mutated campaigns, records, studies, worst cases, gains and command lines, each through the command line.

A case is a seed: `python tests/fuzz.py 10000` runs that many, `python tests/fuzz.py --case K` one again, with all that it says.
Nothing of it may end in a traceback, take longer than LONGEST, or change a file outside of the output folder.
"""

import contextlib
import gzip
import hashlib
import io
import json
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from random import Random

import numpy as np

LONGEST = 10  # s of this process: how much else a machine does is no fault of a case
BLOCKED = 300  # s on the clock: of a case that waits for something
MEMORY = 6 << 30  # bytes: what asks for more is to say so, not to be killed
OUT = "out"
NUMBERS = ["0", "-1", "1e308", "-1e308", "1e-308", "5e-324", "1e200", "1e15", "nan", "inf", "-inf", "1" * 400, "true", "[]", "{}", '""',
           '"x"', "[1, 2]", "0x10", "1_0", "-0.0", "1979-05-27", "1e6", "0.5", "3"]  # fmt: skip
TEXTS = ["", "x" * 300, "\\u0000", "../../etc/passwd", "/dev/zero", "é", "🙂", "a\\nb", "%s%n", "NaN", "N*m", "rad", "s", "1/s", "kg^9999", "m**m",
         ".", "..", "campaign.toml", "a.csv", "<script>", "#import", "rad" * 200, "1e308*m"]  # fmt: skip
LEAVES = [
    None,
    True,
    "x",
    "",
    [],
    {},
    [1],
    -1,
    0,
    1e308,
    -1e308,
    1e15,
    10**400,
    float("nan"),
    float("inf"),
    "inf",
    "nan",
    1e-300,
    "x" * 300,
]

CAMPAIGN = """title = "fuzzed"
plant = "one mass"
evaluation_bandwidth = { value = 60, unit = "Hz" }
actuator_limit = { value = 3.0, unit = "N*m" }
[channels]
time = { column = "t", unit = "s" }
torque = { column = "u", unit = "A", scale = { value = 2.0, unit = "N*m/A" } }
position = { column = "q", unit = "rad", resolution = 1e-5 }
[[effects]]
effect = "inertia"
at = "axis"
parameters.inertia = { value = 0.05, unit = "kg*m^2", fixed = false }
[[effects]]
effect = "presliding_hysteresis"
at = "axis"
[[effects]]
effect = "viscous_friction"
at = "axis"
[[records]]
file = "a.csv"
role = "identification"
motion = "sines"
start_time_s = 0.0
[[records]]
file = "b.csv"
role = "validation"
until = { value = 1.9, unit = "s" }
"""
STUDY = """title = "fuzzed"
campaign = "campaign"
question = "What is missing?"
[loop]
sample_time = { value = 1.0, unit = "ms" }
resolution = { value = 1e-5, unit = "rad" }
[tuning]
lowest = { value = 1e-4, unit = "rad" }
highest = { value = 1.0, unit = "rad" }
count = 24
[task]
step = { value = 0.5, unit = "rad" }
duration = { value = 0.5, unit = "s" }
loads = { values = [0.0, 0.1], unit = "kg*m^2" }
[schedule]
rule = "error"
[describe]
lowest = 1e-5
highest = 1.0
count = 5
[rig]
speed = { value = 1.0, unit = "rad/s" }
[requirements]
verdict = { equals = "cause" }
validation_error_after = { at_most = 0.1 }
"""
STEPS = """from workbench.study import standard
FURTHER = ("rig",)
LIMIT = 3.0


def run(study, say):
    say("running")
    speed = study.table.table("rig", ("speed",)).quantity("speed", "rad/s", above=0.0)
    return standard.run(study, say)
"""
WORDS = ["check", "run", "trace", "new", "plan", "response", "diff", "replay", "verify", "effects", "--out", "--records", "--channel", "--case",
         "--draws", "--no-close", "--resample", "--accuracy", "--separate", "--record", "--firmware", "--controller", "--if-data", "-h", "--version",
         "campaign", "study", OUT, "a.csv", "worst.json", "", "-1", "0", "1e308", "nan", "x" * 300, "\0", "🙂", "/", ".", "..", "/dev/null", "drive=u", "=",
         "position=", "gravity", "inertia", "stribek_friction", "[*]", "~", "$HOME", "\n"]  # fmt: skip


@dataclass
class Bench:
    """A folder with sound inputs, from which every case starts; `fresh` copies it."""

    place: Path

    def fresh(self, to: Path) -> Path:
        shutil.copytree(self.place, to)
        return to


def made(place: Path) -> Bench:
    """Write the sound inputs: a campaign of 2 s, its records in four formats, a study, worst cases, gains."""
    (place / "study" / "campaign").mkdir(parents=True)
    folder = place / "study" / "campaign"
    (folder / "campaign.toml").write_text(CAMPAIGN)
    t = np.arange(2000) * 1e-3
    for name, phase in (("a", 0.0), ("b", 1.0)):
        w = 2 * np.pi * np.array([1.0, 3.0, 7.0])[:, None]
        q, v, a = (
            np.sum(np.array([[0.5], [0.1], [0.03]]) * w**d * np.sin(w * t + phase + d * np.pi / 2), axis=0)
            for d in range(3)
        )
        u = (0.05 * a + 0.1 * v + 0.3 * np.tanh(v / 0.01)) / 2.0
        table = np.column_stack([t, u, 1e-5 * np.floor(q / 1e-5)])
        np.savetxt(folder / f"{name}.csv", table, "%.7g", ",", header="t,u,q", comments="")
    shutil.copytree(folder, place / "campaign")
    shutil.copy(folder / "a.csv", place / "a.csv")
    (place / "study" / "study.toml").write_text(STUDY)
    (place / "study" / "study.py").write_text(STEPS)
    formats(place, t, table)
    (place / "worst.json").write_text(worst_cases())
    gains(place)
    with contextlib.redirect_stdout(io.StringIO()):  # kernels are compiled here, and not within a case
        for arguments in (["check", str(place / "campaign")], ["replay", str(place / "worst.json")]):
            assert command(arguments) in (0, 1), arguments
    return Bench(place)


def formats(place: Path, t: np.ndarray, table: np.ndarray) -> None:
    """Write the same record in other formats."""
    import scipy.io

    (place / "a.csv.gz").write_bytes(gzip.compress((place / "a.csv").read_bytes(), 1))
    scipy.io.savemat(place / "a.mat", {"t": t, "u": table[:, 1], "q": table[:, 2]})
    with contextlib.suppress(ImportError):
        from nptdms import ChannelObject, TdmsWriter

        with TdmsWriter(place / "a.tdms") as f:
            f.write_segment([ChannelObject("log", n, table[:, k].copy()) for k, n in enumerate("tuq")])


def worst_cases() -> str:
    """Return a document of worst cases as a study writes it, of two short ones."""
    from workbench.control import Controller, law_named
    from workbench.definition import find
    from workbench.plant import ONE_MASS, Limits, Plant
    from workbench.robustness import worst
    from workbench.robustness.cases import Varied
    from workbench.robustness.distribution import Distribution
    from workbench.robustness.workload import Block, work
    from workbench.simulation import Loop
    from workbench.task.task import Task

    plant = Plant(
        ONE_MASS,
        (find("inertia")(inertia=0.05), find("viscous_friction")(viscous=0.1), find("coulomb_friction")(coulomb=0.3)),
        True,
        limits=Limits(drive=3.0),
    )
    task = Task(plant, Loop(1e-3, resolution=1e-5), step=0.5, duration=0.2)
    fixed = law_named("fixed_pd")
    factories = {"fixed PD": lambda lanes: Controller("fixed PD", fixed, dict.fromkeys(fixed.parameters, 5.0))}
    varied = (Varied("inertia", Distribution("uniform", 0.8, 1.2), False, "1"),)
    given = work(task, factories, varied)
    values = np.array([[0.9], [1.1]])
    columns = given.columns(Block(0, values))
    cases = tuple(
        worst.Case("fixed PD", k, values[k], {n: float(v[k]) for n, v in columns["fixed PD"].items()}) for k in range(2)
    )
    with tempfile.TemporaryDirectory() as folder:
        worst.write(given, cases, Path(folder) / "w.json")
        return (Path(folder) / "w.json").read_text()


def gains(place: Path) -> None:
    """Write a gain table."""
    from workbench.exporting import export
    from workbench.plant import ONE_MASS, Plant
    from workbench.schedule import Schedule

    knots = 2.0 ** np.arange(-10, -5)
    digest = Plant(ONE_MASS).digest
    schedule = Schedule(knots, np.linspace(5, 9, 5), np.linspace(0.5, 0.9, 5), 1, "error", 3e-5, 1e-3, digest)
    export(schedule, Plant(ONE_MASS), place, scale=None)


# --- mutations -------------------------------------------------------------------------------------------------------


def text(rng: Random, content: str) -> bytes:
    """Return a text with one to three things wrong."""
    for _ in range(rng.randint(1, 3)):
        content = rng.choice(TEXT)(rng, content)
    data = content.encode("utf-8", "surrogatepass")
    return damaged(rng, data) if rng.random() < 0.15 else data


def another(pattern: str, values: list[str], quote: str = "") -> Callable[[Random, str], str]:
    """Return a mutation that puts a bad value in the place of one match of a pattern."""

    def change(rng: Random, content: str) -> str:
        found = list(re.finditer(pattern, content))
        if not found:
            return content
        m = rng.choice(found)
        return f"{content[: m.start()]}{quote}{rng.choice(values)}{quote}{content[m.end() :]}"

    return change


def lines(rng: Random, content: str) -> str:
    """Drop, double or exchange lines."""
    rows = content.split("\n")
    i, k = rng.randrange(len(rows)), rng.randrange(len(rows))
    rows[i : i + 1] = rng.choice([[], [rows[i]] * 2, [rows[k]], [rows[i][: len(rows[i]) // 2]], ["["], ["=" * 50]])
    return "\n".join(rows)


TEXT = (
    another(r"(?<![\w.])-?\d[\d.e+-]*", NUMBERS),
    another(r'"[^"\n]*"', TEXTS, '"'),
    another(r"\b[a-z_]{3,}\b", TEXTS),
    lines,
)


def damaged(rng: Random, data: bytes) -> bytes:
    """Return bytes that a disk or a transfer spoilt."""
    if not data:
        return data
    kind, at = rng.randrange(5), rng.randrange(len(data))
    if kind == 0:
        return data[:at]
    if kind == 1:
        return data[:at] + bytes(rng.randrange(256) for _ in range(rng.randint(1, 9))) + data[at + 1 :]
    if kind == 2:
        return data[:at] + data[at:][: rng.randint(1, 500)] * rng.randint(2, 20) + data[at:]
    if kind == 3:
        return bytes(b ^ (1 << rng.randrange(8)) if rng.random() < 0.002 else b for b in data)
    return data[:at] + b"\0" * rng.randint(1, 2000) + data[at:]


def leaf(rng: Random, content):
    """Return plain data with one value exchanged, dropped or added."""
    place, key = content, None
    for _ in range(20):
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        if not keys:
            return content
        key = rng.choice(keys)
        if not isinstance(place[key], (dict, list)) or rng.random() < 0.15:
            break
        place = place[key]
    if rng.random() < 0.2:
        del place[key]
    else:
        place[key] = rng.choice(LEAVES)
    return content


# --- cases -----------------------------------------------------------------------------------------------------------


def campaign(rng: Random, at: Path) -> list[str]:
    (at / "campaign" / "campaign.toml").write_bytes(text(rng, CAMPAIGN))
    return rng.choice(
        [["check", "campaign"], ["trace", "campaign", "--out", OUT], ["response", "campaign", "--out", OUT]]
    )


def record(rng: Random, at: Path) -> list[str]:
    file = at / "campaign" / "a.csv"
    file.write_bytes(text(rng, file.read_text()) if rng.random() < 0.6 else damaged(rng, file.read_bytes()))
    return rng.choice([["check", "campaign"], ["trace", "campaign", "--out", OUT]])


def column(rng: Random, at: Path) -> list[str]:
    """A channel that is finite and absurd."""
    file = at / "campaign" / "a.csv"
    rows = [r.split(",") for r in file.read_text().splitlines()]
    k, first = rng.randrange(3), rng.randrange(1, len(rows))
    value = rng.choice(["1e308", "-1e308", "1e200", "1e15", "1e9", "0", "-0", "1e-308", "nan", "inf", "", "x", "1,5"])
    for row in rows[first : first + rng.choice([1, 1, 2, 100, 5000])]:
        row[k] = value if rng.random() < 0.5 else f"{row[k]}e{rng.choice([300, -300, 9])}"
    file.write_text("\n".join(map(",".join, rows)) + "\n")
    return rng.choice([["check", "campaign"], ["trace", "campaign", "--out", OUT]])


def log(rng: Random, at: Path) -> list[str]:
    """A log file of any format, to `new`."""
    file = rng.choice(sorted(p for p in at.glob("a.*")))
    file.write_bytes(damaged(rng, file.read_bytes()))
    if rng.random() < 0.1:
        file = file.rename(at / rng.choice(["a.txt", "a.tsv", "a.mat", "a.mf4", "a.xyz", "a", f"{'a' * 240}.csv"]))
    return ["new", str(at / OUT), "--records", str(file)]


def study(rng: Random, at: Path) -> list[str]:
    (at / "study" / "study.toml").write_bytes(text(rng, STUDY))
    return ["run", "study", "--out", OUT]


def steps(rng: Random, at: Path) -> list[str]:
    (at / "study" / "study.py").write_bytes(text(rng, STEPS))
    return [rng.choice(["run", "check"]), "study"] if rng.random() < 0.3 else ["run", "study", "--out", OUT]


def worst_case(rng: Random, at: Path) -> list[str]:
    file = at / "worst.json"
    content = leaf(rng, json.loads(file.read_text()))
    file.write_bytes(json.dumps(content).encode() if rng.random() < 0.85 else damaged(rng, file.read_bytes()))
    return ["replay", "worst.json", *rng.choice([[], ["--case", "1"], ["--case", "2", "--out", OUT]])]


def gain_table(rng: Random, at: Path) -> list[str]:
    file = at / rng.choice(["gains.json", "gains.bin"])
    if file.suffix == ".json" and rng.random() < 0.8:
        file.write_text(json.dumps(leaf(rng, json.loads(file.read_text()))))
    else:
        file.write_bytes(damaged(rng, file.read_bytes()))
    return ["load gains", file.name]


def words(rng: Random, at: Path) -> list[str]:
    return [rng.choice(WORDS) for _ in range(rng.randint(1, 6))]


def places(rng: Random, at: Path) -> list[str]:
    """Outputs where none can be, and inputs that are none."""
    (at / "mine").mkdir()
    (at / "mine" / "thesis.txt").write_text("years of work")
    (at / "loop").symlink_to(at / "loop")
    (at / "into").symlink_to(at / "nowhere" / "else")
    spots = [
        "mine",
        "a.csv",
        "a.csv/below",
        "loop",
        "loop/x",
        "x" * 256,
        "é" * 128,
        "a\0b",
        "/dev/null",
        "/proc/self/x",
        "mine/thesis.txt",
        ".",
    ]
    names = ["campaign", "study", "mine", "a.csv", "loop", "x" * 300, "\0", "", "/", "/dev/zero", "into"]
    return rng.choice([["trace", rng.choice(names), "--out", rng.choice(spots)], ["run", rng.choice(names), "--out", rng.choice(spots)],
                       ["check", rng.choice(names)], ["replay", rng.choice(names)], ["new", rng.choice(spots), "--records", rng.choice(names)]])  # fmt: skip


KINDS = (campaign, campaign, record, column, log, study, study, steps, worst_case, gain_table, words, places)


# --- running ---------------------------------------------------------------------------------------------------------


class Hung(BaseException):
    """A case that took too long. No code may catch it."""


class Enough(BaseException):
    """A case that is sound as far as the first long computation, where it is let go."""


def tree(at: Path) -> dict[str, str]:
    """Every file below a folder but the outputs, with its digest."""
    return {
        str(p.relative_to(at)): hashlib.sha256(p.read_bytes()).hexdigest() if p.is_file() else ""
        for p in sorted(at.rglob("*"))
        if p.relative_to(at).parts[0] != OUT and not {"__pycache__", ".steps"} & set(p.parts)
    }


@contextlib.contextmanager
def let_go():
    """End a case where a search begins: what is bad is to be seen before it."""
    from workbench.study import standard, traced

    def enough(*_, **__):
        raise Enough

    places = [(standard, "trace"), (traced, "trace")]
    before = [getattr(m, n) for m, n in places]
    for m, n in places:
        setattr(m, n, enough)
    try:
        yield
    finally:
        for (m, n), f in zip(places, before, strict=True):
            setattr(m, n, f)


def command(arguments: list[str]) -> int:
    """Return the exit code of a command, in this process."""
    from workbench import exporting
    from workbench.cli import main
    from workbench.errors import WorkbenchError

    try:
        if arguments[0] == "load gains":
            loader = exporting.load_binary if arguments[1].endswith("bin") else exporting.load
            try:
                loader(arguments[1])
            except WorkbenchError as e:
                print(e, file=sys.stderr)
                return 2
            return 0
        return main(arguments)
    except SystemExit as e:
        return e.code if isinstance(e.code, int) else 0 if e.code is None else 2
    except Enough:
        return 0


def case(bench: Bench, number: int, show: bool = False) -> str | None:
    """Run one case; return what is wrong with how it ended, or None."""
    rng = Random(number)
    kind = KINDS[number % len(KINDS)]
    home = os.getcwd()
    said, out = io.StringIO(), io.StringIO()

    def late(*_):
        raise Hung

    with tempfile.TemporaryDirectory(prefix="fuzz-") as top:
        at = bench.fresh(Path(top) / "at")
        arguments = kind(rng, at)
        before, beside = tree(at), set(Path(top).iterdir())
        os.chdir(at)
        before_it = {n: signal.signal(n, late) for n in (signal.SIGALRM, signal.SIGPROF)}
        signal.alarm(BLOCKED)
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        try:
            with let_go(), contextlib.redirect_stderr(said), contextlib.redirect_stdout(out), warnings.catch_warnings():
                warnings.simplefilter("error")
                code = command(arguments)
        except Hung:
            return f"case {number} ({kind.__name__}): {arguments!r:.300} took more than {LONGEST} s"
        except BaseException as e:
            return f"case {number} ({kind.__name__}): {arguments!r:.300} raised {type(e).__name__}: {e!s:.300}"
        finally:
            signal.alarm(0)
            signal.setitimer(signal.ITIMER_PROF, 0)
            for n, handler in before_it.items():
                signal.signal(n, handler)
            os.chdir(home)
            sys.modules.pop("workbench_study_study", None)
        if show:
            print(arguments, code, out.getvalue(), said.getvalue())
        mine = f"studies/{arguments[1]}" if arguments[:1] == ["new"] and code == 0 else ""  # what it was asked to make
        return judged(
            code,
            said.getvalue(),
            at,
            before,
            Path(top),
            beside,
            mine,
            f"case {number} ({kind.__name__}): {arguments!r:.300}",
        )


def judged(code: int, said: str, at: Path, before: dict, top: Path, beside: set, mine: str, what: str) -> str | None:
    """Return what is wrong with how a case ended, or None. mine: a folder that it may have made."""
    if code not in (0, 1, 2, 3):
        return f"{what} ended with {code}: {said[-1500:]}"
    if "Traceback" in said or "Warning" in said:
        return f"{what} said: {said[-800:]}"
    after = tree(at)
    if mine:
        after = {k: v for k, v in after.items() if k != "studies" and not f"{k}/".startswith(f"{mine}/")}
    if after != before or set(top.iterdir()) != beside:
        changed = sorted(k for k in after.keys() | before.keys() if after.get(k) != before.get(k))
        return f"{what} changed {changed[:5]}"
    out = at / OUT
    if code == 2 and out.exists():
        return f"{what} was refused and left {sorted(p.name for p in out.iterdir()) if out.is_dir() else out}"
    return None


def main(arguments: list[str]) -> int:
    with tempfile.TemporaryDirectory(prefix="fuzz-bench-") as place:
        bench = made(Path(place) / "bench")
        if arguments[:1] == ["--case"]:
            print(case(bench, int(arguments[1]), show=True) or "as it should be")
            return 0
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, resource.getrlimit(resource.RLIMIT_AS)[1]))
        count, failed = int(arguments[0]) if arguments else 10_000, 0
        for number in range(int(arguments[1]) if arguments[1:] else 0, count):
            if wrong := case(bench, number):
                failed += 1
                print(wrong, flush=True)
            if number % 20 == 19:
                print(f"{number + 1} of {count} bad inputs: {failed} failures", flush=True)
        return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
