"""Effects in a run: their states at time 0, and their sums, which are exact in checkpoints and rounded in samples."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from idealgas.columns import FIRST_SEGMENT, Column, Values
from idealgas.effects import EFFECTS
from idealgas.effects.bundle import Effects, inner_energy, present
from idealgas.effects.effect import GasAtStart
from idealgas.engine.epoch import driving_speed, encounters_of_effects
from idealgas.physics.exact_sum import make_sums, restore, stored, values
from idealgas.physics.stress import COLLISIONAL, KINETIC, StressAccumulator, empty_buffer
from idealgas.scene import Scene
from idealgas.scene.walls import number_walls
from idealgas.state import MOST_PAIRED, Gas

ENERGY, ACTION, MOMENTUM, HEAT = "energy", "energy time", "mass length/time", "energy length"
TENSOR = ("xx", "xy", "yy", "yx")
LEAST_SHARE = 2.0**-40
"""Smallest ratio of the typical energy to the largest energy that effects may add.

The typical energy is raised to this share so that sums remain far below 2^100 units.
"""


def make_effects(scene: Scene, gas: Gas) -> Effects:
    """Make the effects of a scene at time 0, with all sums; gas: discs at time 0."""
    scene = scene.resolved()
    start = _start(scene, gas)
    tables = ((effect, scene.tables_of(effect)) for effect in EFFECTS)
    states = {effect.field: effect.state_at_start(table, start) for effect, table in tables}
    effects = Effects(**states, schedule=_schedule(scene, start))
    gives = any(effect.gives_energy(state) for effect, state in present(effects))
    loses, inner = not scene.properties.collisions_conserve_energy, inner_energy(effects, gas)
    return with_sums(effects, scene, gas, gives_energy=gives, loses_energy=loses, inner_energy=inner)


Schedule = tuple[tuple[float, int, int, float], ...]


def make_schedule(scene: Scene, gas: Gas) -> Schedule | None:
    """Return the scheduled changes of all effects, in order of time; None if there are none.

    Each change is a tuple of its time, the index of the effect, the item of its state, and the new value.
    """
    return _schedule(scene, _start(scene, gas))


def _start(scene: Scene, gas: Gas) -> GasAtStart:
    first, later = scene.properties.acceleration, scene.properties.later_accelerations
    return GasAtStart(gas, scene.scene.seed, first, *_spins(scene, gas), later)


def _schedule(scene: Scene, start: GasAtStart) -> Schedule | None:
    tables = ((k, effect, scene.tables_of(effect)) for k, effect in enumerate(EFFECTS))
    schedules = ((k, effect.schedule(table, start)) for k, effect, table in tables if effect.find(table) is not None)
    entries = ((change.time, k, change.item, change.value) for k, changes in schedules for change in changes)
    return tuple(sorted(entries)) or None


def _spins(scene: Scene, gas: Gas) -> tuple[np.ndarray, np.ndarray]:
    """Return the angular velocity (N,), 1/time, and the spin temperature (N,), energy, of each disc; 0 if not given."""
    given = 0 if scene.draws_velocities else len(scene.explicit_discs)
    velocity, temperature = np.zeros(len(gas)), np.zeros(len(gas))
    velocity[:given] = scene.explicit_discs.angular_velocity[:given]
    for s in scene.species:
        members = given + np.flatnonzero(gas.species[given:] == gas.species_names.index(s.name))
        velocity[members], temperature[members] = s.angular_velocity or 0.0, s.spin_temperature or 0.0
    return velocity, temperature


def with_sums(
    effects: Effects, scene: Scene, gas: Gas, *, gives_energy: bool, loses_energy: bool, inner_energy: float
) -> Effects:
    """Return the effects at time 0 with all sums of a run.

    gives_energy: whether walls give energy to discs or take energy from them. loses_energy: whether energy is lost in
    collisions. inner_energy: energy of the discs that collisions may convert to kinetic energy, mass length²/time².
    """
    potentials_change = any(EFFECTS[k].energy_part for _, k, *_ in effects.schedule or ())
    speed, walls = _speed(scene, gas, effects, inner_energy), len(number_walls(scene))
    driven = (effect.driving_energy(state, gas) for effect, state in present(effects))
    largest = max(0.5 * float(gas.mass.mean()) * speed**2, inner_energy, *driven)
    energy = max(gas.kinetic_energy / len(gas), LEAST_SHARE * largest)
    return effects._replace(
        wall_energy=make_sums([energy] * walls) if gives_energy else None,
        dissipated=make_sums([energy] * (1 + walls)) if loses_energy else None,
        bath_energy=None if scene.properties.bath is None else make_sums([energy]),
        step_energy=make_sums([energy]) if potentials_change or effects.steering is not None else None,
        flow=_make_flow(scene, gas, effects, speed) if scene.log.pressure else None,
    )


def _make_flow(scene: Scene, gas: Gas, effects: Effects, speed: float) -> StressAccumulator:
    """Make the sums of the momentum flow; speed: typical speed of the discs, length/time."""
    momentum = float(gas.mass.mean()) * speed
    encounters = encounters_of_effects(gas, effects)
    flight = len(gas) / encounters if encounters > 0 else max(gas.box)
    apart = 2.0 * float(gas.radius.mean())
    tensor = [momentum * flight] * 3 + [momentum * apart] * (4 if scene.properties.spins else 3)
    heat = [momentum * speed * flight] * 2 + [momentum * speed * apart] * 2 if scene.log.heat_flow else []
    frame = gas.mass @ gas.velocity / gas.mass.sum() if heat else np.zeros(2)
    faces, species = 2 * len(number_walls(scene)) - FIRST_SEGMENT, len(gas.species_names)
    paired = 1 < species <= MOST_PAIRED
    normal_impulse, tangential_impulse = (make_sums([momentum] * faces) for _ in range(2))
    return StressAccumulator(
        tensor=make_sums(tensor),
        buffer=empty_buffer(),
        walls=make_sums([momentum * max(gas.box)]),
        normal_impulse=normal_impulse,
        tangential_impulse=tangential_impulse,
        hits=np.zeros(faces, np.int64),
        pairs=np.zeros((species, species), np.int64) if paired else None,
        species=gas.species.copy() if paired else None,
        x=gas.box[0] / 2,
        y=gas.box[1] / 2,
        heat=make_sums(heat) if heat else None,
        vx=float(frame[0]),
        vy=float(frame[1]),
    )


def _speed(scene: Scene, gas: Gas, effects: Effects, inner_energy: float) -> float:
    """Typical speed of the discs, length/time: the larger of the initial speed and the speed that effects may cause."""
    mass = float(gas.mass.mean())
    hottest = max(scene.properties.temperatures, default=0.0)
    start = math.sqrt(2 * gas.kinetic_energy / (len(gas) * mass))
    within = math.sqrt(LEAST_SHARE * 2 * inner_energy / mass)
    return max(start, driving_speed(gas, effects), math.sqrt(hottest / mass), within) or 1.0


def _sums(effects: Effects) -> Iterator[tuple[Column, np.ndarray]]:
    """Yield the columns of samples and the arrays of all sums of these effects."""
    if (given := effects.wall_energy) is not None:
        yield Column("wall_energy", "f8", given.shape, ENERGY), given
    if (lost := effects.dissipated) is not None:
        yield Column("dissipated_energy", "f8", lost.shape, ENERGY), lost
    if (heat := effects.bath_energy) is not None:
        yield Column("bath_energy", "f8", (), ENERGY), heat
    if (steps := effects.step_energy) is not None:
        yield Column("step_energy", "f8", (), ENERGY), steps
    if (flow := effects.flow) is not None:
        tensor = np.asarray(flow.tensor)  # slicing a recarray takes ten times as long
        yield Column("kinetic_flow", "f8", (3,), ACTION), tensor[KINETIC]
        yield Column("collision_flow", "f8", (4,), ACTION), tensor[COLLISIONAL]
        yield Column("wall_virial", "f8", (), ACTION), flow.walls
        yield Column("face_normal_impulse", "f8", (len(flow.normal_impulse),), MOMENTUM), flow.normal_impulse
        yield (
            Column("face_tangential_impulse", "f8", (len(flow.tangential_impulse),), MOMENTUM),
            flow.tangential_impulse,
        )
        if flow.heat is not None:
            flowing = np.asarray(flow.heat)
            yield Column("kinetic_heat_flow", "f8", (2,), HEAT), flowing[:2]
            yield Column("collision_heat_flow", "f8", (2,), HEAT), flowing[2:]


def _counts(effects: Effects) -> Iterator[tuple[Column, np.ndarray]]:
    """Yield the columns and arrays of all numbers of collisions."""
    if (flow := effects.flow) is not None:
        yield Column("face_hits", "i8", flow.hits.shape), flow.hits
        if flow.pairs is not None:
            yield Column("pair_collisions", "i8", flow.pairs.shape), flow.pairs


def _exact(column: Column, sums: np.ndarray) -> Column:
    """Return the column of checkpoints, with three integers per sum; see `stored`."""
    return Column(f"{column.name}_sum", "i8", (len(sums), 3), column.unit)


def exact_sums(effects: Effects) -> Values:
    """Return the exact sums and the numbers of collisions, for checkpoints."""
    entries = {_exact(column, sums): stored(sums) for column, sums in _sums(effects)}
    return entries | {column: counts.copy() for column, counts in _counts(effects)}


def observed_sums(effects: Effects) -> Values:
    """Return the sums rounded to floats and the numbers of collisions, for samples."""
    rounded = {column: _shaped(values(sums), column) for column, sums in _sums(effects)}
    return rounded | {column: counts.copy() for column, counts in _counts(effects)}


def _shaped(array: np.ndarray, column: Column) -> np.ndarray:
    """Return values in the shape of a column; if a collision flow has no separate yx component, yx equals xy."""
    if column.shape and len(array) < column.shape[0]:
        array = np.append(array, array[TENSOR.index("xy")])
    return array.reshape(column.shape)


def restore_sums(effects: Effects, entries: Mapping[str, np.ndarray]) -> None:
    """Set the sums to the values of a checkpoint, by name."""
    for column, sums in _sums(effects):
        restore(sums, entries[_exact(column, sums).name])
    for column, counts in _counts(effects):
        counts[:] = entries[column.name]
