"""Every controller of the contest on one actuator, the figures that it comes to, and the checks of its schedule."""

from dataclasses import replace

import numpy as np

from workbench.control import pi_cascade
from workbench.description.friction import friction_of
from workbench.design.baselines import REACHED
from workbench.design.design import Designed, two_modes
from workbench.design.families.family import Family
from workbench.design.optimise import Tuned, optimise_all
from workbench.design.polish import Polished, polish
from workbench.design.tabled import Tabled, tabled
from workbench.plant import Plant
from workbench.simulation import loop_under
from workbench.study.configuration import Study
from workbench.study.control import Control
from workbench.task.task import PHASES, Task
from workbench.verification.checks import Checks, checked
from workbench.verification.contest import Contest, contest, entered
from workbench.verification.controllers import Controllers, controllers_of
from workbench.verification.margin import AgainstMargin, Asked
from workbench.verification.promise import Promise

from .records import assumed

FROZEN, PAPER = "scheduled PD (frozen)", "scheduled PD (following)"
ERROR, PROFILE = "scheduled PD (error)", "scheduled PD (error, profile)"
FIXED, CASCADE, SOFT = "fixed PD", "PI cascade", "soft cascade"
BEST, FED = "profile with PI", "profile with PI, fed forward"
NOMINAL = "scheduled PD (following), no spread"  # for no load and the disc alone
TRADE = "scheduled PD (following), nominal"  # for these alone in time and error, its overshoot held over the grid
SMALL = 0.9e-3  # rad: up to here friction is a spring
TIMES = ("simulated_time_small", "simulated_time_4mrad", "simulated_time_21mrad", "simulated_time_104mrad", "promised_time_deviation")  # fmt: skip
FIT_KEYS = ("actuator", "friction")
BEHIND = (FIXED, ERROR, CASCADE, BEST)  # with a notch, too
SHORT = (PAPER, ERROR, CASCADE, BEST)  # of the second actuator


def soft(study: Study, plant: Plant, speed: float):
    """Return the factory of the stated cascade: kv, ki and kvp as study.toml says."""
    one = study.table.table("contest", optional=("seeds", "tuning_time", "margins", "soft_cascade", "fits")).table(
        "soft_cascade", ("kv", "ki", "ratio")
    )
    kv, ki = (one.quantity(k, "1/s", above=0.0) for k in ("kv", "ki"))
    kvp = one.number("ratio", above=0.0) * kv * plant["inertia"].parameters["inertia"].value
    return lambda lanes: pi_cascade(kv, kvp, ki * kvp, speed)


def fitted(study: Study, made: Controllers, found: Contest) -> dict[str, dict[str, float]]:
    """Return what the stated fits to Table I come to: "scheduled" and "cascade" -> figure of a standing.

    Each has its actuator, one factor on friction, and the numbers of its law; the scheduled one those of two modes.
    """
    top = study.table.table("contest", ("seeds", "tuning_time"), ("margins", "soft_cascade", "fits"))
    both = top.table("fits", ("scheduled", "cascade"))
    family = made.family(PAPER)
    point = np.array([both.table("scheduled", (*FIT_KEYS, "numbers")).values["numbers"]])

    def cascade(lanes):
        return pi_cascade(*both.table("cascade", (*FIT_KEYS, "numbers")).values["numbers"])

    factories = {"scheduled": lambda lanes: family.controller(point, lanes), "cascade": cascade}
    out = {}
    for name, factory in factories.items():
        one = both.table(name, (*FIT_KEYS, "numbers"))
        friction = one.number("friction", above=0.0)
        task = found.task.on(assumed(study, one.text("actuator")))
        seen = [
            task.run(factory(PHASES), task.scenarios((load,), (friction,), (1.0,), PHASES))
            for load in (task.load_inertias[0], task.load_inertias[-1])
        ]
        out[name] = {
            f"{n}{suffix}": float(np.max(getattr(m, field)))
            for m, suffix in zip(seen, ("", "_loaded"), strict=True)
            for n, field in (("time", "time_1pct"), ("error", "final_error"))
        }
    return out


def held(
    study: Study, control: Control, model: Plant, known: Plant, names=None, say=lambda _: None
) -> tuple[Controllers, Contest]:
    """Make every controller from the model, and tune and judge it on the known plant. names: of families, all where absent."""
    asked = study.table.table("contest", ("seeds", "tuning_time"), ("margins", "soft_cascade", "fits"))
    goal = replace(control.goal, drive=known.limits.drive, speed=known.limits.speed)
    task = control.task.on(known)
    made = controllers_of(
        model, control.amplitudes, goal, task, per_octave=control.per_octave, tolerance=control.tolerance
    )
    families = tuple(f for f in made.families if names is None or f.name in names)
    seeds = [int(s) for s in asked.numbers("seeds", (1.0,))]
    time = asked.quantity("tuning_time", "s", above=0.0)
    found = contest(
        task, families, {SOFT: soft(study, known, REACHED * known.limits.speed)},
        tuning_time=time, seeds=seeds, known=model, say=say,
    )  # fmt: skip
    if names is not None:
        return made, found
    say(f"tuning {NOMINAL}")
    narrow = replace(task, frictions=(1.0,), inertias=(1.0,), phases=4, duration=time).on(model)
    alone = entered(task, narrow, made.family(PAPER), seeds, NOMINAL)
    say(f"tuning {TRADE}")
    kept = replace(task, nominal=True, duration=time).on(model)
    trade = entered(task, kept, made.family(PAPER), seeds, TRADE)
    return made, replace(found, standings={**found.standings, NOMINAL: alone, TRADE: trade})


def notched(study: Study, made: Controllers, found: Contest) -> dict[str, Tuned]:
    """Return what controllers that are not the paper's come to with a notch among their numbers, by the same search from one seed."""
    asked = study.table.table("contest", ("seeds", "tuning_time"), ("margins", "soft_cascade", "fits"))
    time = asked.quantity("tuning_time", "s", above=0.0)
    training = replace(found.task, load_inertias=found.task.load_inertias[:1], duration=time).on(made.plant)
    searches = [(training, made.family(n, notch=True), found[n].tuned.median.seed) for n in BEHIND]
    return dict(zip(BEHIND, optimise_all(searches), strict=True))


def for_margin(control: Control, model: Plant, task: Task, limit: float, names: tuple[str, ...]) -> dict[str, Family]:
    """Return families with gains per amplitude tuned anew for a limit on Ms."""
    limits = model.limits
    goal = replace(control.goal, drive=limits.drive, speed=limits.speed, sensitivity=limit)
    made = controllers_of(
        model, control.amplitudes, goal, task, per_octave=control.per_octave, tolerance=control.tolerance
    )
    return {n: made.family(n) for n in names}


def designed(
    made: Controllers, found: Contest, control: Control, plant: Plant, say=lambda _: None
) -> tuple[Designed, dict[str, Checks], Tabled]:
    """Return the table of the study's rule as the chapter on gains and the export take it, rule -> checks of a schedule, and the
    search that the table comes from: gains and table are those of `plant`, which was identified.

    Checked are the table, and the schedule of two modes with which the contest ended under the paper's rule.
    """
    own = found.task.on(plant)
    axis = replace(made.axis, rigid=friction_of(plant))
    polished = polish(axis, made.goal, own, say)
    table = tabled(
        polished, made.linear, made.goal, own, control.rule, per_octave=control.per_octave, tolerance=control.tolerance,
        load=control.load, notch=control.notch, seeds=control.seeds, say=say,
    )  # fmt: skip
    paper = two_modes(made.schedule, found[PAPER].tuned.median, "following")
    laws = {"following": (paper, found[PAPER].tuned.median), control.rule: (table.schedule, table.climbed.best)}
    checks = {
        rule: checked(
            axis, replace(schedule, rule="following"), control.goal,
            loop_under(law.controller(), control.loop),
        )
        for rule, (schedule, law) in laws.items()
    }  # fmt: skip
    tuned = {n: s.tuned.median for n, s in found.standings.items() if s.tuned}
    final, between = {control.rule: table.schedule}, checks[control.rule].between
    return Designed(
        plant, axis.equivalent, axis.gains, table.interpolated, polished, between, tuned, final, table.climbed, table.rivals
    ), checks, table  # fmt: skip


def figures_of_checks(checks: dict[str, Checks]) -> dict[str, float]:
    """Return the worst of all schedules that were checked; what moving gains feed in, of each rule."""
    every = checks.values()
    return {
        "sensitivity_between_knots": max(c.between.worst_sensitivity[0] for c in every),
        "gain_margin": float(min(np.min(c.gain_margin) for c in every)),
        "phase_margin": float(min(np.min(c.phase_margin) for c in every)),
        **{f"pumping_over_damping_{r}": float(np.max(c.moving.pumping / c.moving.damping)) for r, c in checks.items()},
    }


def asked_for(found: Contest, margins: AgainstMargin) -> tuple[Asked, ...]:
    """Return what was hoped of the paper's rule and is not had within the limit on Ms."""
    other = found[TRADE]
    gross = (
        "tuned for its worst case a large step arrives stiffly damped and in gross sliding, where friction holds it at h0/Kp. Tuned "
        "to be accurate on the nominal axis, its overshoot held over the grid, the same schedule may arrive softly, turn back and be "
        f"finished by the presliding gains: at the same margin it leaves {1e6 * other.median('error'):.0f} µrad, "
        f"{1e6 * other.median('error_loaded'):.0f} loaded, and {1e3 * other.median('error_grid'):.2g} mrad in the worst case of the "
        "grid. The trade is nominal against worst case, more than error against margin"
    )
    one = "both arrive with the gains of gross sliding, so a schedule over the stroke is a fixed PD there"
    paper, fixed = margins.values[PAPER], margins.values[FIXED]
    ratio = found[PAPER].median("error") / found[FIXED].median("error")
    return (
        Asked("paper_error", "paper's rule: error", 1e-4, found[PAPER].median("error"), paper["error"], "rad", gross),
        Asked(
            "paper_error_loaded", "paper's rule: error, loaded", 1e-4, found[PAPER].median("error_loaded"),
            paper["error_loaded"], "rad", gross,
        ),
        Asked(
            "paper_error_over_fixed", "paper's rule: error over that of the fixed PD", 0.33, ratio,
            paper["error"] / fixed["error"], "1", one,
        ),
    )  # fmt: skip


def figures_of_steps(polished: Polished, held: Promise) -> dict[str, float]:
    """Return the simulated 1 % times of the nominal optimum, at small amplitudes and at those of TIMES, and the promise's."""
    a, time = polished.linear.amplitude, polished.nominal.nominal.time
    at = np.exp(np.interp(np.log([4.3e-3, 0.021, 0.104]), np.log(a), np.log(time)))
    return dict(zip(TIMES, (float(time[a <= SMALL].max()), *map(float, at), held.deviation), strict=True)) | {
        "price_of_robustness": float(np.median(polished.price))
    }


def figures_of(found: Contest) -> tuple[dict[str, float], dict[str, str]]:
    """Return (figures, units) by which the study is judged; medians over the seeds."""

    def of(name, figure):
        return found[name].median(figure)

    errors = {
        "paper_error": of(PAPER, "error"),
        "paper_error_loaded": of(PAPER, "error_loaded"),
        "paper_error_tuned_without_spread": of(NOMINAL, "error"),
        "paper_error_tuned_without_spread_loaded": of(NOMINAL, "error_loaded"),
        "paper_error_tuned_without_spread_grid": of(NOMINAL, "error_grid"),
        "paper_error_nominal": of(TRADE, "error"),
        "paper_error_nominal_loaded": of(TRADE, "error_loaded"),
        "paper_error_nominal_grid": of(TRADE, "error_grid"),
        "error_rule_error": of(ERROR, "error"),
        "error_rule_error_loaded": of(ERROR, "error_loaded"),
        "error_rule_error_grid": of(ERROR, "error_grid"),
        "error_rule_profile_error_grid": of(PROFILE, "error_grid"),
        "profile_pi_error_grid": of(BEST, "error_grid"),
        "cascade_error_grid": of(CASCADE, "error_grid"),
    }
    ratios = {
        "paper_time_over_bound": found.over_bound(PAPER),
        "paper_time_over_bound_tuned_without_spread": found.over_bound(NOMINAL),
        "paper_time_over_bound_nominal": found.over_bound(TRADE),
        "paper_error_over_fixed": of(PAPER, "error") / of(FIXED, "error"),
        "error_rule_time_over_bound": found.over_bound(ERROR),
        "error_rule_time_over_fixed": of(ERROR, "time") / of(FIXED, "time"),
        "error_rule_error_over_fixed": of(ERROR, "error") / of(FIXED, "error"),
        "profile_pi_time_over_bound": found.over_bound(BEST),
        "paper_time_over_soft_cascade": of(PAPER, "time") / of(SOFT, "time"),
        "cascade_time_over_bound": found.over_bound(CASCADE),
        "paper_time_over_fixed": of(PAPER, "time") / of(FIXED, "time"),
        "sensitivity": max(of(n, "sensitivity") for n, s in found.standings.items() if s.tuned),
        "overshoot": max(of(n, "overshoot_grid") for n, s in found.standings.items() if s.tuned and n != NOMINAL),
    }
    return {**errors, **ratios}, dict.fromkeys(errors, "rad")
