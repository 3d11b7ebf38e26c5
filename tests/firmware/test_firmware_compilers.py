"""The firmware by further compilers: clang and gcc without a warning, gcc's Cortex-M4 in qemu, MC/DC of what is by hand."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from firmware_bench import axes_of, bits_of, every, golden, need
from test_firmware_fuzz import ARITHMETICS, SOURCE, blocks, run

from workbench.firmware import firmware
from workbench.firmware.host import STRICT, WARNINGS

HERE = Path(__file__).parent
CORTEX = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-ffreestanding", "-nostdlib", "-O2")
SCRIPT = """SECTIONS {
 .text 0 : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }
 .data 0x20000000 : { *(.data*) } .bss : { *(.bss*) *(COMMON) }
}
"""


def laid_out(folder: Path, files: dict) -> list[str]:
    for name, text in files.items():
        (folder / name).write_text(text)
    return [n for n in files if n.endswith(".c")]


def compiled(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("name", ["error", "fed forward", "drive, notch", "joint"])
def test_clang_has_no_warning_either(name, arithmetic, tmp_path):
    need("ziglang", "no cross compiler here")
    made = firmware(*every()[name], arithmetic)
    sources = laid_out(tmp_path, made.files | made.source.vectors())
    more = ("-Wshadow", "-Wstrict-prototypes", "-Wundef", "-Wcast-qual", "-Wfloat-conversion", "-Wsign-conversion")
    compiled([sys.executable, "-m", "ziglang", "cc", *STRICT, *WARNINGS, *more, "-O2", "-c", *sources], tmp_path)  # fmt: skip


def array(name: str, values: np.ndarray) -> str:
    """Words as a C array of rows."""
    rows = np.atleast_2d(values.T).T if values.ndim == 1 else values
    body = ",\n".join("{" + ", ".join(f"0x{int(x):X}u" for x in row) + "}" for row in rows)
    return f"static const uint32_t {name}[{len(rows)}][{rows.shape[1]}] = {{\n{body}\n}};\n"


def bench(made, states, words, u, after) -> str:
    """golden.h of qemu.c."""
    data = ", ".join(map(str, made.image.bytes()))
    commands = ", ".join(f"0x{int(x):X}u" for x in u.view(np.uint32))
    head = f"#include <stdint.h>\n#define VECTORS {len(words)}u\n#define STATES {states.shape[1]}u\n"
    return (
        head + f"static const uint8_t image[] = {{{data}}};\nstatic const uint32_t commands[] = {{{commands}}};\n"
        + array("states", states) + array("words", words) + array("wanted", after)
    )  # fmt: skip


@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("wrong", [False, True])
def test_gccs_cortex_m4_agrees_in_qemu_and_a_wrong_sign_does_not(arithmetic, wrong, tmp_path):
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("no cross compiler here")
    if shutil.which("qemu-system-arm") is None:
        pytest.skip("no emulator here")
    made = firmware(*every()["error"], arithmetic)
    states, words = golden(made)
    axes = axes_of(made.reference, states)
    with np.errstate(all="ignore"):
        u = made.reference.step(axes, words[:, 0], words[:, 2], words[:, 3].view(made.reference.dtype), 0)
    files = (
        made.files | made.source.vectors() | {"golden.h": bench(made, states, words, u, bits_of(made.reference, axes))}
    )
    if wrong:
        assert files["axis.c"].count("reference - y") == 2
        files["axis.c"] = files["axis.c"].replace("reference - y", "y - reference")
    sources = laid_out(tmp_path, files | {"qemu.c": (HERE / "qemu.c").read_text(), "link.ld": SCRIPT})
    compiled(["arm-none-eabi-gcc", *CORTEX, *STRICT, *WARNINGS, *sources, "-T", "link.ld", "-lgcc", "-o", "axis.elf"], tmp_path)  # fmt: skip
    board = ["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-semihosting", "-kernel", "axis.elf"]
    left = subprocess.run(board, cwd=tmp_path, capture_output=True, timeout=60).returncode
    assert left == 200 if wrong else left == 0


def measuring() -> str:
    """A clang that measures MC/DC, with its tools beside it, or a skip."""
    for version in ("", *(f"-{n}" for n in range(25, 17, -1))):
        if all(shutil.which(tool + version) for tool in ("clang", "llvm-profdata", "llvm-cov")):
            probe = [f"clang{version}", "-fprofile-instr-generate", "-fcoverage-mapping", "-fcoverage-mcdc", "-x", "c", "-", "-o", "/dev/null"]  # fmt: skip
            if (
                subprocess.run(probe, input="int main(void) { return 0; }", capture_output=True, text=True).returncode
                == 0
            ):
                return version
    pytest.skip("no compiler that measures MC/DC here")


def test_every_condition_by_hand_decides_by_itself(tmp_path):
    """MC/DC of the loader, the encoder and the arithmetic: each condition of a decision is shown to turn it alone."""
    version = measuring()
    objects = []
    for name, arithmetic in [(n, a) for n in ("following", "cascade", "fed forward") for a in ARITHMETICS]:
        made = firmware(*every()[name], arithmetic)
        folder = tmp_path / f"{name}-{arithmetic}".replace(" ", "")
        folder.mkdir()
        sources = laid_out(folder, made.files | {"fuzz.c": SOURCE.read_text()})
        (folder / "tables").write_bytes(b"".join(len(b).to_bytes(4, "little") + b for b in blocks(made)))
        fixed = [f"-DLIMIT_AT={made.numbers.stages.place('limit')}"] + ["-DFIXED"] * (arithmetic == "fixed")
        options = ["-O0", "-fprofile-instr-generate", "-fcoverage-mapping", "-fcoverage-mcdc", "-w"]
        compiled([f"clang{version}", *STRICT, *options, *fixed, *sources, "-o", "fuzz"], folder)
        run(folder, 20000)
        compiled([f"llvm-profdata{version}", "merge", "default.profraw", "-o", "all.profdata"], folder)
        objects.append(folder)
    missed: dict[tuple, set] = {}
    for folder in objects:
        done = subprocess.run(
            [f"llvm-cov{version}", "export", "fuzz", "-instr-profile=all.profdata", "-format=text"],
            cwd=folder, capture_output=True, text=True, check=True,
        )  # fmt: skip
        for file in json.loads(done.stdout)["data"][0]["files"]:
            if not Path(file["filename"]).name.startswith("wb_"):
                continue
            for record in file["mcdc_records"]:
                place = Path(file["filename"]).name, record[0]
                open_ = {i for i, shown in enumerate(record[-1]) if not shown}
                missed[place] = missed[place] & open_ if place in missed else open_
    assert len(missed) > 10
    assert not {k: v for k, v in missed.items() if v}
