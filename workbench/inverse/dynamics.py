"""What a plant asks of the drive along a record's motion: columns of the required drive, beside the drive that was applied.

Order of evaluation: time and command maps on the measured drive (`command`); forces with memory (they provide `dir`); other
forces; those that follow the load, which the others make (`plant.carried`). No force sees the measured drive. Results are kept per effect and shape, so that candidates share the columns of the declared model.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from workbench import definition as fx
from workbench.definition import Effect, catalogue
from workbench.effects.direction import DIRECTION
from workbench.inverse.bodies import CHANNEL, INCREMENT, POSITION, VELOCITY, Bodies, derivatives_in, rows
from workbench.inverse.command import Command, drive_path
from workbench.inverse.forces import Ran, forces_of, linear_of, outputs_of, run_forces, summed
from workbench.inverse.kept import Kept
from workbench.inverse.oftener import moved_oftener, to_rate_of
from workbench.inverse.side_by_side import entered, entering, stacked
from workbench.inverse.turning import turned
from workbench.inverse.unseen import counting
from workbench.inverse.zeros import closed as with_zero
from workbench.inverse.zeros import relaxed
from workbench.motion import MOTION_BAND, Motion, motion
from workbench.plant import PLACES, TWO_MASS, Plant, carried, reads_load
from workbench.record import Record

LOAD_DRIVE = "drive of the load"  # channel of a record whose load is driven, too: that of a machine that is a model, no log has it
# by what a force at a place enters the balances: of the one body, or the motor's and the load's
LEVERS = {"axis": np.ones((1, 1)), "motor": np.array([[1.0], [0.0]]), "load": np.array([[0.0], [1.0]])}


class InverseDynamics:
    """InverseDynamics over one motion. Methods return arrays that must not be changed.

    fine: the same over the same motion at a higher rate, by which operators of its increments are run: where friction turns,
    the moment counts, and a coarse sample has it wrong by half a step. coarse: takes their outputs (k, fine n) to (k, n). times: of a
    log that is too slow for them, by how often their own path is read between two samples.
    counts: (2, n) of bool, where the drive's and the load's balance count in a fit, about no long gap of the log; everywhere where None.
    """

    def __init__(
        self,
        motion: Motion,
        fine: "InverseDynamics | None" = None,
        coarse: Callable | None = None,
        counts: np.ndarray | None = None,
        times: int = 1,
    ):
        self.motion, self.times = motion, times
        self.counts = counting(motion, counts)
        if times > 1 and fine is None:
            fine = InverseDynamics(moved_oftener(motion, times))
            coarse = to_rate_of(motion.record, fine.motion.record)
        self.fine, self.coarse = fine, coarse
        self._keep = Kept()
        self.bodies = Bodies(motion, self._keep)
        self.command = Command(motion, self._keep)

    @cached_property
    def rough(self) -> "InverseDynamics":
        """The same with operators at the motion's own rate, for what only has to be told apart; itself where no finer rate is read of the record."""
        return self if self.fine is None or self.times > 1 else InverseDynamics(self.motion, counts=self.counts)

    def filtered_drive(self, plant: Plant) -> np.ndarray:
        """Return F(u') (rows, n): the drive, and what drives the load, nothing unless the record says so; less what its payload takes."""
        drive = self._drive(plant)
        at_load = self.motion.record.channels.get(LOAD_DRIVE)
        driven = np.zeros_like(drive) if at_load is None else self.motion.filter(at_load)
        given = np.stack([drive, driven][: self.rows(plant)])
        added = self.payload(plant)
        return given if added is None else given - self.closed(plant, self.motion.filter(added), added)

    def power_of_drive(self, plant: Plant) -> float:
        """Return the sum of squares of F(u') about its mean, of the samples in which errors count, whatever a payload takes of it."""
        at, path = self.motion.keep, drive_path(plant)
        return self._keep(("power", path), lambda: (x := self._drive(plant)[at]).size * float(np.var(x)))

    def _drive(self, plant: Plant) -> np.ndarray:
        return self._keep(("drive", drive_path(plant)), lambda: self.motion.filter(self.command.applied(plant)))

    def payload(self, plant: Plant) -> np.ndarray | None:
        """Return what the record's payload takes of each balance (rows, n), or None; a load that is held moves none."""
        record, place = self.motion.record, "load" if plant.kind == TWO_MASS else "axis"
        if record.payload is None or (place == "load" and record.locked):
            return None
        signals, _ = self._signals(plant, place, 2)
        return record.payload.force(signals["q"], signals["a"]) * self._lever(plant, place)[1]

    def rows(self, plant: Plant) -> int:
        """Balances of this record: one body; motor and load; the motor alone where the load is locked."""
        return rows(plant, self.motion.record.locked)

    def columns(self, plant: Plant) -> Iterator[tuple[Effect, str, np.ndarray]]:
        """Yield (effect, linear parameter or "", column (rows, n)) of every force, unfiltered.

        The first row is what the drive feels (one body, or the motor's balance), the second the load's balance.
        """
        for e, outputs, (_, lever), _ in self._forces(plant):
            columns = entered(outputs, lever)
            for name, column in zip(e.linear or ("",), self.closed(plant, columns, columns), strict=False):
                yield e, name, column

    def direction(self, plant: Plant, place: str) -> np.ndarray:
        """Return the direction (n,) at a place that friction there has, between -1 and 1."""
        # reading the velocity, too, it is no contact of its own: it follows the direction that is given there
        told = replace(catalogue()["coulomb_friction"](at=place, label="told"), reads=("dir", "v"))
        forces = [e for e in plant.effects if e.port == fx.FORCE and e.at == place]
        return next(outputs[0] for e, outputs, _, _ in self._at(plant, place, [*forces, told]) if e.key == told.key)

    def filtered(self, plant: Plant, only: Collection[str] = ()) -> Iterator[tuple[Effect, str, np.ndarray]]:
        """As `columns`, through the evaluation filter, of the samples in which errors count: each (N,), `stacked`. only: keys of the
        effects, all where empty."""
        keep, free = self.motion.keep, self.rows(plant) > 1 and self.motion.record.zero is not None
        for e, outputs, (path, lever), key in self._forces(plant):
            if only and e.key not in only:
                continue
            names = e.linear or ("",)
            if lever.shape[1] == 1:  # what does not change in time passes the filter: one balance stands for both
                smooth, means = self._keep(("filtered", free, *key), lambda o=outputs: self._smooth(o, free))
                for name, column, mean in zip(names, smooth, means, strict=False):
                    yield e, name, entering(column, lever, mean, keep, self.counts)
                continue
            kept = ("filtered", *key, path, len(lever))
            smooth = self._keep(kept, lambda o=outputs, by=lever: self.motion.filter(entered(o, by)))
            smooth = self.closed(plant, smooth, lambda o=outputs, by=lever: entered(o, by))
            for name, column in zip(names, smooth, strict=False):
                yield e, name, stacked(column, keep, self.counts)

    def _smooth(self, outputs: np.ndarray, free: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return outputs (columns, n) through the evaluation filter, and what of each in the mean closes the load's balance, (columns,)."""
        means = outputs[:, self.motion.keep].mean(axis=-1) if free else np.zeros(len(outputs))
        return self.motion.filter(outputs), means

    def closed(self, plant: Plant, change: np.ndarray, of: np.ndarray | Callable[[], np.ndarray]) -> np.ndarray:
        """Return `change` with the joint's mean torque where it closes the load's balance, if the encoders' zeros are free."""
        if self.rows(plant) < 2 or self.motion.record.zero is None:
            return change
        return with_zero(change, of() if callable(of) else of, self.motion.keep)

    def moved(self, plant: Plant, other: Plant) -> np.ndarray:
        """Return by how much `other` leaves more of the drive than `plant`, filtered, (rows, n); zeros where nothing differs.

        Both have the same effects and linear values. What differs is summed before the filter, which passes once.
        """
        more = np.zeros((self.rows(plant), self.motion.u.size))
        applied, drive = self.command.applied(plant), self.command.applied(other)
        if drive is not applied:
            more[0] += drive - applied
        for (e, before, (was, lever), key), (_, after, (path, by), new) in zip(
            self._forces(plant), self._forces(other), strict=True
        ):
            if new != key or path != was:
                values = np.array(linear_of(e))
                more -= (values @ after) * by - (values @ before) * lever
        more = self.closed(plant, more, more)
        felt = more.any(axis=1)  # what moves one body alone leaves the other's balance as it is
        more[felt] = self.motion.filter(more[felt])
        return more

    def _forces(self, plant: Plant):
        """Yield (effect, outputs (columns, n), (path, lever), key), place by place, those that provide the direction first."""
        for place in PLACES[plant.kind]:
            forces = forces_of(plant, place)
            if place == "load" and self.motion.record.locked:
                continue
            if forces:
                yield from self._at(plant, place, forces)

    def _signals(self, plant: Plant, place: str, derivatives: int) -> tuple[dict, tuple]:
        """Return the signals that a body at a place gives to its forces, with this many of its derivatives, and what they are kept under."""
        m = self.motion
        path, body = self.bodies.body(plant, place, derivatives)
        signals = {"q": body[POSITION], "dq": body[INCREMENT], **dict(zip("va", body[VELOCITY:], strict=False))}
        signals |= {"dt": m.dt, "t": m.t, "locked": float(m.record.locked)}
        signals |= {"ratio": plant.geometry.gear_ratio, "pole_pairs": plant.geometry.pole_pairs}
        signals |= {n: m.record.channels[n] for n in fx.CHANNELS if n in m.record.channels}
        return signals, path

    def _run(self, e: Effect, signals: dict, plant: Plant, place: str) -> np.ndarray:
        """Return the outputs (columns, n) of a force; of an operator of the motion's increments at the finer rate.

        A direction turns where the body does.
        """
        oftener = self.fine is not None and e.states and "dq" in e.reads and not {"dir", "tau", "u"} & set(e.reads)
        direction = e.name == DIRECTION
        if oftener:
            signals = self.fine._signals(plant, place, 1 if direction else derivatives_in(e.reads))[0]
        outputs = outputs_of(e, signals)
        if direction:
            m, (force, way) = (self.fine if oftener else self).motion, outputs
            time = 1.0 / (MOTION_BAND * m.filter.bandwidth * m.dt)
            outputs = np.stack([force, turned(way, signals["q"], signals["v"], time)])
        return self.coarse(outputs) if oftener else outputs

    def _at(self, plant: Plant, place: str, forces: list[Effect]):
        # once a body is made, its speed costs little more, and most forces want it: so it is the same body for nearly all of them
        wanted = max([1, *(derivatives_in(e.reads) for e in forces)])
        signals, path = self._signals(plant, place, wanted)
        width = max(2 * self.bodies.counts(CHANNEL.get(place, "position")), self.motion.counts, 1e-12)
        lever = self._lever(plant, place)

        def kept(e: Effect, signals: dict, key: tuple) -> np.ndarray:
            return self._keep(("raw", *key), lambda: self._run(e, signals, plant, place))

        lacks = f"record '{self.motion.record.name}' does not have at the {place}"
        for e, outputs, key in run_forces(
            forces, signals, path, width, kept, lambda ran: self._carried(plant, place, ran), lacks
        ):
            yield e, outputs, lever, key

    def _carried(self, plant: Plant, place: str, ran: Ran) -> tuple[np.ndarray, tuple]:
        """Return ((tau, tau_inertia) (2, n), what they are kept under): the torque that a contact carries, from the plant's own values.

        ran: of the forces at this place that have run.
        """
        parts = carried(plant.kind, place, plant.effects)
        if plant.kind == TWO_MASS and place != "joint":
            alike = [e for e in plant.effects if e.at == "joint" and e.port == fx.FORCE and not reads_load(e)]
            ran = {e.key: (outputs, key) for e, outputs, _, key in self._at(plant, "joint", alike)}
        path = tuple(tuple((ran[e.key][1], linear_of(e)) for e in part) for part in parts)
        torque = self._keep(("carried", path), lambda: summed(parts, ran, self.motion.u.size))
        if plant.kind != TWO_MASS or place == "joint" or self.motion.record.zero is None or self.motion.record.locked:
            return torque, path
        # what a joint between encoders of separate zeros carries in the mean is what the load asks for (`closed`)
        asked = [e for e in forces_of(plant, "load") if not reads_load(e)]
        asking = {e.key: (outputs, key) for e, outputs, _, key in self._at(plant, "load", asked)} if asked else {}
        path = path, tuple((asking[e.key][1], linear_of(e)) for e in asked)
        return self._keep(("closed", path), lambda: self._closing(torque, asked, asking)), path

    def _closing(self, torque: np.ndarray, asked: Sequence[Effect], asking: Ran) -> np.ndarray:
        """Return the joint's torque (2, n) with the mean that the load's forces ask for."""
        load = summed((asked,), asking, self.motion.u.size)[0]
        keep = self.motion.keep
        return torque + np.array([[np.mean(load[keep]) - np.mean(torque[0, keep])], [0.0]])

    def _lever(self, plant: Plant, place: str) -> tuple[tuple, np.ndarray]:
        """Return (path, (rows, n or 1)): by what a force at a place enters the balances of this record."""
        whole = self.rows(plant)
        if place == "joint":
            path, lever = self.bodies.leverage(plant)
            return path, lever[:whole]
        return (), LEVERS[place][:whole]


def inverse_dynamics(records: Sequence[Record], bandwidth: float) -> tuple[InverseDynamics, ...]:
    """Return the inverse dynamics over the motions of the records; they may be shared by fits of many plants."""
    return tuple(InverseDynamics(motion(r, bandwidth)) for r in relaxed(records, bandwidth))
