"""A drive that takes no code: its law is the textbook's, its gains keep |S| with lag and notches, and its files are written."""

import json
import tomllib
from dataclasses import replace
from math import pi
from types import SimpleNamespace

import numpy as np
import pytest

from workbench.control import drive_cascade, pi_cascade
from workbench.control.notched import coefficients, response
from workbench.definition import find
from workbench.description import Equivalent
from workbench.drive_tuning.cases import Lagged, slowed
from workbench.drive_tuning.comparison import ComparedDrive, compare_sizes, following_errors
from workbench.drive_tuning.gains import ClosedDrive, behind, sizes_of
from workbench.drive_tuning.search import Strategy, cases, tune_drive
from workbench.drives import Units, elmo
from workbench.drives.files import FormatOptions, files
from workbench.drives.objects import Object, entries, value_of
from workbench.drives.tuned import cascades
from workbench.errors import WorkbenchError
from workbench.frequency import Response
from workbench.frequency.notch import Notch
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.readers.declaration import Table
from workbench.report.drive import drive_chapter
from workbench.simulation import Loop, Scenario, simulate
from workbench.study.drive import OPTIONAL, driven, stated
from workbench.task.task import Task

TS, J, COUNT = 5e-4, 0.0074, 4.8e-6
LOOP = Loop(TS, 2, TS, TS, COUNT)
AXIS = Plant(
    ONE_MASS,
    (find("inertia")(inertia=J), find("viscous_friction")(viscous=0.02), find("coulomb_friction")(coulomb=0.05)),
    limits=Limits(3.3, 20.0),
)
TASK = Task(AXIS, LOOP, 0.1, 0.1, inertias=(0.8, 1.2), phases=1)
NOTCHES = (Notch(180.0, 60.0, 0.1), Notch(320.0, 90.0, 0.3))
DESCRIBED = Equivalent(np.array([1e-4, 1.0]), np.array([20.0, 0.05]), np.zeros(2))
BEGIN = np.array([1e-4, 1.0]), np.array([400.0, 60.0]), np.array([2.5, 1.0])


def test_a_sampled_notch_is_the_continuous_one_at_its_warped_frequency():
    theta = np.geomspace(1e-2, 3.0, 50)
    for notch in NOTCHES:
        warp = notch.centre / np.tan(pi * notch.centre * TS) * np.tan(theta / 2.0)
        assert np.allclose(response((notch,), theta, TS), notch.at(warp), rtol=1e-12)
    b0, b1, b2, a2 = coefficients(NOTCHES[0], TS)
    assert b0 + b1 + b2 == pytest.approx(1.0 + b1 + a2)  # whatever rests passes
    with pytest.raises(WorkbenchError, match="below 1000 Hz"):
        coefficients(Notch(1200.0, 60.0, 0.1), TS)
    with pytest.raises(WorkbenchError, match="up to 4"):
        drive_cascade(1.0, 1.0, 1.0, 1.0, sample_time=TS, notches=NOTCHES * 3)


def test_without_notches_and_feed_forward_the_drive_is_the_cascade():
    scenario = [Scenario(target=0.1, phase=0.5)]
    numbers = (60.0, 1.2, 20.0, 15.0)
    one, other = (
        simulate(AXIS, LOOP, law, scenario, 0.1, ("q", "u")).trajectories
        for law in (pi_cascade(*numbers), drive_cascade(*numbers, sample_time=TS))
    )
    assert np.array_equal(one["u"], other["u"]) and np.array_equal(one["q"], other["q"])


def test_notches_in_the_simulated_law_are_those_of_the_response():
    """A sine that is added to nothing else: the speed's share of the drive's command, through one notch and none."""
    t = np.arange(4000) * TS
    frequency = 180.0
    axis = Plant(
        ONE_MASS, (find("inertia")(inertia=1e6),), limits=Limits(1e9, 1e9)
    )  # stands still, so that the loop is open
    loop, amplitude = replace(LOOP, resolution=0.0, delay=0.0), []
    for notches in ((), NOTCHES[:1]):
        law = drive_cascade(1.0, 1.0, 0.0, 1e9, sample_time=TS, notches=notches)
        u = simulate(
            axis, loop, law, [Scenario()], 2.0, ("u",), reference=np.sin(2 * pi * frequency * np.append(t, 2.0))
        )
        wave = u.trajectories["u"][2000:4000, 0]
        amplitude.append(np.abs(np.mean(wave * np.exp(-2j * pi * frequency * t[2000:]))))
    assert amplitude[1] / amplitude[0] == pytest.approx(NOTCHES[0].depth, rel=1e-3)


def test_a_current_loop_costs_the_phase_that_it_should():
    one = {"loop": LOOP, "inertias": np.array([J]), "springs": np.zeros(1), "viscous": 0.02}
    quick, slow = (Lagged(**one, lag=lag) for lag in (1e-6, 4e-4))
    ratio = slow.position[0] / quick.position[0]
    low = slow.theta < 0.3
    assert np.allclose(ratio[low], 1.0 / (1.0 + 1j * slow.theta[low] * 4e-4 / TS), rtol=2e-2)
    point = np.array([[60.0, 1.2, 20.0]])
    assert slow.sensitivity(point)[0] > quick.sensitivity(point)[0] > 1.0


def shaken(mode: float) -> Response:
    """Position's response of one mass with a resonance, as acceleration over drive."""
    f = np.geomspace(1.0, 900.0, 1500)
    x = f / mode
    h = (1.0 + 0.5 * x**2 / (1.0 - x**2 + 0.04j * x)) / J
    return Response("shaken", f, h, np.ones(f.size), 1e-3 * np.abs(h), 0.5, "periods", 10.0)


def test_a_notch_in_the_loop_that_is_tuned_allows_more_gain_on_a_measured_mode():
    base = {
        "loop": LOOP,
        "inertias": np.array([J]),
        "springs": np.zeros(1),
        "viscous": 0.02,
        "lag": 1e-4,
        "measured": shaken(180.0),
    }
    points = slowed(np.tile([60.0, 1.5, 10.0], (40, 1)), np.geomspace(0.05, 1.0, 40))
    most = []
    for notches in ((), (Notch(180.0, 120.0, 0.08),)):
        fine = Lagged(**base, notches=notches).sensitivity(points) <= 2.0
        most.append(points[np.flatnonzero(fine)[-1], 1])
    assert most[1] > 1.3 * most[0]


@pytest.fixture(scope="module")
def found():
    """A small search, of four sets."""
    closed = ClosedDrive(1e-4, sets=4, speed=True, acceleration=True)
    return tune_drive(closed, TASK, DESCRIBED, BEGIN, budget=Strategy(4, 4))


def test_every_set_keeps_the_sensitivity_and_costs_no_more_than_where_it_began(found):
    assert found.points.shape == (4, 3) and (np.diff(found.sizes) > 0.0).all() and found.sizes[-1] == TASK.step
    assert (found.sensitivity <= 2.0 * 1.001).all() and np.isfinite(found.cost).all()
    again = [
        cases(TASK, 1e-4, DESCRIBED, found.sizes, (), None)[i].sensitivity(found.points[i : i + 1])[0] for i in range(4)
    ]
    assert again == pytest.approx(list(found.sensitivity))


def test_feed_forward_follows_a_smooth_move_closer(found):
    without, fed = following_errors(found)
    assert fed < 0.2 * without


def test_the_chapter_holds_the_drive_beside_the_schedule(found):
    rows = compare_sizes(found, lambda lanes: pi_cascade(60.0, 1.2, 20.0, 15.0))
    assert [r.size for r in rows] == pytest.approx(list(found.sizes))
    chapter = drive_chapter(
        ComparedDrive(found, rows, (0.1, 0.01)), AXIS, "scheduled PD", ("elmo.txt",), {"odrive": "refused."}
    )
    texts = json.dumps([vars(b) for b in chapter.blocks if hasattr(b, "text") or hasattr(b, "texts")], default=str)
    assert "elmo.txt" in texts and "odrive: refused." in texts and "feeds forward" in texts
    drawn = next(b for b in chapter.blocks if hasattr(b, "svg"))
    assert drawn.svg().startswith(b"<?xml") or b"<svg" in drawn.svg()


def test_files_are_written_read_again_or_refused(found):
    sets = cascades(replace(found, forward=0.0, mass=0.0), AXIS)
    told = FormatOptions(
        Units(2**16, 2.0), tuple(Object(n, 0x3000 + i, 0, "REAL32") for i, n in enumerate(("kv", "kvp", "ki")))
    )
    kept, refused = files(("elmo", "sdo", "odrive", "linuxcnc"), sets, AXIS, told)
    assert set(kept) == {"elmo.txt", "sdo.csv", "odrive.json", "linuxcnc.hal", "friction.csv"} and not refused
    held = elmo.read(kept["elmo.txt"])
    assert [row[2] for row in held[:4]] == pytest.approx([s.kv for s in sets], rel=1e-6)
    notched = tuple(replace(s, notches=NOTCHES) for s in sets)
    kept, refused = files(("elmo", "sdo", "ros2", "moteus", "odrive", "linuxcnc"), notched, AXIS, told)
    assert set(kept) == {"friction.csv"} and len(refused) == 6
    assert "holds no notch" in refused["ros2"] and "notch1_centre" in refused["sdo"]


def test_objects_hold_notches_and_idle_ones_pass_everything():
    parts = [f"notch{i}_{part}" for i in (1, 2, 3) for part in ("centre", "width", "depth")]
    objects = tuple(Object(n, 0x3000 + i, 0, "REAL32") for i, n in enumerate(("kv", "kvp", "ki", *parts)))
    sets = SimpleNamespace(kv=1.0, kvp=2.0, ki=3.0, mass=0.0, viscous=0.0, forward=0.0, notches=NOTCHES)
    values = {o.quantity: value_of(o, data) for o, data in entries(sets, objects)}
    assert (values["notch2_centre"], values["notch1_width"], values["notch3_depth"]) == (320.0, 60.0, 1.0)


TEXT = """
[drive]
formats = ["elmo", "sdo"]
current_lag = { value = 0.1, unit = "ms" }
notches = 2
sets = 16
ranges = { kv = { at_most = 500.0 } }
[[drive.objects]]
quantity = "kv"
index = 0x3000
subindex = 1
type = "REAL32"
"""


def declared(text: str) -> Table:
    return Table(tomllib.loads(text), "study.toml", "", (), ("drive",))


def test_a_study_states_its_drive():
    found = stated(declared(TEXT), AXIS, COUNT)
    assert (found.closed.lag, found.closed.notches, found.closed.sets) == (pytest.approx(1e-4), 2, 16)
    assert found.closed.high[0] == 500.0 and found.options.objects[0].index == 0x3000
    assert found.options.units.counts == pytest.approx(2.0 * pi / COUNT)
    assert set(tomllib.loads(TEXT)["drive"]) <= {"formats", *OPTIONAL}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"elmo", "sdo"', '"elmoo"', "no format 'elmoo'"),
        ("notches = 2", "notches = 5", "from 0 to 4"),
        ("sets = 16", "sets = 17", "from 1 to 16"),
        ("at_most = 500.0", "at_most = -1.0", "has to rise"),
        ('quantity = "kv"', 'quantity = "kw"', "'kv'"),
        ("notches", "notch", "'notches'"),
        ('["elmo", "sdo"]', "3", "list of formats"),
    ],
)
def test_what_is_misspelt_of_a_drive_is_named(old, new, said):
    with pytest.raises(WorkbenchError, match=said):
        stated(declared(TEXT.replace(old, new)), AXIS, COUNT)


def test_what_no_gains_can_keep_is_refused():
    with pytest.raises(WorkbenchError, match="range of kv holds none"):
        tune_drive(ClosedDrive(1e-4, high=(1e-6, 1.0, 1.0)), TASK, DESCRIBED, BEGIN)
    with pytest.raises(WorkbenchError, match="current_lag out"):
        behind(behind(TASK, 1e-4), 1e-4)
    assert sizes_of(TASK, 1).tolist() == [TASK.step]


def test_a_study_leaves_its_drives_files_and_figures(tmp_path):
    text = TEXT.replace("sets = 16", "sets = 2\namps = 2.0")
    gains = SimpleNamespace(amplitude=BEGIN[0], kp=BEGIN[1], kd=BEGIN[2])
    law = SimpleNamespace(controller=lambda lanes: pi_cascade(60.0, 1.2, 20.0, 15.0))
    made = SimpleNamespace(gains=gains, equivalent=DESCRIBED, tuned={"scheduled PD (error)": law})
    part = driven(SimpleNamespace(table=declared(text)), TASK, made, (), 100.0, "error", lambda _: None, Strategy(2, 1))
    assert part.figures["drive_sensitivity_peak"] <= 2.01 and set(part.units) < set(part.figures)
    json.dumps(part.tables, allow_nan=True)
    (write,) = part.files
    write(tmp_path)
    assert {p.name for p in (tmp_path / "drive").iterdir()} == {"elmo.txt", "friction.csv"}  # kvp has no object
    assert [f.subject for f in part.findings] == ["sdo"]
