"""Cost of each effect: time per event with it over that in the plain box, measured alternately in one process."""

import math
import statistics
import tempfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from idealgas.log.summary import Summary
from idealgas.run.simulate import simulate
from idealgas.scene import Scene, parse_scene

NUMBER, RADIUS, PACKING_FRACTION = 1000, 0.5, 0.1
SIDE = math.sqrt(NUMBER * math.pi * RADIUS**2 / PACKING_FRACTION)

PLAIN = f"""
[[species]]
name = "gas"
count = {NUMBER}
radius = {RADIUS}
temperature = 1
[log]
events = false
"""


def polygon(corners: int, height: float = SIDE / 2, radius: float = 4.0) -> str:
    """Tables `[[wall]]` of a regular polygon of `radius` (length) with its centre at `height` in the box."""
    turn = [2 * math.pi * k / corners for k in range(corners + 1)]
    points = [[SIDE / 2 + radius * math.cos(a), height + radius * math.sin(a)] for a in turn]
    return "".join(f"[[wall]]\nfrom = {start}\nto = {end}\n" for start, end in pairwise(points))


PERIODIC = '{0} = "periodic"\n{1} = "periodic"\n'
GRAVITY = f"[gravity]\nacceleration = [0, {-1 / SIDE!r}]\n"
ROTATION = "[rotation]\nroughness = 0.5\nwall_roughness = 0.5\n"
RESTITUTION = "[restitution]\nnormal = 0.999\nwall = 0.999\n"
PISTON = f'[piston]\nside = "top"\nposition = {0.95 * SIDE!r}\nmass = 100\npressure = {1.2 * NUMBER / SIDE**2!r}\n'
THERMOSTAT = "[thermostat]\ntemperature = 1\nrate = 0.053\n"  # a tenth of the collisions of a disc per time


def thermal(*sides: str) -> str:
    """Keys of `[box]` for thermal sides at the temperature of the gas."""
    return "".join(f"{side} = {{ thermal = 1 }}\n" for side in sides)


SCENES = {
    "gravity": ("", GRAVITY),
    "periodic sides": (PERIODIC.format("left", "right") + PERIODIC.format("bottom", "top"), ""),
    "wall segments, 6": ("", polygon(6)),
    "wall segments, 1000": ("", polygon(1000)),
    "rotation": ("", ROTATION),
    "restitution": ("", RESTITUTION),
    "thermal walls": (thermal("left", "right", "bottom", "top"), ""),
    "piston": ("", PISTON),
    "thermostat": ("", THERMOSTAT),
    "all": (
        PERIODIC.format("left", "right") + thermal("bottom"),
        polygon(6, height=5.0) + GRAVITY + ROTATION + RESTITUTION + PISTON + THERMOSTAT,
    ),
}
"""Keys of `[box]` and further tables that each effect adds to the scene of the plain box."""


class Row(NamedTuple):
    """Cost of one effect.

    effect: name. ratio: time per event (pair collision or wall hit) over that in the plain box, median over the
    repeats. smallest, largest: its extremes. compile_seconds: time for compiling or loading the machine code, seconds.
    """

    effect: str
    ratio: float
    smallest: float
    largest: float
    compile_seconds: float


def effect_scene(effect: str | None, events: int) -> Scene:
    """Scene of the plain box with one effect of SCENES, or with none."""
    keys, tables = SCENES[effect] if effect is not None else ("", "")
    return parse_scene(f"run.events = {events}\n[box]\nsize = [{SIDE!r}, {SIDE!r}]\n{keys}{PLAIN}{tables}")


def bench_effects(
    events: int = 500_000, repeats: int = 5, on_row: Callable[[Row], None] = lambda row: None
) -> list[Row]:
    """Time every effect alone, and all compatible effects together, alternately with the plain box.

    events: of each run. repeats: runs of each kind. on_row: called with each row.
    """
    with tempfile.TemporaryDirectory(prefix="idealgas-bench-") as folder:

        def run(effect: str | None, most: int) -> Summary:
            return simulate(effect_scene(effect, most), Path(folder) / "bench.h5", force=True)

        run(None, 1)
        rows = []
        for effect in SCENES:
            compile_seconds = run(effect, 1).compile_seconds
            ratios = []
            for _ in range(repeats):
                plain, with_effect = (run(each, events) for each in (None, effect))
                ratios.append((with_effect.seconds / with_effect.events) / (plain.seconds / plain.events))
            rows.append(Row(effect, statistics.median(ratios), min(ratios), max(ratios), compile_seconds))
            on_row(rows[-1])
    return rows
