"""Kernels: one set of bits from NumPy, numba and CasADi for every effect, and a cache that nothing can leave broken."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.definition import FORCE, Effect, catalogue, find, namespace
from workbench.errors import WorkbenchError
from workbench.kernel import arrays, cache, scan, step
from workbench.kernel.lanes import map_lanes
from workbench.kernel.program import Program, read
from workbench.parameter import Parameter

ROOT = Path(__file__).resolve().parents[2]
STEPS = 60


# --- the same bits ----------------------------------------------------------------------------------------------------


def graph(effect: Effect) -> tuple[ca.Function, ca.Function]:
    """The whole step, (signals, states, constants) -> (next states, output and provided signals), and parameters -> constants.

    What `derive` makes of the parameters are the constants, as in the kernels: it is no part of the loop.
    """
    s, z, p = step.symbols(effect)
    inside = namespace(**step.view(effect.parameters, p))
    constants, derived = [p], [p]
    if effect.derive:
        fields = {n: ca.densify(ca.SX(v)) for n, v in vars(effect.derive(inside)).items()}
        inside = namespace(**{n: ca.SX.sym(n, v.numel()) for n, v in fields.items()})
        constants, derived = list(vars(inside).values()), list(fields.values())
    after, output, provided = step.apply(effect, step.view(effect.reads, s), z, inside)
    results = [after, ca.vertcat(output, *(provided[n] for n in effect.provides))]
    whole = ca.Function(f"{effect.name}_whole", [s, z, ca.vertcat(*constants)], [ca.densify(r) for r in results])
    return whole, ca.Function("constants", [p], [ca.vertcat(*(ca.vec(v) for v in derived))])


def motion(names: tuple[str, ...], seed: int) -> np.ndarray:
    """Random signals (n, STEPS) of the sizes that records have, with zeros of both signs and a jump among them."""
    rng = np.random.default_rng(seed)
    sizes = {"q": 1.0, "dq": 1e-3, "v": 5.0, "a": 300.0, "u": 0.5, "tau": 0.5, "motor_q": 1.0, "load_q": 1.0}
    held = {"dt": 1e-3, "ratio": 30.0, "pole_pairs": 5.0, "locked": 0.0, "temperature": 300.0, "normal": 10.0}
    rows = np.empty((len(names), STEPS))  # a column a step also where no signal is read
    for row, name in zip(rows, names, strict=True):
        row[:] = held.get(name, 0.0) if name in held else sizes.get(name, 1.0) * rng.normal(size=STEPS)
        if name == "dir":
            row[:] = np.clip(row, -1, 1)
        if name == "t":
            row[:] = 30.0 + 1e-3 * np.arange(STEPS)
        if name not in held and name != "t":
            row[10:12], row[12], row[13] = 0.0, -0.0, 100 * row[13]
    return rows


def values(effect: Effect, seed: int) -> np.ndarray:
    """Random parameters within their bounds."""
    rng = np.random.default_rng([seed, 7])
    found = []
    for p in effect.parameters.values():
        near = abs(p.value) or 1.0
        found.append(
            np.clip(near * rng.uniform(0.5, 2.0) * (1 if p.lower >= 0 else rng.choice([-1, 1])), p.lower, p.upper)
        )
    return np.array(found)


def by_casadi(function: ca.Function, signals, states, constants) -> np.ndarray:
    out, z = [], states
    for column in signals.T:
        z, y = function(column, z, constants)
        out.append(np.asarray(y).ravel())
    return np.array(out).T


def by_numpy(program: Program, signals, states, constants) -> np.ndarray:
    out, z = [], list(states)
    for column in signals.T:
        z, y = arrays.evaluate(program, column, z, constants)
        out.append([float(v) for v in y])
    return np.array(out).T


def bits(x) -> np.ndarray:
    """The bits of floats, every NaN alike."""
    x = np.array(x, dtype=float)
    return np.where(np.isnan(x), np.nan, x).view(np.uint64)


def assert_same_bits(a, b):
    np.testing.assert_array_equal(bits(a), bits(b))


def assert_all_agree(function, program, signals, rest, constants):
    expected = by_casadi(function, signals, rest, constants)
    assert_same_bits(by_numpy(program, signals, rest, constants), expected)
    assert_same_bits(scan.scan(program, signals, rest, constants), expected)


@pytest.mark.parametrize("name", catalogue())
def test_numpy_numba_and_casadi_give_the_same_bits(name):
    effect = find(name)
    function, derive = graph(effect)
    program = read(function)
    rest = np.zeros(sum(effect.states.values()))
    for seed in range(2):
        signals, constants = motion(effect.reads, seed), np.array(derive(values(effect, seed))).ravel()
        assert_all_agree(function, program, signals, rest, constants)


@pytest.mark.parametrize("name", catalogue())
def test_a_signal_that_is_not_a_number_gives_the_same_bits_too(name):
    effect = find(name)
    function, derive = graph(effect)
    program = read(function)
    rest = np.zeros(sum(effect.states.values()))
    for bad in (np.nan, np.inf, -np.inf):
        signals, constants = motion(effect.reads, 3), np.array(derive(values(effect, 3))).ravel()
        signals[:, 20] = bad
        assert_all_agree(function, program, signals, rest, constants)


@pytest.mark.parametrize("name", catalogue())
def test_columns_add_up_to_the_output(name):
    effect = find(name)
    built = step.build(effect)
    rows = motion(effect.reads, 1)
    given = dict(zip(effect.parameters, values(effect, 1), strict=True))
    signals = dict(zip(effect.reads, rows, strict=True)) or {"t": np.zeros(STEPS)}
    columns = built.run(signals, given)[: len(built.columns)]
    parts = [given[n] * c for n, c in zip(effect.linear, columns, strict=True)] if effect.linear else columns[:1]
    function, derive = graph(effect)
    whole = by_casadi(function, rows, np.zeros(sum(effect.states.values())), derive(list(given.values())))[0]
    np.testing.assert_allclose(sum(parts), whole, rtol=0, atol=1e-13 * max(np.abs(parts).max(), 1e-300))


def least_and_greatest() -> ca.Function:
    a, b = ca.SX.sym("a"), ca.SX.sym("b")
    return ca.Function("extremes", [ca.vertcat(a, b), ca.SX.sym("z", 0), ca.SX.sym("p", 0)],
                       [ca.SX(0, 1), ca.vertcat(ca.fmin(a, b), ca.fmax(a, b), a < b, a <= b)])  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(), st.floats()) | st.sampled_from([(0.0, -0.0), (-0.0, 0.0)]), min_size=1))
def test_minimum_and_maximum_ignore_nan_and_return_the_first_of_equals(pairs):
    function = least_and_greatest()
    signals = np.array(pairs, dtype=float).T
    found = scan.scan(read(function), signals, np.zeros(0), np.zeros(0))
    assert_same_bits(found, by_casadi(function, signals, np.zeros(0), np.zeros(0)))
    for (a, b), least, greatest in zip(pairs, found[0], found[1], strict=True):
        if a != a or b != b:
            expected = (b, b) if a != a else (a, a)
        else:
            expected = (a if a <= b else b, a if a >= b else b)
        assert_same_bits([least, greatest], expected)


def test_a_step_without_states_has_the_same_bits_compiled_and_by_numpy(monkeypatch):
    made = step.build(find("cogging"))
    signals, values = {"q": np.linspace(-3.0, 3.0, 50)}, {"order": 7.0}
    assert len(made.program.lines) > step.MANY
    compiled = made.run(signals, values)
    monkeypatch.setattr(step, "MANY", 10**6)
    np.testing.assert_array_equal(made.run(signals, values), compiled)


def test_a_scan_in_two_parts_is_the_whole_scan():
    effect = find("presliding_hysteresis")
    built = step.build(effect)
    given = {"h0": 0.1, "x0": 1e-3, "d": 0.8}
    dq = 1e-3 * np.random.default_rng(0).normal(size=400)
    whole = built.run({"dq": dq}, given)
    k, slip = np.split(built.constants(given)[1:], 2)
    assert k.size == slip.size == built.states
    x = np.zeros(k.size)
    for n, move in enumerate(dq):  # the definition, written once more
        x = np.clip(x + move, -slip, slip)
        assert whole[1, n] == pytest.approx(k @ x, rel=1e-12)
    first = built.run({"dq": dq[:200]}, given)
    assert_same_bits(first, whole[:, :200])
    x = np.zeros(k.size)
    for move in dq[:200]:
        x = np.clip(x + move, -slip, slip)
    assert_same_bits(built.run({"dq": dq[200:]}, given, states=x), whole[:, 200:])


def test_lanes_are_the_scan_of_one_step():
    x, c = ca.SX.sym("x", 2), ca.SX.sym("c")
    after = ca.vertcat(x[0] * c + x[1], ca.fmax(x[0], x[1]) / c)
    inputs = np.random.default_rng(1).normal(size=(2, 33))
    found = map_lanes(read(ca.Function("two_rows", [x, c], [after])), inputs, [0.3])
    assert_same_bits(found, [inputs[0] * 0.3 + inputs[1], np.maximum(*inputs) / 0.3])


def test_arrays_given_are_not_changed():
    effect = find("presliding_hysteresis")
    built = step.build(effect)
    dq, start = np.full(5, 1e-3), np.zeros(built.states)
    built.run({"dq": dq}, {"h0": 1.0, "x0": 1e-3, "d": 1.0}, states=start)
    assert np.all(dq == 1e-3) and np.all(start == 0.0)


# --- what kernels may hold --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("operation", [ca.sin, ca.exp, ca.log, ca.tanh, ca.atan, ca.acos, ca.ceil, lambda x: x**0.37])
def test_an_operation_that_kernels_may_not_hold_is_refused_with_a_sentence(operation):
    x = ca.SX.sym("x")
    with pytest.raises(
        WorkbenchError, match=r"^'foreign' holds an operation .* write it with workbench\.effects\.elem"
    ):
        read(ca.Function("foreign", [x], [operation(x)]))


def made(output, states=None) -> Effect:
    return Effect(
        "made", "", "", "", FORCE, {"gain": Parameter(1.0, "F", "gain")}, output, linear=("gain",),
        states=states or {}, reads=("v",),
    )  # fmt: skip


def test_sparse_results_of_a_step_are_made_dense():
    effect = made(lambda s, z, p: ({"z": ca.SX(2, 1)}, p.gain * s.v), {"z": 2})
    after, output = step.build(effect).program.outputs
    assert after == ("0.0", "0.0") and len(output) == 1
    silent = made(lambda s, z, p: ({}, ca.SX(1, 1)))
    assert np.all(step.build(silent).run({"v": np.ones(3)}, {"gain": 2.0}) == 0.0)


def test_a_sparse_function_is_refused_with_a_sentence():
    x = ca.SX.sym("x", 2)
    with pytest.raises(WorkbenchError, match="'holes': output 0 is sparse; densify it."):
        read(ca.Function("holes", [x], [ca.vertcat(x[0], ca.SX(1, 1))]))
    with pytest.raises(WorkbenchError, match="'holes': input 0 is sparse; declare it dense."):
        y = ca.SX.sym("y", ca.Sparsity.lower(2))
        read(ca.Function("holes", [y], [ca.densify(ca.sum1(ca.densify(y)))]))


@pytest.mark.parametrize("value", [0.1, -0.1, 1e-300, 5e-324, np.inf, -np.inf, 2.0**53, 1 / 3])
def test_constants_keep_their_bits_in_the_source(value):
    x = ca.SX.sym("x")
    program = read(ca.Function("constant", [x, ca.SX.sym("z", 0), ca.SX.sym("p", 0)], [ca.SX(0, 1), x + value]))
    assert_same_bits(scan.scan(program, np.zeros((1, 1)), [], []), [[value + 0.0]])


def test_a_step_that_returns_other_states_than_declared_is_refused():
    with pytest.raises(WorkbenchError, match=r"step returns states \['y'\], declared are \['z'\]"):
        step.build(made(lambda s, z, p: ({"y": s.v}, p.gain * s.v), {"z": 1}))


# --- the cache --------------------------------------------------------------------------------------------------------


def toy(name: str) -> Program:
    x, z, p = ca.SX.sym("x"), ca.SX.sym("z"), ca.SX.sym("p")
    return read(ca.Function(name, [x, z, p], [z + x, z + x * p]))


def run_toy(name: str) -> list[float]:
    """A scan by a module that is loaded afresh."""
    program = toy(name)
    out = np.empty((1, 3))
    cache.load.__wrapped__(scan.source(program), name).scan(np.ones((1, 3)), np.zeros(1), np.array([2.0]), out)
    return out[0].tolist()


@pytest.fixture
def kept(tmp_path, monkeypatch) -> Path:
    """An empty cache."""
    monkeypatch.setenv("WORKBENCH_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept" / "kernels"


@pytest.mark.parametrize("damage", [b"", b"half a modul", b"\xff\xfe not text"])
def test_broken_source_is_written_again(kept, damage):
    assert run_toy("toy_source") == [2.0, 3.0, 4.0]
    (path,) = kept.glob("toy_source_*.py")
    whole = path.read_bytes()
    path.write_bytes(damage)
    assert run_toy("toy_source") == [2.0, 3.0, 4.0]
    assert path.read_bytes() == whole


@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_broken_machine_code_is_compiled_again(kept, ending):
    assert run_toy("toy_code") == [2.0, 3.0, 4.0]
    (path,) = (kept / "__pycache__").glob(f"toy_code_*.{ending}")
    whole = path.read_bytes()
    for damage in (b"", b"neither", whole[: len(whole) // 2]):
        path.write_bytes(damage)
        assert run_toy("toy_code") == [2.0, 3.0, 4.0]


def test_what_other_writers_made_of_the_same_text_is_not_taken(kept, monkeypatch):
    run_toy("toy_writers")
    monkeypatch.setattr(cache, "_writers", lambda: b"other instructions")
    run_toy("toy_writers")
    assert len(list(kept.glob("toy_writers_*.py"))) == 2
    modules = Path(cache.__file__).parent.glob("*.py")
    assert set(cache.WRITERS) == {m.name for m in modules if "from llvmlite" in m.read_text(encoding="utf-8")}


def test_a_folder_that_cannot_be_written_falls_back(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("WORKBENCH_CACHE", str(tmp_path / "file" / "below"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    assert run_toy("toy_refuge") == [2.0, 3.0, 4.0]


def test_what_a_process_keeps_for_itself_alone_goes_with_it(tmp_path):
    passing, file = tmp_path / "passing", tmp_path / "file"
    passing.mkdir()
    file.write_text("no folder")
    code = "from workbench.kernel import cache; m = cache.load('x = 1', 'toy_passing'); print(m.__file__)"
    surroundings = {
        **os.environ,
        "WORKBENCH_CACHE": str(file / "below"),
        "TMPDIR": str(passing),
        "PYTHONPATH": str(ROOT),
    }
    said = subprocess.run([sys.executable, "-c", code], env=surroundings, capture_output=True, text=True, check=True)
    assert str(passing) in said.stdout
    assert not list(passing.iterdir())


def test_the_folder_is_where_the_user_says(monkeypatch):
    monkeypatch.setenv("WORKBENCH_CACHE", "/somewhere")
    assert cache.folder() == Path("/somewhere")
    monkeypatch.delenv("WORKBENCH_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", "/else")
    assert cache.folder() == Path("/else/servo-workbench")


def test_two_processes_at_once_compile_the_same_kernel(tmp_path):
    code = textwrap.dedent("""
        import numpy as np
        from workbench.definition import find
        from workbench.kernel.step import build
        out = build(find("coulomb_friction")(coulomb=1.0)).run({"dir": np.ones(3)}, {"coulomb": 1.0})
        dq = np.full(3, 1e-3)
        print(build(find("presliding_hysteresis")).run({"dq": dq}, {"h0": 1.0, "x0": 1e-3, "d": 1.0})[1].tolist(), out.sum())
    """)
    surroundings = {**os.environ, "WORKBENCH_CACHE": str(tmp_path), "PYTHONPATH": str(ROOT)}
    both = [
        subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, env=surroundings, stdout=subprocess.PIPE, text=True)
        for _ in range(2)
    ]
    said = [process.communicate(timeout=120)[0] for process in both]
    assert [process.returncode for process in both] == [0, 0]
    assert said[0] == said[1] != ""
    assert not [p for p in (tmp_path / "kernels").iterdir() if p.name.startswith(".")]
