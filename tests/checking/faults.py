"""Faults put into measured campaigns, as wrong cables, wrong settings and wrong units put them there.

Nothing here comes from the workbench: the files are read, changed and written as text.
"""

import gzip
import shutil
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

Table = dict[str, np.ndarray]


class Folder:
    """A copy of a campaign in which columns are changed. Channels are called as campaign.toml calls them."""

    def __init__(self, original: Path, place: Path):
        shutil.copytree(original, place)
        self.place = place
        self.declared = tomllib.loads((place / "campaign.toml").read_text(encoding="utf-8"))
        self.columns = {n: c["column"] for n, c in self.declared["channels"].items()}

    def change(self, change: Callable[[Table], None], *stems: str) -> "Folder":
        """Apply `change` to channel -> (n,) of the records named (of all where none is)."""
        for record in self.declared["records"]:
            file = self.place / record["file"]
            if stems and file.name.split(".")[0] not in stems:
                continue
            raw = file.read_bytes()
            packed = raw[:2] == b"\x1f\x8b"
            head, values = numbers(gzip.decompress(raw) if packed else raw)
            names = head.split(",")
            channel = {column: n for n, column in self.columns.items()}
            table = {channel.get(n, n): values[:, k].copy() for k, n in enumerate(names)}
            change(table)
            order = [table[channel.get(n, n)] for n in names]
            rows = "\n".join(",".join(f"{x:.10g}" for x in row) for row in np.column_stack(order).tolist())
            made = f"{head}\n{rows}\n".encode()
            file.write_bytes(gzip.compress(made, 1) if packed else made)
        return self

    def declare(self, old: str, new: str) -> "Folder":
        """Change the text of campaign.toml."""
        file = self.place / "campaign.toml"
        text = file.read_text(encoding="utf-8")
        assert old in text, old
        file.write_text(text.replace(old, new), encoding="utf-8")
        return self


@cache
def numbers(text: bytes) -> tuple[str, np.ndarray]:
    """Return the head of a file and its numbers, row by row; the same record is given many faults, and read once."""
    head, _, body = text.decode().partition("\n")
    return head, np.loadtxt(body.splitlines(), delimiter=",", ndmin=2)


def drive_of(table: Table) -> str:
    return "torque" if "torque" in table else "force"


def times(channel: str, factor: float) -> Callable[[Table], None]:
    """A channel in another unit, or of the other sign. "drive" is torque or force."""

    def change(t: Table):
        t[drive_of(t) if channel == "drive" else channel] *= factor

    return change


def clip(channel: str, share: float) -> Callable[[Table], None]:
    """A range that ends at a share of what the channel reaches."""

    def change(t: Table):
        name = drive_of(t) if channel == "drive" else channel
        end = share * np.abs(t[name]).max()
        t[name] = np.clip(t[name], -end, end)

    return change


def freeze(channel: str, seconds: float, fast: bool = True) -> Callable[[Table], None]:
    """A channel that holds its value for a while, in the middle of the fastest motion."""

    def change(t: Table):
        name = drive_of(t) if channel == "drive" else channel
        n = round(seconds / np.median(np.diff(t["time"])))
        speed = np.abs(np.gradient(t["position"]))
        inside = np.convolve(speed, np.ones(n), "valid")
        first = int(np.argmax(inside))
        t[name][first : first + n] = t[name][first]

    return change


def late(channel: str, seconds: float) -> Callable[[Table], None]:
    """A channel that stands this much later in the log."""

    def change(t: Table):
        name = drive_of(t) if channel == "drive" else channel
        n = round(seconds / np.median(np.diff(t["time"])))
        t[name] = np.concatenate([np.full(n, t[name][0]), t[name][:-n]])

    return change


def drop(count: int, length: int, *, clock: bool, seed: int = 1) -> Callable[[Table], None]:
    """Samples that are lost in motion. clock: the time channel shows it; else it was made afterwards."""

    def change(t: Table):
        rng = np.random.default_rng(seed)
        speed = np.abs(np.gradient(t["position"]))
        moving = np.flatnonzero(speed > 0.5 * speed.max())
        moving = moving[(moving > 10) & (moving < speed.size - 10 - length)]
        lost = np.concatenate([k + np.arange(length) for k in rng.choice(moving, count, replace=False)])
        kept = np.setdiff1d(np.arange(speed.size), lost)
        time = t["time"][: kept.size]
        for name in t:
            t[name] = t[name][kept]
        if not clock:
            t["time"] = time

    return change


def faster(factor: float) -> Callable[[Table], None]:
    """A clock that runs wrong from the record's first sample on."""

    def change(t: Table):
        t["time"] = t["time"][0] + factor * (t["time"] - t["time"][0])

    return change
