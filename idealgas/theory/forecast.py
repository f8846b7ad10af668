"""Forecast of a run from kinetic theory: collision rates, number of events and size of the log."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.columns import IMAGES, SPINS, event_columns
from idealgas.physics.collision_rates import contact_value, mean_trial_time
from idealgas.physics.rotation import moment_of_inertia
from idealgas.scene import RestingDisc, Scene
from idealgas.scene.defaults import reference_speed
from idealgas.state import Gas
from idealgas.theory import conserved, hard_discs, time_steps
from idealgas.theory.barometric import DENSEST, column_rates
from idealgas.theory.ensemble import Composition, classes, column_temperature, equilibrium
from idealgas.theory.values import SOLID, box_theory, crystal

BYTES_A_ROW = {"gzip": 38, "none": 49}
"""Bytes per event row in the log, by type of compression."""

MORE_BYTES = {"angular_velocity": {"gzip": 7, "none": 8}, "image": {"gzip": 2, "none": 8}}
"""Bytes that each additional column adds to an event row, by type of compression."""

BYTES_A_SNAPSHOT, BYTES_A_DISC = 800, {"gzip": 31, "none": 36}
"""Bytes per snapshot in the log, and per disc in a snapshot, by type of compression."""


@dataclass(frozen=True)
class SpeciesForecast:
    """Initial discs of a species and its collision rate in equilibrium.

    name: name of the species. number: number of its discs. radius: mean radius, length. polydispersity: standard
    deviation of the radius over its mean. mass: mean mass. packing_fraction: area of its discs over the area of the
    box. temperature: initial mean kinetic energy of its discs relative to the motion of the gas as a whole, energy.
    collision_rate: collisions of one disc with other discs, 1/time; None if theory is not available.
    """

    name: str
    number: int
    radius: float
    polydispersity: float
    mass: float
    packing_fraction: float
    temperature: float
    collision_rate: float | None


@dataclass(frozen=True)
class Forecast:
    """Expected state of the gas in equilibrium, and expected length and size of the run.

    Theory describes a uniform gas of constant energy or in a heat bath, and a dilute column under gravity. Values for
    which theory is not available are None.

    number: number of discs. packing_fraction: area of the discs over the area of the box. beyond: effects in the scene
    that theory does not include. temperature: temperature in equilibrium, energy. collision_rate: collisions of one
    disc with other discs per time. pair_collision_rate, wall_hit_rate, thermostat_collision_rate: pair collisions, wall
    hits and thermostat collisions of the whole gas per time. duration: simulated time at the end of the run. events:
    number of events. rows: number of event rows in the log. bytes: size of the log. species: forecast of each species.
    rough: why the rates and the values that depend on them are approximate, or the temperature if no rates are known;
    empty if their error is below 2 %. caveats: caveats of time averages that follow from the initial state and the
    method. rest: behaviour of discs that have come to rest; None if this cannot happen.
    """

    number: int
    packing_fraction: float
    beyond: tuple[str, ...]
    temperature: float | None
    collision_rate: float | None
    pair_collision_rate: float | None
    wall_hit_rate: float | None
    thermostat_collision_rate: float
    duration: float | None
    events: float | None
    rows: float | None
    bytes: float | None
    species: tuple[SpeciesForecast, ...]
    rough: str = ""
    caveats: tuple[str, ...] = ()
    rest: RestingDisc | None = None


KNOWN = ("uniform", "conserves_energy")
"""Properties of a scene that theory requires, apart from heat sources of at most one temperature."""

PARTED = "walls inside the box may divide the gas, and each part then keeps its own temperature"

SLOW_BATH = 10.0
"""Number of thermostat collisions per disc in a run below which the heat bath is reported as slow."""

NEARLY = 0.05
"""Relative deviation of the initial temperature from that of a slow heat bath below which there is no caveat."""

ROUGH = 0.02
"""Relative error of the rates above which a forecast is marked as approximate."""


class _Rates(NamedTuple):
    """Rates of a gas in equilibrium, 1/time.

    per_disc: (S,), collisions of one disc of each species. pairs, hits, trials, thermostat: pair collisions, wall hits,
    Monte Carlo trials and thermostat collisions of the whole gas. rough: why the rates are approximate; empty if they
    are not.
    """

    per_disc: np.ndarray
    pairs: float
    hits: float
    trials: float = 0.0
    thermostat: float = 0.0
    rough: str = ""

    @property
    def events(self) -> float:
        """All events of the whole gas, without trials."""
        return self.pairs + self.hits + self.thermostat


def forecast(scene: Scene, gas: Gas) -> Forecast:
    """Forecast a run from the Enskog rates at the equilibrium temperature, up to the first stop rule that is met.

    For a gas under gravity, the rates are those of a dilute column.
    """
    heated = ("isolated",) if len(scene.properties.temperatures) > 1 else ()
    beyond, temperature = scene.lacking(*KNOWN, *heated), _temperature(scene, gas)
    rates = None
    if temperature is not None:
        rates = _column(scene, gas, temperature) if beyond else _rates(scene, gas, temperature)
    if rates is None and any(scene.properties.acceleration) and scene.properties.isolated:
        temperature = None  # the column is not dilute
    parted = "" if rates or temperature is None or scene.properties.empty else PARTED
    duration = _duration(scene, len(gas), rates)
    events = rows = None
    if rates and duration is not None:
        events = duration * rates.events
        rows = duration * (rates.pairs + rates.events)
    if not scene.log.events:
        rows = 0.0
    area = scene.free_area
    return Forecast(
        number=len(gas),
        packing_fraction=gas.packing_fraction * gas.area / area,
        beyond=() if rates else beyond,
        temperature=temperature,
        collision_rate=2 * rates.pairs / len(gas) if rates else None,
        pair_collision_rate=rates.pairs if rates else None,
        wall_hit_rate=rates.hits if rates else None,
        thermostat_collision_rate=len(gas) * scene.properties.thermostat_rate,
        duration=duration,
        events=events,
        rows=rows,
        bytes=_bytes(scene, len(gas), rows, duration),
        species=tuple(_species(scene, gas, k, area, rates) for k in range(len(gas.species_names))),
        rough=rates.rough if rates else parted,
        caveats=(
            *conserved.caveats(scene, gas),
            *conserved.lost_motion(scene, gas),
            *time_steps.caveats(scene, gas),
            *_slow_bath(scene, gas, duration),
        ),
        rest=scene.resting_disc,
    )


def _slow_bath(scene: Scene, gas: Gas, duration: float | None) -> tuple[str, ...]:
    """Return a caveat if the heat bath needs much of the run to bring the gas to its temperature."""
    rate, bath = scene.properties.thermostat_rate, scene.properties.bath
    if bath is None or duration is None or rate * duration > SLOW_BATH:
        return ()
    if abs(gas.temperature / bath - 1) < NEARLY:
        return ()
    return (
        f"The heat bath needs a time of about {1 / rate:.3g} to bring the gas to its temperature; until then the rates "
        f"are those at the initial temperature, {gas.temperature:.3g}.",
    )


def _has_room(gas: Gas, periodic: tuple[bool, bool]) -> bool:
    """Return whether every disc can move between the sides."""
    least = min((length for length, on in zip(gas.box, periodic, strict=True) if not on), default=math.inf)
    return 2 * float(gas.radius.max()) < least


def _bytes(scene: Scene, number: int, rows: float | None, duration: float | None) -> float | None:
    """Return the size of the log from the numbers of rows and snapshots; None if these are unknown."""
    every = scene.log.snapshot_every
    if rows is None or (every and duration is None):
        return None
    snapshots = duration / every if every and duration else 0.0
    a_snapshot = BYTES_A_SNAPSHOT + BYTES_A_DISC[scene.log.compression] * number
    return rows * _bytes_a_row(scene) + snapshots * a_snapshot


def _bytes_a_row(scene: Scene) -> int:
    compression, has = scene.log.compression, scene.properties
    columns = event_columns(*[SPINS] * has.spins, *[IMAGES] * any(has.periodic))
    return BYTES_A_ROW[compression] + sum(MORE_BYTES[c.name][compression] for c in columns if c.name in MORE_BYTES)


def _spin_energy(scene: Scene) -> float:
    """Return the initial total energy of the spins of all discs, energy."""
    if (factor := scene.properties.inertia) is None:
        return 0.0
    energy = 0.0
    for s in scene.species if scene.draws_velocities else [s for _, s in scene.placed]:
        for size in s.sizes:
            inertia = moment_of_inertia(factor, size.mass, size.radius)
            energy += size.number * (s.spin_temperature or inertia * (s.angular_velocity or 0.0) ** 2) / 2
    given = scene.explicit_discs
    if len(given) and not scene.draws_velocities:
        inertia = moment_of_inertia(factor, given.mass, given.radius)
        energy += float((inertia * given.angular_velocity**2).sum()) / 2
    return energy


def _temperature(scene: Scene, gas: Gas) -> float | None:
    """Return the temperature in equilibrium; None if it is unknown."""
    properties, spin_energy = scene.properties, _spin_energy(scene)
    if not any(properties.acceleration):
        ensemble = equilibrium(scene, gas, spin_energy)
        return ensemble.temperature if ensemble else None
    axis = int(properties.acceleration[1] != 0)
    if properties.acceleration[1 - axis] or properties.periodic[axis] or not properties.empty:
        return None
    return column_temperature(scene, gas, spin_energy, axis)


def _rates(scene: Scene, gas: Gas, temperature: float) -> _Rates | None:
    """Return the rates of a uniform gas; None if a disc has no room to move."""
    discs, periodic = classes(gas), scene.properties.periodic
    if scene.run.method == "monte_carlo":
        return _rates_without_positions(scene, gas, temperature, discs)
    if not _has_room(gas, periodic):
        return None
    number = discs.number
    per_disc = hard_discs.mixture_collision_rate(discs.radius, discs.mass, number, gas.area, temperature)
    per_disc = (per_disc - np.diag(np.diag(per_disc) / number)).sum(axis=1)  # a disc does not collide with itself
    if len(number) == 1 and SOLID <= (phi := gas.packing_fraction) < hard_discs.CLOSE_PACKING:
        per_disc *= (crystal(phi).value - 1) / (2 * phi * contact_value(phi))  # for equal discs Z = 1 + 2φχ exactly
    crowding = 1.0
    if scene.properties.interacting:
        crowding = hard_discs.mixture_compressibility_factor(discs.radius, discs.number, gas.area)
        rough = _why_rough(gas, discs, temperature, periodic, per_disc)
    else:
        per_disc *= 0
        rough = "" if scene.properties.shares_energy else conserved.KEPT
    hits = crowding * _wall_hit_rate(gas, discs, temperature, periodic)
    thermostat = len(gas) * scene.properties.thermostat_rate
    pairs = float(number @ per_disc) / 2
    return _Rates(discs.shares @ per_disc, pairs, hits, thermostat=thermostat, rough=rough)


def _column(scene: Scene, gas: Gas, temperature: float) -> _Rates | None:
    """Return the rates of a dilute gas in a closed box under gravity along one axis; None for other gases."""
    properties, pull = scene.properties, np.abs(scene.properties.acceleration)
    if any(properties.periodic) or not pull.any() or not temperature > 0 or not _has_room(gas, properties.periodic):
        return None
    axis = int(pull[1] > 0)
    _, radius, mass, number, _ = discs = classes(gas)
    column = column_rates(temperature, mass, radius, number, float(pull[axis]), gas.box[axis], gas.box[1 - axis])
    if column.densest > DENSEST:
        return None
    rough = f"the law of a dilute column, whose lowest layer has a packing fraction of {column.densest:.2g}"
    thermostat = len(gas) * properties.thermostat_rate
    per_disc, pairs = discs.shares @ column.per_disc * properties.interacting, column.pairs * properties.interacting
    return _Rates(per_disc, pairs, column.hits, thermostat=thermostat, rough=rough)


def _why_rough(
    gas: Gas, discs: Composition, temperature: float, periodic: tuple[bool, bool], per_disc: np.ndarray
) -> str:
    """Return why Enskog rates are approximate, as part of a sentence; empty if their error is below ROUGH."""
    theory = box_theory(discs.radius, discs.number, gas.box, periodic)
    if theory.reason:
        return theory.reason
    expected = theory.contacts * hard_discs.mean_relative_speeds(temperature, discs.mass)
    known = expected.sum(axis=1)
    # the last term allows for corrections of order 1/N
    off = np.abs(per_disc - known) + (theory.rate_error * expected).sum(axis=1) + known / len(gas)
    relative = float((off[known > 0] / known[known > 0]).max(initial=0.0))
    return f"Enskog's theory is off by up to {relative:.0%} for this gas and box" if relative > ROUGH else ""


def _rates_without_positions(scene: Scene, gas: Gas, temperature: float, discs: Composition) -> _Rates:
    """Return the rates of a gas without positions; its trials occur at the rate of the fastest possible pair."""
    contacts = hard_discs.contacts_without_positions(discs.radius, discs.number, gas.box)
    per_disc = (contacts * hard_discs.mean_relative_speeds(temperature, discs.mass)).sum(axis=1)
    v_ref = reference_speed(scene.run, float(np.hypot(*gas.velocity.T).max()))
    reach = float(np.sort(gas.radius)[-2:].sum())
    trials = 1 / mean_trial_time(len(gas), gas.area, gas.packing_fraction, reach, v_ref)
    speeds = len(gas) + (scene.run.trials or 0)  # number of speeds drawn in a run, each of which may be the largest
    fastest = math.sqrt(2 * temperature * math.log(speeds) / discs.mass.min())
    rises = scene.run.v_ref is None and scene.run.trials is not None and fastest > v_ref / 2
    rough = "v_ref rises when discs become faster than at the start, which makes trials more frequent" if rises else ""
    return _Rates(discs.shares @ per_disc, float(discs.number @ per_disc) / 2, 0.0, trials, rough=rough)


def _species(scene: Scene, gas: Gas, k: int, area: float, rates: _Rates | None) -> SpeciesForecast:
    members = gas.species == k
    velocity = gas.velocity[members] - conserved.motion_at_start(scene, gas)
    mass, radius, number = gas.mass[members], gas.radius[members], int(members.sum())
    return SpeciesForecast(
        name=gas.species_names[k],
        number=number,
        radius=float(radius[0] if (radius == radius[0]).all() else radius.mean()),
        polydispersity=float(radius.std() / radius.mean()) if np.ptp(radius) > 0 else 0.0,
        mass=float(mass[0] if (mass == mass[0]).all() else mass.mean()),
        packing_fraction=float(np.pi * (radius**2).sum() / area),
        temperature=float((mass * (velocity**2).sum(axis=1)).sum() / (2 * number)),
        collision_rate=float(rates.per_disc[k]) if rates else None,
    )


def _wall_hit_rate(gas: Gas, discs: Composition, temperature: float, periodic: tuple[bool, bool]) -> float:
    """Return the wall hits of an ideal gas per time: the flux of disc centres onto the lines that they can reach.

    The density of hard discs at a wall is Z times the mean density.
    """
    rate = 0.0
    for r, m, n in zip(discs.radius, discs.mass, discs.number, strict=True):
        width, height = (
            length if is_periodic else length - 2 * r for length, is_periodic in zip(gas.box, periodic, strict=True)
        )
        if width > 0 and height > 0:
            flux = hard_discs.effusion_flux(n / (width * height), temperature, m)
            rate += 2 * (height * (not periodic[0]) + width * (not periodic[1])) * flux
    return float(rate)


def _duration(scene: Scene, number: int, rates: _Rates | None) -> float | None:
    """Return the simulated time at which the first stop rule is met; None if this is unknown or never happens."""
    run = scene.run
    if rates is None:
        return run.until if {run.events, run.collisions_per_disc, run.trials} == {None} else None
    ends = [run.until or math.inf]
    if run.events is not None and rates.events > 0:
        ends.append(run.events / rates.events)
    if run.collisions_per_disc is not None and rates.pairs > 0:
        ends.append(run.collisions_per_disc * number / (2 * rates.pairs))
    if run.trials is not None and rates.trials > 0:
        ends.append(run.trials / rates.trials)
    return end if math.isfinite(end := min(ends)) else None
