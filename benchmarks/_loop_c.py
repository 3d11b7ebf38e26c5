"""The hand-written C loop (reference/loop.c), compiled here and called through ctypes."""

import ctypes
import shutil
import subprocess
import tempfile
from ctypes import POINTER, Structure, c_double, c_int, c_int64
from pathlib import Path

import numpy as np

from benchmarks._loop_work import BANK, LOOP, Work
from workbench.simulate import Criteria
from workbench.simulate.dynamics import constants_of

SOURCE = Path(__file__).parent / "reference" / "loop.c"
FLAGS = ["-O3", "-march=native", "-std=c99", "-shared", "-fPIC"]
STRICT = ["-ffp-contract=off"]
MOST = 64
METRICS = (
    "q v k_outside e_outside e_inside outside k_settled peak peak_speed peak_torque final_error sum_u sum_uu reversals"
).split()  # names of the rows that the C struct's fields are, in its order


class PlantC(Structure):
    _fields_ = [(n, c_double) for n in ("height", "viscous", "mass")] + [
        ("stiffness", c_double * MOST),
        ("slip", c_double * MOST),
        ("torque_limit", c_double),
    ]


class LoopC(Structure):
    _fields_ = [
        *((n, c_double) for n in ("sample_time", "smoothing", "resolution", "back")),
        ("table", POINTER(c_double)),
        ("first", c_double),
        ("last", c_double),
        ("shift", c_int64),
        ("offset", c_int64),
        ("hold_band", c_double),
        ("hold", c_double),
    ]


def compiled(extra: list[str]) -> ctypes.CDLL | None:
    """Return the library, or None where there is no C compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "loop.so"
        subprocess.run([compiler, *FLAGS, *extra, str(SOURCE), "-o", str(library), "-lm"], check=True)
        return ctypes.CDLL(str(library))


def constants(work: Work) -> dict[str, float]:
    return constants_of(work.plant, work.bound(1).design.symbols, {})


def elements(values: dict[str, float], field: str, n: int) -> list[float]:
    """Values of a vector constant of the bank."""
    return [values[f"{BANK}@axis.{field}" + (f"[{i}]" if n > 1 else "")] for i in range(n)]


def caller(library: ctypes.CDLL, work: Work, samples: int):
    """Return a function that runs all scenarios and returns metrics (scenarios, len(METRICS))."""
    values, n = constants(work), work.n
    stiffness, slip = (c_double * MOST)(*elements(values, "k", n)), (c_double * MOST)(*elements(values, "slip", n))
    plant = PlantC(
        values[f"{BANK}@axis.h0"],
        values["viscous_friction@axis.viscous"],
        values["inertia@axis.inertia"],
        stiffness,
        slip,
        work.plant.limits.drive,
    )
    table, criteria, bound = work.controller.tables[0], Criteria(), work.bound(samples)
    rows, judged = np.ascontiguousarray(table.rows), criteria.constants(LOOP)
    loop = LoopC(LOOP.sample_time, LOOP.smoothing, LOOP.resolution, 3.0 * LOOP.resolution - 0.5 * LOOP.resolution,
                 rows.ctypes.data_as(POINTER(c_double)), table.knots[0], table.knots[-1], table.shift, table.offset,
                 judged["hold_band"], judged["hold"])  # fmt: skip
    s = work.scenarios
    fields = (s.target, s.inertia, s.friction, s.load, s.phase)
    scenarios = np.ascontiguousarray(np.stack([np.broadcast_to(f, (s.lanes,)) for f in fields], axis=1))
    out = np.zeros((s.lanes, len(METRICS)))

    def run() -> np.ndarray:
        library.simulate_all(
            ctypes.byref(plant), ctypes.byref(loop), ctypes.c_void_p(scenarios.ctypes.data),
            ctypes.c_void_p(out.ctypes.data), c_int64(s.lanes), c_int(n), c_int(LOOP.substeps), c_int64(samples),
            c_int64(bound.window_from),
        )  # fmt: skip
        return out

    run.kept = rows, scenarios  # the arrays that the pointers are to
    return run
