"""Detection of runs that make no progress, because there are no events or a few discs have nearly all events."""

import math
from dataclasses import replace

import numpy as np

from idealgas.effects.bundle import next_change
from idealgas.engine.epoch import EVENTS_OF_FEW, EVENTS_PER_DISC
from idealgas.engine.simulation import Simulation, Stop
from idealgas.physics.absorbing import inside
from idealgas.physics.collision_rates import disc_collisions_per_length
from idealgas.state import Gas

EMPTY_EPOCHS = 10_000
"""Number of consecutive epochs without an event after which a run without `until` stops, unless this may be chance."""

EXPECTED = 10_000
"""Number of pair collisions expected from kinetic theory whose complete absence cannot be due to chance.

A run that only pair collisions can end also stops when this number was expected and no collision occurred.
"""

HOPELESS = 1e-9
"""Expected collisions per epoch below which it is pointless to wait, because the discs hardly move past each other."""

QUIET_SAMPLES = 64
"""Number of consecutive epochs without an event that are sampled; later epochs without an event are not sampled."""

STUCK = 1000
"""Largest number of collisions of a disc per contact duration, above which the disc is stuck.

The number is an average over at least one contact duration. A disc at rest has 1/e collisions per contact duration.
Between walls, or under an arch of other discs, gaps may be so small that all collisions count as contacts at rest;
these are elastic, so the disc keeps its speed.
"""

OVERDUE = 8
"""The busiest discs are determined if an epoch has more than this multiple of the planned number of events."""


class StallDetector:
    """Detects runs that will not end because there are no events or, if only these end the run, no pair collisions.

    In a resumed run, counting restarts from zero.
    """

    def __init__(self, simulation: Simulation, stop: Stop, begun: bool) -> None:
        """Begin at the start of an epoch; begun: whether the log already has a checkpoint at this time."""
        self._simulation = simulation
        self._events_at_checkpoint = simulation.totals.events if begun else -1
        never = Stop()
        self._endless = stop.time == never.time and stop.trials == never.trials
        self._needs_pairs = self._endless and stop.events == never.events
        self._empty = 0  # consecutive epochs without an event
        self._expected = 0.0  # pair collisions expected in these epochs
        self._missed = 0.0  # pair collisions expected since the last one, if only pair collisions end the run
        self._overdue: float = OVERDUE
        self._hits = np.zeros(len(simulation.gas), int)  # collisions of each disc by id since `_hits_since`
        self._hits_since = simulation.time

    def end_epoch(self) -> None:
        """Take account of an epoch that has ended, before the next epoch begins."""
        simulation = self._simulation
        before, now = simulation.totals, simulation.counters
        empty, apart = now.events == before.events, now.disc_collisions == before.disc_collisions
        expected = 0.0
        if self._endless and (empty or (apart and self._needs_pairs)):
            expected = _expected_collisions(simulation.gas, simulation.length, simulation.effects.absorbing)
        self._empty, self._expected = (self._empty + 1, self._expected + expected) if empty else (0, 0.0)
        self._missed = self._missed + expected if apart and self._needs_pairs else 0.0
        if math.isfinite(next_change(simulation.effects, simulation.time)):  # a gate may change everything
            self._empty, self._expected, self._missed = min(self._empty, QUIET_SAMPLES), 0.0, 0.0

    def checkpoint_due(self, every: int) -> bool:
        """Whether to store the start of this epoch: once in `every` epochs, if events have happened since the last."""
        simulation = self._simulation
        due = simulation.epoch % every == 0 and simulation.totals.events > self._events_at_checkpoint
        if due:
            self._events_at_checkpoint, self._empty, self._expected = simulation.totals.events, 0, 0.0
        return due

    @property
    def sample_due(self) -> bool:
        """Whether to sample the start of this epoch."""
        return self._empty < QUIET_SAMPLES

    def stall_reason(self) -> str:
        """Reason why the run cannot be expected to reach its stop; empty if it can."""
        if not self._endless:
            return ""
        if self._simulation.totals.escaped == len(self._simulation.gas):
            return "all discs have left the gas"
        hopeless = self._expected < HOPELESS * self._empty
        if self._empty >= EMPTY_EPOCHS and (self._expected >= EXPECTED or hopeless):
            return f"no event in {self._empty} epochs"
        if self._missed >= EXPECTED:
            return f"no collision between discs although about {EXPECTED:,} were expected".replace(",", " ")
        return ""

    def stuck(self) -> int:
        """Return the id of an inelastic disc that is stuck, or -1; must also be called at the end of each epoch."""
        simulation, restitution = self._simulation, self._simulation.effects.restitution
        if restitution is None or simulation.method.single_epoch:
            return -1
        discs, hits = simulation.method.discs, self._hits.copy()
        hits[discs.id] += discs.record.count
        durations = (simulation.last_event_time - self._hits_since) / restitution.contact_duration
        if simulation.epoch_over:
            self._hits = hits if durations < 1 else np.zeros_like(hits)
            self._hits_since = self._hits_since if durations < 1 else simulation.time + simulation.length
        disc = int(hits.argmax())
        return disc if hits[disc] > STUCK * (1 + durations) else -1

    def busy(self) -> str:
        """Return a notice, once per run, if an epoch has far too many events and a few discs have most of them."""
        simulation, n = self._simulation, len(self._simulation.gas)
        events = simulation.counters.events - simulation.totals.events
        if simulation.method.single_epoch or events <= self._overdue * max(EVENTS_PER_DISC * n, EVENTS_OF_FEW):
            return ""
        share = np.cumsum(np.sort(simulation.method.discs.record.count)[::-1], dtype=float)
        few = int(share.searchsorted(share[-1] / 2, "right")) + 1
        if share[-1] == 0 or n == 1 or few > math.ceil(n / 4):
            self._overdue *= 2
            return ""
        self._overdue = math.inf
        span = f"from t = {simulation.time:g} to t = {simulation.last_event_time:g}"
        return f"{few} of {n} discs account{'s' * (few == 1)} for most of the events {span}"


def _expected_collisions(gas: Gas, duration: float, absorbing: np.ndarray | None = None) -> float:
    """Number of pair collisions expected during a time from kinetic theory, with velocities relative to their mean."""
    here = inside(gas.position[:, 0], absorbing)
    gas = replace(gas, velocity=gas.velocity[here], radius=gas.radius[here], mass=gas.mass[here])
    if (n := len(gas)) < 2:
        return 0.0
    speed = float(np.hypot(*(gas.velocity - gas.velocity.mean(axis=0)).T).mean())
    per_length = disc_collisions_per_length(n, 2 * float(gas.radius.mean()), gas.packing_fraction, gas.box)
    return n / 2 * per_length * speed * duration
