"""Density and temperature along an axis where theory knows them: of dilute gases, of discs small beside a strip."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from idealgas.analysis.composition import Composition, composition
from idealgas.analysis.ensemble import known_ensemble, wall_temperatures
from idealgas.log import Log
from idealgas.scene import Scene, ThermalSide

POINTS = 64
"""Places in a strip that averages over it are taken from."""


@dataclass(frozen=True)
class Expected:
    """law: in words. density, temperature: (S, K), averages over the strips; temperature of each degree of freedom."""

    law: str
    density: np.ndarray
    temperature: np.ndarray


def natural_axis(log: Log) -> int:
    """The axis along which something changes: that of gravity, or of thermal sides of two temperatures; else x."""
    if log.gravity[1] != 0:
        return 1
    bottom, top = log.scene.box.sides[2:]
    return int(isinstance(bottom, ThermalSide) and isinstance(top, ThermalSide) and bottom != top)


def expected_profile(log: Log, axis: int, edges: np.ndarray, start: float) -> Expected | None:
    """In the strips between edges (K + 1,), from time start on; None where no simple theory applies."""
    scene, discs = log.scene, composition(log.discs)
    if not _is_empty(scene, start) or scene.piston or log.gravity[1 - axis]:
        return None
    reach = np.zeros_like(discs.radius) if log.joined[axis] else discs.radius  # of centres, from the sides
    inside = np.clip(edges, reach[:, None], log.box[axis] - reach[:, None])
    size = np.diff(inside)
    places = inside[:, :-1, None] + size[:, :, None] * (np.arange(POINTS) + 0.5) / POINTS
    found = _course(log, axis, places, discs)
    if found is None:
        return None
    law, weight, temperature = found
    parts = weight.mean(axis=2) * size
    number = discs.number[:, None] * parts / parts.sum(axis=1, keepdims=True)
    strips = np.diff(edges) * log.box[1 - axis]
    return Expected(law, number / strips, (weight * temperature).mean(axis=2) / weight.mean(axis=2))


def _is_empty(scene: Scene, start: float) -> bool:
    """Whether no wall is in the box from a time on."""
    return all(opens <= start and not math.isfinite(closes) for opens, closes in (w.absence for w in scene.wall))


def _course(log: Log, axis: int, places: np.ndarray, discs: Composition) -> tuple[str, np.ndarray, np.ndarray] | None:
    """The law, and at places (S, K, P) relative density and temperature."""
    one = np.ones_like(places)
    low, high = log.scene.box.sides[2 * axis : 2 * axis + 2]
    if len(wall_temperatures(log.scene)) == 2 and isinstance(low, ThermalSide) and isinstance(high, ThermalSide):
        if log.scene.gravity or "restitution" in log.scene.effects or low == high:
            return None
        power = low.thermal**1.5 + (high.thermal**1.5 - low.thermal**1.5) * places / log.box[axis]
        temperature = power ** (2 / 3)
        return "T^(3/2) in a straight line between the walls, nT the same (Fourier)", 1 / temperature, temperature
    if log.gravity[axis]:
        if (t := column_temperature(log, axis, discs)) is None:
            return None
        weight = np.exp(discs.mass[:, None, None] * log.gravity[axis] * (places - log.box[axis] / 2) / t)
        return f"barometric: n ~ exp(-m g h/T), T = {t:.6g} at all heights", weight, t * one
    equilibrium = known_ensemble(log)
    if equilibrium is None:
        return None
    return "uniform", one, equilibrium.of_species[:, None, None] * one


def column_temperature(log: Log, axis: int, discs: Composition) -> float | None:
    """Of a gas that falls along an axis: its walls' own, or what its energy at the start comes to in a dilute gas.

    None where other effects leave it unknown, and for a single disc, with which nobody shares.
    """
    scene, gas = log.scene, log.discs
    if scene.piston or "restitution" in scene.effects or log.joined[1 - axis] or len(gas) == 1:
        return None
    if walls := wall_temperatures(scene):
        return walls.pop() if len(walls) == 1 else None
    if scene.rotation and (abs(scene.rotation.roughness) < 1 or abs(scene.rotation.wall_roughness) < 1):
        return None
    g = log.gravity[axis]
    start = log.state_at(log.start_time)
    energy = gas.kinetic_energy - float(gas.mass @ start.position[:, axis]) * g
    spins = 0.0
    if scene.rotation and start.angular_velocity is not None:
        inertia = scene.rotation.inertia * gas.mass * gas.radius**2
        energy += float(inertia @ start.angular_velocity**2) / 2
        spins = len(gas) / 2
    height = log.box[axis] - 2 * discs.radius

    def excess(t: float) -> float:
        x = discs.mass * g * height / t
        with np.errstate(over="ignore"):
            above = height * (1 / -np.expm1(-x) - 1 / x)  # mean of h' in (0, height) with weight exp(x h'/height)
        potential = -(discs.number * discs.mass * g * (discs.radius + above)).sum()
        return (len(gas) + spins) * t + float(potential) - energy

    lowest = -(discs.number * discs.mass * g * np.where(g < 0, discs.radius, log.box[axis] - discs.radius)).sum()
    scale = max(energy - float(lowest), 1e-300) / len(gas)
    return float(brentq(excess, 1e-3 * scale, 2 * scale))
