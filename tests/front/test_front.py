"""The front door: every name of `import workbench`, called as an engineer with a notebook would, and what a notebook shows."""

import importlib
import inspect
import json
import pkgutil
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import workbench as wb
from workbench.errors import WorkbenchError

ROOT = Path(__file__).resolve().parents[2]
CAMPAIGN = ROOT / "studies" / "harmonic_drive_axis" / "campaign"
DT = 1e-3
FUNCTIONS = sorted(name for name in wb.HELD if name[0].islower())


@pytest.fixture(scope="module", autouse=True)
def every_module():
    """Import every module of the package before anything is called: none may take a name of the front door."""
    for found in pkgutil.walk_packages(wb.__path__, "workbench."):
        importlib.import_module(found.name)


@pytest.fixture(scope="module")
def declared():
    return (
        wb.Plant("one mass") + wb.find("inertia")(inertia=2e-3, fixed=True) + wb.find("viscous_friction")(viscous=0.02)
    )


@pytest.fixture(scope="module")
def records(declared):
    """Two records of an axis that has Coulomb friction besides, driven by a few waves."""
    truth = declared + wb.find("presliding_hysteresis")(h0=0.05, x0=2e-3)
    t = DT * np.arange(6000)
    drive = sum(0.08 * np.sin(2 * np.pi * f * t + f) for f in (0.5, 1.7, 6.1, 17.0, 41.0))
    run = wb.open_loop(truth, drive, DT, substeps=10, resolution=2e-5)
    torque = (drive + np.roll(drive, 1)) / 2  # held over a sample: what acts about it is the mean of two

    def part(name, role, keep):
        channels = {"torque": torque[keep].copy(), "position": run["y"][keep, 0].copy()}
        return wb.Record(name, role, t[keep].copy(), channels, resolution={"position": 2e-5})

    return [part("first", "identification", slice(10, 4000)), part("last", "validation", slice(4000, None))]


@pytest.fixture(scope="module")
def fit(declared, records):
    return wb.identify(declared, records, bandwidth=80.0)


@pytest.fixture(scope="module")
def found(fit):
    return wb.trace(fit, only={"presliding_hysteresis", "coulomb_friction", "transport_delay"})


@pytest.fixture(scope="module")
def loop():
    return wb.Loop(sample_time=2e-4, substeps=4, velocity_filter=4e-4, resolution=2e-5)


@pytest.fixture(scope="module")
def schedule(found, loop):
    goal = wb.TuningGoal(drive=1.0)
    return wb.fit_schedule(wb.tune(found, loop, [0.005, 0.02, 0.08], goal), loop, found, per_octave=1)


def test_a_lone_import_takes_no_time_and_brings_nothing_along():
    code = "import sys, time; before, start = set(sys.modules), time.process_time(); import workbench; "
    code += "print(time.process_time() - start, *sorted(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    took, *modules = done.stdout.split()
    assert modules == ["workbench"] and float(took) <= 0.05  # s of this process, not of a busy machine


def test_the_names_are_the_functions_after_every_module_was_imported():
    asked = "load Plant find effect Parameter Record identify trace describe tune fit_schedule simulate open_loop compensate"
    asked += " check diff plan separate response export"
    assert set(asked.split()) <= set(wb.HELD) <= set(dir(wb))
    for name in wb.HELD:
        assert callable(getattr(wb, name)) and not isinstance(getattr(wb, name), ModuleType), name


def test_no_name_of_a_package_hides_its_module():
    hidden = []
    for name, module in list(sys.modules.items()):
        package, _, leaf = name.rpartition(".")
        if name.startswith("workbench.") and getattr(sys.modules[package], leaf, None) is not module:
            hidden.append(name)
    assert not hidden


def test_what_editors_read_is_what_is_handed_on():
    stub = (ROOT / "workbench" / "__init__.pyi").read_text(encoding="utf-8")
    assert {n: m for m, n in re.findall(r"^from (\S+) import (\w+) as \2$", stub, re.MULTILINE)} == wb.HELD
    assert (ROOT / "workbench" / "py.typed").is_file()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_help_shows_types_and_what_a_function_does(name):
    function = getattr(wb, name)
    signature = inspect.signature(function)
    untyped = [p.name for p in signature.parameters.values() if p.annotation is p.empty]
    if name not in ("export",):  # takes whatever has a schedule's fields
        assert not untyped and signature.return_annotation is not signature.empty
    assert len(inspect.getdoc(function)) > 80 or name == "find"


def test_an_unknown_name_is_answered_with_those_that_are_there():
    with pytest.raises(AttributeError, match="hands on .*trace"):
        wb.tracing_of  # noqa: B018


def test_a_folder_is_loaded_and_checked():
    campaign = wb.load(CAMPAIGN)
    assert wb.check(campaign) == wb.check(str(CAMPAIGN)) == ()
    backwards = [replace(r, channels={**r.channels, "torque": -r.channels["torque"]}) for r in campaign.records]
    said = wb.check(replace(campaign, records=tuple(backwards)))
    assert said and "sign is turned" in str(said[0])


def test_a_campaign_a_fit_and_a_plant_with_records_are_traced_alike(declared, records, fit, found):
    assert found.added == ("presliding_hysteresis",)
    again = wb.trace(
        declared, records, bandwidth=80.0, only={"presliding_hysteresis", "transport_delay"}
    )  # a refinement of 0.05 ms
    assert again.added == found.added and again.after.validation == pytest.approx(found.after.validation, rel=1e-6)
    assert found.plant["presliding_hysteresis"].parameters["h0"].value == pytest.approx(0.05, rel=0.1)
    assert wb.identify(found).validation == pytest.approx(found.after.validation, rel=0.05)  # with what it found


def test_an_effect_and_a_plant_are_described(declared):
    plant = declared + wb.find("presliding_hysteresis")(h0=0.05, x0=2e-3)
    own = wb.describe(plant["presliding_hysteresis"], [1e-4, 1e-3])
    whole = wb.describe(plant, [1e-4, 1e-3], omega=10.0)
    # a plant is stepped, 1024 steps a cycle: half a step of phase is 0.3 % of the stiffness
    assert np.abs(own.stiffness - whole.stiffness).max() < 0.01 * own.stiffness.max()
    assert np.abs(own.loss - whole.loss).max() < 0.005 * own.stiffness.max()
    assert wb.describe(wb.find("viscous_friction")(viscous=0.1), [1e-3], omega=10.0).loss == pytest.approx([1.0])


def test_gains_are_tuned_scheduled_simulated_compensated_and_exported(found, loop, schedule, tmp_path):
    told = wb.simulate(found, loop, schedule, [0.01, 0.05], 0.4, record=("q",))
    assert np.all(told.final_error < 0.05 * np.array([0.01, 0.05])) and told.trajectories["q"].shape == (2000, 2)
    compensated = wb.compensate(schedule, found, "presliding_hysteresis", source="reference")
    assert "presliding_hysteresis" in compensated.law.name
    assert wb.simulate(found, loop, compensated, 0.01, 0.4).finite.all()
    gains = schedule.gains(0.01)
    assert wb.simulate(found, loop, tuple(map(float, gains)), wb.Scenario(target=0.01), 0.4).finite.all()
    assert {p.name for p in wb.export(schedule, found.plant, tmp_path)} >= {"gains.h", "gains.json", "gains.bin"}


def test_what_to_record_next_and_what_moved(declared, records, fit, found):
    plan = wb.plan(fit, accuracy=0.1, high=2.0, low=-2.0)
    assert plan.trajectory.position.max() <= 2.0 and {e.parameter for e in plan.promised} >= {"viscous"}
    parted = wb.separate(found, "presliding_hysteresis", "viscous_friction")
    assert parted.apart and parted.reference is not None
    other = [replace(r, channels={**r.channels, "torque": 1.3 * r.channels["torque"]}) for r in records]
    moved = wb.diff(fit, wb.identify(declared, other, bandwidth=80.0))
    assert {c.parameter for c in moved.moved} == {"inertia", "viscous"}
    assert wb.response(records[0]).value.dtype == complex and wb.response(fit, "last").record == "last"


def test_every_result_shows_itself_with_a_table_and_a_drawing(fit, found, schedule, records):
    shown = [
        fit,
        found,
        wb.describe(found, [1e-4, 1e-3], omega=10.0),
        schedule,
        wb.response(records[0]),
        wb.diff(fit, fit),
    ]
    for one in shown:
        page = one._repr_html_()
        assert "<table>" in page and "data:image/png;base64," in page and page.count("<div>") == page.count("</div>")
    assert str(fit.findings[0]) == fit.findings[0].sentence if fit.findings else True


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda p, r: wb.identify(p), "records=\\["),
        (lambda p, r: wb.identify(p, r), "state bandwidth="),
        (lambda p, r: wb.identify(p, r, bandwidth=1e4), "below 450 Hz"),
        (lambda p, r: wb.identify(p, replace(r[0], channels={"torque": r[0].channels["torque"]}), bandwidth=60.0), "'position'"),
        (lambda p, r: wb.identify(p, replace(r[0], time=r[0].time**2), bandwidth=20.0), "even steps"),
        (lambda p, r: wb.identify(p, replace(r[0], time=r[0].time[1:].copy()), bandwidth=60.0), "one a sample"),
        (lambda p, r: wb.describe(p, [1e-3]), "state omega="),
        (lambda p, r: wb.tune(wb.Plant("one mass"), wb.Loop(1e-3), [1e-3]), "no inertia"),
        (lambda p, r: wb.tune(wb.Plant("two mass"), wb.Loop(1e-3), [1e-3]), "joint"),
        (lambda p, r: wb.simulate(p, wb.Loop(1e-3), "pd", 1e-3, 0.1), "no controller"),
        (lambda p, r: wb.compensate((1.0, 0.1), wb.Plant("one mass")), "can be cancelled"),
        (lambda p, r: wb.response(r[0], channel="torque"), "no position"),
        (lambda p, r: wb.response(wb.identify(p, r, bandwidth=60.0), "frist"), "did you mean 'first'"),
        (lambda p, r: wb.trace(3.0), "a plant is needed"),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_said_with_what_mends_it(call, sentence, declared, records):
    with pytest.raises(WorkbenchError, match=sentence):
        call(declared, records)


def run(code: str, folder: Path, monkeypatch) -> dict:
    """Run Python as a reader would type it, in a folder."""
    monkeypatch.chdir(folder)
    names: dict = {}
    exec(compile(code, "page", "exec"), names)
    return names


def test_the_python_of_the_readme_runs(tmp_path, monkeypatch, capsys):
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    (code,) = re.findall(r"^```python\n(.*?)^```$", (ROOT / "README.md").read_text("utf-8"), re.MULTILINE | re.DOTALL)
    names = run(code, tmp_path, monkeypatch)
    assert names["found"].added == ("stribeck_friction",) and (tmp_path / "gains" / "gains.h").is_file()
    assert "Stribeck friction is missing" in capsys.readouterr().out


def test_the_python_of_the_page_on_packages_runs(tmp_path, monkeypatch):
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    page = (ROOT / "docs" / "python.md").read_text("utf-8")
    names = run("".join(re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)), tmp_path, monkeypatch)
    friction, long = names["friction"], names["long"]
    assert friction.effects == ("viscous_friction@axis",) and (friction.low <= friction.value).all()
    elements = [long.plant["maxwell_slip"].parameters[f"k{k}"].value for k in (1, 2, 3)]
    assert long.error < 0.2 and min(elements) >= 0.0 < max(elements)


def test_the_notebook_runs_from_a_log_to_gains(tmp_path, monkeypatch):
    notebook = json.loads((ROOT / "docs" / "from_log_to_gains.ipynb").read_text("utf-8"))
    cells = [c for c in notebook["cells"] if c["cell_type"] == "code"]
    assert not any(c["outputs"] or c["execution_count"] for c in cells), "clear the outputs before the notebook is kept"
    (tmp_path / "tutorial").symlink_to(ROOT / "docs" / "tutorial")
    names = run("\n".join("".join(c["source"]) for c in cells), tmp_path, monkeypatch)
    assert names["found"].verdict == "cause" and names["schedule"].kp.size
