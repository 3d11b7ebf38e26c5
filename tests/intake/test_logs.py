"""Logs as people have them: a corpus of layouts in ten variants, and what `new` makes of each.

A guess is silent and wrong where a study is made, a channel is not what it is in truth or has another unit or rate, and
nothing in the campaign says that this is assumed.
"""

import re
import shlex

import numpy as np
import pytest
from logs import LAYOUTS, VARIANTS, made

from workbench.campaign import load
from workbench.errors import WorkbenchError
from workbench.intake.new import new

CHANNELS = {"drive": ("torque", "force"), "position": ("position",), "time": ("time",), "reference": ("reference",)}
REFUSED = ()  # layouts whose logs do not become a study by one flag: at most two of thirty


def flagged(sentence: str, layout, log) -> dict:
    """Return what a user who knows the log says by the flag that a sentence names; nothing where it names none."""
    if "--axis" in sentence:
        return {"axis": layout.axis}
    if "--rate" in sentence:
        return {"rate": layout.rate}
    if found := re.search(r"--channel (drive|position)=", sentence):
        return {"told": {found[1]: log.columns[found[1]]}} if found[1] in log.columns else {}
    if found := re.search(r"--unit (.*)$", sentence):
        column = shlex.split(found[1])[0].rpartition("=")[0]
        (channel,) = [c for c, n in log.columns.items() if n == column]
        return {"units": {column: log.units[channel]}}
    return {}


def tried(layout, log, folder):
    """Return (campaign or None, whether a flag was needed, the sentence that refused it)."""
    try:
        new(folder / "a", [log.path])
        return load(folder / "a" / "campaign"), False, ""
    except WorkbenchError as e:
        flags, sentence = flagged(str(e), layout, log), str(e)
    try:
        new(folder / "b", [log.path], **flags)
        return load(folder / "b" / "campaign"), True, sentence
    except WorkbenchError as e:
        return None, True, f"{sentence} THEN {e}"


def wrong(layout, log, campaign) -> list[str]:
    """Return what is wrong and not said to be assumed."""
    found, record = [], campaign.records[1]  # the second half holds all of the file
    assumed = {f.subject for f in campaign.findings if f.kind == "assumed scale"}
    dt = 1.0 / layout.rate
    if "time" not in assumed and abs(record.dt / dt - 1.0) > 0.05:
        found.append(f"rate {1 / record.dt:g} for {layout.rate:g}")
    at = (record.time - record.time[0]) * (dt / record.dt if "time" in assumed else 1.0)
    for channel, names in CHANNELS.items():
        here = next((n for n in names if n in record.channels), None)
        if channel == "time" or here is None or channel not in log.si:
            continue
        if log.columns[channel] and record.source.columns[here] != log.columns[channel]:
            found.append(f"{here} is column '{record.source.columns[here]}', not '{log.columns[channel]}'")
            continue
        truth = np.interp(at, log.time - log.time[0], log.si[channel])
        mine = record.channels[here]
        inner = slice(20, -20)
        if abs(np.corrcoef(truth[inner], mine[inner])[0, 1]) < 0.98:
            found.append(f"{here} is no reading of the {channel}")
        slope = np.polyfit(truth[inner], mine[inner], 1)[0]
        if here not in assumed and abs(slope - 1.0) > 0.03:
            found.append(f"{here} is {slope:.4g} times what it is")
    return found


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda one: one.name)
def test_a_layout_in_ten_variants_is_never_guessed_wrongly_in_silence(layout, tmp_path):
    passed = 0
    for variant, name in enumerate(VARIANTS):
        folder = tmp_path / str(variant)
        folder.mkdir()
        log = made(layout, variant, folder)
        campaign, _, said = tried(layout, log, folder)
        passed += campaign is not None
        if campaign is not None:
            assert not wrong(layout, log, campaign), name
        elif layout.name not in REFUSED:
            pytest.fail(f"variant '{name}': {said}")
    assert passed == len(VARIANTS) or layout.name in REFUSED


def test_the_corpus_is_as_large_as_it_says():
    assert len(LAYOUTS) >= 30 and len(VARIANTS) == 10
    assert len({one.name for one in LAYOUTS}) == len(LAYOUTS) and all(one.source for one in LAYOUTS)
    assert len(REFUSED) <= 2
