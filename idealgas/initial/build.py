"""The discs of a scene as arrays; dtypes and shapes are defined only here."""

import math

import numpy as np

from idealgas.initial.contacts import static_contact_issues
from idealgas.physics.elementary import cos_sin_turns
from idealgas.physics.shear import flow_at
from idealgas.scene import Scene, SceneError, Species
from idealgas.scene.checks.piston import chamber_issues
from idealgas.scene.sizes import Values, mass_of
from idealgas.state import Gas, rng
from idealgas.toml.issues import Issue


def make_gas(scene: Scene) -> Gas:
    """Make the discs of a scene at time 0; explicit discs have the first ids, followed by the species in order.

    Raises:
        SceneError: the discs cannot be placed, a disc is in static contact with a wall or piston against which it is
            pressed, pistons crush discs, or there is no disc between two pistons.
    """
    radius, mass, species, names = disc_constants(scene)
    position, velocity = _positions(scene, radius), _all_velocities(scene, mass, species, names)
    if rate := scene.properties.shear:  # explicit velocities remain unchanged
        explicit = [names.index(s.name) for s in scene.species if s.velocities is not None]
        drawn = ~np.isin(species, explicit)
        drawn[: 0 if scene.draws_velocities else len(scene.explicit_discs)] = False
        velocity[drawn, 0] += flow_at(position[drawn, 1], rate, scene.box.size[1])
    gas = Gas(
        box=scene.box.size,
        position=position,
        velocity=velocity,
        radius=radius,
        mass=mass,
        species=species,
        species_names=names,
        solid_area=scene.solids.area,
    )
    if issues := [*static_contact_issues(scene, gas), *chamber_issues(scene, gas.position, gas.radius)]:
        raise SceneError(scene.report(issues))
    return gas


def disc_constants(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[str, ...]]:
    """Return the radius (N,), mass (N,) and species (N,) of each disc of a scene, and the names of the species."""
    given, tables = scene.explicit_discs, [s.name for s in scene.species]
    names = (*(name for name in given.names if name not in tables), *tables)
    number = {name: k for k, name in enumerate(names)}
    count = [s.count for _, s in scene.placed]
    radius = [_radii(s, scene.scene.seed) for _, s in scene.placed]
    mass = [mass_of(s.mass, values) for (_, s), values in zip(scene.placed, radius, strict=True)]
    placed_species = np.repeat(np.array([number[name] for name in tables], np.uint16), count)
    return (
        np.concatenate((given.radius, *radius)),
        np.concatenate((given.mass, *mass)),
        np.concatenate((np.array([number[name] for name in given.names], np.uint16)[given.species], placed_species)),
        names,
    )


def _radii(species: Species, seed: int) -> np.ndarray:
    """Radii (count,) of the discs of a species, length; radii of a continuous distribution are in random order."""
    if isinstance(species.radius, float):
        return np.full(species.count, species.radius)
    radii = np.array([size.radius for size in species.sizes])
    return radii if isinstance(species.radius, Values) else rng(seed, f"radii {species.name}").permutation(radii)


def _all_velocities(scene: Scene, mass: np.ndarray, species: np.ndarray, names: tuple[str, ...]) -> np.ndarray:
    """Velocities (N, 2) of all discs, length/time; explicit discs keep theirs unless the scene draws new velocities.

    mass, species: (N,) of all discs. names: names of the species.
    """
    velocity = np.empty((len(species), 2))
    kept = 0 if scene.draws_velocities else len(scene.explicit_discs)
    velocity[:kept] = scene.explicit_discs.velocity[:kept]
    for s in scene.species if scene.draws_velocities else [s for _, s in scene.placed]:
        members = kept + np.flatnonzero(species[kept:] == names.index(s.name))
        velocity[members] = _velocities(s, mass[members], rng(scene.scene.seed, f"velocities {s.name}"))
    return velocity


def _velocities(species: Species, mass: np.ndarray, random: "np.random.Generator") -> np.ndarray:
    """Velocities (count, 2) of the discs of a species, length/time.

    If the species has a temperature T, the kinetic energy is count * T, and the total momentum of two or more discs is
    0. mass: (count,) of the discs.
    """
    n = species.count
    if n == 0:
        return np.empty((0, 2))
    if species.velocities is not None:
        return np.array(species.velocities)
    if species.speed is not None:
        return species.speed * np.column_stack(cos_sin_turns(random.random(n)))
    velocity = random.standard_normal((n, 2))
    if np.ptp(mass) > 0:
        velocity /= np.sqrt(mass)[:, None]
        velocity -= mass @ velocity / mass.sum()
    elif n > 1:
        velocity -= velocity.mean(axis=0)
    mean_square = (mass @ velocity**2).sum() / n if np.ptp(mass) > 0 else mass[0] * ((velocity**2).sum() / n)
    return velocity * np.sqrt(2 * (species.temperature or 0.0) / mean_square)


def _positions(scene: Scene, radius: np.ndarray) -> np.ndarray:
    """Positions (N, 2), length; if discs are compressed, all are first placed with smaller radii."""
    if not any(s.placement == "compressed" and s.count for _, s in scene.placed):
        return _placed(scene, radius)
    from idealgas.initial.compression import compress, loose_scale

    scale = loose_scale(radius, scene.box.size)
    position = _placed(scene, radius * scale)
    reached = compress(position, radius, scene.box.size, scale, rng(scene.scene.seed, "compression"))
    if reached < 1:
        dense = math.pi * float(radius @ radius) * reached**2 / (scene.box.size[0] * scene.box.size[1])
        got = f"jammed at a packing fraction of {dense:.4g}"
        raise _no_room(scene, 0, "by compression", got, 'fewer or smaller discs, or placement = "triangular"')
    return position


def _placed(scene: Scene, radius: np.ndarray) -> np.ndarray:
    """Positions (N, 2), length; explicit discs are placed first, then discs on lattices, then discs at random."""
    from idealgas.initial import lattices, placement  # compiled code, which readers of logs do not need
    from idealgas.initial.room import make_room

    box, periodic = scene.box, scene.properties.periodic
    space = scene.room
    walls = [wall for wall in scene.walls if wall.is_present(0.0)]
    bounds, position = np.empty((len(radius), 4)), np.empty((len(radius), 2))
    room = make_room(box.size, radius, periodic, walls, scene.solids.walls, not scene.properties.interacting)
    random = rng(scene.scene.seed, "placement")
    ids = np.split(
        np.arange(len(radius)), np.cumsum([len(scene.explicit_discs), *(s.count for _, s in scene.placed)])[:-1]
    )
    position[ids[0]] = scene.explicit_discs.position
    placed = ids[0]
    by_region: dict[tuple[float, ...], list[int]] = {}
    triangular: list[int] = []
    at_random: list[int] = []
    for k, s in scene.placed:
        if s.count == 0:
            continue
        x0, y0, x1, y1 = region = s.region or space
        radii = radius[ids[k + 1]]
        bounds[ids[k + 1]] = np.column_stack((x0 + radii, y0 + radii, x1 - radii, y1 - radii))
        if s.placement == "lattice":
            by_region.setdefault(region, []).append(k)
        elif s.placement == "triangular":
            triangular.append(k)
        else:
            at_random.append(k)
            for axis in (a for a in range(2) if periodic[a] and s.region is None):
                bounds[ids[k + 1], axis::2] = 0.0, np.nextafter(box.size[axis], 0.0)
    for members in by_region.values():
        chosen = np.concatenate([ids[k + 1] for k in members])
        if len(members) > 1:
            random.shuffle(chosen)
        largest = bounds[chosen[radius[chosen].argmax()]]
        if not lattices.place_on_lattice(room, position, radius, largest, placed, chosen):
            raise _no_room(
                scene, members[0], "on a lattice", f"{len(chosen)} discs", "fewer or smaller discs, or more room"
            )
        placed = np.concatenate((placed, chosen))
    if lattice := scene.lattice:
        chosen = np.concatenate([ids[k + 1] for k in triangular])
        if len(triangular) > 1:
            random.shuffle(chosen)
        position[chosen] = lattices.lattice_sites(lattice)
        if not lattices.fits(room, position, radius, placed, chosen):
            raise _no_room(
                scene,
                triangular[0],
                "on a triangular lattice",
                f"{len(chosen)} discs",
                "no other discs or walls in its way",
            )
        placed = np.concatenate((placed, chosen))
    if at_random:
        chosen = np.concatenate([ids[k + 1] for k in at_random])
        chosen = chosen[np.argsort(-radius[chosen], kind="stable")]  # the largest first
        max_refusals = max(placement.REFUSALS_PER_DISC * len(chosen), placement.MIN_REFUSALS)
        number = placement.place_at_random(room, position, radius, bounds, placed, chosen, random, max_refusals)
        if number < len(chosen):
            k = next(k for k in at_random if chosen[number] in ids[k + 1])
            got = f"{len(chosen)} discs, {number} placed"
            raise _no_room(scene, k, "at random", got, 'fewer or smaller discs, or placement = "lattice"')
    return position


def _no_room(scene: Scene, species: int, how: str, got: str, allowed: str) -> SceneError:
    """Return the error for a species whose discs do not fit into the box; how: kind of placement."""
    keys = (*(("species", species, key) for key in ("count", "radius", "region")), ("box", "size"))
    return SceneError(scene.report([Issue(keys, f"no room for all discs {how}", got, allowed)]))
