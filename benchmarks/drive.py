"""Sixteen gain sets of a closed drive on the main study's declared axis: CPU time of the tuning, as it is and with two notches in the loop.

Asked: 5 s. The kernels are compiled by a first, short search, as in a study that has simulated its own controllers before.
"""

import sys
from pathlib import Path
from time import process_time

from workbench.campaign import load
from workbench.drive_tuning.gains import ClosedDrive
from workbench.drive_tuning.search import Strategy, tune_drive
from workbench.frequency.notch import Notch
from workbench.study import configuration
from workbench.study.control import control_of
from workbench.tuning import tuned_axis

STUDY = Path(__file__).resolve().parent.parent / "studies" / "harmonic_drive_axis"
LAG = 1e-4
MOST = 5.0
NOTCHES = (Notch(180.0, 60.0, 0.1), Notch(320.0, 90.0, 0.3))


def main() -> int:
    study = configuration.load(STUDY)
    declared = load(study.campaign).plant
    control = control_of(study.table, declared)
    task = control.task.on(control.limited(declared))
    axis = tuned_axis(task.plant, control.amplitudes, control.goal, task.loop)
    equivalent, gains = axis.equivalent, axis.gains
    begin = gains.amplitude, gains.kp, gains.kd
    longest = 0.0
    for said, notches in (("no notch", ()), ("two notches in the loop", NOTCHES)):
        closed = ClosedDrive(LAG, len(notches), 16, True, True)
        tune_drive(closed, task, equivalent, begin, notches=notches, budget=Strategy(1, 1))
        start = process_time()
        found = tune_drive(closed, task, equivalent, begin, notches=notches)
        longest = max(longest, spent := process_time() - start)
        print(f"  {said:<26}{spent:6.1f} s   {found.tried} steps, Ms at most {found.sensitivity.max():.2f}")
    print(f"  asked: {MOST:g} s")
    return int(longest > MOST)


if __name__ == "__main__":
    sys.exit(main())
