"""What kinetic theory expects of a scene before it is run."""

import math
from dataclasses import dataclass

import numpy as np

from idealgas.analysis import theory
from idealgas.gas import Gas
from idealgas.scene import Scene

BYTES_A_ROW = {"gzip": 36, "none": 49}
"""Size of an event in the log, by compression."""


@dataclass(frozen=True)
class SpeciesForecast:
    """One species at the start; collision_rate: collisions per disc and time in equilibrium."""

    name: str
    number: int
    radius: float
    mass: float
    packing_fraction: float
    temperature: float
    collision_rate: float


@dataclass(frozen=True)
class Forecast:
    """The gas in equilibrium: rates per time, collision_rate per disc too. Of the run: duration to bytes."""

    number: int
    packing_fraction: float
    temperature: float
    collision_rate: float
    pair_collision_rate: float
    wall_hit_rate: float
    duration: float
    events: float
    rows: float
    bytes: float
    species: tuple[SpeciesForecast, ...]


def forecast(scene: Scene, gas: Gas) -> Forecast:
    """Rates by Enskog's theory at the temperature all species will share; sizes by the stop rule met first."""
    number = np.bincount(gas.species)
    _, first = np.unique(gas.species, return_index=True)
    radius, mass = gas.radius[first], gas.mass[first]
    per_disc = theory.mixture_collision_rate(radius, mass, number, gas.area, gas.temperature)
    per_disc = (per_disc - np.diag(np.diag(per_disc) / number)).sum(axis=1)  # no disc meets itself
    collisions = float(number @ per_disc) / 2
    hits = _wall_hit_rate(gas, radius, mass, number)
    duration = _duration(scene, len(gas), collisions, hits)
    rows = duration * (2 * collisions + hits) if scene.log.events else 0.0
    return Forecast(
        number=len(gas),
        packing_fraction=gas.packing_fraction,
        temperature=gas.temperature,
        collision_rate=2 * collisions / len(gas),
        pair_collision_rate=collisions,
        wall_hit_rate=hits,
        duration=duration,
        events=duration * (collisions + hits),
        rows=rows,
        bytes=rows * BYTES_A_ROW[scene.log.compression],
        species=tuple(_species(gas, k, float(rate)) for k, rate in enumerate(per_disc)),
    )


def _species(gas: Gas, k: int, collision_rate: float) -> SpeciesForecast:
    members = gas.species == k
    mass, radius, number = gas.mass[members][0], gas.radius[members][0], int(members.sum())
    return SpeciesForecast(
        name=gas.species_names[k],
        number=number,
        radius=float(radius),
        mass=float(mass),
        packing_fraction=float(np.pi * radius**2 * number / gas.area),
        temperature=float(mass * (gas.velocity[members] ** 2).sum() / (2 * number)),
        collision_rate=collision_rate,
    )


def _wall_hit_rate(gas: Gas, radius: np.ndarray, mass: np.ndarray, number: np.ndarray) -> float:
    """Flux onto the lines that the centres reach; hard discs stand Z times as dense there as in the gas."""
    crowding = theory.mixture_compressibility(radius, number, gas.area)
    rate = 0.0
    for r, m, n in zip(radius, mass, number, strict=True):
        width, height = (length - 2 * r for length in gas.box)
        if width > 0 and height > 0:
            flux = theory.effusion_flux(crowding * n / (width * height), gas.temperature, m)
            rate += 2 * (width + height) * flux
    return float(rate)


def _duration(scene: Scene, number: int, collisions: float, hits: float) -> float:
    """Time at which the first stop rule is met."""
    ends = [scene.run.until or math.inf]
    if scene.run.events is not None and collisions + hits > 0:
        ends.append(scene.run.events / (collisions + hits))
    if scene.run.collisions_per_disc is not None and collisions > 0:
        ends.append(scene.run.collisions_per_disc * number / (2 * collisions))
    return min(ends)
