"""A scene's effects as arrays for the engines: the one place for their dtypes and shapes."""

import math

import numpy as np

from idealgas._jit import aligned
from idealgas.gas.build import stream
from idealgas.gas.state import Gas
from idealgas.physics.effects import Effects
from idealgas.physics.motion import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.piston import PISTON
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal
from idealgas.physics.wall import SEGMENT
from idealgas.scene import Scene, ThermalSide
from idealgas.scene.defaults import contact_duration
from idealgas.scene.tables.box import SIDES


def make_effects(scene: Scene, gas: Gas) -> Effects:
    """The effects of a scene at time 0; None for those that it does not call for."""
    temperature = wall_temperatures(scene)
    thermal = bool((temperature >= 0).any())
    rotation, restitution = _rotation(scene, gas), _restitution(scene, len(gas))
    lossy = (restitution is not None and restitution.wall < 1) or (
        rotation is not None and abs(rotation.wall_roughness) < 1
    )
    wall_energy = thermal or lossy or scene.piston is not None
    return Effects(
        gravity=Gravity(*scene.gravity.acceleration) if scene.gravity else None,
        periodic=_periodic(scene, len(gas)),
        segments=_segments(scene),
        rotation=rotation,
        restitution=restitution,
        thermal=Thermal(temperature, np.uint64(scene.scene.seed), np.zeros(len(gas), np.uint64)) if thermal else None,
        piston=_piston(scene),
        wall_energy=np.zeros(4 + len(scene.wall)) if wall_energy else None,
    )


def wall_temperatures(scene: Scene) -> np.ndarray:
    """(4 + S,) f8, of the sides and then the segments; -1 for those that reflect."""
    sides = [side.thermal if isinstance(side, ThermalSide) else -1.0 for side in scene.box.sides]
    return np.array([*sides, *(wall.temperature or -1.0 for wall in scene.wall)])


def make_segments(
    start: np.ndarray, end: np.ndarray, opens: np.ndarray | float = math.inf, closes: np.ndarray | float = math.inf
) -> np.recarray:
    """(S,) SEGMENT at time 0. start, end: (S, 2). opens, closes: from when to when each is not there."""
    segments = aligned(len(start), SEGMENT)
    segments.x, segments.y = start.T
    segments.length = np.hypot(*(end - start).T)
    segments.tx, segments.ty = ((end - start) / segments.length[:, None]).T
    segments.opens, segments.closes = opens, closes
    segments.active = segments.opens > 0
    return segments


def _periodic(scene: Scene, n: int) -> Periodic | None:
    if not any(scene.box.periodic):
        return None
    return Periodic(*scene.box.periodic, *scene.box.size, np.zeros((n, 2), np.int32), np.zeros((n, 2), np.int32))


def _segments(scene: Scene) -> np.recarray | None:
    if not scene.wall:
        return None
    start, end, absence = (
        np.array([getattr(wall, name) for wall in scene.wall]) for name in ("start", "end", "absence")
    )
    return make_segments(start, end, *absence.T)


def _rotation(scene: Scene, gas: Gas) -> Rotation | None:
    if scene.rotation is None:
        return None
    table = scene.rotation
    inertia = table.inertia * gas.mass * gas.radius**2
    omega = [disc.angular_velocity or 0.0 for disc in scene.disc]
    for s in scene.species:
        spin = np.full(s.count, s.angular_velocity or 0.0)
        if s.spin_temperature:
            spin = stream(scene.scene.seed, f"spins {s.name}").standard_normal(s.count)
            spin *= math.sqrt(s.spin_temperature / (table.inertia * s.mass * s.radius**2 * (spin**2).mean()))
        omega.extend(spin)
    return Rotation(np.array(omega), inertia, table.roughness, table.wall_roughness)


def _restitution(scene: Scene, n: int) -> Restitution | None:
    table = scene.restitution
    if table is None or table.elastic:
        return None
    duration = contact_duration(table, scene.species, scene.disc)
    return Restitution(table.normal, table.wall, duration, np.full(n, -math.inf))


def _piston(scene: Scene) -> np.ndarray | None:
    if scene.piston is None:
        return None
    table, size = scene.piston, scene.box.size
    piston = aligned(1, PISTON)
    record = piston[0]
    record.x, record.v, record.a = table.start(size), table.velocity or 0.0, table.acceleration(size, scene.gravity)
    record.m, record.stop, record.side = table.mass or 0.0, table.stop(size), SIDES.index(table.side)
    return piston
