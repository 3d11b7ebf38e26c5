"""What is said where the columns of a log do not tell what they are, and which flag says it."""

import shlex
from collections.abc import Sequence

from workbench.errors import WorkbenchError
from workbench.intake.columns import Columns
from workbench.intake.names import alike


def no_time(columns: Columns, named: Sequence[str]) -> str:
    """Return why no column is the time. named: those that are called so."""
    reasons = [f"'{n}' does not increase from sample to sample" for n in named]
    reasons += [f"left out: {why}" for s in columns.surveys for why in s.refused.values()][:3]
    because = f" ({'; '.join(r.rstrip('.') for r in reasons)})" if reasons else ""
    return (
        f"{columns.surveys[0].path}: no column increases evenly as time does ({', '.join(columns.names)}){because}; say which column it is, "
        "--channel time=COLUMN, or at which rate in Hz the samples were taken, --rate HZ."
    )


def unknown_unit(columns: Columns, name: str) -> WorkbenchError:
    """Return the sentence on a unit that is stated and not known, with the nearest that are."""
    m = columns.meanings[name]
    near = alike(m.unknown, m.kind)
    say = shlex.quote(f"{name}={near[0]}")
    what = f"a {m.kind}" if m.kind else "a column"
    return WorkbenchError(
        f"{columns.surveys[0].path}: column '{name}' states the unit '{m.unknown}', which is not known for {what}; nearest: "
        f"{', '.join(near)}. Say which it is: --unit {say}"
    )


def untold(columns: Columns, rest: Sequence[str]) -> str:
    """Return that drive and position cannot be told. rest: the columns that may be either."""
    refused = [why for s in columns.surveys for why in s.refused.values()]
    still = [n for n in columns.names if not columns.moves(n)]
    left = f" Left out: {' '.join(refused[:3])}" if refused else ""
    left += f" Left out, since they do not move: {', '.join(still)}." if still else ""
    return (
        f"{columns.path}: which column is the drive's torque, force or current and which the position cannot "
        f"be told from the names or the data ({', '.join(rest) or 'none is left'}); say --channel drive=COLUMN "
        f"--channel position=COLUMN.{left}"
    )
