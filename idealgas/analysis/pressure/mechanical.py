"""Mechanical pressure of every wall, for gases whose pressure follows from no equation of state."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.equilibrium import kept_momentum
from idealgas.analysis.core.settling import why_never_stationary
from idealgas.analysis.core.statistics import Estimate, mean, ratio
from idealgas.analysis.core.wall_pressure import Face, WallGauge, wall_name
from idealgas.analysis.core.window import Window
from idealgas.log import Log

SMOOTH = 1e-9
"""Largest stress along a wall, relative to the pressure, that is rounding."""


@dataclass(frozen=True)
class WallPressure:
    """What discs press on one face of a wall, per length.

    name: of the wall, and for a wall segment of the direction in which the face looks. pressure: force per length of
    discs that touch the body of the wall, while it is there; its theory is what holds a piston from outside. stress:
    force along the face per length, its direction the outward normal turned by 90°; None for a smooth face.
    """

    name: str
    pressure: Estimate
    stress: Estimate | None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        stress = None if self.stress is None else self.stress.as_dict()
        return {"wall": self.name, "pressure": self.pressure.as_dict(), "stress": stress}


@dataclass(frozen=True)
class WallForce:
    """Force of the discs on one wall or on all, with their ends, mass·length/time².

    name: of the wall. x, y: along each axis; the theory of the force on all walls is the weight of the discs.
    """

    name: str
    x: Estimate
    y: Estimate

    @property
    def large(self) -> dict[str, Estimate]:
        """Components by their axis that are more than rounding, or that have a theory."""
        both = {"x": self.x, "y": self.y}
        size = {axis: abs(one.value) + one.standard_error for axis, one in both.items()}
        return {axis: one for axis, one in both.items() if size[axis] > SMOOTH * max(size.values()) or one.theory}

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {"wall": self.name, "x": self.x.as_dict(), "y": self.y.as_dict()}


@dataclass(frozen=True)
class Mechanical:
    """Mechanical pressure of every face and force on every wall of a gas.

    area: mean area that the gas has, length². walls: pressure on every face. forces: on every wall, then on all
    together. unsteady: why the gas never comes to a stationary state, as part of a sentence; empty if it may. Then
    the numbers are means over a changing state.
    """

    area: float
    walls: tuple[WallPressure, ...]
    forces: tuple[WallForce, ...]
    unsteady: str

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {
            "walls": [wall.as_dict() for wall in self.walls],
            "forces": [force.as_dict() for force in self.forces],
            "unsteady": self.unsteady or None,
        }


def mechanical(log: Log, gauge: WallGauge, window: Window) -> Mechanical:
    """Mechanical pressure of all walls of a log in a window of time, from a gauge whose tallies are filled."""
    some, unsteady = slice(window.first, None), why_never_stationary(log)
    return Mechanical(
        area=float(gauge.area(window.edges)[some].mean()),
        walls=tuple(_pressure(face, some, _holding(gauge, face, window)) for face in gauge.faces(window.edges)),
        forces=_forces(log, gauge, window, bool(unsteady)),
        unsteady=unsteady,
    )


def _holding(gauge: WallGauge, face: Face, window: Window) -> float | None:
    """Pressure that holds a piston from outside; None for other walls."""
    moving = gauge.moving
    return moving.balance(window.start, window.end) if moving is not None and face.wall == moving.wall else None


def _pressure(face: Face, some: slice, holding: float | None) -> WallPressure:
    push, along, exposed = face.push[some], face.along[some], face.exposed[some]
    if not push.any():  # a wall that was never hit tells nothing of its error
        return WallPressure(face.name, Estimate(0.0, np.nan, 0.0, holding), None)
    there = exposed > 0
    rough = np.abs(along).sum() > SMOOTH * push.sum()
    return WallPressure(
        face.name,
        ratio(push[there], exposed[there], theory=holding),
        ratio(along[there], exposed[there]) if rough else None,
    )


def _forces(log: Log, gauge: WallGauge, window: Window, unsteady: bool) -> tuple[WallForce, ...]:
    """Force on every wall that was hit, and on all walls, which carry the weight of a gas in a stationary state."""
    given = window.of(gauge.impulses.given)
    hit = gauge.impulses.hits[window.first :].any(axis=0)
    by_wall = [(wall_name(k, wall.name), given[:, k]) for k, wall in enumerate(log.walls) if hit[k]]
    total, kept = given.sum(axis=1), kept_momentum(log)
    weight = [None if kept[k] or unsteady else float(log.discs.mass.sum()) * log.gravity[k] for k in range(2)]
    return (
        *(WallForce(name, mean(series[:, 0]), mean(series[:, 1])) for name, series in by_wall),
        WallForce("all walls", mean(total[:, 0], theory=weight[0]), mean(total[:, 1], theory=weight[1])),
    )
