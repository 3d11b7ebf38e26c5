"""The exported C header, compiled with warnings as errors and compared with Python bit for bit."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import AXIS
from test_export import SCALE, plant, schedule

from workbench.control import scheduled_pd
from workbench.exporting import export, lookup32
from workbench.firmware import firmware
from workbench.simulation import Loop

SOURCE = Path(__file__).parent / "consumer" / "consumer.c"
WARNINGS = "-Wall -Wextra -Wconversion -Wdouble-promotion -Wpedantic -Werror -ffp-contract=off".split()
C99, CPP17 = ["-std=c99"], ["-x", "c++", "-std=c++17"]
F = np.float32


def compiled(folder: Path, source: Path = SOURCE, options=(*C99, "-O2")) -> Path:
    """Return the consumer compiled against the header in `folder`."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler here")
    out = folder / "consumer"
    command = [compiler, *options, *WARNINGS, f"-I{folder}", str(source), "-o", str(out)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="module", params=["frozen", "following", "error", "closing"])
def consumer(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    export(schedule(rule=request.param), plant(), folder, scale=SCALE)
    return request.param, folder, compiled(folder)


@pytest.fixture(scope="module")
def follower(tmp_path_factory) -> Path:
    """The consumer of a table whose amplitude is that of the stroke."""
    folder = tmp_path_factory.mktemp("follower")
    export(schedule(rule="following"), plant(), folder)
    return compiled(folder)


def run(binary: Path, what: str, *columns) -> list[np.ndarray]:
    """Return the columns of float32 that the consumer prints for columns of float32."""
    rows = np.column_stack([np.asarray(c, F).view(np.uint32) for c in columns]) if columns else []
    text = "\n".join(" ".join(f"{word:x}" for word in row) for row in rows)
    done = subprocess.run([binary, what], input=text, capture_output=True, text=True, check=True, timeout=60)
    words = [[int(word, 16) for word in line.split()] for line in done.stdout.splitlines()]
    return list(np.array(words, dtype=np.uint32).view(F).T)


def same(got, wanted):
    assert np.array_equal(np.asarray(got, F).view(np.uint32), np.asarray(wanted, F).view(np.uint32))


def amplitudes() -> np.ndarray:
    """1000 random amplitudes over and beyond the table, and every edge."""
    knots = schedule().knots.astype(F)
    random = np.exp(np.random.default_rng(3).uniform(np.log(knots[0] / 4), np.log(knots[-1] * 4), 1000)).astype(F)
    near = [np.nextafter(knots, F(side)) for side in (-1, 1)]
    odd = [0.0, -0.0, 1e-45, 1e-40, 1.17549435e-38, 3.4028235e38, np.inf, -np.inf, np.nan, -1e-45, -1e-4, -3.4e38]
    return np.concatenate([random, knots, *near, np.array(odd, F)])


@pytest.mark.parametrize(("what", "drive"), [("lookup", False), ("drive", True)])
def test_c_and_python_look_up_the_same_bits(consumer, what, drive):
    _, folder, binary = consumer
    a = amplitudes()
    got = run(binary, what, a)
    for c, python in zip(got, lookup32(folder / "gains.json", a, drive=drive), strict=True):
        same(c, python)


@pytest.mark.parametrize("per_octave", [1, 64])
def test_other_grids_are_the_same_bits_too(tmp_path, per_octave):
    s = schedule(octaves=(-4, 3), per_octave=per_octave)
    export(s, plant(), tmp_path)
    a = np.exp(np.random.default_rng(3).uniform(-5, 5, 500)).astype(F)
    same(run(compiled(tmp_path), "lookup", a), lookup32(s, a))


def test_c_knows_crc32_and_finds_its_tables_whole(consumer):
    _, _, binary = consumer
    done = subprocess.run([binary, "check"], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["cbf43926", "1"]


def test_c_finds_a_changed_table(tmp_path):
    h = export(schedule(), plant(), tmp_path)[0]
    text = h.read_text()
    entry = text.split("wb_gains_kd_slope[WB_GAINS_COUNT] = {\n")[1].split("f")[0].strip()
    assert text.count(entry) == 1
    h.write_text(text.replace(entry, "0x1.0p+0"))
    done = subprocess.run([compiled(tmp_path), "check"], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["cbf43926", "0"]


@pytest.mark.parametrize("options", [CPP17, [*C99, "-O0"], [*C99, "-Os"], ["-std=c11", "-O3"]])
def test_the_header_compiles_clean_otherwise_too(consumer, tmp_path, options):
    shutil.copy(consumer[1] / "gains.h", tmp_path)
    binary = compiled(tmp_path, options=options)
    same(run(binary, "lookup", amplitudes()), lookup32(schedule(), amplitudes()))


def test_two_tables_stand_in_one_file(tmp_path):
    export(schedule(), plant(), tmp_path, name="azimuth", scale=SCALE)
    export(schedule(rule="following"), plant(), tmp_path, name="elevation")
    both = tmp_path / "both.c"
    both.write_text(
        '#include "azimuth.h"\n#include "elevation.h"\n#include "azimuth.h"\n'
        "int main(void) { return (wb_azimuth_check() + wb_elevation_check() == 2) ? 0 : 1; }\n"
    )
    assert subprocess.run([compiled(tmp_path, both)]).returncode == 0


def test_an_empty_table_of_segments_compiles(tmp_path):
    s = schedule()
    one = type(s)(s.knots[:1], s.kp[:1], s.kd[:1], plant_digest=s.plant_digest)
    export(one, plant(), tmp_path)
    same(run(compiled(tmp_path), "lookup", [0.0, np.nan, 1.0, np.inf])[0], np.full(4, s.kp[0]))


# --- the stroke since the last reversal ------------------------------------------------------------------------------


class Stroke:
    """The same machine, written apart from the C: the whole walk is kept, and each sample reads it from the last turn."""

    def __init__(self, reversal, position):
        self.reversal, self.walk, self.turn, self.sign, self.turned = F(reversal), [F(position)], F(position), 0, False

    def update(self, position):
        """Return (amplitude, whether a reversal was counted in this sample)."""
        y = F(position)
        self.walk.append(y)
        counted = False
        if self.sign == 0:
            if abs(y - self.turn) > self.reversal:
                self.sign, self.walk = (1 if y > self.turn else -1), [y]
        else:
            extreme = max(self.walk) if self.sign > 0 else min(self.walk)
            if abs(extreme - y) > self.reversal:
                self.turn, self.sign, self.turned, self.walk = extreme, -self.sign, True, [y]
                counted = True
        return self.amplitude(y - self.turn), counted

    def amplitude(self, way):
        return F(0.5) * abs(way) if self.turned else abs(way)


class Closing:
    """The error, and no less than the size of the move that the target last jumped to, up to sixteen reversals."""

    def __init__(self, reversal, target, position):
        self.reversal, self.target, self.size = F(reversal), F(target), abs(F(target) - F(position))

    def __call__(self, target, position):
        error = abs(F(target) - F(position))
        if abs(F(target) - self.target) > self.reversal:
            self.size = error
        self.target = F(target)
        return max(error, min(self.size, F(16.0) * self.reversal))


def walk(seed: int, n: int = 1500) -> np.ndarray:
    """Positions of an axis that wanders and jitters, in counts of 5 microradians: many reversals, and near ones."""
    draw = np.random.default_rng(seed)
    drift = 6.0 * np.sin(np.arange(n) * draw.uniform(0.01, 0.2)) * draw.uniform(0.1, 1.0)
    return np.round(np.cumsum(drift + draw.normal(size=n) * draw.uniform(0.2, 3.0))) * 5e-6 + draw.uniform(-1, 1)


@pytest.mark.parametrize("seed", range(4))
def test_c_and_python_see_the_same_strokes(follower, seed):
    y = walk(seed).astype(F)
    amplitude, turn = run(follower, "stroke", y)
    reference = Stroke(schedule().reversal, y[0])
    wanted, turns, counted = [F(0)], [y[0]], 0
    for position in y[1:]:
        a, reversed_now = reference.update(position)
        wanted.append(a)
        turns.append(reference.turn)
        counted += reversed_now
    assert counted > 10
    same(amplitude, wanted)
    same(turn, turns)


@pytest.mark.parametrize("seed", range(4))
def test_c_and_python_schedule_the_same_gains(consumer, seed):
    rule, _, binary = consumer
    y = walk(seed).astype(F)
    r = (walk(seed + 100) - y[0]).astype(F)
    got = run(binary, "schedule", r, y)
    reference = Stroke(schedule().reversal, y[0])
    frozen, closing = rule == "frozen", Closing(schedule().reversal, r[0], y[0])
    wanted = [reference.amplitude(r[0] - y[0]) if frozen else closing(r[0], y[0]) if rule == "closing" else F(0)]
    for target, position in zip(r[1:], y[1:], strict=True):
        a, reversed_now = reference.update(position)
        if frozen:
            a = reference.amplitude(target - position) if reversed_now else wanted[-1]
        elif rule == "error":
            a = min(a, reference.amplitude(target - position))
        elif rule == "closing":
            a = closing(target, position)
        wanted.append(a)
    same(got[0], wanted)
    same(got[1:], lookup32(schedule(), wanted))


@pytest.mark.parametrize("rule", ["following", "error", "closing"])
def test_the_exported_rule_looks_up_where_the_simulated_law_does(rule, tmp_path):
    """A step of the simulated loop: its readings given to the C code, and the gains from there those that it commanded with."""
    from workbench.definition import find
    from workbench.plant import ONE_MASS, Limits, Plant
    from workbench.simulation import Loop, ScenarioArrays, simulate

    s = schedule(rule=rule)
    export(s, plant(), tmp_path)
    axis = Plant(ONE_MASS, (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1.6e-3)),
                 limits=Limits(3.3, 12.6))  # fmt: skip
    loop = Loop(2.5e-4, 4, 0.0, 2.5e-4, 4e-6)  # a reversal lies between counts
    m = simulate(axis, loop, scheduled_pd(s, rule), ScenarioArrays(1, target=0.02, phase=0.5), 0.4, ("y", "vh", "u_c"))
    y, vh, u = (m.trajectories[n][:, 0] for n in ("y", "vh", "u_c"))
    _, kp, kd = run(compiled(tmp_path), "schedule", np.full(y.size, 0.02), y)
    wanted = np.clip(kp * (0.02 - y) - kd * vh, -3.3, 3.3)
    assert np.abs(u[1:] - wanted[1:]).max() < 2e-3 * np.abs(u).max() and np.ptp(kp[1:]) > 0.0


def test_amplitude_is_the_stroke_from_rest_and_half_of_it_after_a_reversal(follower):
    c = 2.0**-17  # 7.6 microradians: more than 1.5e-5 rad is two of them
    y = np.array([0, 1, -1, 3, 8, 7, 9, 8, 7, 4, 5, 6, 7], F) * F(c)
    amplitude, turn = run(follower, "stroke", y)
    same(turn / F(c), [0, 0, 0, 0, 0, 0, 0, 0, 9, 9, 9, 4, 4])
    same(amplitude / F(c), [0, 1, 1, 3, 8, 7, 9, 8, 1, 2.5, 2, 1, 1.5])


def test_a_nan_position_is_passed_on_and_forgotten(follower):
    y = walk(0)[:200].astype(F)
    holes = np.insert(y, 100, np.nan)
    amplitude, _ = run(follower, "stroke", holes)
    assert np.isnan(amplitude[100])
    same(np.delete(amplitude, 100), run(follower, "stroke", y)[0])


@pytest.mark.parametrize("rule", ["frozen", "following", "error", "closing"])
def test_the_header_runs_what_the_firmware_runs(rule, tmp_path):
    """Word by word: each line of C by which a firmware follows the motion stands in the header too."""
    made = firmware(scheduled_pd(schedule(rule=rule)), Loop(2.5e-4, 1, resolution=4e-6), AXIS)
    source, text = made.files["axis.c"], export(schedule(rule=rule), plant(), tmp_path)[0].read_text()
    body = source[source.index("static float observe") : source.index("static float command")]

    def alike(line: str) -> str:
        line = line.split(" /*")[0].strip().replace("s->", "state->").replace("k[BACK]", "WB_GAINS_REVERSAL")
        line = line.replace("k[NUMBER_0]", "(16.0f * WB_GAINS_REVERSAL)").replace("wb_high", "wb_max")
        return re.sub(r"\by\b", "position", line).replace("reference", "target").replace("wb_low", "wb_min")

    wanted = [alike(x) for x in body.splitlines() if " = " in x and "vh" not in x and "rate" not in x]
    there = [
        x.split(" /*")[0].strip().replace("wb_table_", "wb_").replace("wb_low", "wb_min") for x in text.splitlines()
    ]
    # the firmware's numbers are never NaN, so that it writes x <= 0 as the opposite of 0 < x, and counts lines with its filter
    there = [re.sub(r"\((\w+) <= 0.0f\)", r"(!(0.0f < \1))", x) for x in there]
    assert len(wanted) > 5 and not [x for x in wanted if x not in there]
