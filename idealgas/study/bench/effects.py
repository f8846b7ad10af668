"""What an effect costs: the time of an event with it, over that of the plain box, in turn in one process."""

import math
import statistics
import tempfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from idealgas.run.simulate import Summary, simulate
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
    """`[[wall]]` tables of a regular polygon at a height in the box."""
    turn = [2 * math.pi * k / corners for k in range(corners + 1)]
    points = [[SIDE / 2 + radius * math.cos(a), height + radius * math.sin(a)] for a in turn]
    return "".join(f"[[wall]]\nfrom = {start}\nto = {end}\n" for start, end in pairwise(points))


PERIODIC = '{0} = "periodic"\n{1} = "periodic"\n'
GRAVITY = f"[gravity]\nacceleration = [0, {-1 / SIDE!r}]\n"
ROTATION = "[rotation]\nroughness = 0.5\nwall_roughness = 0.5\n"
RESTITUTION = "[restitution]\nnormal = 0.999\nwall = 0.999\n"
PISTON = f'[piston]\nside = "top"\nposition = {0.95 * SIDE!r}\nmass = 100\npressure = {1.2 * NUMBER / SIDE**2!r}\n'


def thermal(*sides: str) -> str:
    """Keys of `[box]` for sides at the temperature of the gas."""
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
    "all": (
        PERIODIC.format("left", "right") + thermal("bottom"),
        polygon(6, height=5.0) + GRAVITY + ROTATION + RESTITUTION + PISTON,
    ),
}
"""What each adds to the plain box: keys of `[box]`, and tables."""


class Row(NamedTuple):
    """ratio: time per event (pair collision or wall hit) over that of the plain box, the median over the repeats;
    smallest and largest beside it. compile_seconds: to make or load the machine code.
    """

    effect: str
    ratio: float
    smallest: float
    largest: float
    compile_seconds: float


def effect_scene(effect: str | None, events: int) -> Scene:
    """The plain box with one of SCENES, or as it is."""
    keys, tables = SCENES[effect] if effect is not None else ("", "")
    return parse_scene(f"run.events = {events}\n[box]\nsize = [{SIDE!r}, {SIDE!r}]\n{keys}{PLAIN}{tables}")


def bench_effects(
    events: int = 500_000, repeats: int = 5, on_row: Callable[[Row], None] = lambda row: None
) -> list[Row]:
    """Time every effect alone, and all that go together at once, against the plain box, in turn."""
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
