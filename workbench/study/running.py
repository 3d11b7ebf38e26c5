"""Run a study: its steps, its checks, its report; written whole, and not at all where nothing has changed."""

import importlib.util
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from workbench.errors import WorkbenchError
from workbench.keeping import FOLDER as KEPT
from workbench.keeping import keeping
from workbench.outputs import replaceable, whole
from workbench.study import configuration, stamp
from workbench.study.configuration import STEPS, Study
from workbench.study.outcome import Outcome


@dataclass(frozen=True)
class Ran:
    """folder: of the outputs. fresh: whether anything was computed. passed: whether every check has."""

    folder: Path
    fresh: bool
    passed: bool
    lines: tuple[str, ...]


def steps_of(study_folder: Path):
    """Return the study's own module (study.py), or None. It is a package: other modules beside it are `from . import ...`.

    WorkbenchError, with file and line, where it cannot be imported or has no `run`.
    """
    path = study_folder / STEPS
    if not path.is_file():
        return None
    name = f"workbench_study_{study_folder.name}"
    spec = importlib.util.spec_from_file_location(name, path, submodule_search_locations=[str(study_folder)])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    with own_faults(study_folder):
        spec.loader.exec_module(module)
    if not callable(getattr(module, "run", None)):
        raise WorkbenchError(f"{path}: has no function run(study, say); add it, it returns the study's Outcome.")
    return module


@contextmanager
def own_faults(study_folder: Path) -> Iterator[None]:
    """Say what comes out of a study's own code in a sentence with file and line, and where it was raised."""
    try:
        yield
    except (WorkbenchError, OSError):
        raise
    except SyntaxError as e:
        raise WorkbenchError(f"{e.filename}, line {e.lineno}: is no valid Python ({e.msg}); mend it there.") from e
    except (Exception, SystemExit) as e:
        frames = traceback.extract_tb(e.__traceback__)
        own = [f for f in frames if Path(f.filename).is_relative_to(study_folder)]
        if not own:
            raise
        inner = frames[-1]
        raised = f" (raised in {inner.filename}, line {inner.lineno})" if inner is not own[-1] else ""
        text = f"{own[-1].filename}, line {own[-1].lineno}: {type(e).__name__}: {str(e).rstrip('.')}{raised}"
        raise WorkbenchError(f"{text}; mend the study's own steps there.") from e


def _input_files(study: Study) -> list[Path]:
    """Files outside the study's folder that its results depend on."""
    found = [study.measured(key) for key in study.data]
    if study.campaign is not None and study.folder not in study.campaign.parents:
        found += stamp.files(study.campaign)
    return found


def run(name: str, out: Path | None = None, say: Callable[[str], None] = lambda _: None, scheduler: str = "") -> Ran:
    """Run a study given by path or name. out: folder of the outputs, reports/<name> beside studies/ where absent.

    scheduler: address of a cluster for what is many; the numbers are the same without it.
    """
    folder = configuration.find(name)
    study = replace(configuration.load(folder), scheduler=scheduler)
    place = out or folder.parent.parent / "reports" / study.name
    digest = stamp.inputs(folder, _input_files(study))
    replaceable(place, stamp.FILE)
    if stamp.unchanged(place, digest):
        return Ran(place, False, _all_passed(place), _lines(place))
    from workbench.study import standard

    module = steps_of(folder)
    with keeping(folder / KEPT, digest) as keeper:
        if keeper.known:
            say(f"going on from {keeper.known} finished steps of a run that was stopped")
        with own_faults(folder):
            outcome = (module.run if module else standard.run)(study, say)
        if not isinstance(outcome, Outcome):
            raise WorkbenchError(
                f"{folder}/study.py: run() returned {type(outcome).__name__}; return an Outcome, as workbench.study.standard.run does."
            )
        return _written(study, outcome, place, digest, say)


def _written(study: Study, outcome, place: Path, digest: str, say: Callable[[str], None]) -> Ran:
    """Write the outputs of a study, all or none."""
    from workbench.study import results

    judged = results.checks(study, outcome)
    from workbench.report import write as write_report
    from workbench.study.reporting import headline, list_again, report_of
    from workbench.tracing.output import write as write_trace

    say("writing the report")
    with whole(place, stamp.FILE) as beside:
        write_trace(outcome.trace, beside, outcome.residual_maps)
        for writer in outcome.files:
            writer(beside)
        report = report_of(study, outcome, judged, beside, _input_files(study))
        results.write(study, outcome, judged, beside, headline(report))
        write_report(report, beside)
        stamp.write(beside, digest)
    list_again(study, place)
    return Ran(place, True, all(c.passed for c in judged), _lines(place))


def _results(place: Path) -> dict:
    import json

    return json.loads((place / "results.json").read_text(encoding="utf-8"))


def _all_passed(place: Path) -> bool:
    return all(c["passed"] for c in _results(place)["checks"])


def _lines(place: Path) -> tuple[str, ...]:
    """What the command line says: the finding first, then the checks, then where to look."""
    from workbench.finding import NOT_TUNED

    content = _results(place)
    lines = [
        content["sentence"],
        *filter(None, [content["advice"]]),
        *(f["sentence"] for f in content["findings"] if f["kind"] == NOT_TUNED),
        "",
    ]
    for c in content["checks"]:
        value = f"{c['value']:.4g}" if isinstance(c["value"], float) else str(c["value"])
        unit = "" if c["unit"] == "1" else f" {c['unit']}"
        lines.append(f"  {'passed' if c['passed'] else 'FAILED'}  {c['name']}: {value}{unit} (bound {c['bound']})")
    lines += [""] if content["checks"] else []
    return (*lines, f"{place / 'report.html'}", f"{place / 'report.pdf'}")
