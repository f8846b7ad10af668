"""Z = PA/NT of gases that are simulated in memory, by the virials and by the force on every wall, seed by seed."""

import math
from typing import NamedTuple

import numpy as np

from idealgas.columns import IMAGES, OUTWARD, POSITIONS, SIDES, empty_batch, event_columns
from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.lattices import place_on_lattice
from idealgas.initial.placement import place_at_random
from idealgas.initial.room import make_room
from idealgas.log import Flights, LogState
from idealgas.log.join import Join
from idealgas.physics.periodic import Periodic
from idealgas.state import Gas
from idealgas.tallies.impacts import Impacts


class Virials(NamedTuple):
    """Z by route, one entry a seed: pairs, walls (not a number without walls): (seeds,); sides: (seeds, 4).

    collisions: (seeds, S, S), of pairs of species per time, upper triangle.
    """

    pairs: np.ndarray
    walls: np.ndarray
    sides: np.ndarray
    collisions: np.ndarray


def mean_and_error(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over seeds and its standard error from their scatter, which needs no model of correlations."""
    return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))


def virials(radius, box, periodic=(False, False), *, seeds, collisions, warm_up=100, lattice=False) -> Virials:
    """Run gases of unit masses that differ in their seed: Z after `warm_up` collisions a disc, over `collisions` more.

    radius: (N,), one species a radius. lattice: start from one, where random places are too few.
    """
    radius = np.asarray(radius, float)
    actual = [_run(radius, box, periodic, np.random.default_rng(seed), collisions, warm_up, lattice) for seed in seeds]
    return Virials(*(np.array(column) for column in zip(*actual, strict=True)))


def _run(radius, box, periodic, random, collisions, warm_up, lattice):
    n, area = len(radius), box[0] * box[1]
    velocity = random.standard_normal((n, 2))
    velocity -= np.where(periodic, velocity.mean(axis=0), 0.0)
    dof = 2 * n - sum(periodic)
    velocity *= math.sqrt(dof / (velocity**2).sum())  # so that T = 2E/D = 1
    position = _places(radius, box, periodic, random, lattice)
    _, species = np.unique(radius, return_inverse=True)
    names = tuple(f"{k}" for k in range(species.max() + 1))
    gas = Gas(box, position, velocity, radius, np.ones(n), species.astype(np.uint16), names)
    images = Periodic(*periodic, *box, np.zeros((n, 2), np.int32)) if any(periodic) else None
    simulation = Simulation(gas, EventDriven(), Effects(periodic=images))
    for _ in _rows(simulation, warm_up * n // 2, any(periodic)):
        pass
    start, tally = simulation.last_event_time, Impacts(periodic=periodic)
    gas, _ = simulation.state()
    tally.begin(gas, np.array([start, math.inf]))
    join = Join(LogState(start, gas.position, gas.velocity), ("time", "velocity"))
    for rows in _rows(simulation, warm_up * n // 2 + collisions, any(periodic)):
        before = join.pass_on({"time": rows.time, "disc": rows.disc, "velocity": rows.velocity})
        tally.add(
            Flights(
                disc=rows.disc,
                species=gas.species[rows.disc],
                block=np.zeros(len(rows.disc), np.intp),
                start=before["time"],
                end=rows.time,
                kind=rows.kind,
                partner=rows.partner,
                ends_in_collision=rows.partner >= 0,
                velocity=before["velocity"],
                end_velocity=before["velocity"],
                new_velocity=rows.velocity,
                displacement=before["velocity"] * (rows.time - before["time"])[:, None],
                path=np.hypot(*before["velocity"].T) * (rows.time - before["time"]),
                end_position=rows.position,
            )
        )
    tally.finish()
    duration = simulation.last_event_time - start
    pairs = 1 + tally.pair_virial[0] / duration / (2 * n)
    axes = 2 - sum(periodic)
    walls = tally.wall_virial[0] / duration / (axes * n) if axes else math.nan
    push = (tally.impulse[0, : len(SIDES)] * np.array(OUTWARD)).sum(axis=1) / duration
    return pairs, walls, push / (box[1], box[1], box[0], box[0]) * area / n, tally.collisions[0] / duration


def _rows(simulation, collisions, periodic):
    batch, stop = empty_batch(4096, event_columns(POSITIONS, *[IMAGES] * periodic)), Stop(disc_collisions=collisions)
    while not simulation.finished(stop):
        yield batch.rows(0, simulation.advance(stop, batch))
        if simulation.epoch_over and not simulation.finished(stop):
            simulation.next_epoch()


def _places(radius, box, periodic, random, lattice):
    position = np.empty((len(radius), 2))
    room = make_room(box, radius, periodic)
    bounds = np.array([[*np.where(periodic, 0.0, r), *np.where(periodic, box, np.subtract(box, r))] for r in radius])
    ids = np.argsort(-radius, kind="stable")
    if lattice:
        random.shuffle(ids)
        largest = np.array([radius.max(), radius.max(), box[0] - radius.max(), box[1] - radius.max()])
        assert place_on_lattice(room, position, radius, largest, ids[:0], ids)
    else:
        assert place_at_random(room, position, radius, bounds, ids[:0], ids, random, 3_000_000) == len(radius)
    return position
