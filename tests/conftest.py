"""What all tests share: where measured data is found, and the rule on skips.

A test that does not run proves nothing, and a skip is easily overlooked. So a test may skip only for a reason of the
list below, each of which says what this machine lacks; every other skip, and every expected failure, is a failure.
"""

import os
from pathlib import Path

import pytest

from workbench.verbs import progress

progress.QUIET = 1e9  # s: on a busy machine a line of progress would stand in what tests compare
if "PYTEST_XDIST_WORKER" in os.environ:  # the cores are shared already
    os.environ.setdefault("WORKBENCH_PROCESSES", "1")

NO_DATA = "measured data is not here: set WORKBENCH_DATA"
ALLOWED = (
    NO_DATA,
    "no C compiler here",
    "no browser here",
    "no git checkout here",
    "no forks here",
    "no A2L reader here",
    "no CANopen library here",
    "no cross compiler here",
    "no emulator here",
    "no compiler that measures MC/DC here",
)


def offence(report) -> str | None:
    """Return what is wrong with a report that stands for a test not run or not believed, or None."""
    if hasattr(report, "wasxfail"):
        return "This test is marked as an expected failure: mend what it shows, or remove it."
    if not report.skipped:
        return None
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    reason = reason.removeprefix("Skipped: ")
    if reason in ALLOWED:
        return None
    return f"This test skipped for a reason that is not allowed, '{reason}'. Allowed (tests/conftest.py): {ALLOWED}."


def judged(report):
    """Return the report, made a failure where it offends. Done where the test runs, so it holds under xdist too."""
    sentence = offence(report)
    if sentence is not None:
        report.outcome = "failed"
        report.longrepr = sentence
        vars(report).pop("wasxfail", None)
    return report


# Outermost (tryfirst of the wrappers): pytest's own wrapper turns xfail into its outcome, and must have done so.
@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport(item, call):
    return judged((yield))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_make_collect_report(collector):
    return judged((yield))


def measured(*parts: str) -> Path:
    """Return a folder of the measured data. A test skips where there is none, but a mistyped variable is an error."""
    root = os.environ.get("WORKBENCH_DATA")
    if not root:
        pytest.skip(NO_DATA)
    if not Path(root).is_dir():
        pytest.fail(f"WORKBENCH_DATA names '{root}', which is not a folder.", pytrace=False)
    folder = Path(root, *parts).resolve()
    if not folder.is_dir():
        pytest.skip(NO_DATA)
    return folder


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of measured data."""
    return measured()


@pytest.fixture(scope="session")
def campaigns() -> Path:
    """The folder of measured campaigns."""
    return measured("campaigns")
