"""The sampled loop with the compiled firmware as its controller: the plant's programs as C in double, one lane.

Stages, their order, noise and delay are those of workbench.simulation; the controller is the C that a drive would run, which
reads encoder counts and gives a command in its own arithmetic.
"""

import ctypes
from collections.abc import Sequence
from pathlib import Path
from string import Template

import numpy as np

from workbench.firmware import host
from workbench.firmware.make import Firmware
from workbench.kernel.c import Writer
from workbench.plant import Plant
from workbench.simulation import Criteria, Loop, Metrics
from workbench.simulation.binding import Bound, bind, samples_of
from workbench.simulation.design import Design, Piece
from workbench.simulation.metrics import Trajectories, finished
from workbench.simulation.scenario import ScenarioArrays, arrays_of

HERE = Path(__file__).parent
CLOCKS = "double clock_k, double clock_t, double clock_window"


BESIDE = {  # what a compensation adds to the loop: it begins where the axis is, and is handed what is read or asked for
    "included": '#include "$name.h"\n',
    "kept": "static ${p}_table beside_table;\nstatic ${p}_state beside_state;\n",
    "loaded": """
uint32_t wb_loop_load_beside(const uint8_t *bytes, uint32_t size)
{
    return (uint32_t)${p}_load(&beside_table, bytes, (size_t)size, NULL);
}
""",
    "declared": "        ${p}_inputs beside;\n",
    "added": """        beside.fraction = 0u;
        if (k == 0) {
            beside.position = now.position;
            ${p}_start(&beside_state, &beside_table, &beside);
        }
        beside.position = $asked;
        now.added = ${p}_step(&beside_state, &beside_table, &beside);
""",
}


class Run(ctypes.Structure):
    """wb_run of loop.c.in."""

    _fields_ = [
        ("seed", ctypes.c_uint64), ("strength", ctypes.c_double), ("sample_time", ctypes.c_double),
        ("h", ctypes.c_double), ("count", ctypes.c_double), ("other_count", ctypes.c_double), ("unit", ctypes.c_double),
        ("reference", ctypes.c_void_p), ("delay", ctypes.c_long), ("samples", ctypes.c_long),
        ("window_from", ctypes.c_long), ("slots", ctypes.c_long),
    ]  # fmt: skip


def _function(piece: Piece, at: dict[str, int], first: int) -> str:
    """Return one piece as a C function over the rows r and the constants c, its own from `first` on."""
    used = {n for line in piece.after.lines for n in (line.a, line.b, getattr(line, "condition", ""))}
    used |= set(piece.after.outputs[0])
    inputs = {f"i0_{j}": f"i0_{j}" for j in range(len(piece.rows))}
    inputs |= {f"i1_{m}": f"c[{first + m}]" for m in range(piece.after.inputs[1])}
    head = [
        f"    const double i0_{j} = {f'r[{at[n]}]' if n in at else f'clock_{n}'};"
        for j, n in enumerate(piece.rows)
        if f"i0_{j}" in used
    ]
    writer = Writer(piece.after, "double", inputs, {})
    body = [f"    {line}" for line in writer.lines()]
    values = [writer.value(v) for v in piece.after.outputs[0]]
    body += [f"    const double o_{i} = {v};" for i, v in enumerate(values)]
    body += [f"    r[{at[n]}] = o_{i};" for i, n in enumerate(piece.outputs)]
    unused = ["    (void)clock_k;", "    (void)clock_t;", "    (void)clock_window;", "    (void)c;"]
    return "\n".join(
        [f"static void {piece.name}(double *r, const double *c, {CLOCKS})", "{", *head, *body, *unused, "}\n"]
    )


def _source(made: Firmware, design: Design, substeps: int) -> str:
    """Return the C of a loop around a firmware."""
    at = {n: i for i, n in enumerate(design.rows)}
    first, pieces = 0, []
    for piece in design.pieces:
        pieces.append(_function(piece, at, first))
        first += piece.after.inputs[1]
    other, counted = "", "0.0"
    if made.numbers.stages.both:
        row = "load.y" if made.numbers.stages.feedback == "position" else "motor.y"
        other = f"        now.other = wb_counted(r[{at[row]}], run->other_count);\n"
        counted = "(double)now.other"
    noise = f"        r[{at['noise']}] = wb_noise(run->seed, (uint64_t)k) * run->strength;\n" if design.noisy else ""
    beside = dict.fromkeys(("included", "kept", "loaded", "declared"), "") | {"added": "        now.added = 0;\n"}
    if made.compensation:
        p = made.compensation.source.p
        asked = "now.position" if made.compensation.reads else "(uint32_t)now.reference"
        beside = {
            n: Template(t).substitute(p=p, name=made.compensation.source.name, asked=asked) for n, t in BESIDE.items()
        }
    return Template((HERE / "loop.c.in").read_text(encoding="utf-8")).substitute(
        beside,
        header=f"{made.source.name}.h", p=made.source.p, pieces="\n".join(pieces), other=other, counted=counted, noise=noise,
        y=at["y"], u=at["u"], u_c=at["u_c"], q=at["q"] if "q" in at else at["y"], substeps=substeps,
    )  # fmt: skip


class Compiled:
    """A firmware in the loop of plants of one structure."""

    def __init__(self, made: Firmware, bound: Bound):
        self.made, self.design = made, bound.design
        files = made.files | {"loop.c": _source(made, bound.design, bound.loop.substeps)}
        self.library = host.compiled(files, ("-O2", "-Wno-unused-function"))
        data = made.image.bytes()
        refused = self.library.wb_loop_load(data, len(data))
        assert refused == 0, refused  # the table was made for this law, a line above
        if made.compensation:
            data = made.compensation.image.bytes()
            assert self.library.wb_loop_load_beside(data, len(data)) == 0

    def lane(self, bound: Bound, i: int, reference: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the final rows of one scenario, and its readings, commands, counts of the other encoder and positions (samples, 4).

        reference (samples,): rad or m, its target all along where absent; it is rounded to counts.
        """
        scenarios, loop, made = bound.scenarios, bound.loop, self.made

        def one(x):
            return x[i] if np.ndim(x) else x

        rows = np.array([float(one(bound.initial.get(n, 0.0))) for n in self.design.rows])
        constants = np.array([float(one(v)) for values in bound.frontier for v in values])
        delay = int(one(bound.delays))
        slots = 1 + -(-delay // loop.substeps) + 1
        other = loop.load_resolution if loop.feedback == "position" else loop.resolution
        unit = float(made.reference.real("u_c", 1))
        asked = np.full(bound.samples, one(scenarios.target)) if reference is None else reference
        asked = np.floor(asked / loop.count + 0.5).astype(np.int64)
        run = Run(
            int(one(scenarios.seed)), float(one(bound.strength)), loop.sample_time, loop.substep, loop.count,
            other or 1.0, unit, asked.ctypes.data, delay, asked.size, bound.window_from, slots,
        )  # fmt: skip
        ring, out = np.zeros(slots), np.zeros((asked.size, 4))
        pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in (rows, constants)]
        self.library.wb_loop_run(
            *pointers, ctypes.byref(run), *(x.ctypes.data_as(ctypes.c_void_p) for x in (ring, out))
        )
        return rows, out


def run_firmware(
    made: Firmware,
    plant: Plant | Sequence[Plant],
    loop: Loop,
    scenarios: ScenarioArrays,
    duration: float,
    criteria: Criteria | None = None,
) -> Metrics:
    """Return the metrics of a loop that the compiled firmware closes, one scenario after another, with "y", "u" and, of two encoders,
    the other one's counts "other" kept.

    Targets are rounded to encoder counts. Raises WorkbenchError as `simulate`, and where there is no C compiler.
    """
    criteria = criteria or Criteria()
    arrays = arrays_of(scenarios)
    bound = bind(plant, loop, None, arrays, samples_of(duration, loop), criteria)
    compiled = Compiled(made, bound)
    lanes = [compiled.lane(bound, i) for i in range(arrays.lanes)]
    final = {n: np.array([rows[j] for rows, _ in lanes]) for j, n in enumerate(bound.design.rows)}
    kept = np.stack([out for _, out in lanes], axis=-1)
    time = np.arange(bound.samples) * loop.sample_time
    return finished(
        bound,
        final,
        criteria.band,
        Trajectories(time, dict(zip(("y", "u", "other", "q"), np.moveaxis(kept, 1, 0), strict=True))),
    )


def followed_by_firmware(
    made: Firmware,
    plant: Plant,
    loop: Loop,
    scenarios: ScenarioArrays,
    references: np.ndarray,
    which: np.ndarray,
    lasts: np.ndarray,
) -> np.ndarray:
    """Return the positions (n, lanes) of loops that the compiled firmware closes, as `workbench.simulation.followed` does of a law's.

    Of positions beyond those that are needed, lasts (lanes,), nothing is known.
    """
    bound = bind(plant, loop, None, scenarios, len(references), Criteria())
    compiled, q = Compiled(made, bound), np.full((len(references), scenarios.lanes), np.nan)
    for i, (r, n) in enumerate(zip(which, lasts, strict=True)):
        q[:n, i] = compiled.lane(bound, i, references[:n, r])[1][:, 3]
    return q
