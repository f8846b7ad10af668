"""Measure the cost of each effect: the time per event with the effect, relative to a box without effects.

Runs with and without the effect alternate in the same process.
"""

import math
import statistics
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from idealgas.effects import EFFECTS
from idealgas.effects.effect import SAMPLE_DISCS, BenchmarkSample
from idealgas.log.summary import Summary
from idealgas.run.simulate import simulate
from idealgas.scene import Scene, parse_scene

RADIUS, PACKING_FRACTION = 0.5, 0.1
SIDE = math.sqrt(SAMPLE_DISCS * math.pi * RADIUS**2 / PACKING_FRACTION)

PLAIN = f"""
[[species]]
name = "gas"
count = {SAMPLE_DISCS}
radius = {RADIUS}
temperature = 1
[log]
events = false
"""


def _scenes() -> dict[str, Sequence[BenchmarkSample]]:
    scenes: dict[str, Sequence[BenchmarkSample]] = {
        ", ".join(filter(None, (effect.name, sample.name))): [sample] for effect in EFFECTS for sample in effect.samples
    }
    return scenes | {"all": [effect.sample_together or effect.samples[0] for effect in EFFECTS]}


SCENES = _scenes()
"""Samples that each effect, and all effects together, add to the benchmark scene without effects."""


class EffectCost(NamedTuple):
    """Cost of an effect.

    Attributes:
        effect: name of the effect.
        ratio: time per event (pair collision or wall hit) relative to the box without effects, median over the repeats.
        smallest: smallest of these ratios.
        largest: largest of these ratios.
        compile_seconds: time for compiling or loading the machine code, s.
    """

    effect: str
    ratio: float
    smallest: float
    largest: float
    compile_seconds: float


def effect_scene(effect: str | None, events: int) -> Scene:
    """Return the scene of the benchmark box with an effect from SCENES, or without effects for None."""
    samples = SCENES[effect] if effect is not None else ()
    keys = "".join(sample.box(SIDE) for sample in samples)
    tables = "".join(sample.tables(SIDE) for sample in samples)
    return parse_scene(f"run.events = {events}\n[box]\nsize = [{SIDE!r}, {SIDE!r}]\n{keys}{PLAIN}{tables}")


def bench_effects(
    events: int = 500_000, repeats: int = 5, on_row: Callable[[EffectCost], None] = lambda row: None
) -> list[EffectCost]:
    """Measure the cost of each effect alone, and of all compatible effects together.

    Args:
        events: number of events in each run.
        repeats: number of runs of each kind.
        on_row: function that is called with each row of the result.
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
            rows.append(EffectCost(effect, statistics.median(ratios), min(ratios), max(ratios), compile_seconds))
            on_row(rows[-1])
    return rows
