"""A proposal in words: campaign.toml and study.toml with a comment on every guess, and the lines that its user reads."""

import json
from collections.abc import Sequence

from workbench.intake.entries import Entry
from workbench.intake.proposal import Channel, Proposal
from workbench.units import effect_unit

INERTIA, VISCOUS = ("inertia", "inertia", "F*s^2/x"), ("viscous_friction", "viscous", "F*s/x")
COULOMB = ("coulomb_friction", "coulomb", "F")
ONE_MASS = tuple(("axis", *effect) for effect in (INERTIA, VISCOUS, COULOMB))
TWO_MASS = (
    *(("motor", *effect) for effect in (INERTIA, VISCOUS, COULOMB)),
    *(("load", *effect) for effect in (INERTIA, VISCOUS, COULOMB)),  # else a gap or a drag at the load takes its place
    ("joint", "linear_stiffness", "stiffness", "F/x"),
    ("joint", "linear_damping", "damping", "F*s/x"),
)


def campaign_text(title: str, p: Proposal, files: Sequence[str]) -> str:
    """Return campaign.toml. files: name of each surveyed file within the folder."""
    said = [
        "# What was measured, and what is believed of the axis. Each guess is followed by its reason; correct what is wrong.",
        *(["# Every line that says `assumed = true` waits for a number from a data sheet."] if _assumed(p) else []),
        "",
        f"title = {json.dumps(title, ensure_ascii=False)}",
        'plant = "two mass"  # an encoder on the motor and one on the load'
        if p.two_mass
        else 'plant = "one mass"  # or "two mass", with an encoder on the motor and one on the load',
        f'evaluation_bandwidth = {{ value = {p.bandwidth!r}, unit = "Hz" }}  # models are compared below it; up to here the '
        "position's spectrum stands above its noise",
        *_limits(p),
    ]
    if p.uneven:
        said.append(f"resample = true  # {p.uneven} time steps are more than 1 % off: samples were dropped or jitter")
    for c in p.channels:
        said += ["", *_channel(c)]
    said += [
        "",
        "# The model that the workbench begins with; it says itself what this lacks. All parameters are fitted.",
    ]
    for at, effect, parameter, unit in TWO_MASS if p.two_mass else ONE_MASS:
        said += ["[[effects]]", f'effect = "{effect}"', f'at = "{at}"']
        said += [
            f'parameters.{parameter} = {{ value = 0.0, unit = "{effect_unit(unit, p.rotary)}", fixed = false }}',
            "",
        ]
    for e in p.entries:
        said += ["[[records]]", f"file = {json.dumps(files[e.survey], ensure_ascii=False)}"]
        said += [f'name = "{e.name}"'] if e.name else []
        said.append(f'role = "{e.role}"  # {e.why}')
        said += ["load_locked = true  # the load's encoder stands"] if e.locked else []
        for key, value in (("from", e.since), ("until", e.until), ("counts_from", e.counts_from)):
            said += [f'{key} = {{ value = {value!r}, unit = "s" }}'] if value is not None else []
        said.append("")
    return "\n".join(said).rstrip() + "\n"


def _assumed(p: Proposal) -> list[str]:
    return [c.guess.channel for c in p.channels if c.scale and c.scale.assumed]


def _limits(p: Proposal) -> list[str]:
    effort, x = ("N*m", "rad") if p.rotary else ("N", "m")
    return [
        f'# actuator_limit = {{ value = 1.0, unit = "{effort}" }}  # of the drive; with it, gains are tuned within it',
        f'# speed_limit = {{ value = 1.0, unit = "{x}/s" }}  # of the axis',
    ]


def _channel(c: Channel) -> list[str]:
    g = c.guess
    said = [
        f"[channels.{g.channel}]  # {g.why}",
        *([f'rate = {{ value = {g.rate!r}, unit = "Hz" }}'] if g.rate else []),
        *([] if g.rate else [f"column = {json.dumps(g.column, ensure_ascii=False)}", f'unit = "{g.unit}"']),
    ]
    if c.scale:
        held = ", assumed = true" if c.scale.assumed else ""
        said.append(f'scale = {{ value = {c.scale.value!r}, unit = "{c.scale.unit}"{held} }}  # {c.scale.why}')
    if c.resolution:
        said.append(f"resolution = {float(f'{c.resolution:.9g}')!r}  # {c.resolution_why}")
    return said


def study_text(title: str, p: Proposal) -> str:
    """Return study.toml: identify, trace and report; and tune, where the campaign states the limit of its drive."""
    x = "rad" if p.rotary else "m"
    step = 1.0 if p.rotary else 0.01
    return f"""\
# What is asked of the campaign. `workbench run` identifies its model, finds what that lacks, and writes the report.

title = {json.dumps(title, ensure_ascii=False)}
question = "Is inertia with viscous and Coulomb friction enough for this axis, and if not, what does it lack?"
campaign = "campaign"

# Once campaign.toml states actuator_limit, gains are tuned, scheduled, compared and exported too. What is not stated below is
# taken from the records, and the report says so: a loop at their rate with one sample of delay, on their encoder; a move over
# half of their travel, no faster than they are; amplitudes from the smallest on at which that loop allows any gains.

[loop] # what the controller runs on
# sample_time = {{ value = {1e3 / p.rate:.9g}, unit = "ms" }}
# delay = {{ value = {1e3 / p.rate:.9g}, unit = "ms" }}  # of the command: one sample of computation
# velocity_filter = {{ value = {1e3 / p.rate:.9g}, unit = "ms" }}  # time constant
# resolution = {{ value = 1e-5, unit = "{x}" }}  # of its encoder

[task] # the move by which controllers are judged
# step = {{ value = {step:g}, unit = "{x}" }}
# duration = {{ value = 1.0, unit = "s" }}

# [axis]
# speed_limit = {{ value = 10.0, unit = "{x}/s" }}

# [tuning] # amplitudes at which gains are tuned
# lowest = {{ value = {1e-4 * step:g}, unit = "{x}" }}
# highest = {{ value = {step:g}, unit = "{x}" }}
# count = 24
"""


def lines_of(p: Proposal, files: Sequence[str]) -> list[str]:
    """Return what was guessed and why, a line each. files: name of each surveyed file within the folder."""
    said = []
    for c in p.channels:
        g = c.guess
        if g.rate:
            said.append(f"{g.channel}: {g.rate:g} Hz - {g.why}.")
            continue
        said.append(f"{g.channel}: column '{g.column}' in '{g.unit}' - {g.why}.")
        if c.scale:
            what = "assumed until you edit it" if c.scale.assumed else "found"
            said.append(f"    scale {c.scale.value:g} {c.scale.unit}, {what}: {c.scale.why}.")
        if c.resolution:
            said.append(f"    encoder step {c.resolution:.6g} {g.unit}: {c.resolution_why}.")
    for e in p.entries:
        said.append(f"{files[e.survey]}{_window(e)}: {e.role} - {e.why}.")
    said.append(f"evaluation bandwidth {p.bandwidth:g} Hz: up to here the position's spectrum stands above its noise.")
    if p.short:
        said.append(f"{p.short} samples are left out: they lie between gaps too near each other for a record.")
    if p.uneven:
        said.append(f"{p.uneven} time steps are more than 1 % off; the records are resampled, and the report says so.")
    return said


def _window(e: Entry) -> str:
    """Say which part of a file is a record, or counts as one."""
    first = e.since if e.counts_from is None else e.counts_from
    since, until = f" from {first:.6g} s" if first is not None else "", f" up to {e.until:.6g} s" if e.until else ""
    return since + (until or (" on" if since else ""))
