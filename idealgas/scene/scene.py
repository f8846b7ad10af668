"""Scenes that have been checked, and digests that identify equal runs and equal gases."""

import hashlib
import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, Self

from pydantic import BaseModel, PrivateAttr, TypeAdapter, ValidationError, ValidationInfo, model_validator

from idealgas.scene.checks import issues
from idealgas.scene.discs import ExplicitDiscs, InitialDiscs
from idealgas.scene.document import Document
from idealgas.scene.start import StartError, read_start
from idealgas.toml.issues import Issue, SceneError, as_issues, issues_error, table_at
from idealgas.toml.overrides import names_of
from idealgas.toml.text import TextOrigin


class _SceneType(type(BaseModel)):  # type: ignore[misc]
    """Metaclass of scenes; calling the class makes a checked scene, as `make_scene` does."""

    def __call__(cls, *, discs: Mapping[str, Any] | None = None, **tables: Any) -> "Scene":
        if discs is not None:
            tables = {"start": {}} | tables
        return make_scene(tables, TextOrigin(), columns=discs)


class Scene(Document, metaclass=_SceneType):
    """A checked scene: its numbers are in range, its discs fit into the box, and its run ends.

    `Scene(box=…, run=…)` takes the tables of a scene as dictionaries or as instances of their classes. The argument
    `discs` is a dictionary of columns with the discs from which the scene starts; `idealgas.scene.start` describes the
    columns. An invalid scene raises SceneError.
    """

    _origin: TextOrigin = PrivateAttr(default_factory=TextOrigin)

    @model_validator(mode="after")
    def _check(self, info: ValidationInfo) -> Self:
        if self.start is not None:
            try:
                self._explicit = ExplicitDiscs(*read_start(self, **info.context or {}))
            except StartError as error:
                issue = Issue((("start", error.key), ("start",)), error.wrong, error.got, error.allowed)
                raise issues_error([issue]) from None
        if errors := list(issues(self)):
            raise issues_error(errors)
        return self

    def resolved(self) -> Self:
        """Return this scene with explicit values for the defaults that depend on other tables."""
        update: dict[str, Any] = {}
        sides = [{} if piston.inner else {"side": piston.wall} for piston in self.piston]
        update["piston"] = tuple(
            piston.model_copy(update={**side, "position": piston.start(self.box.size)})
            for piston, side in zip(self.piston, sides, strict=True)
        )
        if self.restitution and not self.restitution.elastic:
            update["restitution"] = self.restitution.model_copy(update={"contact_duration": self.contact_duration})
        if self.start and self.start.digest is None:
            known = {"number": len(self.explicit_discs), "digest": self.explicit_discs.digest}
            update["start"] = self.start.model_copy(update=known | dict(self._explicit.update))
        return self.model_copy(update=update)

    def with_origin(self, origin: TextOrigin) -> Self:
        """Set the origin of this scene and return the scene."""
        self._origin = origin
        return self

    def report(self, issues: Sequence[Issue]) -> list[str]:
        """Return a line, with file name and line number, for each issue detected after the scene was checked."""
        return self._origin.report(issues)


MOST_NAMED = 6
"""Largest number of different radii that are listed in the description of a gas."""

STATE = ("temperature", "position", "velocity")
"""Keys for the initial state and the temperature of a gas outside the tables of discs; `gas_digest` ignores them."""


def draws_random_numbers(scene: Scene) -> bool:
    """Return whether the initial state of a scene or its run depends on the seed."""
    drawn = scene.draws_velocities or any(s.count for _, s in scene.placed)
    return drawn or not scene.properties.isolated or scene.run.method == "monte_carlo"


def run_digest(scene: Scene) -> str:
    """Return the digest of everything that determines the motion of the discs.

    Logs with the same digest contain the same motion, possibly of different length. The digest does not depend on the
    tables `scene` (except for the seed), `run` and `log`.
    """
    tables = _tables(scene)
    if start := tables.get("start"):
        tables["start"] = {key: start[key] for key in ("digest", "velocities")}
    seed = scene.scene.seed if draws_random_numbers(scene) else None
    return _digest({name: value for name, value in tables.items() if name not in ("scene", "run", "log")} | {"": seed})


def gas_digest(scene: Scene) -> str:
    """Return the digest of the discs, the box and the effects of a scene, ignoring initial state and temperature."""
    left_out = ("scene", "run", "log", "species", "disc", "start")
    tables = {name: _without_state(value) for name, value in _tables(scene).items() if name not in left_out}
    box = {side: "thermal" if "thermal" in value else value for side, value in tables["box"].items()}
    fixed = [[*wall.start, wall.radius] for wall in scene.walls if wall.radius]
    return _digest([sorted(_discs(scene).items()), tables | {"box": box}, *fixed])


def gas_kind(scene: Scene) -> str:
    """Describe a gas by the sizes of its discs and by its effects, ignoring the number of discs and the box size."""
    sizes = _sizes(scene)
    smallest, number = min(sizes), sizes.total()
    if len(sizes) > MOST_NAMED:
        mean = math.fsum(radius * count for radius, count in sizes.items()) / number
        spread = math.sqrt(math.fsum((radius - mean) ** 2 * count for radius, count in sizes.items()) / number)
        parts = [f"radii of s.d. {spread / mean:.3g}, {smallest / mean:.3g} to {max(sizes) / mean:.3g} times the mean"]
    else:
        parts = [f"{count / number:.3g} of radius {radius / smallest:.3g}" for radius, count in sorted(sizes.items())]
    discs = f"mixture ({', '.join(parts)})" if len(sizes) > 1 else "equal discs"
    return ", ".join((discs, *(scene.effects or ("reflecting box",))))


def is_mixture(scene: Scene) -> bool:
    """Return whether the discs of a scene have different radii."""
    return len(_sizes(scene)) > 1


def describe_gas(scene: Scene) -> str:
    """Describe the gas in a scene by the number of discs, the size of the box, and the kind of gas."""
    width, height = scene.box.size
    number = _discs(scene).total()
    return f"N = {number} in {width:.6g} × {height:.6g}, {gas_kind(scene)}"


def _discs(scene: Scene) -> Counter[tuple[float, float]]:
    """Return the number of discs of each radius and mass."""
    discs: Counter[tuple[float, float]] = Counter()
    for size in scene.sizes:
        discs[size.radius, size.mass] += size.number
    discs.update(zip(scene.explicit_discs.radius.tolist(), scene.explicit_discs.mass.tolist(), strict=True))
    return +discs


def _sizes(scene: Scene) -> Counter[float]:
    """Return the number of discs of each radius."""
    sizes: Counter[float] = Counter()
    for (radius, _), count in _discs(scene).items():
        sizes[radius] += count
    return sizes


def _tables(scene: Scene) -> dict[str, Any]:
    """Return the tables with explicit defaults, in which polygonal lines are replaced by their pieces."""
    single = scene.resolved().model_copy(update={"wall": scene.pieces})
    return single.model_dump(mode="json", by_alias=True, exclude_none=True)


def _without_state(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_state(part) for key, part in value.items() if key not in STATE}
    return [_without_state(part) for part in value] if isinstance(value, list) else value


def _digest(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:32]


def make_scene(
    document: dict[str, Any],
    origin: TextOrigin,
    errors: Sequence[str] = (),
    *,
    columns: Mapping[str, Any] | None = None,
    discs: InitialDiscs | None = None,
) -> Scene:
    """Make a checked scene from a document.

    Args:
        document: tables by name.
        origin: origin of the document.
        errors: errors that have already been detected.
        columns: columns of the discs from which the scene starts, by name.
        discs: discs from which the scene starts, as stored in the log of this scene.

    Raises:
        SceneError: if the document has errors or `errors` is not empty.
    """
    try:
        origin.names = names_of(document)
        context = {"folder": origin.folder, "columns": columns, "discs": discs}
        scene = Scene.model_validate(document, context=context).resolved().with_origin(origin)
    except ValidationError as error:
        errors = [*errors, *origin.report(_all_issues(error, document))]
    if errors:
        raise SceneError(errors)
    return scene


def _all_issues(error: ValidationError, document: dict[str, Any]) -> list[Issue]:
    """Return the errors in single tables and the contradictions between tables that are valid in themselves."""
    findings = error.errors(include_url=False)
    if not findings[0]["loc"]:  # from the check of the whole scene, whose tables are all valid
        return as_issues(findings, Scene)
    parts, invalid = _valid_parts(document)
    return [*as_issues(findings, Scene), *issues(parts, invalid)]


def _valid_parts(document: dict[str, Any]) -> tuple[Scene, set[str]]:
    """Return the tables of a document, with None for each invalid table, and the names of the invalid tables."""
    parts: dict[str, Any] = {}
    invalid = set()
    for name, field in Scene.model_fields.items():
        table, value = table_at((name,), Scene), document.get(name)
        if value is not None and field.default == ():
            parts[name] = [_valid(table, item) for item in value] if isinstance(value, list) else [None]
            valid = None not in parts[name]
        elif value is not None or field.is_required():
            parts[name] = _valid(table, value)
            valid = parts[name] is not None
        else:
            valid = True
        if not valid:
            invalid.add(name)
    return Scene.model_construct(**parts), invalid


def _valid(table: type, value: Any) -> Any:
    try:
        return TypeAdapter(table).validate_python(value)
    except ValidationError:
        return None
