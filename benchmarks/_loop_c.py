"""The hand-written C loop (reference/loop.c), compiled here and called through ctypes."""

import ctypes
import shutil
import subprocess
import tempfile
from ctypes import POINTER, Structure, c_double, c_int, c_int64
from pathlib import Path

import numpy as np

from benchmarks._loop_work import BANK, JOINT, LUGRE, TWO, Work
from workbench.simulation import Criteria
from workbench.simulation.dynamics import constants_of

SOURCE = Path(__file__).parent / "reference" / "loop.c"
FLAGS = ["-O3", "-march=native", "-std=c99", "-shared", "-fPIC"]
STRICT = ["-ffp-contract=off"]
FREE = ["-DLIBM"]
MOST = 64
METRICS = (
    "q v k_outside e_outside e_inside outside k_settled peak peak_speed peak_torque final_error sum_u sum_uu reversals"
).split()  # names of the rows that the C struct's fields are, in its order


class PlantC(Structure):
    _fields_ = [(n, c_double) for n in ("height", "viscous", "mass")] + [
        ("stiffness", c_double * MOST),
        ("slip", c_double * MOST),
        ("torque_limit", c_double),
        *((n, c_double) for n in ("load_mass", "load_viscous", "linear", "cubic", "joint_height")),
        ("joint_stiffness", c_double * JOINT),
        ("joint_slip", c_double * JOINT),
        *((n, c_double) for n in ("sigma0", "sigma1", "x0", "ratio", "speed")),
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


def elements(values: dict[str, float], field: str, n: int, place: str = "axis") -> list[float]:
    """Values of a vector constant of the bank at a place."""
    return [values[f"{BANK}@{place}.{field}" + (f"[{i}]" if n > 1 else "")] for i in range(n)]


def plant_of(work: Work) -> PlantC:
    """The plant's numbers; those that its kind does not have are zero."""
    values, n = constants(work), work.n
    place = "motor" if work.kind == TWO else "axis"
    plant = PlantC(
        viscous=values[f"viscous_friction@{place}.viscous"],
        mass=values[f"inertia@{place}.inertia"],
        torque_limit=work.plant.limits.drive,
    )
    if work.kind == LUGRE:
        for name in ("sigma0", "sigma1", "x0", "ratio", "speed"):
            setattr(plant, name, values[f"lugre_friction@axis.{name}"])
        return plant
    plant.height = values[f"{BANK}@{place}.h0"]
    plant.stiffness[:n], plant.slip[:n] = (elements(values, field, n, place) for field in ("k", "slip"))
    if work.kind == TWO:
        plant.load_mass, plant.load_viscous = values["inertia@load.inertia"], values["viscous_friction@load.viscous"]
        plant.linear, plant.cubic = values["linear_stiffness@joint.stiffness"], values["cubic_stiffness@joint.k3"]
        plant.joint_height = values[f"{BANK}@joint.h0"]
        plant.joint_stiffness[:] = elements(values, "k", JOINT, "joint")
        plant.joint_slip[:] = elements(values, "slip", JOINT, "joint")
    return plant


def caller(library: ctypes.CDLL, work: Work, samples: int):
    """Return a function that runs all scenarios and returns metrics (scenarios, len(METRICS))."""
    n, side = work.n, work.loop
    plant = plant_of(work)
    table, criteria, bound = work.controller.tables[0], Criteria(), work.bound(samples)
    rows, judged = np.ascontiguousarray(table.rows), criteria.constants(side)
    loop = LoopC(side.sample_time, side.smoothing, side.resolution, 3.0 * side.resolution - 0.5 * side.resolution,
                 rows.ctypes.data_as(POINTER(c_double)), table.knots[0], table.knots[-1], table.shift, table.offset,
                 judged["hold_band"], judged["hold"])  # fmt: skip
    s = work.scenarios
    fields = (s.target, s.inertia, s.friction, s.load, s.phase)
    scenarios = np.ascontiguousarray(np.stack([np.broadcast_to(f, (s.lanes,)) for f in fields], axis=1))
    out = np.zeros((s.lanes, len(METRICS)))

    def run() -> np.ndarray:
        library.simulate_all(
            ctypes.byref(plant), ctypes.byref(loop), ctypes.c_void_p(scenarios.ctypes.data),
            ctypes.c_void_p(out.ctypes.data), c_int64(s.lanes), c_int(work.kind), c_int(n), c_int(side.substeps), c_int64(samples),
            c_int64(bound.window_from),
        )  # fmt: skip
        return out

    run.kept = rows, scenarios  # the arrays that the pointers are to
    return run
