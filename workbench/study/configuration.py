"""study.toml: what a study asks, and what it must reach."""

import ast
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path

from workbench.campaign import FILE as CAMPAIGN
from workbench.errors import WorkbenchError, nearest
from workbench.readers.declaration import Table, read

FILE = "study.toml"
STEPS = "study.py"
DATA = "WORKBENCH_DATA"
KEYS = ("question", "answer", "campaign", "data", "describe", "requirements", "words")
CONTROL = (
    "loop",
    "axis",
    "tuning",
    "schedule",
    "ladder",
    "task",
    "export",
    "plan",
)  # read by study.control, study.planning
SERIES = (
    "robustness",
    "limit_cycle",
    "compensation",
    "drive",
)  # read by study.robustness, .limit_cycle, .compensation, .drive


class MissingData(WorkbenchError):
    """Measured data that the project may not carry is not on this machine."""


@dataclass(frozen=True)
class Requirement:
    """A figure of the study and its bound. at_most, at_least: in `unit`. equals: a word, for figures that are words."""

    name: str
    unit: str = "1"
    at_most: float | None = None
    at_least: float | None = None
    equals: str | None = None

    def passed(self, value) -> bool:
        """Whether a figure meets the bound; NaN meets none."""
        if self.equals is not None:
            return value == self.equals
        if not isinstance(value, (int, float)) or not isfinite(value):
            return False
        return (self.at_most is None or value <= self.at_most) and (self.at_least is None or value >= self.at_least)

    @property
    def bound(self) -> str:
        if self.equals is not None:
            return self.equals
        sides = [f"≥ {self.at_least:g}"] if self.at_least is not None else []
        sides += [f"≤ {self.at_most:g}"] if self.at_most is not None else []
        return " and ".join(sides)


@dataclass(frozen=True)
class Study:
    """folder: the study's own. name: the folder's. table: the checked table of study.toml, for the study's own steps.

    campaign: folder of its campaign, or None. data: file -> (path under WORKBENCH_DATA, sha256) of measured files.
    describe: (lowest, highest, count) of amplitudes in SI. answer: to the question, with {figure} where a number stands. words:
    figure -> what it is called in the report. scheduler: address of a cluster that runs what is many, or "".
    """

    folder: Path
    name: str
    title: str
    question: str
    table: Table
    campaign: Path | None
    data: Mapping[str, tuple[str, str]]
    describe: tuple[float, float, int] | None
    requirements: tuple[Requirement, ...] = field(default=())
    scheduler: str = ""
    answer: str = ""
    words: Mapping[str, str] = field(default_factory=dict)

    def measured(self, key: str) -> Path:
        """Return the path of a measured file, its sha256 checked; MissingData where this machine does not have it."""
        import hashlib

        path, digest = self.data[key]
        root = os.environ.get(DATA)
        if not root:
            raise MissingData(
                f"study '{self.name}' needs measured data that the project may not carry ({path}); "
                f"set {DATA} to the folder that holds it."
            )
        file = Path(root) / path
        if not file.is_file():
            raise MissingData(f"{file}: there is no such file; study '{self.name}' needs it. Set {DATA} to its folder.")
        found = hashlib.sha256(file.read_bytes()).hexdigest()
        if found != digest:
            raise WorkbenchError(
                f"{file}: its sha256 is {found[:16]}..., study '{self.name}' was written for {digest[:16]}...; "
                "obtain the original file."
            )
        return file


def _there(path: Path) -> bool:
    """Whether a path is a file that can be looked at: none has a name of 300 characters."""
    try:
        return path.is_file()
    except OSError:
        return False


def find(name: str) -> Path:
    """Return the folder of a study given as a path or as a name under studies/."""
    for folder in (Path(name), Path("studies") / name):
        if _there(folder / FILE):
            return Path(os.path.abspath(folder))
    known = sorted(p.parent.name for p in Path("studies").glob(f"*/{FILE}"))
    raise WorkbenchError(
        f"there is no study '{name}' ({FILE} is looked for there and under studies/); {nearest(name, known)}"
    )


def campaign_of(name: str) -> Path:
    """Return the campaign's folder of a study given by path or name, or the folder itself where it is a campaign.

    WorkbenchError where it is neither, or a study without a campaign.
    """
    if _there(Path(name) / CAMPAIGN):
        return Path(name)
    if _there(Path(name)):
        raise WorkbenchError(f"'{name}' is a file; name the folder that holds {CAMPAIGN} and its records.")
    try:
        folder = find(name)
    except WorkbenchError as e:
        raise WorkbenchError(f"'{name}' is no folder with a {CAMPAIGN}, and {e}") from None
    _, campaign = _declared(folder)
    if campaign is None:
        raise WorkbenchError(f"study '{folder.name}' reads its data in its own steps; it has no campaign.")
    return campaign


def load(folder: Path) -> Study:
    """Return the study of a folder. Raises WorkbenchError naming the file and key."""
    top, campaign = _declared(folder)
    measured, words = top.named("data"), top.named("words")
    files = {key: measured.table(key, ("path", "sha256")) for key in measured.values}
    data = {key: (one.text("path"), one.text("sha256")) for key, one in files.items()}
    describe = None
    if "describe" in top:
        one = top.table("describe", ("lowest", "highest", "count"))
        describe = (
            one.number("lowest", above=0.0),
            one.number("highest", above=0.0),
            int(one.number("count", above=1.0)),
        )
        if describe[0] >= describe[1]:
            raise WorkbenchError(f"{one.path('lowest')} is {describe[0]:g}, not below 'highest', {describe[1]:g}.")
    return Study(
        folder, folder.name, top.text("title"), top.text("question"), top, campaign, data, describe, requirements(top),
        answer=top.text("answer") if "answer" in top else "", words={name: words.text(name) for name in words.values},
    )  # fmt: skip


def _declared(folder: Path) -> tuple[Table, Path | None]:
    """Return a study's study.toml, whose keys the workbench knows or the study's own steps, and its campaign's folder, None without."""
    further = _further_keys(folder)
    top = read(folder / FILE, ("title",), (*KEYS, *CONTROL, *SERIES, *further))
    if "campaign" not in top:
        return top, None
    text = top.text("campaign")
    campaign = (folder / text).resolve()
    if not (campaign / CAMPAIGN).is_file():
        raise WorkbenchError(f"{top.path('campaign')}: there is no {CAMPAIGN} in '{text}'.")
    return top, campaign


def _further_keys(study_folder: Path) -> tuple[str, ...]:
    """Tables of study.toml that the study's own steps read: FURTHER = (...) in its study.py, read without running it.

    WorkbenchError where it is no Python, or FURTHER no tuple of names.
    """
    path = study_folder / STEPS
    if not path.is_file():
        return ()
    try:
        tree = ast.parse(path.read_bytes(), str(path))
    except (SyntaxError, ValueError, RecursionError, MemoryError) as e:
        line = f", line {e.lineno}" if getattr(e, "lineno", None) else ""
        raise WorkbenchError(f"{path}{line}: is no valid Python ({getattr(e, 'msg', e)}); mend it there.") from e
    for node in tree.body:
        if isinstance(node, ast.Assign) and any(getattr(t, "id", "") == "FURTHER" for t in node.targets):
            try:
                names = ast.literal_eval(node.value)
            except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
                names = None
            if not isinstance(names, (tuple, list)) or not all(isinstance(n, str) for n in names):
                raise WorkbenchError(
                    f'{path}, line {node.lineno}: FURTHER must be a tuple of names of tables in quotes, such as ("rig",).'
                )
            return tuple(names)
    return ()


def requirements(top: Table) -> tuple[Requirement, ...]:
    """Return [requirements]: figure -> { at_most, at_least, unit } or { equals }."""
    inner, found = top.named("requirements"), []
    for name in inner.values:
        one = inner.table(name, optional=("at_most", "at_least", "equals", "unit"))
        if not {"at_most", "at_least", "equals"} & set(one.values):
            raise WorkbenchError(f"{inner.path(name)}: a requirement needs 'at_most', 'at_least' or 'equals'.")
        found.append(
            Requirement(
                name,
                one.text("unit", "1"),
                one.number("at_most") if "at_most" in one else None,
                one.number("at_least") if "at_least" in one else None,
                one.text("equals") if "equals" in one else None,
            )
        )
    return tuple(found)
