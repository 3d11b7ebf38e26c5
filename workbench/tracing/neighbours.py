"""What the neighbours of a stretch of record say of it, in bench time or in place, out of sample; and levels that no noise has."""

from collections.abc import Sequence

import numpy as np

from workbench.tracing.lines import Part

STRETCH = 0.25  # s
# Changes of a level from stretch to stretch that are enough to call few of them steps, and of their power what these hold then. Of eight
# complete axes, three of them with low-frequency noise, steps hold nothing; of a joint that slips (33 changes), of pushes and an air jet 0.57
# to 0.96, of a brake that drags 0.49, of what wanders 0.21 to 0.36. Each halved or doubled, noise stays noise and a slip a slip
FEWEST, STEPPED = 10, 0.25
# Skewness of these changes that no noise has, and share of the residual that the level is then: noise of any colour rises as it falls. Of thirteen
# complete axes it is 0.9 and less, where the level is 0.25 and less; of a valve that recharges what leaks away 1.6, of 0.77. Each halved, and
# skewness doubled: as it is, and the valve is noise
SKEWED, MOSTLY = 1.0, 0.5
# s, widths of the neighbourhood in bench time. The first is a stretch: without it a brake that drags for 0.25 to 1.1 s at a time is noise, with it 108
# complete axes have 0.76 % of the drive more at most
SPANS = (0.25, 0.5, 2.0, 8.0)
# s, a stretch of a payload, and widths of the neighbourhood: a move between two dwells is a second and less. Of a gripper that carries a piece in half of its
# moves (0.3 to 0.5 s) 5.4 % of the drive, where a stretch of 0.05 has 5.7, one of 0.15 4.2 and one of 0.25 nothing; no complete model of 22 shows anything with it.
HANDLED, PAYLOADS = 0.1, (0.1, 0.2, 0.5, 2.0)
# Share of that which a force alone takes at most: beside what wanders a mass is found, too. Of 19 unknown causes two payloads show no force and a drive that folds
# back one of 0.15; of the others it is 0.55 (a payload, too), 0.72 and more. Halved, the same three; doubled, a level that wanders is one
WEIGHT = 0.5
RIDGE = 1e-3  # of a stretch's mean square, added to what the neighbours say, for one that has none; ten times less or more changes no tenth of what is taken
CERTAIN = 3.0  # standard errors over blocks by which a share must differ from zero


def over_time(parts: Sequence[Part], least: float) -> tuple[float, float]:
    """Return the power that neighbours in bench time predict as a friction, a damping or a mass, where no level that they predict over the same span takes as
    much, and that which they predict as a level: each the best of SPANS.

    A force alone that neighbours predict is low-frequency noise inside the loop (pink noise of a floor: 3 to 7 % of the drive on complete
    models); what of it follows a law is asked as force over time, and pushes are moments. Over one swing a level looks like a friction. A level
    that steps now and then is none: where changes beyond `least` robust standard deviations hold a good part of what it changes, it counts; nor is
    one that is most of the residual, and creeps one way and jumps the other.
    """
    sums, changes = [], []
    for p in parts:
        stretch = np.floor((p.time - p.time[0]) / STRETCH).astype(int)
        r = np.where(p.moves, p.residual, 0.0)
        along = [np.where(p.moves, x, 0.0) for x in (np.ones(r.size), p.way, *p.outside.T[1:3])]
        at = p.time[0] + (np.arange(stretch[-1] + 1) + 0.5) * STRETCH
        power, *found = (np.bincount(stretch, w) for w in (r**2, *(r * x for x in along), *(x**2 for x in along)))
        sums.append(np.stack([at, power, *found]))
        full = found[4] > 0.5 * found[4].max()
        changes.append(np.diff(found[0] / np.maximum(found[4], 1e-300))[full[1:] & full[:-1]])
    at, power, *pairs = np.concatenate(sums, axis=1)
    best, most = 0.0, 0.0
    for span in SPANS:
        level, *ways = (
            gained(power, power - 2.0 * mean * total + mean**2 * weight)
            for total, weight in zip(pairs[:4], pairs[4:], strict=True)
            for mean in [of_neighbours(at, span, total, weight)]
        )
        best, most = max([best, *(x for x in ways if x > level)]), max(most, level)
    if _in_steps(np.concatenate(changes), least):
        return max(best, most), most
    mean = of_neighbours(at, STRETCH, pairs[0], pairs[4])
    near = gained(power, power - 2.0 * mean * pairs[0] + mean**2 * pairs[4])
    held = float(np.sum(pairs[0] ** 2 / np.maximum(pairs[4], 1.0)))
    returns = held > MOSTLY * float(power.sum()) and _one_sided(np.concatenate(changes))
    return max(best, near) if returns else best, most


def gain_over_time(parts: Sequence[Part]) -> float:
    """Return the power that neighbours in bench time predict as a share of the model's own drive, where no level that they predict over the same
    span takes as much: of a drive whose gain changes slowly, as a magnet's that warms up or a supply's that sags. The best of SPANS."""
    sums = []
    for p in parts:
        stretch = np.floor((p.time - p.time[0]) / STRETCH).astype(int)
        r, model = p.residual, p.drive - p.residual
        at = p.time[0] + (np.arange(stretch[-1] + 1) + 0.5) * STRETCH
        products = (r**2, r, np.ones(r.size), r * model, model**2)
        sums.append(np.stack([at, *(np.bincount(stretch, w) for w in products)]))
    at, power, *pairs = np.concatenate(sums, axis=1)
    best = 0.0
    for span in SPANS:
        level, share = (
            gained(power, power - 2.0 * mean * total + mean**2 * weight)
            for total, weight in (pairs[:2], pairs[2:])
            for mean in [of_neighbours(at, span, total, weight)]
        )
        best = max(best, share if share > level else 0.0)
    return best


def payload_over_time(parts: Sequence[Part]) -> float:
    """Return the power that neighbours in bench time predict as a mass and a force together, of which the force alone is less than WEIGHT: of
    a piece that a gripper takes and puts down, whose weight pulls and whose mass is moved. The best of PAYLOADS."""
    best = 0.0
    for span in PAYLOADS:
        power, force, both = (np.concatenate(x) for x in zip(*(_told_of_payload(p, span) for p in parts), strict=True))
        taken = gained(power, both)
        best = max(best, taken if gained(power, force) < WEIGHT * taken else 0.0)
    return best


def _told_of_payload(p: Part, span: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the power (stretches,) of a record's residual, and what is left of it by its neighbours as a force, and as a force and a mass."""
    stretch = np.floor((p.time - p.time[0]) / HANDLED).astype(int)
    r, *x = (np.where(p.moves, y, 0.0) for y in (p.residual, np.ones(p.residual.size), p.outside[:, 2]))
    x = [y / max(float(np.sqrt(np.mean(y**2))), 1e-300) for y in x]
    power = np.bincount(stretch, r**2)
    moments = np.stack([np.bincount(stretch, r * y) for y in x], axis=1)
    gram = np.stack([[np.bincount(stretch, y * z) for z in x] for y in x]).transpose(2, 0, 1)
    near = np.exp(-0.5 * (HANDLED * np.subtract.outer(*2 * [np.arange(power.size)]) / span) ** 2)
    np.fill_diagonal(near, 0.0)
    left = []
    for k in (1, 2):
        g, m = gram[:, :k, :k], moments[:, :k]
        told = np.einsum("ij,jkl->ikl", near, g) + (RIDGE * r.size / power.size) * np.eye(k)
        c = np.linalg.solve(told, (near @ m)[..., None])[..., 0]
        left.append(power - 2.0 * np.sum(c * m, axis=1) + np.einsum("ik,ikl,il->i", c, g, c))
    return power, *left


def _in_steps(changes: np.ndarray, least: float) -> bool:
    """Whether few of a level's changes (n,) from stretch to stretch, beyond `least` robust standard deviations, hold STEPPED of their power."""
    if changes.size < FEWEST:
        return False
    size = np.abs(changes)
    few = size > least * 1.4826 * np.median(size)
    return float(np.sum(size[few] ** 2)) > STEPPED * float(np.sum(size**2))


def _one_sided(changes: np.ndarray) -> bool:
    """Whether a level's changes (n,) go one way by little and the other by much: skewness beyond SKEWED and CERTAIN of its standard
    errors. Source: of a normal sample that is sqrt(6/n); Fisher 1930, Proc. Royal Society A 130, 16-28."""
    if changes.size < FEWEST:
        return False
    d = changes - changes.mean()
    skewness = abs(float(np.mean(d**3))) / max(float(np.mean(d**2)) ** 1.5, 1e-300)
    return skewness > max(SKEWED, CERTAIN * np.sqrt(6.0 / d.size))


def of_neighbours(at: np.ndarray, width: float, total: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the coefficient (n,) that the others say, nearer ones more: total over weight, by a Gaussian of this width over `at`."""
    near = np.exp(-0.5 * ((at[:, None] - at) / width) ** 2)
    np.fill_diagonal(near, 0.0)
    return near @ total / np.maximum(near @ weight, 1e-300)


def gained(before: np.ndarray, after: np.ndarray) -> float:
    """Return the power taken away over blocks, 0 where it does not differ from zero by CERTAIN standard errors of the share.

    A block that is told badly lowers the share as it is; it makes what the others say no less certain than the one that is told best does. Else
    one pass of a door, told at twice its size, hides a drag that all the others show.
    """
    whole = float(before.sum())
    g = 1.0 - float(after.sum()) / whole if whole > 0.0 else 0.0
    spread = (before - after) - g * before
    spread = np.maximum(spread, -spread.max(initial=0.0))
    n = before.size
    scatter = np.sqrt(n / max(n - 1, 1) * (spread @ spread)) / whole if whole > 0.0 else np.inf
    return g * whole if g > CERTAIN * scatter else 0.0
