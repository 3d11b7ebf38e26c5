"""Where the residual lives: small multiples of its mean and size over everything that it may follow, before and after."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.finding import capital
from workbench.report import numbers
from workbench.report import residual_figures as figures
from workbench.report.contents import Block, Chapter, Figure, Heading, Items, Paragraph, StudyResult, Table
from workbench.report.residual_figures import SPREAD, Shade
from workbench.report.unknown import localised, shade
from workbench.report.wording import listed, span
from workbench.residual.maps import BINS, DIRECTION, MOTOR_TURN, POSITION_NAME, TIME, TURN
from workbench.residual.residual_maps import ResidualMaps
from workbench.residual.spectra import STANDS_OUT
from workbench.residual.window import Window
from workbench.residual.windows import sentence

ANGLE = (
    "With an encoder on both sides the load's motion asks for a deflection of the joint, and there is a measured one; the angle "
    "residual is the first less the second: what the load's balance leaves, over the joint's mean stiffness."
)
FOLLOWS = 0.05  # share of the residual's power from which it is said to follow a coordinate
CLOSELY = 0.3  # share from which that is the finding, rather than a window in which the residual is larger
NAMED = 3  # windows said, those where the residual stands out most: one window shows in several coordinates
PLACES = (POSITION_NAME, TURN, MOTOR_TURN)


def where_it_lives(result: StudyResult) -> Chapter | None:
    """The chapter: over place, over motion, over time, over frequency and order; in the angle too, where there is one. What no effect
    explains stands first, and is shaded in the graphs of the drive."""
    unknown = (Heading("Where it lives"), localised(result)) if result.trace.unknown else ()
    blocks = (*unknown, *_mapped(result.residual_maps, shade(result)))
    return Chapter("Where the residual lives", blocks) if blocks else None


def _mapped(found: Sequence[ResidualMaps], shaded: Shade | None) -> list[Block]:
    """Return what is said and drawn of the maps."""
    text = (
        "What a residual follows tells what it comes from. The residual of the identification records is held "
        "against each coordinate in bins, for each way of motion: its mean, with two standard errors (over visits to a bin, "
        "since neighbouring samples are no independent witnesses), and its rms. A coordinate explains the share of the "
        "residual's power that the means hold. Where a window of a coordinate holds plainly more of the residual than the "
        "rest, it is the one whose variance differs most likely from the rest's."
    )
    blocks: list[Block] = []
    every = [_words(w) for w in found]
    for k, (w, words) in enumerate(zip(found, every, strict=True)):
        if w.of == "angle":
            blocks += [Heading("In the angle of the joint"), Paragraph(ANGLE + _balanced(w))]
        blocks += [Items(tuple(_told(w, words))), *([] if k else [Paragraph(text)])]
        blocks += [*_drawn(w, words, shaded if w.of != "angle" else None), _ways(w)]
    return blocks


def _balanced(w: ResidualMaps) -> str:
    """Return the error of the load's balance: the second one, beside that of the drive."""
    texts = []
    for role, errors in w.load.items():
        before, *after = (numbers.percent(e) for e in errors)
        texts.append(f"{before} on {role}" + "".join(f" ({a} with the extended model)" for a in after))
    return f" The load's balance leaves {listed(texts)}, in per cent of the joint's torque." if texts else ""


@dataclass(frozen=True)
class Words:
    """What is said of the window in each coordinate: of the declared model's residual, and of the extended one's."""

    before: Mapping[str, str]
    after: Mapping[str, str]


def _words(w: ResidualMaps) -> Words:
    """Return what is said of each window."""
    every = [
        {p.coordinate: sentence(p, _name(w), span(p.low, p.high, p.unit)) for p in residual.windows} if residual else {}
        for residual in (w.before, w.after)
    ]
    return Words(*every)


def _name(w: ResidualMaps) -> str:
    return "residual" if w.of in ("torque", "force") else f"{w.of} residual"


def _standing(w: ResidualMaps) -> list[Window]:
    return [p for p in w.before.windows if p.stands_out]


def _told(w: ResidualMaps, words: Words) -> list[str]:
    """Return sentences: what the residual follows most, and the windows that stand out."""
    best = _ranked(w)[0]
    share = w.before.explained(best)
    if share >= FOLLOWS:
        texts = [
            f"{capital(best)} and the way of motion explain {numbers.percent(share)} of the {_name(w)}'s power{_then(w, best)}."
        ]
    else:
        texts = [f"No coordinate explains more than {numbers.percent(max(share, 1e-3))} of the {_name(w)}'s power."]
    texts += [f"{capital(words.before[p.coordinate])}{_later(w, words, p)}." for p in _standing(w)[:NAMED]]
    return texts


def _ranked(w: ResidualMaps) -> list[str]:
    """Return the coordinates, the one that explains most first."""
    names = dict.fromkeys(m.coordinate for m in w.before.maps if not m.record)
    return sorted(names, key=lambda n: -w.before.explained(n))


def _then(w: ResidualMaps, coordinate: str) -> str:
    """Return what a coordinate explains of the extended model's residual."""
    if w.after is None:
        return ""
    return f", and {numbers.percent(w.after.explained(coordinate))} of what the extended model leaves"


def _later(w: ResidualMaps, words: Words, p: Window) -> str:
    """Return whether a window stands out in the extended model's residual too."""
    if w.after is None:
        return ""
    other = w.after.window(p.coordinate)
    if other is None or not other.stands_out:
        return "; in the extended model's residual nothing stands out there"
    return f"; for the extended model {words.after[p.coordinate]}"


def _drawn(w: ResidualMaps, words: Words, shade: Shade | None = None) -> list[Figure]:
    """Return the figures of one residual."""
    coordinates = [c for c in dict.fromkeys(m.coordinate for m in w.before.maps) if c not in (DIRECTION, TIME)]
    rows = {"place": [c for c in coordinates if c in PLACES], "motion": [c for c in coordinates if c not in PLACES]}
    made = [_multiples(w, words, kind, chosen, shade) for kind, chosen in rows.items()]
    if w.before.over(TIME):
        made.append(_over_time(w, words, shade))
    return [*made, _spectra(w)]


def _heading(w: ResidualMaps, words: Words, coordinates: Sequence[str]) -> str:
    """Return which coordinate the residual follows; where it follows none closely, the window that stands out most."""
    best = max(coordinates, key=w.before.explained)
    share = w.before.explained(best)
    places = [p for p in _standing(w) if p.coordinate in coordinates]
    if places and share < CLOSELY:
        return capital(words.before[places[0].coordinate])
    if share < FOLLOWS:
        return f"The {_name(w)} follows none of these: {numbers.percent(share)} of its power at most"
    return f"{capital(best)} and the way of motion explain {numbers.percent(share)} of the {_name(w)}'s power{_then(w, best)}"


def _both(w: ResidualMaps) -> str:
    return "of the declared and the extended model" if w.after else "of the declared model"


def _multiples(
    w: ResidualMaps, words: Words, kind: str, coordinates: Sequence[str], shade: Shade | None = None
) -> Figure:
    """Return one figure: a row a coordinate, backward motion on the left and forward motion on the right."""
    shade = shade if shade and shade.coordinate in coordinates else None
    title = shade.title if shade else _heading(w, words, coordinates)
    others = "; ".join(f"{c} explains {numbers.percent(w.before.explained(c))}" for c in coordinates)
    caption = (
        f"Residual of the {w.of} over {listed(coordinates)}: mean with two standard errors (line and area) and rms (dotted), "
        f"{_both(w)}. {capital(others)} of the declared model's."
    )
    return Figure(
        f"where_{w.of}_{kind}",
        lambda: figures.multiples(title, w, coordinates, shade),
        caption,
        f"{2 * len(coordinates)} graphs, a row a coordinate. {title}. {others}.",
    )


def _ways(w: ResidualMaps) -> Table:
    """Return the residual of each way of motion in numbers."""
    found = [r.over(DIRECTION)[0] for r in (w.before, w.after) if r]
    factor, unit = numbers.prefixed(float(np.nanmax(found[0].rms)), w.unit)
    rows = []
    for k, way in enumerate(("backward", "at rest", "forward")):
        share = numbers.percent(float(found[0].count[k] / found[0].count.sum()))
        means = (numbers.plus_minus(float(m.mean[k]) * factor, SPREAD * float(m.error[k]) * factor) for m in found)
        cells = ((mean, numbers.number(float(m.rms[k]) * factor)) for mean, m in zip(means, found, strict=True))
        rows.append((way, share, *(c for pair in cells for c in pair)))
    models = ("declared", "extended")[: len(found)]
    columns = (
        "way of motion",
        "of the samples",
        *(f"{what} ({unit}), {m}" for m in models for what in ("mean", "rms")),
    )
    caption = f"The residual of the {w.of} by the way of motion: mean with two standard errors, and rms."
    return Table(columns, tuple(rows), caption, "lr" + "rr" * len(found))


def _over_time(w: ResidualMaps, words: Words, shade: Shade | None = None) -> Figure:
    """Return the residual on each record over time."""
    records = [m.record for m in w.before.over(TIME)]
    place = w.before.window(TIME)
    shade = shade if shade and shade.coordinate == TIME else None
    if shade:
        title = shade.title
    else:
        title = capital(words.before[TIME]) if place and place.stands_out else _falling(w)
    return Figure(
        f"where_{w.of}_time",
        lambda: figures.over_time(title, w, shade),
        f"Rms residual of the {w.of} in {BINS} stretches of each record, {_both(w)}.",
        f"{len(records)} graphs over time, one a record: {listed(records)}. {title}.",
    )


def _falling(w: ResidualMaps) -> str:
    """Return by how much the residual falls on the records, or how large it is on them."""
    now = w.after or w.before
    rms = [[float(np.sqrt(np.sum(m.rms**2 * m.count) / m.count.sum())) for m in r.over(TIME)] for r in (w.before, now)]
    if w.after is None:
        factor, unit = numbers.prefixed(max(rms[0]), w.unit)
        low, high = (numbers.number(f(rms[0]) * factor) for f in (min, max))
        return f"On no record a time stands out: the {_name(w)} is {low} to {high} {unit} rms"
    ratios = [a / b for a, b in zip(*rms, strict=True) if b > 0.0]
    low, high = (numbers.number(f(ratios, default=1.0), 2) for f in (min, max))
    by = low if low == high else f"{low} to {high}"
    return f"On no record a time stands out; the {_name(w)} is {by} times smaller with the extended model"


def _spectra(w: ResidualMaps) -> Figure:
    """Return the residual over frequency and over order."""
    frequency, order = w.before.spectra
    low, high = frequency.band
    there = span(low, high, "Hz") if low else f"below {numbers.scaled(high, 'Hz')}"
    title = f"Half of the {_name(w)}'s power lies {there}"
    line, times = order.lines[0] if order.lines else (0.0, 0.0)
    if times >= STANDS_OUT:
        title += f"; order {numbers.exact(line, 3)} is {numbers.number(times, 2)} times the orders about it"
    caption = (
        f"Residual of the {w.of}, {_both(w)}: density over frequency (top), and amplitude over order, the spectrum over "
        f"position (bottom); an order of k has k waves in 2\u03c0 {'rad, a turn' if w.rotary else 'm'}."
    )
    return Figure(f"where_{w.of}_spectra", lambda: figures.spectra(title, w), caption, f"Two graphs. {title}.")
