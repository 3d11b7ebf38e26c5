"""The firmware on an emulated Cortex-M4 or RISC-V: cross-compiled by zig, run by unicorn, instructions counted."""

import subprocess
import sys
from pathlib import Path

import numpy as np
from elftools.elf.elffile import ELFFile
from firmware_bench import need

from workbench.firmware.host import STRICT, WARNINGS

CPUS = {
    "cortex-m4": ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4+vfp4d16sp"),
    "risc-v": ("-target", "riscv32-freestanding-none", "-mcpu=generic_rv32+m+a+f+c", "-mabi=ilp32f"),
}
SPEED = ("-O2", "-fomit-frame-pointer")
BARE = (
    "-ffreestanding",
    "-nostdlib",
    "-fno-unwind-tables",
    "-fno-asynchronous-unwind-tables",
    "-fno-sanitize=undefined",
)
START = "void _start(void);\nvoid _start(void) { for (;;) {} }\n"
FLASH, RAM, STACK, STOP = 0x0, 0x20000000, 0x20010000, 0x30000000
PAGE = 0x10000


def build(made, folder: Path, change=lambda files: files, cpu: str = "cortex-m4") -> Path:
    """Cross-compile a firmware with its test bench, and return the ELF file."""
    need("ziglang", "no cross compiler here")
    files = change(made.files | made.source.vectors()) | {"start.c": START}
    for name, text in files.items():
        (folder / name).write_text(text)
    out = folder / "firmware.elf"
    sources = [n for n in files if n.endswith(".c")]
    command = [sys.executable, "-m", "ziglang", "cc", *CPUS[cpu], *SPEED, *STRICT, *WARNINGS, *BARE, *sources]
    done = subprocess.run(
        [*command, "-Wl,--no-gc-sections", "-o", str(out)], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return out


class Target:
    """A firmware on the emulated target, its table loaded."""

    def __init__(self, made, folder: Path, change=lambda files: files, cpu: str = "cortex-m4"):
        self.elf = build(made, folder, change, cpu)
        need("unicorn", "no emulator here")
        import unicorn
        from unicorn import arm_const as arm
        from unicorn import riscv_const as riscv

        self.thumb = cpu == "cortex-m4"
        if self.thumb:
            self.uc = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
            self.uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
            names = [f"UC_ARM_REG_{n}" for n in ("SP", "LR", "R0", "R1", "R2", "R3")]
            self.registers = [getattr(arm, n) for n in names]
        else:
            self.uc = unicorn.Uc(unicorn.UC_ARCH_RISCV, unicorn.UC_MODE_RISCV32)
            self.uc.reg_write(riscv.UC_RISCV_REG_MSTATUS, 0x6000)  # the floating-point unit on
            names = [f"UC_RISCV_REG_{n}" for n in ("SP", "RA", "A0", "A1", "A2", "A3")]
            self.registers = [getattr(riscv, n) for n in names]
        self.steps, self.hook = 0, None
        self._load()
        data = made.image.bytes()
        self.data = self.put(data)
        assert self.call("wb_vectors_load", self.data, len(data)) == 0

    def _load(self) -> None:
        with self.elf.open("rb") as file:
            elf = ELFFile(file)
            table = elf.get_section_by_name(".symtab")
            self.symbols = {s.name: (s["st_value"], s["st_size"]) for s in table.iter_symbols() if s.name}
            bench = [place for n, place in self.symbols.items() if n.startswith("wb_vectors")]
            self.bench = min(bench)[0] & ~1, max(at + size for at, size in bench)  # not counted
            segments = [s for s in elf.iter_segments() if s["p_type"] == "PT_LOAD"]
            end = max(s["p_vaddr"] + s["p_memsz"] for s in segments)
            self.uc.mem_map(FLASH, -(-end // PAGE) * PAGE)
            for s in segments:
                self.uc.mem_write(s["p_vaddr"], s.data())
        self.uc.mem_map(RAM, 16 * PAGE)
        self.uc.mem_map(STOP, PAGE)
        self.free = STACK

    def put(self, data: bytes) -> int:
        """Lay bytes into memory, and return where."""
        at, self.free = self.free, -(-(self.free + len(data)) // 8) * 8
        self.uc.mem_write(at, data)
        return at

    def count(self, on: bool) -> None:
        """Count instructions from now on, or no more."""
        import unicorn

        if self.hook is not None:
            self.uc.hook_del(self.hook)
        self.uc.ctl_flush_tb()  # code that was translated without the hook would not call it
        self.hook = self.uc.hook_add(unicorn.UC_HOOK_CODE, self._tick) if on else None

    def _tick(self, uc, address, size, data) -> None:
        self.steps += not self.bench[0] <= address < self.bench[1]

    def call(self, name: str, *arguments: int) -> int:
        stop = STOP | 1 if self.thumb else STOP
        for register, value in zip(self.registers, (STACK - 16, stop, *arguments), strict=False):
            self.uc.reg_write(register, value)
        self.uc.emu_start(self.symbols[name][0] | self.thumb, STOP)
        return self.uc.reg_read(self.registers[2]) & 0xFFFFFFFF

    def vectors(self, states: np.ndarray, words: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return commands (n,), states after (n, k) as bits, and instructions of each step (n,)."""
        state, word = self.put(states[0].tobytes()), self.put(words[0].tobytes())
        after, out, spent = np.zeros_like(states), np.zeros(len(words), np.uint32), np.zeros(len(words), int)
        for i in range(len(words)):
            self.uc.mem_write(state, states[i].tobytes())
            self.call("wb_vectors_set", state)
            self.uc.mem_write(word, words[i].tobytes())
            before = self.steps
            out[i] = self.call("wb_vectors_step", word)
            spent[i] = self.steps - before
            self.call("wb_vectors_get", state)
            after[i] = np.frombuffer(self.uc.mem_read(state, states[i].nbytes), np.uint32)
        return out, after, spent

    def run(self, words: np.ndarray, fresh: np.ndarray) -> np.ndarray:
        """Return the commands' bits of samples `words` (n, 4)."""
        words, fresh = np.ascontiguousarray(words, np.uint32), np.ascontiguousarray(fresh, np.uint8)
        given, began, out = self.put(words.tobytes()), self.put(fresh.tobytes()), self.put(bytes(4 * len(words)))
        self.call("wb_vectors_run", given, began, out, len(words))
        return np.frombuffer(self.uc.mem_read(out, 4 * len(words)), np.uint32)

    @property
    def code(self) -> int:
        """Bytes of code of controller and loader, without the test bench."""
        return sum(size for name, (_, size) in self.symbols.items()
                   if name.startswith("wb_") and not name.startswith("wb_vectors"))  # fmt: skip
