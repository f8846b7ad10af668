"""What only the Monte Carlo method has, and what a gas without positions cannot have."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING

from idealgas.scene.defaults import mean_speed
from idealgas.scene.effects import SIDES
from idealgas.scene.fault import Fault, Key

if TYPE_CHECKING:
    from idealgas.scene.model import Scene

MONTE_CARLO = "monte_carlo"
KEYS = ("trials", "v_ref", "impact")


def method_faults(scene: Scene, unsound: AbstractSet[str]) -> Iterator[Fault]:
    """Keys of another method, effects that need positions, and gases in which no pair ever meets."""
    run = scene.run
    if run.method != MONTE_CARLO:
        for key in KEYS:
            if (value := getattr(run, key)) is not None:
                allowed = f'no {key}, or method = "{MONTE_CARLO}"'
                yield Fault((("run", key), ("run", "method")), f"no trials in {run.method}", str(value), allowed)
        return
    for place in _places(scene, unsound):
        got = f'method = "{MONTE_CARLO}"'
        yield Fault((place, ("run", "method")), "needs discs that are somewhere", got, "event_driven, brute_force")
    if not {"species", "disc"} & unsound and (scene.species or scene.disc):
        if sum(s.count for s in scene.species) + len(scene.disc) < 2:
            yield Fault((("run", "method"),), "no pair to collide", "one disc", "two discs or more")
        elif mean_speed(scene.species, scene.disc) == 0:
            yield Fault((("run", "method"),), "nothing moves, so no pair meets", "every speed 0", "discs that move")


def _places(scene: Scene, unsound: AbstractSet[str]) -> Iterator[Key]:
    """Keys of everything that acts at a place."""
    if scene.gravity:
        yield ("gravity",)
    if "box" not in unsound:
        for name, side in zip(SIDES, scene.box.sides, strict=True):
            if side != "reflecting":
                yield ("box", name)
    for i, wall in enumerate(scene.wall):
        if wall is not None:
            yield ("wall", i)
    if scene.piston:
        yield ("piston",)
