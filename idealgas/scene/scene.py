"""Checked scenes, and digests by which equal runs and equal gases are recognised."""

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from typing import Any, Self

from pydantic import PrivateAttr, model_validator
from pydantic_core import PydanticCustomError

from idealgas.scene.checks import issues
from idealgas.scene.document import Document
from idealgas.toml.issues import Issue
from idealgas.toml.table import Table
from idealgas.toml.text import Origin


class Scene(Document):
    """A checked scene: its numbers are in range, its discs fit into the box, and its run ends."""

    _origin: Origin = PrivateAttr(default_factory=Origin)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := list(issues(self)):
            raise PydanticCustomError("issues", "{summary}", {"summary": str(found[0]), "issues": found})
        return self

    def resolved(self) -> Self:
        """This scene with the defaults that follow from other tables."""
        update: dict[str, Table] = {}
        if self.piston:
            update["piston"] = self.piston.model_copy(update={"position": self.piston.start(self.box.size)})
        if self.restitution and not self.restitution.elastic:
            update["restitution"] = self.restitution.model_copy(update={"contact_duration": self.contact_duration})
        return self.model_copy(update=update)

    def from_origin(self, origin: Origin) -> Self:
        """This scene with its origin."""
        self._origin = origin
        return self

    def report(self, issues: Sequence[Issue]) -> list[str]:
        """One line per issue that was found after the check of the scene, with file and line."""
        return self._origin.report(issues)


STATE = ("temperature", "position", "velocity")
"""Keys, outside the tables of discs, of the initial state and temperature of a gas, which are not in `gas_digest`."""


def draws_random_numbers(scene: Scene) -> bool:
    """Whether a scene depends on its seed, in its initial state or during the run."""
    return bool(scene.species) or not scene.properties.isolated or scene.run.method == "monte_carlo"


def run_digest(scene: Scene) -> str:
    """Digest of everything that determines the motion: logs with the same digest have the same run, or parts of it.

    The title, and the tables `run` and `log`, are left out.
    """
    tables = _tables(scene)
    seed = scene.scene.seed if draws_random_numbers(scene) else None
    return _digest({name: value for name, value in tables.items() if name not in ("scene", "run", "log")} | {"": seed})


def gas_digest(scene: Scene) -> str:
    """Digest of the discs, the box and the effects of a scene, without its initial state and temperature."""
    left_out = ("scene", "run", "log", "species", "disc")
    rest = {name: _without_state(value) for name, value in _tables(scene).items() if name not in left_out}
    box = {side: list(value) if isinstance(value, dict) else value for side, value in rest["box"].items()}
    return _digest([sorted(_discs(scene).items()), rest | {"box": box}])


def gas_kind(scene: Scene) -> str:
    """Description of a gas by the sizes of its discs and its effects, without their number and the size of the box."""
    sizes = _sizes(scene)
    smallest, number = min(sizes), sizes.total()
    parts = [f"{count / number:.3g} of radius {radius / smallest:.3g}" for radius, count in sorted(sizes.items())]
    discs = f"mixture ({', '.join(parts)})" if len(parts) > 1 else "equal discs"
    return ", ".join((discs, *(scene.effects or ("reflecting box",))))


def is_mixture(scene: Scene) -> bool:
    """Whether the discs of a scene differ in radius."""
    return len(_sizes(scene)) > 1


def describe_gas(scene: Scene) -> str:
    """Description of the gas of a scene: number of discs, box, and kind of gas."""
    width, height = scene.box.size
    number = _discs(scene).total()
    return f"N = {number} in {width:.6g} × {height:.6g}, {gas_kind(scene)}"


def _discs(scene: Scene) -> Counter[tuple[float, float]]:
    """Number of discs by their radius and mass."""
    discs: Counter[tuple[float, float]] = Counter()
    for species in scene.species:
        discs[species.radius, species.mass] += species.count
    for disc in scene.disc:
        discs[disc.radius, disc.mass] += 1
    return discs


def _sizes(scene: Scene) -> Counter[float]:
    """Number of discs by their radius."""
    sizes: Counter[float] = Counter()
    for (radius, _), count in _discs(scene).items():
        sizes[radius] += count
    return sizes


def _tables(scene: Scene) -> dict[str, Any]:
    return scene.resolved().model_dump(mode="json", by_alias=True, exclude_none=True)


def _without_state(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_state(part) for key, part in value.items() if key not in STATE}
    return [_without_state(part) for part in value] if isinstance(value, list) else value


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:32]
