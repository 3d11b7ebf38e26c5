"""The draws on a cluster: two honest workers, of which one is killed, and one that gives other bits. Loopback alone."""

import json
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest

from workbench.control import fixed_pd
from workbench.definition import find
from workbench.errors import WorkbenchError
from workbench.plant import ONE_MASS, Limits, Plant
from workbench.robustness import Varied, blocks, independent, joined, uniform, work
from workbench.robustness.cluster import on_cluster
from workbench.robustness.local import on_cores
from workbench.robustness.workload import digest
from workbench.simulation import Loop
from workbench.task.task import Task

PATIENCE = 60.0  # s for a process to come up on a busy machine
TAMPER = """
import workbench.simulation.noise as noise  # the noise of this worker is larger by some 4000 units in the last place
noise.SIGMA *= 1.0 + 1e-12
"""


def python(*arguments: str, log) -> subprocess.Popen:
    return subprocess.Popen([sys.executable, "-m", *arguments], stdout=log, stderr=log, stdin=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """(scheduler's address, name -> process) of a scheduler with the workers a and b, and c which is tampered with."""
    place = tmp_path_factory.mktemp("cluster")
    (place / "tamper.py").write_text(TAMPER)
    file = place / "scheduler.json"
    started = {}
    with open(place / "log", "w+") as log:
        local = ("--host", "127.0.0.1", "--no-dashboard")
        started["scheduler"] = python(
            "distributed.cli.dask_scheduler", *local, "--port", "0", "--scheduler-file", str(file), log=log
        )
        try:
            for name, more in (("a", ()), ("b", ()), ("c", ("--preload", str(place / "tamper.py")))):
                started[name] = python(
                    "distributed.cli.dask_worker", *local, "--scheduler-file", str(file), "--no-nanny", "--nthreads", "1",
                    "--name", name, "--local-directory", str(place), *more, log=log,
                )  # fmt: skip
            yield there(file, 3, started, log), started
        finally:
            for process in reversed(started.values()):
                process.kill()
                process.wait()


def there(file, workers: int, started, log) -> str:
    """Return the scheduler's address once so many workers are there."""
    from distributed import Client

    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if any(p.poll() is not None for p in started.values()):
            log.seek(0)
            pytest.fail(f"a process of the cluster has ended:\n{log.read()}", pytrace=False)
        try:
            address = json.loads(file.read_text())["address"]
        except (OSError, ValueError):
            time.sleep(0.1)
            continue
        with Client(address, timeout=PATIENCE, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=PATIENCE)
        return address
    pytest.fail("the scheduler did not come up", pytrace=False)


@pytest.fixture(scope="module")
def given():
    """(work, blocks, digest of what this machine's threads give)."""
    effects = (find("inertia")(inertia=0.0074), find("presliding_hysteresis")(h0=0.15, x0=1 / 636))
    task = Task(
        Plant(ONE_MASS, effects, limits=Limits(3.3, 12.57)),
        Loop(2.5e-4, 2, 2.5e-4, 2.5e-4, 4.848e-6),
        0.05,
        0.2,
        noise=2e-3,
    )
    vary = (Varied("inertia", uniform(0.5, 1.5)), Varied("presliding_hysteresis.x0", uniform(0.7, 1.4), relative=True))
    w = work(task, {"fixed PD": lambda lanes: fixed_pd(60.0, 1.3)}, vary)
    parts = blocks(independent(vary, 1280, 5), 32)
    return w, parts, digest(joined(on_cores(w, parts)))


def test_a_worker_with_other_bits_is_refused_by_name_and_the_numbers_are_the_same(cluster, given, capsys):
    address, _ = cluster
    w, parts, expected = given
    assert digest(joined(on_cluster(address, w, parts[:8]))) == digest(joined(on_cores(w, parts[:8])))
    said = capsys.readouterr().err
    assert "worker 'c' at tcp://127.0.0.1" in said and "other numbers" in said
    assert "'a'" not in said and "'b'" not in said


def test_a_study_is_the_same_on_a_cluster(cluster, given, tmp_path):
    from workbench.study import configuration
    from workbench.study.robustness import robustness

    w, *_ = given
    (tmp_path / "study.toml").write_text(
        'title = "t"\n[robustness]\ndraws = 96\n[robustness.vary]\ninertia = { uniform = [0.5, 1.5] }\n'
        '"presliding_hysteresis.x0" = { uniform = [0.7, 1.4], relative = true }\n'
    )
    study = configuration.load(tmp_path)
    here, there = (
        robustness(
            replace(study, scheduler=address), w.task, {"fixed PD": lambda lanes: fixed_pd(60.0, 1.3)}, lambda _: None
        )
        for address in ("", cluster[0])
    )
    assert here.figures == there.figures


def test_a_worker_that_is_killed_costs_no_block_and_no_bit(cluster, given):
    address, started = cluster
    w, parts, expected = given
    got = []
    for k, columns in enumerate(on_cluster(address, w, parts)):
        got.append(columns)
        if k == 2:
            started["b"].kill()
            started["b"].wait()
    assert len(got) == len(parts) and digest(joined(got)) == expected
    assert started["a"].poll() is None


def test_an_error_of_the_work_itself_reaches_who_asked(cluster, given):
    """A drawn number that is none: the worker's sentence comes back, and is not taken for a lost worker."""
    from workbench.robustness.workload import Block

    address, _ = cluster
    w, parts, _ = given
    with pytest.raises(WorkbenchError, match="finite"):
        list(on_cluster(address, w, [parts[0], Block(32, np.full((4, 2), np.nan))]))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere://x"])
def test_an_address_without_a_scheduler_is_a_sentence(address, given, monkeypatch):
    from workbench.robustness import cluster as module

    monkeypatch.setattr(module, "CONNECT", 0.5)
    w, parts, _ = given
    with pytest.raises(WorkbenchError, match="no Dask scheduler"):
        list(on_cluster(address, w, parts))
