"""A run that a Python program advances, observes and steers."""

import math

import numpy as np
from numpy.typing import ArrayLike

from idealgas.engine.records import UNLIMITED
from idealgas.engine.simulation import Stop
from idealgas.errors import UserError
from idealgas.log import LogState
from idealgas.log.schema import CHANGE_COLUMNS
from idealgas.run.effects import make_schedule
from idealgas.run.layout import by_name, snapshot_state
from idealgas.run.logged_run import LoggedRun
from idealgas.scene.changes import SceneChange, changed_scene
from idealgas.toml.table import LARGEST

LONGEST_SETTING = np.dtype(CHANGE_COLUMNS[-1].dtype).itemsize
"""Largest size of the text of a change, in bytes."""


class SteeredRun(LoggedRun):
    """A run that `open_run` begins and that a Python program advances, at most to the end of the scene.

    Each change ends an epoch, is written to the log, and is followed by a checkpoint.

    Attributes:
        time: time that the run has reached.
        events: number of events so far.
        ended: whether the run has reached the end of its scene.
        summary: summary of the run; None until it is finished.
    """

    @property
    def time(self) -> float:
        """Time that the run has reached."""
        return self._simulation.reached

    @property
    def events(self) -> int:
        """Number of events so far."""
        return self._simulation.counters.events

    @property
    def ended(self) -> bool:
        """Whether the run has reached the end of its scene."""
        return self._simulation.finished(self._stop)

    def advance(self, *, until: float = math.inf, events: int = UNLIMITED) -> bool:
        """Simulate to a time or for a number of events, at most to the end of the scene.

        Args:
            until: time at which to return.
            events: number of events after which to return.

        Returns:
            True if the run can continue, False once it has reached the end of the scene.

        Raises:
            UserError: as in `simulate`.
        """
        stop = self._stop
        if until > self.time:
            until, events = min(until, stop.time), min(self.events + events, stop.events)
            self._advance(stop._replace(time=until, events=events))
        return not self.ended

    def state(self) -> LogState:
        """Return the state of all discs at the time reached, in order of id."""
        gas, effects = self._simulation.state()
        arrays = by_name(snapshot_state(gas, effects, self._simulation.method.has_positions))
        arrays.setdefault("position", np.full_like(gas.velocity, np.nan))
        if effects.absorbing is not None:  # as in the states of a log
            for name in arrays.keys() & {"velocity", "angular_velocity"}:
                arrays[name] = arrays[name].copy()
                arrays[name][np.isnan(gas.position[:, 0])] = np.nan
        return LogState(self.time, **arrays)

    def set_velocities(self, velocity: ArrayLike, discs: ArrayLike | None = None) -> None:
        """Give discs new velocities at the time reached.

        The log contains a row of kind STEERED for each disc whose velocity changes.

        Args:
            velocity: (n, 2) velocities, length/time.
            discs: (n,) ids of the discs; all discs by default.

        Raises:
            UserError: the scene has no [steering] table, or an array has a wrong shape or invalid values.
        """
        number = len(self._simulation.gas)
        ids = np.arange(number) if discs is None else np.asarray(discs)
        given = np.asarray(velocity, float)
        whole = ids.dtype.kind in "iu" or not ids.size  # an empty list becomes an array of floats
        if ids.ndim != 1 or not whole or not ((ids >= 0) & (ids < number)).all():
            raise UserError(f"discs: not ids (allowed 0 to {number - 1})")
        ids, record = ids.astype(int), self._simulation.method.discs
        if self._simulation.effects.absorbing is not None:
            left = ids[np.isin(ids, record.id[np.isnan(record.record.x)])]
            if len(left):
                raise UserError(f"discs: disc {left[0]} has left the gas")
        if given.shape != (len(ids), 2) or not (np.abs(given) <= LARGEST).all():
            raise UserError(f"velocity: not ({len(ids)}, 2) numbers up to {LARGEST:g} (got {given.shape})")
        self._arrive()
        self._stall.end_epoch()
        self._simulation.set_velocities(ids, given)
        self._begin_epoch(changed=True)

    def reverse(self) -> None:
        """Reverse all velocities and spins, and the velocities of pistons of finite mass, at the time reached.

        Raises:
            UserError: the scene has no [steering] table.
        """
        self._arrive()
        self._stall.end_epoch()
        self._simulation.reverse()
        self._begin_epoch(changed=True)

    def change(self, setting: str) -> None:
        """Change a value of the scene at the time reached; later steps of this value in the scene are dropped.

        Args:
            setting: "table.key=value" for a value that may be given in steps, such as "thermostat.temperature=2", or
                "wall.NAME.open=true" or "wall.NAME.open=false" for a gate.

        Raises:
            UserError: the scene has no [steering] table.
            SceneError: the setting does not fit the scene.
        """
        self._arrive()
        if self.time == 0:
            raise UserError("the run has not begun: change the scene itself")
        if len(setting.encode()) > LONGEST_SETTING:
            raise UserError(f"setting: too long (got {len(setting.encode())} bytes; allowed <= {LONGEST_SETTING})")
        simulation, change = self._simulation, SceneChange(self.time, setting)
        self._scene = changed_scene(self._scene, change)
        self._stall.end_epoch()
        simulation.reschedule(make_schedule(self._scene, simulation.gas))
        self._log.change(*change)
        self._begin_epoch(changed=True)

    def _arrive(self) -> None:
        """Process all events up to the time reached, so that the epoch can end there."""
        simulation = self._simulation
        if self._scene.steering is None:
            raise UserError("only a scene with a [steering] table can be changed during its run")
        if self.ended:
            raise UserError("the run has reached the end of its scene")
        if not simulation.epoch_over:
            self._advance(Stop(time=math.nextafter(self.time, math.inf) if self.time else 0.0))
