"""Creep: a spring whose foot follows slowly (linear creep operators)."""

from workbench.definition import FORCE, Effect, effect
from workbench.effects.elementary import expm1
from workbench.parameter import Parameter


@effect
def creep(elements: int = 2) -> Effect:
    """T = sum k_j (q - l_j), dl_j/dt = lambda_j (q - l_j), with lambda_j = lambda ratio^(j-1); relaxed at the start.

    The state is w = q - l, so no position is needed. Exact step for a position that is linear over the step:
    w <- exp(-L) w + (1 - exp(-L))/L dq, L = lambda dt. Slow elements are springs, fast ones dampers.
    """
    numbers = range(1, elements + 1)

    def step(s, z, p):
        after, force, rate = {}, 0.0, p.rate
        for j in numbers:
            turned = rate * s.dt
            gone = -expm1(-turned)  # 1 - exp(-L) without cancellation: rates are slow, samples short
            w = getattr(z, f"w{j}")
            after[f"w{j}"] = (w - gone * w) + (gone / turned) * s.dq
            force = force + getattr(p, f"k{j}") * after[f"w{j}"]
            rate = rate * p.ratio
        return after, force

    springs = {f"k{j}": Parameter(0.0, "F/x", f"stiffness of creep element {j}", lower=0.0) for j in numbers}
    return Effect(
        name="creep",
        cause="grease, cables or a flexure that give way slowly: a force that relaxes while the axis stands",
        formula="T = sum kj (q - lj), dlj/dt = rate_j (q - lj)",
        source="Krejci and Kuhnen 2001 (linear creep operators); Maxwell 1867",
        port=FORCE,
        family="creep",
        parameters=springs
        | {
            "rate": Parameter(1.0, "1/s", "rate of the slowest element", lower=1e-6, scale="rate"),
            "ratio": Parameter(5.0, "1", "rate of each element over that before it", lower=1.5, upper=1e3, scale="number"),
        },
        linear=tuple(springs),
        states={f"w{j}": 1 for j in numbers},
        reads=("dq", "dt"),
        step=step,
        holds=("passive", "odd"),
        places=("axis", "motor", "load", "joint"),
    )  # fmt: skip
