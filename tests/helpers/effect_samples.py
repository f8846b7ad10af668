"""Small gases with any set of effects, for tests of the engine."""

from typing import Any

import numpy as np

from helpers.support import record
from idealgas.bench.effects import effect_scene
from idealgas.columns import FIRST_SEGMENT
from idealgas.effects import EFFECTS
from idealgas.effects.arc import make_arcs
from idealgas.effects.bundle import Effects
from idealgas.effects.effect import Effect, GasAtStart
from idealgas.effects.wall import make_segments
from idealgas.engine.simulation import Simulation, Stop
from idealgas.jit import aligned
from idealgas.physics.arc_geometry import arc_through
from idealgas.physics.exact_sum import make_sums
from idealgas.physics.gravity import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.permeable import FROM_LEFT, FROM_RIGHT, OPEN, SOLID, Permeable
from idealgas.physics.piston import PISTON
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.stress import StressAccumulator, empty_buffer
from idealgas.physics.thermal import Thermal
from idealgas.physics.thermostat import Thermostat, draw_first_collisions
from idealgas.run.effects import exact_sums
from idealgas.run.layout import by_name
from idealgas.state import Gas

BOX = (12.0, 9.0)
ARC = (4.2, 8.2), (5.7, 7.3), (7.2, 8.2)

NAMES = (*(effect.field for effect in EFFECTS), "gates", "inner")
"""Effects by their fields of the bundle; gates are segments too, and inner is an inner piston, before one at a side."""


def make_gas(seed: int, columns: int = 4, rows: int = 3) -> Gas:
    """Discs of two kinds on a loose lattice that keeps clear of the walls and the piston below."""
    draw = np.random.default_rng(seed)
    n = columns * rows
    site = np.arange(n)
    position = np.column_stack((site % columns, site // columns)) * [2.0, 2.4] + [1.2, 1.4]
    kind = draw.integers(2, size=n)
    return Gas(
        box=BOX,
        position=position + draw.uniform(-0.2, 0.2, position.shape),
        velocity=draw.normal(size=(n, 2)),
        radius=np.where(kind == 0, 0.5, 0.3),
        mass=np.where(kind == 0, 1.0, 2.5),
        species=kind.astype(np.uint16),
        species_names=("a", "b"),
    )


def make_effects(names: set[str], gas: Gas, seed: int = 1) -> Effects:
    """Fresh effects. Periodic sides join left and right (top and bottom where a piston leaves no other)."""
    n = len(gas)
    draw = np.random.default_rng(seed)
    walls: list[tuple[float, float, float, float, bool]] = []
    arcs = []
    schedule: list[tuple[float, int, int, float]] = []
    if names & {"segments", "permeable", "absorbing"}:
        walls += [(9.0, 1.0, 10.0, 4.0, True), (9.5, 7.0, 10.5, 7.0, True)]
    if "arcs" in names:
        arcs = [None] * len(walls) + [arc_through(*ARC)]
        walls += [(*ARC[0], *ARC[2], True)]
    if "gates" in names:
        gate, field = len(walls), [effect.field for effect in EFFECTS].index("segments")
        walls += [(8.6, 4.5, 8.6, 8.8, True), (0.5, 8.6, 3.5, 8.6, False)]
        schedule = [(3.0, field, gate, 0.0), (4.0, field, gate + 1, 1.0), (7.0, field, gate, 1.0)]
    table = np.array(walls).reshape(-1, 5)
    inertia = 0.5 * gas.mass * gas.radius**2
    moves, inner, inside = not names.isdisjoint({"piston", "inner"}), "inner" in names, len(walls) + ("inner" in names)
    temperature = np.full(FIRST_SEGMENT + inside, -1.0)
    temperature[2] = 1.5
    passage = np.resize(np.array([[FROM_LEFT, FROM_RIGHT], [OPEN, SOLID]], np.uint8), (len(walls), 2))
    passage[2:] = SOLID
    pistons = aligned(max(inner + ("piston" in names), 1), PISTON)
    pistons.length = BOX[0]
    last = pistons[-1]
    last.x, last.a, last.m, last.wall, last.outward = 11.5, -0.8, 20.0, 1, 1.0
    if inner:
        first = pistons[0]
        first.x, first.a, first.m, first.outward, first.wall = 4.2, 0.0, 3.0, 0.0, FIRST_SEGMENT + len(walls)
    own: dict[str, Any] = {
        "gravity": lambda: Gravity(0.1, -0.4),
        "periodic": lambda: Periodic(not moves, moves, *BOX, np.zeros((n, 2), np.int32)),
        "segments": lambda: make_segments(table[:, :2], table[:, 2:4], table[:, 4] > 0),
        "permeable": lambda: Permeable(gas.species.copy(), passage),
        "absorbing": lambda: np.arange(len(walls)) == 1,
        "arcs": lambda: make_arcs([*arcs, *[None] * (len(walls) - len(arcs))]),
        "rotation": lambda: Rotation(draw.normal(size=n), inertia, 0.6, 0.3),
        "restitution": lambda: Restitution(0.9, 0.95, 1e-6, np.full(n, -np.inf)),
        "thermal": lambda: Thermal(temperature, np.uint64(seed), np.zeros(n, np.uint64)),
        "piston": lambda: pistons,
        "thermostat": lambda: make_thermostat(n, seed),
    }
    there = {*names, *(["segments"] if walls else []), *(["piston"] if inner else [])}
    there |= {"periodic"} if "shear" in names else set()
    wanted = [effect for effect in EFFECTS if effect.field in there]
    return Effects(
        **{e.field: own[e.field]() if e.field in own else from_benchmark(e, gas, seed) for e in wanted},
        wall_energy=make_sums([1.0] * (FIRST_SEGMENT + inside)),
        dissipated=make_sums([1.0] * (1 + FIRST_SEGMENT + inside)),
        bath_energy=make_sums([1.0]) if "thermostat" in names else None,
        flow=make_flow(gas, FIRST_SEGMENT + 2 * inside, 7 if "rotation" in names else 6),
        schedule=tuple(schedule) or None,
    )


def from_benchmark(effect: Effect[Any], gas: Gas, seed: int) -> Any:
    """State of an effect with no sample here: that of its scene of the benchmark, in this box."""
    scene = effect_scene(effect.name, 1)
    rest = np.zeros(len(gas))
    tables = scene.tables_of(effect)._replace(size=BOX)
    return effect.state_at_start(tables, GasAtStart(gas, seed, scene.properties.acceleration, rest, rest))


def make_thermostat(n: int, seed: int) -> Thermostat:
    """A heat bath that n discs meet about as often as they collide."""
    thermostat = Thermostat(2.0, 0.5, np.uint64(seed), np.empty(n), np.zeros(n, np.uint64))
    draw_first_collisions(thermostat)
    return thermostat


def make_flow(gas: Gas, faces: int, tensor: int = 6) -> StressAccumulator:
    """Sums of the momentum flow for a number of faces and of parts of the tensor."""
    kinds = len(gas.species_names)
    return StressAccumulator(
        tensor=make_sums([1.0] * tensor),
        buffer=empty_buffer(),
        walls=make_sums([1.0]),
        normal_impulse=make_sums([1.0] * faces),
        tangential_impulse=make_sums([1.0] * faces),
        hits=np.zeros(faces, np.int64),
        pairs=np.zeros((kinds, kinds), np.int64) if kinds > 1 else None,
        species=gas.species.copy() if kinds > 1 else None,
        x=gas.box[0] / 2,
        y=gas.box[1] / 2,
    )


def sums_of(effects: Effects) -> list[np.ndarray]:
    """The sums of a run: those that do not depend on order as whole numbers, and counts."""
    return list(by_name(exact_sums(effects)).values())


def allowed(names: set[str]) -> bool:
    """Whether the effects go together here: hot and vibrating sides leave only the left and right ones to join.

    Sheared sides go with few others.
    """
    moving = names & {"piston", "inner"}
    crossed = "periodic" in names and moving and names & {"thermal", "vibration"}
    sheared = "shear" in names and not names <= {"shear", "periodic", "rotation", "restitution", "thermostat"}
    return not crossed and not sheared


def log_of(gas: Gas, effects: Effects, method, stop: Stop, rows: int) -> list[np.ndarray]:
    """All columns of the event log, and the state of the effects at the end."""
    columns = record(Simulation(gas, method, effects), stop, rows)
    return [*(column for column in columns if column is not None), *sums_of(effects)]
