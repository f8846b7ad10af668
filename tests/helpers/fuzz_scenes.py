"""Scenes drawn at random: any effects that go together, at nasty scales, dense and thin, with ties and without.

What a scene is made of is drawn by hypothesis, places and velocities by a seed that it draws. Units come last: at first
a box is about 6 wide.
"""

import math
from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
from hypothesis import reject
from hypothesis import strategies as st

from helpers.random_walls import HEIGHT, WIDTH, distances, some_walls
from idealgas.columns import SIDES
from idealgas.initial.build import make_gas
from idealgas.physics.arc_geometry import arc_through, bounds, nearest_points
from idealgas.scene import Scene, SceneError, parse_scene
from idealgas.state import Gas
from idealgas.toml.dump import toml_value

EFFECTS = (
    "periodic x",
    "periodic y",
    "walls",
    "gravity",
    "rotation",
    "restitution",
    "thermal",
    "piston",
    "thermostat",
    "vibration",
    "fixed",
    "permeable",
    "absorbing",
    "arcs",
    "steering",
)
LENGTHS = (1.0, 1e-9, 1e9, 2.0**-10, 1e-3, 1e4)
SPEEDS = (1.0, 1e-8, 1e8, 2.0**10, 1e-3, 1e3)
MASSES = (1.0, 1e-8, 1e8)


def room_of(size, pistons) -> tuple[float, float, float, float]:
    """Where discs may be: up to pistons at sides."""
    low, high = [0.0, 0.0], list(size)
    for piston in pistons:
        if "side" in piston:
            axis, upper = divmod(SIDES.index(piston["side"]), 2)
            (high if upper else low)[axis] = piston["position"]
    return (*low, *high)


def place(random, size, periodic, room, walls, bent, number, share, gridded, factors):
    """Positions (M, 2) and radii (M,) of discs on a lattice, moved a little unless gridded.

    Those in walls are left out. bent: tables of the walls. share: of the pitch that the largest discs take up.
    """
    low, span = np.array(room[:2]), np.array(room[2:]) - room[:2]
    columns = max(round(math.sqrt(number * span[0] / span[1])), 1)
    shape = np.array([columns, -(-number // columns)])
    pitch = span / shape
    site = np.column_stack(np.divmod(np.arange(number), columns)[::-1])
    radius = 0.5 * share * pitch.min() * random.choice(factors, number)
    position = low + (site + 0.5) * pitch
    if not gridded:
        position += 0.99 * random.uniform(-1, 1, (number, 2)) * (pitch / 2 - radius[:, None])
        shift = random.uniform(0, 1, 2) * periodic * size
        position = np.where(periodic, (position + shift) % size, position)
    if len(walls):
        shifts = [(x, y) for x in ((-1, 0, 1) if periodic[0] else (0,)) for y in ((-1, 0, 1) if periodic[1] else (0,))]
        images = np.concatenate([walls + np.array(s) * size for s in shifts])
        clear = distances(position, images).min(axis=1) >= radius
        for wall in (wall for wall in bent if "via" in wall):
            ends = tuple(wall["from"]), tuple(wall["to"])
            nearest = nearest_points(position, *ends, arc_through(ends[0], tuple(wall["via"]), ends[1]))
            clear &= np.hypot(*(position - nearest).T) >= radius
        position, radius = position[clear], radius[clear]
    return position, radius


def move(random, how: str, number: int) -> np.ndarray:
    """Velocities (N, 2) in units of the scene's speed."""
    if how == "few directions":
        return random.choice([-1.0, 0.0, 1.0], (number, 2))
    velocity = random.normal(size=(number, 2))
    if how == "one hot":
        velocity[1:] *= 1e-6
    if how == "one moves":
        velocity[1:] = 0.0
    if how == "all speeds":
        velocity *= 10.0 ** random.uniform(-8, 0, (number, 1))
    return velocity


@st.composite
def walls_in(draw, size) -> np.ndarray:
    """(W, 2, 2), both ends inside the box."""
    walls = np.array(draw(some_walls)).reshape(-1, 2, 2)
    walls = np.clip(walls * np.array(size) / (WIDTH, HEIGHT), 0, size)
    along_side = ((walls[:, 0] == walls[:, 1]) & ((walls[:, 0] == 0) | (walls[:, 0] == size))).any(axis=1)
    return walls[(np.hypot(*(walls[:, 1] - walls[:, 0]).T) > 1.1e-9 * max(size)) & ~along_side]


def pick(draw, *values):
    return draw(st.sampled_from(values))


def in_steps(draw, *values: float):
    """One of some values, or several in steps in time."""
    times = pick(draw, (), (), (0.3,), (0.01, 0.02), (0.1, 1.0))
    steps = [[time, pick(draw, *values)] for time in (0.0, *times)]
    return steps if times else steps[0][1]


def draw_gate(draw) -> dict[str, Any]:
    """When a wall opens and closes, if it does."""
    if pick(draw, False, False, True):
        return {"opens_at": [pick(draw, 0.0, 0.1), 0.5], "closes_at": [0.2, 0.6]}
    opens, lasts = pick(draw, None, None, 0.1, 1.0), pick(draw, None, 0.01, 0.5)
    gate = {} if opens is None else {"opens_at": opens}
    return gate if lasts is None else gate | {"closes_at": (opens or 0.0) + lasts}


def draw_passage(draw, start, end) -> dict[str, Any]:
    """Which discs a wall lets pass, if any: those of the tables [[disc]], or all, from both sides or from one."""
    sides = [s for axis in range(2) if start[1 - axis] != end[1 - axis] for s in SIDES[2 * axis : 2 * axis + 2]]
    one_way, some = {"permeable_from": pick(draw, *sides)}, {"permeable_to": ["disc"]}
    return pick(draw, {}, some, one_way, some | one_way)


def bend(draw, size, wall: dict[str, Any]) -> dict[str, Any]:
    """A wall bent to either side, to a shallow arc, a half circle or more, or a circle, if the box has room for it."""
    (x, y), end = wall["from"], wall["to"]
    along, height = np.subtract(end, (x, y)), pick(draw, 0.1, -0.1, 0.5, -0.5, 2.0)
    via = (np.add((x, y), end) / 2 + height * np.array([-along[1], along[0]])).tolist()
    bent = wall | {"via": via} | ({"to": [x, y]} if pick(draw, False, False, True) else {})
    arc = arc_through((x, y), tuple(via), tuple(bent["to"]))
    if arc is None or arc.radius > 50 * max(size):
        return wall
    low, high = bounds((x, y), bent["to"], arc)
    return bent if min(low) >= 0 and high[0] <= size[0] and high[1] <= size[1] else wall


def draw_pistons(draw, size, mass: float) -> list[dict[str, Any]]:
    """One piston, or two in order."""
    axis = pick(draw, 0, 1)
    low, high = SIDES[2 * axis : 2 * axis + 2]
    inner = {"inner": "xy"[axis]}
    if pick(draw, True, False):
        kind = pick(draw, inner, {"side": low}, {"side": high})
        share = pick(draw, 0.5, 0.4, 0.9, 1.0) if kind is inner else pick(draw, 1.0, 0.9, 0.5)
        return [
            draw_motion(draw, mass, kind | {"position": size[axis] * (1 - share if kind == {"side": low} else share)})
        ]
    second = inner | {"name": "second"}
    kinds = pick(
        draw, ({"side": low}, inner), (inner, {"side": high}), ({"side": low}, {"side": high}), (inner, second)
    )
    shares = pick(draw, (0.25, 0.75), (0.3, 0.6), (0.1, 0.9))
    both = zip(kinds, shares, strict=True)
    return [draw_motion(draw, mass, kind | {"position": size[axis] * share}) for kind, share in both]


def draw_motion(draw, mass: float, piston: dict[str, Any]) -> dict[str, Any]:
    """A piston with a velocity, or with a mass."""
    if pick(draw, True, False) if "side" in piston else pick(draw, True, False, False):
        return piston | {"velocity": in_steps(draw, 0.0, 0.1, -0.1, -0.003)}
    piston = piston | {"mass": mass * pick(draw, 1.0, 1e-3, 1e3)}
    if "inner" in piston:
        return piston | {"velocity": pick(draw, 0.0, 0.1, -1.0)}
    return piston | {"pressure": in_steps(draw, *(mass * pressure for pressure in (1.0, 0.01, 30.0)))}


def keep_clear_of_piston(walls, size, pistons) -> None:
    """Press walls together at the side that a single piston cannot reach; an inner one with a mass reaches all."""
    if len(pistons) != 1 or "inner" in pistons[0]:
        return
    axis, upper = divmod(SIDES.index(pistons[0]["side"]), 2)
    walls[:, :, axis] *= 0.1
    if not upper:
        walls[:, :, axis] += 0.9 * size[axis]


def axis_of_piston(piston: dict[str, Any]) -> int:
    return "xy".index(piston["inner"]) if "inner" in piston else SIDES.index(piston["side"]) // 2


def lines_of_inner(size, pistons) -> np.ndarray:
    """(I, 2, 2), both ends of inner pistons at the start."""
    lines = np.empty((0, 2, 2))
    for piston in (piston for piston in pistons if "inner" in piston):
        ends = np.array([[0.0, 0.0], size])
        ends[:, axis_of_piston(piston)] = piston["position"]
        lines = np.concatenate((lines, ends[None]))
    return lines


def draw_species(draw, size, mass: float, largest: float, spins: bool) -> list[dict[str, Any]]:
    """A few small discs more, equal or not, put where there is room."""
    radius = min(0.2 * largest, 0.02 * min(size))
    table = {"name": "gas", "count": pick(draw, 1, 3, 6, 40)}
    table["radius"] = pick(draw, radius, {"uniform": [0.1 * radius, radius]}, {"values": [radius, 0.3 * radius]})
    table["mass"] = pick(draw, mass, {"density": mass / radius**2})
    table |= pick(draw, {"temperature": mass}, {"speed": 0.5}, {"temperature": 1e-6 * mass})
    table |= {"placement": pick(draw, "random", "lattice")}
    return [table | ({"spin_temperature": mass} if spins else {})]


@st.composite
def tables_of(draw) -> dict[str, Any]:
    """A scene's tables in units of its length, speed and mass."""
    called = {name for name in EFFECTS if draw(st.booleans())}
    random = np.random.default_rng(draw(st.integers(0, 2**32)))
    size = pick(draw, (6.0, 5.0), (6.0, 6.0), (6.0, 1.5), (1.0, 6.0))
    periodic = np.array(["periodic x" in called, "periodic y" in called])
    masses = pick(draw, [1.0], [1.0, 3.0], [1.0, 1e8], [1e-8, 1.0, 1e4])
    pistons = draw_pistons(draw, size, masses[0]) if "piston" in called else []
    if pistons:
        periodic[axis_of_piston(pistons[0])] = False
    walls = draw(walls_in(size)) if "walls" in called else np.empty((0, 2, 2))
    keep_clear_of_piston(walls, size, pistons)
    passages = [draw_passage(draw, *wall) if "permeable" in called else {} for wall in walls.tolist()]
    free = np.array(["permeable_to" in p and "permeable_from" not in p for p in passages], bool)
    tables_of_walls = [{"from": a, "to": b} | p for (a, b), p in zip(walls.tolist(), passages, strict=True)]
    if "arcs" in called and not pistons:
        bent = [draw(st.booleans()) and "permeable_from" not in wall for wall in tables_of_walls]
        tables_of_walls = [bend(draw, size, w) if on else w for w, on in zip(tables_of_walls, bent, strict=True)]
    solid = [wall for wall, passes in zip(tables_of_walls, free, strict=True) if not passes]
    straight = np.concatenate((walls[~free], lines_of_inner(size, pistons)))
    number = pick(draw, 4, 1, 2, 3, 9, 16, 40)
    share = pick(draw, 0.5, 1.0, 1 - 1e-9, 0.97, 0.1, 1e-3, 1e-6)
    factors = pick(draw, [1.0], [1.0, 0.5], [1.0, 0.1, 1e-3])
    gridded = draw(st.booleans())
    position, radius = place(
        random, np.array(size), periodic, room_of(size, pistons), straight, solid, number, share, gridded, factors
    )
    n = len(position)
    velocity = move(random, pick(draw, "normal", "few directions", "one hot", "one moves", "all speeds"), n)
    mass = random.choice(masses, n)
    spins = "rotation" in called
    discs = [
        {"position": position[k].tolist(), "velocity": velocity[k].tolist(), "radius": radius[k], "mass": mass[k]}
        | ({"angular_velocity": random.normal() / radius[k]} if spins else {})
        for k in range(n)
    ]
    for k in range(1, n, 3) if "fixed" in called else ():
        discs[k] = {"position": discs[k]["position"], "radius": radius[k], "fixed": True}
    tables = {"box": {"size": list(size)}, "disc": discs, "run": {"until": pick(draw, 3.0, 0.3, 30.0)}}
    tables["run"]["events"] = pick(draw, 10, 30, 30, 100)
    for axis in range(2):
        for side in SIDES[2 * axis : 2 * axis + 2]:
            if periodic[axis]:
                tables["box"][side] = "periodic"
            elif "vibration" in called and draw(st.booleans()):
                amplitude = pick(draw, 1e-3, 0.02, 0.1) * min(size)
                motion = {"frequency": pick(draw, 0.1, 1.0, 30.0), "motion": pick(draw, "parabolas", "sine")}
                tables["box"][side] = {"vibrating": {"amplitude": amplitude, **motion}}
            elif "thermal" in called and draw(st.booleans()) and not any(p.get("side") == side for p in pistons):
                tables["box"][side] = {"thermal": in_steps(draw, *(masses[-1] * x for x in (1.0, 1e-4, 100.0)))}
    if len(walls):
        hot = {"temperature": masses[0] * 2.0} if "thermal" in called and draw(st.booleans()) else {}
        gates = draw(st.booleans())
        holes = [{}, {"absorbing": True}] if "absorbing" in called else [{}]
        tables["wall"] = [
            wall
            | (draw_gate(draw) if gates and "permeable_from" not in wall else {})
            | (hot if hot and k == 0 else pick(draw, *holes))
            for k, wall in enumerate(tables_of_walls)
        ]
    if "gravity" in called:
        pull = pick(draw, 1.0, 0.01, 1e-6, 100.0)
        direction = pick(draw, (0.0, -1.0), (0.3, 0.1), (-1.0, 1.0), (0.0, 1.0), (-1.0, 0.0))
        gravity = [pull * component for component in direction]
        if not any("mass" in piston for piston in pistons) and draw(st.booleans()):
            gravity = [[0.0, gravity], [pick(draw, 0.02, 0.5), [-share * component for component in gravity]]]
        tables["gravity"] = {"acceleration": gravity}
    if spins:
        tables["rotation"] = {"inertia": pick(draw, 0.5, 1.0, 1e-6), "roughness": pick(draw, 1.0, 0.0, -0.5, 0.99)}
        tables["rotation"]["wall_roughness"] = pick(draw, -1.0, 1.0, 0.5)
    if "restitution" in called:
        tables["restitution"] = {"normal": pick(draw, 0.9, 1.0, 0.3, 0.0), "wall": pick(draw, 1.0, 0.9, 0.0)}
        tables["restitution"]["contact_duration"] = pick(draw, 1e-6, 1e-3)
    if pistons:
        tables["piston"] = pistons
    if "steering" in called:
        tables["steering"] = {"reversed_at": pick(draw, 0.3, 1.0, [0.01, 0.02], [0.1, 1.0])}
    if "thermostat" in called:
        tables["thermostat"] = {"temperature": in_steps(draw, *(masses[0] * x for x in (1.0, 1e-4, 100.0)))}
        tables["thermostat"]["rate"] = pick(draw, 0.1, 1e-3, 10.0)
    if n and n <= 9 and share <= 0.5 and draw(st.booleans()):
        tables["species"] = draw_species(draw, size, masses[0], radius.max(), spins)
    return tables


def dimension(path: tuple[str, ...]) -> tuple[int, int, int]:
    """Powers of length, speed and mass in the unit of a key."""
    key = path[-1]
    powers = {
        "size": (1, 0, 0), "position": (1, 0, 0), "radius": (1, 0, 0), "from": (1, 0, 0), "to": (1, 0, 0),
        "via": (1, 0, 0),
        "velocity": (0, 1, 0), "speed": (0, 1, 0), "mass": (0, 0, 1), "angular_velocity": (-1, 1, 0),
        "temperature": (0, 2, 1), "thermal": (0, 2, 1), "spin_temperature": (0, 2, 1), "acceleration": (-1, 2, 0),
        "pressure": (-2, 2, 1), "until": (1, -1, 0), "opens_at": (1, -1, 0), "closes_at": (1, -1, 0),
        "contact_duration": (1, -1, 0), "rate": (-1, 1, 0), "uniform": (1, 0, 0), "values": (1, 0, 0),
        "reversed_at": (1, -1, 0), "density": (-2, 0, 1), "amplitude": (1, 0, 0), "frequency": (-1, 1, 0),
    }  # fmt: skip
    return powers.get(key, (0, 0, 0))


def in_units(value, units, path=()):
    """The tables in other units."""
    if isinstance(value, dict):
        return {key: in_units(item, units, (*path, key)) for key, item in value.items()}
    stepped = path[-1:] in (("temperature",), ("thermal",), ("pressure",), ("velocity",), ("acceleration",))
    if stepped and isinstance(value, list) and isinstance(value[0], list):
        return [[in_units(time, units, ("until",)), in_units(x, units, path)] for time, x in value]
    if isinstance(value, list):
        return [in_units(item, units, path) for item in value]
    if isinstance(value, (float, np.floating)):
        return float(value) * math.prod(unit**power for unit, power in zip(units, dimension(path), strict=True))
    return value


def text_of(tables: dict[str, Any]) -> str:
    return "\n".join(f"{key} = {toml_value(table)}" for key, table in tables.items())


@lru_cache(maxsize=1)
def scene_and_gas(text: str) -> tuple[Scene, Gas]:
    """SceneError if the scene is refused."""
    scene = parse_scene(text)
    return scene, make_gas(scene)


@st.composite
def scene_texts(draw) -> str:
    """The text of a scene that is accepted: what the checks refuse is first tried again with less in it."""
    tables = draw(tables_of())
    units = (pick(draw, *LENGTHS), pick(draw, *SPEEDS), pick(draw, *MASSES))
    for omitted in ((), ("wall",), ("piston",), ("wall", "piston"), ("species",), ("gravity",), tuple(tables)[3:]):
        text = text_of(in_units({key: table for key, table in tables.items() if key not in omitted}, units))
        with suppress(SceneError):
            scene_and_gas(text)
            return text
    reject()
