"""Mechanical pressure on every wall, for gases without an equation of state."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from idealgas.fields import Key
from idealgas.log import Log
from idealgas.statistics.estimates import Estimate, mean_of_flux, mean_of_replicates, ratio
from idealgas.tallies.equilibration import Window
from idealgas.tallies.equilibrium import nonstationary_reason
from idealgas.tallies.walls import Face, WallGauge, wall_name
from idealgas.theory.conserved import conserved_momentum

SEGMENTS = 8
"""Number of segments of the window that are averaged separately if the state of the gas changes steadily."""

SMOOTH = 1e-9
"""Largest tangential stress on a wall, relative to the pressure, that is attributed to rounding."""


@dataclass(frozen=True)
class WallPressure:
    """Pressure of the discs on one face of a wall.

    Attributes:
        name: name of the wall; for a wall segment, followed by the direction in which the face looks.
        pressure: normal force per length that the discs exert on the face while the wall is present; for a piston, the
            theoretical value is the external pressure that holds it.
        stress: tangential force per length, positive along the outward normal turned by 90°; None for a smooth face.
    """

    name: Annotated[str, Key("wall")]
    pressure: Estimate
    stress: Estimate | None


@dataclass(frozen=True)
class WallForce:
    """Force of the discs on one wall, including its ends, or on all walls, mass·length/time².

    Attributes:
        name: name of the wall.
        x: component along x; for all walls together, theory predicts the weight of the discs.
        y: component along y, with the same prediction.
    """

    name: Annotated[str, Key("wall")]
    x: Estimate
    y: Estimate

    @property
    def large(self) -> dict[str, Estimate]:
        """Components, by axis, that exceed rounding errors or have a nonzero theoretical value."""
        both = {"x": self.x, "y": self.y}
        size = {axis: abs(component.value) + component.standard_error for axis, component in both.items()}
        return {
            axis: component
            for axis, component in both.items()
            if size[axis] > SMOOTH * max(size.values()) or component.theory
        }


@dataclass(frozen=True)
class Mechanical:
    """Mechanical pressure on every face and force on every wall of a gas.

    Attributes:
        walls: pressure on every face.
        forces: force on every wall, followed by the force on all walls together.
        unsteady: why the gas never becomes stationary, as part of a sentence; None if it can become stationary. If a
            reason is given, the numbers are means over a changing state.
    """

    walls: tuple[WallPressure, ...]
    forces: tuple[WallForce, ...]
    unsteady: str | None


def mechanical(log: Log, gauge: WallGauge, window: Window) -> Mechanical:
    """Return the mechanical pressure on all walls in a window, given a gauge whose tallies have been filled."""
    used, why = slice(window.first, None), nonstationary_reason(log)
    present = (face for face in gauge.faces(window.edges) if face.exposed[used].any())
    faces = [(face, _external_pressure(gauge, face, window)) for face in present]
    balances = None if why else _balances(log, gauge, window, faces)
    return Mechanical(
        walls=tuple(_pressure(face, used, balances, holding) for face, holding in faces),
        forces=_forces(log, gauge, window, balances),
        unsteady=why or None,
    )


def _external_pressure(gauge: WallGauge, face: Face, window: Window) -> float | None:
    """Return the external pressure on a piston; None for other walls."""
    held = (piston.balance(window.start, window.end) for piston in gauge.moving if piston.wall == face.wall)
    return next(held, None)


def _balances(log: Log, gauge: WallGauge, window: Window, faces: Sequence[tuple[Face, float | None]]) -> np.ndarray:
    """Return the rate of change of the momentum of the discs and of each piston in each block, (B, K).

    The rate for the discs is the force on all walls minus the weight of the discs, along axes along which only the
    walls carry the weight. The rate for a piston is the force of the discs minus the external force that holds it.
    """
    forces = window.of(gauge.impulses.given).sum(axis=1) - _weight(log)
    held = [
        (face.push - holding * face.exposed)[window.first :] / window.width
        for face, holding in faces
        if holding is not None
    ]
    return np.array([*forces.T[_carried(log)], *held]).reshape(-1, len(forces)).T


def _carried(log: Log) -> np.ndarray:
    """Return whether the walls alone carry the weight along x and y, (2,) bool; a heat bath would carry part of it."""
    return ~conserved_momentum(log.scene) & (log.scene.properties.bath is None)


def _weight(log: Log) -> np.ndarray:
    """Return the weight of all discs, (2,)."""
    return np.asarray(log.discs.mass.sum() * np.array(log.gravity))


def _pressure(face: Face, used: slice, balances: np.ndarray | None, holding: float | None) -> WallPressure:
    push, along, exposed = face.push[used], face.along[used], face.exposed[used]
    if not push.any():  # the error of a wall that was never hit is unknown
        return WallPressure(face.name, Estimate(0.0, np.nan, 0.0, holding), None)
    rough = np.abs(along).sum() > SMOOTH * push.sum()
    return WallPressure(
        face.name, _average(push, exposed, balances, holding), _average(along, exposed, balances) if rough else None
    )


def _average(
    given: np.ndarray, exposed: np.ndarray, balances: np.ndarray | None, theory: float | None = None
) -> Estimate:
    """Return the mean momentum given to a wall per exposed length and time.

    For a changing state the window is averaged in segments, so that the change does not count as a fluctuation.

    Args:
        given: momentum given in each block, (B,).
        exposed: exposed length of the wall times time in each block, (B,).
        balances: see `_balances`; None for a changing state. The part of a force that is correlated with the balances
            fluctuates strongly, but it shifts the mean only by the change in the stored momentum.
        theory: force per length that balances the force of the discs; None if unknown.
    """
    there = exposed > 0
    given, exposed = given[there], exposed[there]
    if theory is not None:
        return mean_of_flux(given / exposed, np.full(len(given), theory), theory)
    if balances is None:
        segments = zip(np.array_split(given, SEGMENTS), np.array_split(exposed, SEGMENTS), strict=True)
        return mean_of_replicates([ratio(*piece) for piece in segments])
    if np.ptp(exposed) > SMOOTH * exposed.max():
        return ratio(given, exposed)
    force = given / exposed
    part = balances[there] @ np.linalg.lstsq(balances[there], force - force.mean())[0]
    return mean_of_flux(force, force - part)


def _forces(log: Log, gauge: WallGauge, window: Window, balances: np.ndarray | None) -> tuple[WallForce, ...]:
    """Return the force on every wall that was hit, and on all walls, which carry the weight of a steady gas."""
    given = window.of(gauge.impulses.given)
    hits = gauge.impulses.hits[window.first :].sum(axis=0)
    by_wall = [(wall_name(k, wall.name), given[:, k]) for k, wall in enumerate(log.walls) if hits[k]]
    all_time, known = np.ones(len(given)), ~conserved_momentum(log.scene) & (balances is not None)
    weight = [float(force) if balanced else None for force, balanced in zip(_weight(log), known, strict=True)]
    bounded = _carried(log)

    def force(name: str, series: np.ndarray, theory: Sequence[float | None] = (None, None)) -> WallForce:
        x, y = (_average(series[:, k], all_time, balances, theory[k] if bounded[k] else None) for k in range(2))
        return WallForce(name, replace(x, theory=theory[0]), replace(y, theory=theory[1]))

    return (*(force(name, series) for name, series in by_wall), force("all walls", given.sum(axis=1), weight))
