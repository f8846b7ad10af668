"""Gases in tall boxes, whose slabs are as thin as possible, and their logs by one thread and by several."""

import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle
from unittest.mock import patch

import numpy as np

from helpers.support import gas_of, record
from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.parallel.decomposition import _Slab
from idealgas.engine.parallel.slabs import Tuning
from idealgas.engine.parallel.subdomain import MIN_ROWS
from idealgas.engine.simulation import Simulation, Stop
from idealgas.initial.build import make_gas
from idealgas.physics.periodic import Periodic
from idealgas.run.effects import exact_sums, make_effects
from idealgas.run.layout import by_name
from idealgas.scene import parse_scene
from idealgas.state import Gas

EAGER = Tuning(min_rows=MIN_ROWS, min_discs=1, min_events=1, max_events=1000, autotune=False)
SMALLEST_CELLS = 1e-9  # discs a cell

EVERYTHING = """
[thermostat]
temperature = 2.0
rate = 0.5
[gravity]
acceleration = [0.0, -0.05]
[rotation]
roughness = 0.7
[restitution]
normal = 0.95
[[wall]]
from = [1.0, 50.0]
to = [7.0, 50.5]
[[wall]]
from = [0.6, 27.0]
to = [7.4, 27.0]
opens_at = 2.0
"""
EFFECTS = {
    "plain": "",
    "periodic": "".join(f'box.{side} = "periodic"\n' for side in ("left", "right", "bottom", "top"))
    + "log.heat_flow = true\n",
    "gravity": "gravity.acceleration = [0.0, -0.05]\n",
    "rotation": "rotation.roughness = 0.7\n",
    "restitution": "restitution.normal = 0.95\n",
    "walls": EVERYTHING[EVERYTHING.index("[[wall]]") :],
    "thermal": "box.bottom = { thermal = 1.0 }\nbox.top = { thermal = 3.0 }\n",
    "steps": "box.bottom = { thermal = [[0, 1.0], [1.5, 4.0]] }\nbox.top = { thermal = [[0, 3], [0.7, 0.5]] }\n",
    "vibration": "box.bottom = { vibrating = { amplitude = 0.4, frequency = 2 } }\n"
    "box.top = { vibrating = { amplitude = 0.1, frequency = 0.7, motion = 'sine' } }\n"
    "gravity.acceleration = [0.0, -0.05]\n",
    "steering": "steering.reversed_at = [0.5, 1.7]\n"
    "gravity.acceleration = [[0, [0, 0]], [0.9, [0, -0.1]], [1.5, [0, 0]]]\n",
    "fixed": "disc = [{ position = [2, 30], radius = 1, fixed = true }, "
    "{ position = [5, 50], radius = 2, fixed = true }]\n",
    "permeable": "wall = [{ from = [0, 40], to = [8, 40.5], permeable_from = 'bottom' }, "
    "{ from = [0, 70], to = [8, 70], permeable_to = ['b'] }]\n",
    "absorbing": "wall = [{ from = [3, 40], to = [5, 40.5], absorbing = true }, "
    "{ from = [0, 70], to = [8, 70], absorbing = true, opens_at = 0.4 }]\n",
    "arcs": "wall = [{ from = [0.1, 30], to = [0.1, 30], via = [7.9, 30] }, "
    "{ from = [1, 60], to = [7, 60], via = [4, 66] }]\n",
    "flow": 'box.left = "periodic"\nbox.right = "periodic"\nbox.bottom = { thermal = 1.0 }\n'
    "gravity.acceleration = [[0, [0.2, -0.05]], [1, [-0.1, 0]]]\n",
    "everything": 'box.left = "periodic"\nbox.right = "periodic"\nbox.bottom = { thermal = 1.0 }\n' + EVERYTHING,
}


def tall_scene(effects: str, seed: int) -> tuple[Gas, Effects]:
    """A gas at random in a box of 8 by 100, thin to dense, with heavy or hot discs in it, and its effects."""
    draw = np.random.default_rng(seed)
    number = int(draw.choice([8, 20, 100, 300, 450]))
    mass, temperature = draw.choice([0.01, 1.0, 1000.0]), draw.choice([1.0, 20.0])
    text = f"""
scene.seed = {seed}
box.size = [8.0, 100.0]
{EFFECTS[effects]}
[[species]]
name = "a"
count = {number - number // 3}
radius = 0.5
temperature = 1.0
[[species]]
name = "b"
count = {number // 3}
radius = 0.25
mass = {mass}
temperature = {temperature}
[run]
until = 1.0
"""
    dotted = [line for line in text.splitlines() if line.split(" = ")[0].count(".") == 1 and not line.startswith("[")]
    tables = [line for line in text.splitlines() if line not in dotted]
    scene = parse_scene("\n".join([*dotted, "log.pressure = true", *tables]))
    gas = make_gas(scene)
    return gas, make_effects(scene, gas)


def lattice(seed: int) -> tuple[Gas, Effects]:
    """Discs on a grid, as fast as each other along x or y, or at rest: many events have one time."""
    draw = np.random.default_rng(seed)
    width, height = ((8, 128), (12, 96), (4, 160))[draw.integers(3)]
    spacing = draw.choice([1.0, 1.5, 2.0, 4.0])
    x, y = np.meshgrid(np.arange(spacing / 2, width, spacing), np.arange(spacing / 2, height, spacing))
    position = np.column_stack((x.ravel(), y.ravel()))
    position = position[draw.random(len(position)) < draw.choice([0.3, 0.7, 1.0])]
    moves = np.array([(0, 1), (0, -1), (1, 0), (-1, 0), (0, 0)], float)[: draw.choice([2, 5])]
    velocity = moves[draw.integers(len(moves), size=len(position))]
    return gas_of((width, height), position, velocity, draw.choice([0.25, 0.5])), Effects()


def tie_at_an_interface() -> tuple[Gas, Effects]:
    """Discs 1 and 2 are to meet across an interface at the time of another contact of disc 1, which diverts it."""
    discs = np.array(
        [  # x, y, vx, vy, radius, mass
            (19.0, 98.5, 4.0, -2.0, 1.0, 3.0),
            (17.0, 91.5, 0.0, 0.0, 4.0, 1.0),
            (17.0, 97.5, 0.0, 0.0, 1.0, 7.0),
            (17.0, 83.0, 0.0, 1.0, 4.0, 1.0),
            (11.0, 97.5, -8.0, 0.0, 1.0, 1.0),
            (17.0, 103.5, 0.0, -1.0, 1.0, 1.0),
            (22.5, 91.5, 0.0, 1.0, 0.5, 1.0),
            (22.5, 86.0, 0.0, 2.0, 0.5, 1.0),
            (23.0, 101.5, -2.0, 0.0, 1.0, 1.0),
            *((x, y, 0.0, 0.0, 0.5, 1.0) for x, y in ((4.0, 90.0), (1.0, 90.0), (2.5, 90.0), (1.0, 92.0), (2.5, 92.0))),
        ]
    )
    return gas_of((24.0, 194.0), discs[:, :2], discs[:, 2:4], discs[:, 4], discs[:, 5]), Effects()


def tie_with_a_late_migrant() -> tuple[Gas, Effects]:
    """Discs 0 and 1 hit walls at t = 3; disc 0 migrates to the slab of disc 1 at 2.5, delayed by the events of disc 3.

    Disc 2 only crosses into another cell at 3.5, so that the slab's latest event is one without rows.
    """
    row = 24 / 23
    discs = np.array(
        [  # x, y, vx, vy, mass
            (6.75, 11 * row - 0.625, 0.25, 0.25, 1.0),
            (1.25, 19.0, -0.25, 0.0, 1.0),
            (4.0, 18 * row - 0.875, 0.0, 0.25, 1.0),
            (1.0, 0.501, 0.0, 0.25, 1.0),
            (1.0, 1.502, 0.0, 0.0, 1e9),
        ]
    )
    return gas_of((8.0, 24.0), discs[:, :2], discs[:, 2:4], 0.5, discs[:, 4]), Effects()


def wind(seed: int) -> tuple[Gas, Effects]:
    """Columns of discs that fly upwards in a periodic box, all but one without a collision: all migrate repeatedly."""
    draw = np.random.default_rng(seed)
    width, height, columns, each = 8.0, 100.0, 7, 20
    x = np.repeat(np.linspace(0.6, 7.4, columns), each)
    y = (np.tile(np.arange(each) * height / each, columns) + np.repeat(height * draw.random(columns), each)) % height
    up = np.repeat(draw.uniform(1.0, 3.0, columns), each)
    up[:each] += draw.normal(0.0, 2.0, each)
    none = np.zeros((len(x), 2), np.int32)
    gas = gas_of((width, height), np.column_stack((x, y)), np.column_stack((0 * up, up)), 0.4)
    return gas, Effects(periodic=Periodic(False, True, width, height, none))


def stop_of(draw: np.random.Generator) -> Stop:
    """An end in time, or after a number of events or of collisions, some thousands at most."""
    stops = (
        Stop(time=draw.uniform(1.0, 6.0), events=20_000),
        Stop(events=int(draw.integers(300, 5000)), time=40.0),
        Stop(disc_collisions=int(draw.integers(200, 3000)), time=40.0),
    )
    return stops[draw.integers(3)]


def log_with(gas: Gas, effects: Effects, stop: Stop, events: int, method: EventDriven) -> list[np.ndarray]:
    """All results of a run: rows, the state and the sums at its end, and the numbers of events."""
    simulation = Simulation(gas, method, effects)
    rows = record(simulation, stop, events=events)
    end, effects = simulation.state()
    counted = simulation.counters
    numbers = [counted.events, counted.disc_collisions, counted.wall_hits, simulation.time, simulation.last_event_time]
    sums = by_name(exact_sums(effects)).values()
    return [*(column for column in rows if column is not None), end.position, end.velocity, *sums, np.array(numbers)]


@contextmanager
def late_threads(draw: np.random.Generator) -> Iterator[None]:
    """Threads that begin their part of a slice late, at random, so that others are ahead of them."""
    run, delays = _Slab.run, cycle(draw.choice([0.0, 0.0, 1e-5, 1e-4, 1e-3], 97).tolist())

    def late(slab: _Slab, *arguments) -> None:
        time.sleep(next(delays))
        run(slab, *arguments)

    with patch.object(_Slab, "run", late):
        yield


def compare(sample, seed: int, threads: tuple[int, ...] = (2, 3, 4, 7)) -> Counter[str]:
    """Assert that several numbers of threads give the log of one thread. sample: makes a new gas and its effects.

    Returns the counts of `Workers`, and how often there were so many slabs.
    """
    draw = np.random.default_rng(seed)
    stop, events = stop_of(draw), int(draw.choice([100, 1000, 10_000]))
    expected = log_with(*sample(), stop, events, EventDriven(SMALLEST_CELLS))
    counts: Counter[str] = Counter()
    for number in threads:
        lead = float(draw.choice([0.1, EAGER.lead, 1e9]))
        method = EventDriven(SMALLEST_CELLS, number, EAGER._replace(lead=lead))
        with late_threads(draw):
            result = log_with(*sample(), stop, events, method)
        assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(result, expected, strict=True)), (
            seed,
            number,
            method.workers.counts,
        )
        assert method.threads.number == number
        assert (
            method.workers.counts["error"] == 0
        )  # an error of a slab's thread is dropped: one thread repeats the slice
        counts += method.workers.counts
        counts[f"{number} slabs"] += 1
    return counts
