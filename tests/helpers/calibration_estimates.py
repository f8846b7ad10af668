"""Estimates that are calibrated, taken of the log of a gas."""

from collections.abc import Iterator
from typing import Literal

from idealgas import (
    Log,
    cooling,
    effusion,
    entropy,
    escape,
    heat_capacity,
    histogram,
    order,
    profile,
    relaxation,
    scattering,
    shear,
    sound,
    work,
)
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.scattering.sums import SEGMENTS as PARTS
from idealgas.analysis.temperature import temperature
from idealgas.analysis.transport.coefficients import SYMBOLS
from idealgas.analysis.transport.diffusion import MOST_SEGMENTS as SEGMENTS
from idealgas.analysis.transport.measure import transport
from idealgas.analysis.transport.pair_distribution import FRAMES as INSTANTS

Named = Iterator[tuple[str, Estimate]]
"""Estimates by their names."""


def box(log: Log) -> Named:
    """Pressure, rates, flights, temperature and the heat capacity of a closed box."""
    found = pressure(log)
    for route in found.routes:
        yield route.name, route.compressibility_factor
    yield "collision rate", found.collision_rates[0].rate
    (free,) = found.free_paths
    yield from (("free path", free.path), ("free time", free.time), ("mean speed", free.speed))
    yield "temperature along x", temperature(log).species[0].x
    yield "heat capacity E/T", heat_capacity(log).routes["E/T"]
    for quantity in ("vx", "free-path", "waiting-time"):
        yield f"mean {quantity} (histogram)", histogram(log, quantity).distributions[0].mean


def escapes(log: Log) -> Named:
    """Rates at which discs leave through a hole."""
    found = escape(log)
    assert found.per_path is not None
    yield "escapes per path", found.per_path
    yield "mean escape time", found.mean_time


def strips(log: Log) -> Named:
    """Density and temperature in strips of a closed box."""
    (strips,) = profile(log, "x", 4).species
    for k, place in enumerate(("at the side", "in the middle")):
        yield f"density {place}", strips.density[k]
        yield f"temperature {place}", strips.temperature[k]
    assert strips.gradient is not None
    yield "temperature gradient", strips.gradient


def along_x(log: Log) -> Named:
    """Profiles in ten strips along x: two at a side, and one in the middle."""
    return _profiles(log, "x", 10, (0, 1, 4))


def along_y(log: Log) -> Named:
    """Profiles in five strips along y, the lowest ones."""
    return _profiles(log, "y", 5, (0, 1, 2))


def _profiles(log: Log, axis: Literal["x", "y"], bins: int, strips: tuple[int, ...]) -> Named:
    """Densities and temperatures of each species, temperature gradients, and the pressure tensor in some strips."""
    found = profile(log, axis, bins)
    for entry in found.species:
        for k in strips:
            yield f"density of {entry.species} in strip {k}", entry.density[k]
            yield f"temperature of {entry.species} in strip {k}", entry.temperature[k]
        assert entry.gradient is not None
        yield f"temperature gradient of {entry.species}", entry.gradient
    for name, parts in found.pressure.items():
        for k in strips:
            yield f"P_{name} in strip {k}", parts[k]
    yield from of_parts(log)


def of_parts(log: Log) -> Named:
    """Temperatures of the species that share the energy."""
    for entry in temperature(log).species:
        if entry.both.standard_error > 0:
            yield f"temperature of {entry.species}", entry.both


def periodic(log: Log) -> Named:
    """Transport in a periodic box, and its curves at one lag and at contact."""
    found = transport(log)
    (disc,), (pairs,), (contact,) = found.diffusion, found.pair_distributions, found.contacts
    yield "pairs, virial", pressure(log).routes[-1].compressibility_factor
    yield "contact value", contact.value
    yield "g(r) at contact", Estimate(pairs.value[0], pairs.error[0], INSTANTS)
    yield "diffusion coefficient", disc.coefficient
    yield "velocity correlation time", disc.velocity_correlation_time
    early = len(disc.lag) // 8
    yield "velocity correlation, early", Estimate(disc.correlation[early], disc.correlation_error[early], SEGMENTS)
    yield "D(t), early", Estimate(disc.running[early], disc.running_error[early], SEGMENTS)
    yield "D(t), late", Estimate(disc.running[-2], disc.running_error[-2], SEGMENTS)
    assert found.collective is not None
    for name, one in found.collective.coefficients.items():
        yield name.replace("_", " "), one.value
        if one.difference is not None:
            yield f"{name.replace('_', ' ')}, difference of routes", one.difference
        for when, k in (("early", len(one.times) // 8), ("late", -2)):
            curve = Estimate(float(one.running[k]), float(one.running_error[k]), SEGMENTS)
            yield f"{SYMBOLS[name]}(t), {when}", curve
    for name in ("xx", "xy"):
        yield f"pressure tensor, {name}", found.pressure[name]


def in_each_other(log: Log) -> Named:
    """Diffusion of two species."""
    found = transport(log)
    assert found.collective is not None
    mutual = found.collective.coefficients["mutual_diffusion"]
    assert mutual.difference is not None
    yield from (("mutual diffusion", mutual.value), ("mutual diffusion, difference of routes", mutual.difference))
    for entry in found.diffusion:
        yield f"diffusion coefficient, {entry.species}", entry.coefficient


def cools(log: Log) -> Named:
    """A gas that loses energy in its collisions."""
    found = cooling(log)
    yield from (("part of T lost per collision", found.loss), ("Haff's time", found.haff), ("a₂", found.fourth))
    yield from (("scatter of numbers, first tenth", found.first_scatter), ("flow, last tenth", found.last_flow))
    yield "scatter of numbers, last tenth", found.last_scatter
    if found.temperature_ratio is not None:
        yield "temperature of spin over that of motion", found.temperature_ratio


def ordered(log: Log) -> Named:
    """Hexagonal order in a periodic box."""
    found = order(log)
    yield from (("ψ₆ of a disc", found.local), ("Ψ₆ of all discs", found.whole), ("six neighbours", found.hexagons))
    assert found.structure is not None
    for name, value, error in (
        ("g₆ of neighbours", found.correlation, found.correlation_error),
        ("S of the longest waves", found.structure.value, found.structure.error),
    ):
        yield name, Estimate(float(value[0]), float(error[0]), found.frames)


def bath(log: Log) -> Named:
    """A gas between thermal walls: fluctuations of its energy, and heat."""
    yield "heat capacity Var(E)/T²", heat_capacity(log).routes["Var(E)/T²"]
    yield "temperature", temperature(log).species[0].both
    yield "heat of a wall", profile(log, "x", 2).heat["left"]


def rough(log: Log) -> Named:
    """Discs with spin: fluctuations of the kinetic energy of motion."""
    found = heat_capacity(log)
    yield "heat capacity, fluctuations", found.routes["fluctuations of the kinetic energy"]
    yield "temperature by kinetic energy", found.temperature


def waves(log: Log) -> Named:
    """Sound in a periodic box."""
    (wave,) = sound(log).waves
    yield from (("speed of sound", wave.speed), ("damping of sound", wave.damping))
    yield from (("thermal diffusivity", wave.spreading), ("adiabatic exponent", wave.exponent))


def mixture(log: Log) -> Named:
    """Two species that start at two temperatures."""
    for entry in temperature(log).species[:2]:
        yield f"temperature, {entry.species}", entry.both
    for rate in pressure(log).collision_rates:
        yield f"rate, {rate.species} {rate.other}", rate.rate


def fluid(log: Log) -> Named:
    """Pressure, collision rates of every two species, and temperatures that fluctuate."""
    found = pressure(log)
    yield "pairs, virial", found.routes[-1].compressibility_factor
    names = list(dict.fromkeys(rate.species for rate in found.collision_rates))
    for rate in found.collision_rates:
        if names.index(rate.species) <= names.index(rate.other):
            yield f"rate, {rate.species} {rate.other}", rate.rate
    for entry in temperature(log).species[: len(names)]:
        if entry.both.standard_error > 0:
            yield f"temperature, {entry.species}", entry.both


def slit(log: Log) -> Named:
    """Two chambers and a slit."""
    yield "flow through a slit", effusion(log).speed


def gauges(log: Log) -> Named:
    """Mechanical pressure of every wall, and what holds all of them together."""
    found = pressure(log).mechanical
    assert found is not None
    for wall in found.walls:
        yield wall.name, wall.pressure
    for axis, force in found.forces[-1].large.items():
        yield f"all walls, {axis}", force


def equal_speeds(log: Log) -> Named:
    """Relaxation from equal speeds."""
    found = relaxation(log)
    assert found.in_time is not None
    assert found.in_collisions is not None
    yield from (("relaxation time", found.in_time), ("relaxation, collisions per disc", found.in_collisions))


def currents(log: Log) -> Named:
    """Viscosities and thermal conductivity."""
    found = transport(log).collective
    assert found is not None
    for name, one in found.coefficients.items():
        yield name.replace("_", " "), one.value


def steady_state(log: Log) -> Named:
    """Pressure of the walls and temperature of a gas that exchanges its kinetic energy."""
    yield from gauges(log)
    yield "mean temperature", temperature(log).species[-1].both


def in_phase_space(log: Log) -> Named:
    """Boltzmann's H, and the entropy of positions."""
    (found,) = entropy(log).species
    assert found.mean_h is not None
    assert found.mean_positions is not None
    yield from (("Boltzmann's H", found.mean_h), ("entropy of positions", found.mean_positions))


def strokes(log: Log) -> Named:
    """Free energy by the work of a piston; outwards few strokes decide, so that errors take 1000 of them."""
    found = work(log)
    inwards, outwards = found.processes
    yield from (("free energy, inwards", inwards.free_energy), ("mean work, inwards", inwards.mean_work))
    for name, one in (("inwards", inwards), ("outwards", outwards)):
        yield f"kinetic energy before, {name}", one.kinetic_energy
    (crossing,) = found.crossings
    yield from (("crossing", crossing.free_energy), ("slope of the crossing", crossing.slope))


def scattered(log: Log) -> Named:
    """Density and current correlations of four wave numbers."""
    found = scattering(log)
    for name, one in zip(("long", "second", "third", "short"), found.waves, strict=True):
        for title, estimate in (
            ("S(k)", one.structure),
            ("⟨j²⟩ along", one.longitudinal_square),
            ("⟨j²⟩ across", one.transverse_square),
            ("F_s, early", one.early),
        ):
            yield f"{title}, {name}", estimate
        for title, curve, index in (
            ("F", one.density, 8),
            ("F_s", one.self_part, 8),
            ("current along", one.longitudinal, 4),
            ("current across", one.transverse, 4),
            ("S(k, ω)", one.spectrum, 3),
        ):
            yield f"{title}, {name}", Estimate(float(curve.value[index]), float(curve.error[index]), PARTS)
    for name, moved in zip(("long", "second", "third", "short"), found.van_hove, strict=True):
        yield f"G_s, {name}", Estimate(float(moved.density.value[8]), float(moved.density.error[8]), PARTS)
    for name, other in zip(("t = 0", "long", "second", "third", "short"), found.distinct, strict=True):
        for place, index in (("at contact", 20), ("at twice the diameter", 40)):
            yield (
                f"G_d {place}, {name}",
                Estimate(float(other.density.value[index]), float(other.density.error[index]), PARTS),
            )
    curve, late = found.non_gaussian, len(found.time) // 2
    yield "α₂", Estimate(float(curve.value[late]), float(curve.error[late]), PARTS)


def sheared(log: Log) -> Named:
    """A sheared gas: viscosity and pressure are those at its temperature T, and their errors have none of that of T."""
    found = shear(log)
    t = found.temperature.value
    yield from (("η/√T", found.viscosity.times(t**-0.5)), ("P/T", found.pressure.times(1 / t)))
    yield "temperature of a sheared gas", found.temperature
    yield from (("normal stress over pressure", found.normal_stress), ("slope of the flow", found.slope))


def counted(log: Log) -> Named:
    """Impact parameters of collisions, and numbers of collisions of a disc in a time."""
    yield "mean impact parameter", histogram(log, "impact-parameter").distributions[0].mean
    (found,) = histogram(log, "collisions").distributions
    yield "collisions in 10 free times", found.mean
    for name, one in found.cumulants.items():
        yield name.replace("_", " "), one
