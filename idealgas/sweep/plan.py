"""Plan of a sweep: a base scene, axes whose values change it, and the resulting points, each with its scene."""

import copy
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from idealgas.scene import Scene, SceneError
from idealgas.scene.scene import make_scene
from idealgas.sweep.tables import (
    BASE,
    PHI,
    Axis,
    Published,
    SweepTables,
    Value,
    axis_groups,
    published_errors,
    size_errors,
    table_errors,
)
from idealgas.toml.dump import toml_value
from idealgas.toml.issues import Key, as_issues
from idealgas.toml.overrides import OverrideError, apply
from idealgas.toml.text import TextOrigin, parse_document, read_text


@dataclass(frozen=True)
class Point:
    """A point of a sweep: a single run.

    Attributes:
        index: number of the point.
        combination: number of its combination of values.
        replicate: number of its replicate.
        values: value on each axis, by the key of the axis, in the order of the axes.
        scene: scene to be run.
    """

    index: int
    combination: int
    replicate: int
    values: dict[str, Value]
    scene: Scene


@dataclass(frozen=True)
class Sweep:
    """A sweep: its runs and the analyses of each run.

    Attributes:
        analyses: names of the analyses that are applied to each point.
        keep_logs: whether logs are kept.
        points: all runs.
        seed: seed from which the seeds of all points are derived.
        text: text of the sweep file, which is copied to the folder of the sweep.
        published: published values.
    """

    analyses: tuple[str, ...]
    keep_logs: bool
    points: tuple[Point, ...]
    seed: int
    text: str
    published: tuple[Published, ...] = ()


def load_sweep(
    path: str | PathLike[str],
    overrides: Sequence[str] = (),
    on_progress: Callable[[int, int], None] = lambda done, total: None,
) -> Sweep:
    """Read a sweep file and make all points of the sweep.

    Args:
        path: path of the file.
        overrides: changes "table.key=value" to a table of the file ("sweep.replicates=2") or to every base scene
            ("run.events=1000").
        on_progress: function that is called with the number of combinations of values that have been checked, and the
            total number of combinations.

    Raises:
        SceneError: with all errors in the file, in its base scenes and in its points.
    """
    text, name = read_text(path).replace("\r\n", "\n"), str(path)
    document = parse_document(text, name)
    of_sweep = [override for override in overrides if override.split(".")[0].strip() in SweepTables.model_fields]
    of_scene = [override for override in overrides if override not in of_sweep]
    origin = TextOrigin(text, name, _override(document, of_sweep))
    try:
        tables = SweepTables.model_validate(document)
    except ValidationError as error:
        raise SceneError(origin.report(as_issues(error.errors(include_url=False), SweepTables))) from None
    if issues := list(table_errors(tables)) or list(size_errors(tables)):
        raise SceneError(origin.report(issues))
    points = tuple(_points(tables, _bases(tables, Path(path), origin, of_scene), origin, on_progress))
    head = [f"# sweep of {len(points)} points by idealgas", *(f"# --set {toml_value(text)}" for text in overrides)]
    settings, text = tables.sweep, "\n".join([*head, text])
    combinations = points[-1].combination + 1
    if issues := list(published_errors(tables.published, combinations)):
        raise SceneError(origin.report(issues))
    return Sweep(settings.analyses, settings.keep_logs, points, settings.seed, text, tables.published)


def _override(document: dict[str, Any], overrides: Iterable[str]) -> dict[Key, str]:
    """Apply overrides to a document, and return each override by the key that it sets. Raises SceneError."""
    places: dict[Key, str] = {}
    for override in overrides:
        place = f"--set {override}"
        places[_apply(override, document, place)] = place
    return places


Base = tuple[dict[str, Any], TextOrigin]


def _bases(tables: SweepTables, path: Path, origin: TextOrigin, overrides: Sequence[str]) -> dict[Value | None, Base]:
    """Return the base scenes, with overrides, by their value on the axis "base"; a single base scene has key None."""
    bases: dict[Value | None, Base]
    if tables.base is not None:
        places = {key[1:]: place for key, place in origin.overridden.items() if key[0] == "base"}
        bases = {None: (tables.base, TextOrigin(origin.text, origin.name, places, above=("base",)))}
    elif tables.sweep.scene is not None:
        bases = {None: _read_base(path.parent / tables.sweep.scene)}
    else:
        (axis,) = (axis for axis in tables.axis if axis.key == BASE)
        bases = {value: _read_base(path.parent / str(value)) for value in axis.steps}
    return {value: (document, _placed(o, _override(document, overrides))) for value, (document, o) in bases.items()}


def _read_base(path: Path) -> Base:
    text = read_text(path).replace("\r\n", "\n")
    return parse_document(text, str(path)), TextOrigin(text, str(path))


# ── points ──


def _points(
    tables: SweepTables, bases: dict[Value | None, Base], origin: TextOrigin, on_progress: Callable[[int, int], None]
) -> Iterator[Point]:
    """Return the points in the order of the axes; the last axis varies fastest, and replicates are consecutive."""
    settings, groups = tables.sweep, axis_groups(tables.axis)
    total = math.prod(map(len, groups))
    errors: dict[str, None] = {}  # a dict, so that each line is listed only once
    points: list[Point] = []
    for combination, steps in enumerate(product(*groups)):
        on_progress(combination, total)
        pairs = [pair for step in steps for pair in step]
        try:
            scene = _scene(tables.axis, pairs, bases, origin)
        except SceneError as error:
            errors |= dict.fromkeys(error.errors)
            continue
        values = {tables.axis[i].key: value for i, value in sorted(pairs, key=lambda pair: pair[0])}
        for replicate in range(settings.replicates):
            seeded = with_seed(scene, seed_of(settings.seed, combination, replicate))
            points.append(Point(len(points), combination, replicate, values, seeded))
    if errors:
        raise SceneError(list(errors))
    return iter(points)


def _scene(
    axes: Sequence[Axis], pairs: Sequence[tuple[int, Value]], bases: dict[Value | None, Base], origin: TextOrigin
) -> Scene:
    """Return the scene for a combination of values, each given with the number of its axis. Raises SceneError."""
    base, base_origin = bases[next((value for i, value in pairs if axes[i].key == BASE), None)]
    document = copy.deepcopy(base)
    places: dict[Key, str] = {}
    for i, value in sorted(pairs, key=lambda pair: axes[pair[0]].key == PHI):  # phi depends on the discs
        key, line = axes[i].key, origin.line(("axis", i, "key"))
        place = f"{origin.name}:{line}: {key} = {toml_value(value)}"
        if key == BASE:
            continue
        if key == PHI:
            scale_box(document, make_scene(document, _placed(base_origin, places)), value, place)
            places[("box", "size")] = place
            continue
        changed = _apply(f"{key}={toml_value(value)}", document, place)
        for earlier, by in (*base_origin.overridden.items(), *places.items()):
            if earlier[: len(changed)] == changed:
                raise SceneError([f"{place}: replaces the value of {by}"])
        places[changed] = place
    return make_scene(document, _placed(base_origin, places))


def _placed(origin: TextOrigin, places: Mapping[Key, str]) -> TextOrigin:
    """Return the origin of a document in which the keys at the given places have been changed."""
    return TextOrigin(origin.text, origin.name, {**origin.overridden, **places}, origin.above)


def _apply(override: str, document: dict[str, Any], place: str) -> Key:
    """Apply an override to a document, and return its key. Raises SceneError."""
    before = _seed(document)
    try:
        key = apply(override, document)
    except OverrideError as error:
        raise SceneError([f"{place}: {error}"]) from None
    if _seed(document) != before:
        allowed = "sweep.seed and sweep.replicates, from which the seeds of all points are derived"
        raise SceneError([f"{place}: the seed of a scene cannot be chosen in a sweep (allowed {allowed})"])
    return key


def _seed(document: dict[str, Any]) -> Any:
    scene = document.get("scene")
    return scene.get("seed") if isinstance(scene, dict) else None


def with_seed(scene: Scene, seed: int) -> Scene:
    """Return the scene with another seed."""
    return scene.model_copy(update={"scene": scene.scene.model_copy(update={"seed": seed})})


def seed_of(seed: int, combination: int, replicate: int) -> int:
    """Return the seed for the scene of a point; it does not depend on other points or on the worker that runs it."""
    drawn = np.random.SeedSequence(seed, spawn_key=(combination, replicate)).generate_state(1, np.uint64)
    return int(drawn[0]) >> 1


def scale_box(document: dict[str, Any], scene: Scene, phi: Value, place: str) -> None:
    """Scale the box in a document so that its discs have packing fraction phi.

    Args:
        document: document to change.
        scene: scene of the document.
        phi: packing fraction.
        place: place of the value of phi, with which error messages begin.

    Raises:
        SceneError: if phi is not a packing fraction, or if something in the scene has a fixed position in the box.
    """
    fixed = ["start" if scene.start else "disc"] if len(scene.explicit_discs) else []
    fixed += [str(effect.keys[0][0]) for effect in scene.active_effects if not effect.properties.is_scalable]
    fixed += ["species.region"] if any(s.region for s in scene.species) else []
    if fixed:
        allowed = "a scene in which nothing has a fixed position in the box"
        raise SceneError([f"{place}: phi scales only the box (got a scene with {', '.join(fixed)}; allowed {allowed})"])
    if isinstance(phi, bool) or not isinstance(phi, int | float) or not 0 < phi < 1:
        raise SceneError([f"{place}: not a packing fraction (got {toml_value(phi)}; allowed 0 < phi < 1)"])
    width, height = scene.box.size
    scale = math.sqrt(scene.covered_area / (phi * width * height))
    document["box"]["size"] = [width * scale, height * scale]
