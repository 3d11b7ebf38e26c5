"""Which window of a coordinate a residual is concentrated in: the scan statistic for variances.

Of all windows of neighbouring bins that hold at most half of the samples, the one whose variance and that of the rest make
the data likeliest: the largest N ln s^2 - n ln s_in^2 - (N - n) ln s_out^2 with s_in > s_out.

Source: Kulldorff, Huang and Konty 2009 (a scan statistic for continuous data based on the normal model), for variances.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from workbench.residual.maps import DIRECTION, TIME, Map
from workbench.residual.window import DIRECTIONS, EITHER, Window

MOST = 0.5  # of the samples that a window may hold
QUIET = 1e-300


def _windows(m: Map) -> tuple[np.ndarray, ...]:
    """Return (first bin, last bin + 1, samples, power) of every window of neighbouring bins, (windows,) each."""
    count = np.concatenate([[0.0], np.cumsum(m.count)])
    power = np.concatenate([[0.0], np.cumsum(np.nan_to_num(m.rms) ** 2 * m.count)])
    a, b = np.triu_indices(count.size, 1)
    return a, b, count[b] - count[a], power[b] - power[a]


def likeliest(group: Sequence[Map]) -> Window | None:
    """Return the window of a residual among maps of one coordinate; None where no window is larger than the rest.

    A window of one direction, or of one record, is compared with all else: the other direction and the other records too.
    """
    whole = [m for m in group if m.direction == EITHER]
    samples = float(sum(m.count.sum() for m in whole))
    total = float(sum((np.nan_to_num(m.rms) ** 2 * m.count).sum() for m in whole))
    best, most = None, 0.0
    for m in group:
        a, b, n, power = _windows(m)
        keep = (n >= 1) & (n <= MOST * samples)
        if m.coordinate == DIRECTION:  # what moves backward, rests and moves forward are no neighbours
            keep &= b == a + 1
        if not keep.any():
            continue
        a, b, n, power = a[keep], b[keep], n[keep], power[keep]
        inside, outside = np.maximum(power, QUIET) / n, np.maximum(total - power, QUIET) / (samples - n)
        likelier = samples * np.log(max(total, QUIET) / samples) - n * np.log(inside) - (samples - n) * np.log(outside)
        likelier = np.where(inside > outside, likelier, -np.inf)
        k = int(np.argmax(likelier))
        if likelier[k] > most:
            most = float(likelier[k])
            times, share = float(np.sqrt(inside[k] / outside[k])), float(power[k] / max(total, QUIET))
            low, high = (float(m.edges[i[k]]) for i in (a, b))
            covered = float(n[k] / samples)
            best = Window(
                m.coordinate, ((low, high),), m.direction, share, covered, times, 1.0, unit=m.unit, record=m.record,
            )  # fmt: skip
    return best


def windows(found: Iterable[Map]) -> tuple[Window, ...]:
    """Return the window in each coordinate that has one, the one where the residual stands out most first."""
    groups: dict[str, list[Map]] = {}
    for m in found:
        groups.setdefault(m.coordinate, []).append(m)
    named = [p for p in map(likeliest, groups.values()) if p is not None]
    return tuple(sorted(named, key=lambda p: (not p.stands_out, -p.times, p.coordinate)))


def explained(group: Sequence[Map]) -> float:
    """Return the share of a residual's power that is a function of this coordinate and the direction, by the bins' means.

    The power of a mean is less by its squared standard error, so that noise alone explains nothing.
    """
    whole = [m for m in group if m.direction == EITHER]
    total = sum(float((np.nan_to_num(m.rms) ** 2 * m.count).sum()) for m in whole)
    known = sum(
        float(np.nansum(m.count * (m.mean**2 - m.error**2))) for m in group if m.direction != EITHER or len(group) == 1
    )
    return max(known / total, 0.0) if total > 0.0 else 0.0


def sentence(p: Window, of: str = "residual", span: str = "") -> str:
    """Return "the residual is 4 times larger between 1.2 and 1.5 rad when moving forward", or that none stands out.

    of: what it is called. span: where, in words; in three digits of SI units where absent.
    """
    if not p.stands_out:
        over = {DIRECTION: "ways of motion", TIME: "times and records"}.get(p.coordinate, f"of the {p.coordinate}")
        return f"the {of} is about the same over all {over}"
    if p.coordinate == DIRECTION:
        where = next(
            w for k, w in enumerate(("moving backward", "at rest", "moving forward")) if p.low < k - 1 < p.high
        )
        return f"the {of} is {p.times:.2g} times larger when {where}"
    span = span or f"between {p.low:.3g} and {p.high:.3g} {p.unit}"
    way = f" when moving {DIRECTIONS[p.direction]}" if p.direction else ""
    return f"the {of} is {p.times:.2g} times larger {span}{_named(p)}{way}"


def _named(p: Window) -> str:
    """Return of what the window is, where its unit does not tell: " of velocity", " of record x"."""
    if p.record:
        return f" of the record {p.record}"
    return "" if p.coordinate == "position" else f" of {p.coordinate}"
