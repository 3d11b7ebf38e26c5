"""The firmware under sanitizers, a million calls, and every line and branch of what is written by hand.

Run by itself (`make fuzz`) it makes a hundred million calls of each law.
"""

import gzip
import json
import shutil
import struct
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import every, need_compiler
from test_firmware_table import changed

from workbench.firmware import firmware, host

SOURCE = Path(__file__).with_name("fuzz.c")
LAWS = ("following", "frozen", "following, profiled", "fed forward", "cascade")
ARITHMETICS = ("float32", "fixed")


def blocks(made) -> list[bytes]:
    """The table, and one of each kind that is refused."""
    image = made.image
    data = image.bytes()
    fields = {"version": 9, "arithmetic": 7, "law": 1, "plant": bytes(32), "knots": 0, "constants": 3, "rows": 1, "bits": 1,
              "jump": 2**30, "verdict": 7, "sample_time": -1.0, "count": np.nan, "limit": 0.0, "per_octave": 3}  # fmt: skip
    if not image.knots.size:
        del fields["per_octave"]  # there are none
    bad = [changed(data, name, value) for name, value in fields.items()]
    bad += [changed(data, "knots", n) for n in (10**6, max(image.knots.size - 1, 0))]
    bad += [
        changed(data, "count", np.inf),
        changed(data, "limit", np.inf),
        changed(data, "bits", 33),
        changed(data, "verdict", 16),
        data[:40],
        data[:-1],
        data + b"\0",
        data[:-1] + bytes((data[-1] ^ 1,)),
    ]
    bad += [b"X" + data[1:], data[:8] + data[8:12][::-1] + data[12:]]
    if image.knots.size:
        off = np.array(image.knots)
        off[1] = off[0]
        bad += [replace(image, knots=off).bytes(), replace(image, knots=-np.array(image.knots)).bytes()]
        bad += [replace(image, knots=0.0 * np.array(image.knots)).bytes()]
    if made.image.arithmetic == 1:
        constants = np.array(image.constants)
        constants[0] = np.inf
        bad += [replace(image, constants=constants).bytes()]
    return [data, *(b for b in bad if b != data)]


def built(folder: Path, made, options) -> Path:
    """Compile the fuzzer for a firmware."""
    need_compiler()
    for name, text in made.files.items():
        (folder / name).write_text(text)
    shutil.copy(SOURCE, folder)
    (folder / "tables").write_bytes(b"".join(struct.pack("<I", len(b)) + b for b in blocks(made)))
    fixed = [f"-DLIMIT_AT={made.numbers.stages.place('limit')}"] + ["-DFIXED"] * (made.image.arithmetic == 2)
    sources = [n for n in made.files if n.endswith(".c")] + ["fuzz.c"]
    command = [host.compiler(), *host.STRICT, *host.WARNINGS, "-Wno-overlength-strings", *fixed, *options, *sources]
    done = subprocess.run([*command, "-o", "fuzz"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "fuzz"


def run(folder: Path, calls: int, seed: int = 1) -> str:
    done = subprocess.run(["./fuzz", "tables", str(calls), str(seed)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
def test_a_hundred_thousand_calls_under_the_sanitizers_break_nothing(name, arithmetic, tmp_path):
    """Ten such runs are a million calls."""
    made = firmware(*every()[name], arithmetic)
    built(tmp_path, made, ["-O1", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"])
    said = run(tmp_path, 100000, seed=len(name))
    assert said.endswith("100000 calls\n")
    codes = [int(line) for line in said.splitlines()[1:-1]]
    assert codes[0] == 0 and 0 not in codes[1:]
    roots = [int(word, 16) for word in said.split()[:10]]
    values = np.array([0.0, -1.0, 1e-45, 1e-39, 1e-30, 0.5, 1.0, 2.0, 3.4e38, np.inf], np.float32)
    assert np.array_equal(np.array(roots, np.uint32).view(np.float32), np.sqrt(np.maximum(values, 0)))


def covered(folder: Path) -> dict[str, dict]:
    """File -> {line: (count, branch counts)} by gcov, of every file by hand."""
    found: dict[str, dict] = {}
    subprocess.run(
        ["gcov", "-b", "-j", *(p.name for p in folder.glob("*.gcda"))], cwd=folder, capture_output=True, check=True
    )
    for path in folder.glob("*.gcov.json.gz"):
        for file in json.loads(gzip.decompress(path.read_bytes()))["files"]:
            if file["file"].startswith("wb_"):
                lines = found.setdefault(file["file"], {})
                for line in file["lines"]:
                    key = line["line_number"], line.get("function_name", "")
                    count, branches = lines.get(key, (0, [0] * len(line["branches"])))
                    more = [b["count"] for b in line["branches"]]
                    same = len(more) == len(branches)
                    lines[key] = (
                        count + line["count"],
                        [a + b for a, b in zip(branches, more, strict=True)] if same else more,
                    )
    return found


def test_every_line_and_branch_by_hand_is_run(tmp_path):
    if shutil.which("gcov") is None or "gcc" not in host.compiler():
        pytest.skip("no C compiler here")
    total: dict[str, dict] = {}
    for name, arithmetic in [(n, a) for n in ("following", "fed forward", "cascade") for a in ARITHMETICS]:
        folder = tmp_path / f"{name}-{arithmetic}".replace(" ", "")
        folder.mkdir()
        built(folder, firmware(*every()[name], arithmetic), ["-O0", "--coverage", "-fno-inline"])
        run(folder, 20000)
        for file, lines in covered(folder).items():
            for key, (count, branches) in lines.items():
                before = total.setdefault(file, {}).get(key, (0, [0] * len(branches)))
                total[file][key] = before[0] + count, [a + b for a, b in zip(before[1], branches, strict=False)]
    missed = [f"{file}:{n} in {f}" for file, lines in total.items() for (n, f), (count, b) in sorted(lines.items())
              if not count or not all(b)]  # fmt: skip
    assert set(total) == {"wb_runtime.c", "wb_runtime.h", "wb_root.c", "wb_fixed.c", "wb_fixed.h"}
    assert not missed, "\n".join(missed)


if __name__ == "__main__":
    for law in LAWS:
        for kind in ARITHMETICS:
            with tempfile.TemporaryDirectory() as place:
                built(
                    Path(place),
                    firmware(*every()[law], kind),
                    ["-O2", "-fsanitize=undefined", "-fno-sanitize-recover=all"],
                )
                print(f"{law}, {kind}: {run(Path(place), int(sys.argv[1]), seed=7).splitlines()[-1]}", flush=True)
