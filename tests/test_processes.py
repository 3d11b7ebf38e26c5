"""Work shared among forks: results in order, errors as they were raised, and nothing lost when a fork is."""

import os
import signal
import subprocess
import sys
import time
from multiprocessing import active_children
from multiprocessing.context import ForkProcess
from pathlib import Path

import pytest

from workbench import processes
from workbench.errors import WorkbenchError
from workbench.processes import begun, count, shared


@pytest.fixture(autouse=True)
def three(monkeypatch):
    if sys.platform != "linux":
        pytest.skip("no forks here")
    monkeypatch.setenv(processes.VARIABLE, "3")


def test_results_come_in_the_order_of_the_items_and_from_other_processes():
    def square(k):
        time.sleep(
            0.03 + 0.05 * (k % 3 == 0)
        )  # the first share lags behind, and none takes all before the others begin
        return k * k, os.getpid()

    made = list(shared(square, range(10)))
    assert [value for value, _ in made] == [k * k for k in range(10)]
    assert len({process for _, process in made}) == 3 and os.getpid() not in {process for _, process in made}


def test_what_is_called_with_need_not_pickle_and_is_not_changed_here():
    held = {"calls": 0}

    def call(function):
        held["calls"] += 1
        return function()

    assert list(shared(call, [lambda k=k: k for k in range(7)])) == list(range(7))
    assert held["calls"] == 0


def test_what_a_call_raises_is_raised_in_its_turn_and_tells_where():
    def grumble(k):
        if k == 4:
            raise WorkbenchError("Four is too many.")
        return k

    seen = []
    with pytest.raises(WorkbenchError, match="Four is too many") as caught:
        for k in shared(grumble, range(9)):
            seen.append(k)
    assert seen == [0, 1, 2, 3] and "grumble" in caught.value.__notes__[0]


def test_a_result_that_does_not_pickle_is_an_error_and_no_silence():
    with pytest.raises(Exception, match="[Pp]ickle"):
        list(shared(lambda k: lambda: k, range(3)))


def test_the_part_of_a_fork_that_is_killed_is_done_here():
    parent = os.getpid()

    def fragile(k):
        if k >= 4 and os.getpid() != parent:
            os.kill(os.getpid(), signal.SIGKILL)
        return k

    assert list(shared(fragile, range(9))) == list(range(9))


def test_no_process_outlives_a_caller_that_wants_no_more():
    made = shared(lambda k: time.sleep(60 * (k > 0)) or os.getpid(), range(6))
    process = next(made)
    made.close()
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_one_process_or_one_item_needs_no_fork(monkeypatch):
    assert list(shared(lambda _: os.getpid(), [0])) == [os.getpid()]
    monkeypatch.setenv(processes.VARIABLE, "1")
    assert set(shared(lambda _: os.getpid(), range(5))) == {os.getpid()}


def test_what_is_done_meanwhile_is_done_once_and_here_and_not_where_there_is_nobody_to_wait_for(monkeypatch):
    done = []
    assert list(shared(abs, range(4), lambda: done.append(os.getpid()))) == [0, 1, 2, 3]
    assert done == [os.getpid()]
    monkeypatch.setenv(processes.VARIABLE, "1")
    assert list(shared(abs, range(4), lambda: done.append(os.getpid()))) == [0, 1, 2, 3]
    assert len(done) == 1


def test_a_fork_does_not_fork_again():
    assert list(shared(lambda _: count(), range(3))) == [1, 1, 1]


def test_as_many_as_there_are_cores_and_never_more_than_memory_allows(monkeypatch):
    monkeypatch.delenv(processes.VARIABLE)
    assert count() == min(processes.MOST, len(os.sched_getaffinity(0)))


@pytest.mark.parametrize("given", ["two", "0", "-1", ""])
def test_a_number_of_processes_that_is_none_is_refused_in_a_sentence(monkeypatch, given):
    monkeypatch.setenv(processes.VARIABLE, given)
    with pytest.raises(WorkbenchError, match=f"WORKBENCH_PROCESSES holds '{given}'.*is needed[.]$"):
        count()


def test_an_interrupt_ends_all_at_once_and_only_the_first_process_speaks():
    code = (
        "import signal, time\n"
        "from workbench.processes import shared\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a shell's background job begins without
        "print('begun', flush=True)\n"
        "list(shared(lambda k: time.sleep(60), range(3)))\n"
    )
    started = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert started.stdout.readline() == "begun\n"
    time.sleep(0.3)
    os.killpg(started.pid, signal.SIGINT)
    _, said = started.communicate(timeout=20)
    assert said.count("KeyboardInterrupt") == 1 and said.count("Traceback") == 1


def test_an_interrupt_while_forks_are_made_leaves_none_behind(monkeypatch):
    """It waits until all of them are known; then all are ended."""
    start = ForkProcess.start

    def interrupted(fork):
        start(fork)
        signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr(ForkProcess, "start", interrupted)
    try:
        with pytest.raises(KeyboardInterrupt):
            list(shared(lambda _: time.sleep(60), range(3)))
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert active_children() == []


def test_whoever_is_free_takes_the_next_item():
    """One slow item holds up one process; the others do the rest."""

    def work(k):
        time.sleep(0.3 if k == 0 else 0.005)
        return os.getpid()

    made = list(shared(work, range(30)))
    assert made.count(made[0]) < 5


def test_more_items_than_a_queue_holds_are_all_done(monkeypatch):
    monkeypatch.setattr(processes, "QUEUED", 4)
    assert list(shared(lambda k: k, range(10))) == list(range(10))


def test_forks_of_a_process_that_is_killed_end_in_the_midst_of_their_work(tmp_path):
    program = (
        "import os, pathlib, sys, time\n"
        "from workbench.processes import shared\n"
        "def work(k):\n"
        "    pathlib.Path(sys.argv[1], str(os.getpid())).touch()\n"
        "    time.sleep(60)\n"
        "list(shared(work, range(2)))\n"
    )
    run = subprocess.Popen(
        [sys.executable, "-c", program, str(tmp_path)], env=os.environ | {"WORKBENCH_PROCESSES": "2"}
    )
    until = time.monotonic() + 30.0
    while len(forks := [int(p.name) for p in tmp_path.iterdir()]) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    run.kill()
    run.wait()
    while any(map(_runs, forks)) and time.monotonic() < until:
        time.sleep(0.05)
    assert len(forks) == 2 and run.pid not in forks and not any(map(_runs, forks))


def _runs(pid: int) -> bool:
    """Whether a process is there, and not merely unburied."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_what_is_begun_goes_on_in_another_process_while_this_one_does_something_else():
    with begun(lambda: (time.sleep(0.2), os.getpid())[1]) as result:
        before = time.monotonic()
        assert len(active_children()) == 1 and time.monotonic() - before < 0.1
        assert result() != os.getpid()
    assert not active_children()


def test_what_is_begun_and_raises_does_so_where_its_result_is_asked_for():
    def grumble():
        raise WorkbenchError("No loop.")

    with begun(grumble) as result:
        time.sleep(0.05)
        with pytest.raises(WorkbenchError, match="No loop"):
            result()


def test_what_is_begun_and_killed_is_done_here():
    parent = os.getpid()
    with begun(lambda: os.getpid() if os.getpid() == parent else os.kill(os.getpid(), signal.SIGKILL)) as result:
        assert result() == parent


def test_what_is_begun_and_not_asked_for_ends_with_its_block():
    with begun(lambda: time.sleep(60)):
        pass
    assert not active_children()


def test_where_one_process_works_what_is_begun_is_done_when_it_is_asked_for(monkeypatch):
    monkeypatch.setenv(processes.VARIABLE, "1")
    with begun(os.getpid) as result:
        assert not active_children() and result() == os.getpid()


SLOW_TO_BEGIN = """
import os, time
os.register_at_fork(after_in_child=lambda: time.sleep(0.3))  # ahead of what the package does in a fork
from workbench.interruption import stoppable
from workbench.processes import begun
with stoppable():
    with begun(lambda: time.sleep(60)):
        pass  # nobody asks for it: the fork is ended before it has begun
    time.sleep(1.0)
print("went on")
"""


def test_a_fork_that_is_ended_before_it_has_begun_does_not_end_its_parent():
    """On a busy machine a fork waits for its first turn, and is told to end before it has its own ways with signals."""
    ran = subprocess.run([sys.executable, "-c", SLOW_TO_BEGIN], capture_output=True, text=True, timeout=30)
    assert (ran.returncode, ran.stdout) == (0, "went on\n")
