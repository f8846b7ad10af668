"""Plan of a sweep: a base scene, axes of values that change it, and the resulting points, each with its scene."""

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from os import PathLike
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from idealgas.catalogue import commands
from idealgas.scene import Scene, SceneError
from idealgas.scene.scene import make_scene
from idealgas.scene.tables import AnalysisName
from idealgas.toml.dump import toml_value
from idealgas.toml.issues import Issue, Key, as_issues
from idealgas.toml.overrides import OverrideError, apply
from idealgas.toml.table import NotNegative, Number, Positive, Table
from idealgas.toml.text import Origin, parse_document, read_text

PHI, BASE = "phi", "base"
"""Keys of axes in addition to those of a scene: packing fraction, by scaling the box, and path of the base scene."""


Value = bool | int | float | str | tuple[Any, ...]
Count = Annotated[int, Field(ge=1, le=100_000)]


class Settings(Table):
    """Table `[sweep]`: base scene, seed, replicates and analyses."""

    scene: str | None = Field(default=None, description="path of the base scene, from this file's folder")
    seed: int = Field(default=0, ge=0, lt=2**63, description="whole number from which the seeds of all points follow")
    replicates: Count = Field(default=1, description="runs of each point that differ in their seeds, 1 to 100000")
    analyses: Annotated[tuple[AnalysisName, ...], Field(strict=False)] = Field(
        default=(), description=f"names of {', '.join(commands())}"
    )
    keep_logs: bool = Field(default=True, description="whether the logs stay after their analyses")


class Axis(Table):
    """Table `[[axis]]`: one key and its values; axes are combined with each other, those of the same `zip` in step."""

    key: str = Field(description='a key of the scene, as for --set, or "phi" or "base"')
    values: Annotated[tuple[Any, ...], Field(strict=False, min_length=1)] | None = Field(
        default=None, description="at least one value"
    )
    range: Annotated[tuple[Number, Number, Count], Field(strict=False)] | None = Field(
        default=None, description="[first, last, number of values]"
    )
    log_range: Annotated[tuple[Positive, Positive, Count], Field(strict=False)] | None = Field(
        default=None, description="[first, last, number of values], first and last > 0"
    )
    zip: str | None = Field(default=None, description="a word; axes of one word are as long as one another")

    @property
    def steps(self) -> list[Value]:
        """Values of the axis in order; whole numbers of a range are integers, which keys such as `count` need."""
        if self.range:
            steps = np.linspace(*self.range).tolist()
        elif self.log_range:
            steps = np.geomspace(*self.log_range).tolist()
        else:
            return list(self.values or ())
        return [round(step) if math.isclose(step, round(step), rel_tol=1e-12) else step for step in steps]


class Published(Table):
    """Table `[[published]]`: values of a quantity in a paper, one for each combination of the axes, in their order."""

    source: str = Field(description="the paper")
    quantity: str = Field(description='its name in results.csv, such as "run.events"')
    values: Annotated[tuple[Number, ...], Field(strict=False)] = Field(description="one for each point")
    errors: Annotated[tuple[NotNegative, ...], Field(strict=False)] = Field(
        default=(), description="their standard errors; none: exact"
    )
    note: str = Field(default="", description="a known difference, in one sentence")


class Tables(Table):
    """Tables of the file of a sweep."""

    sweep: Settings = Field(
        default_factory=Settings, description="[sweep]: scene, seed, replicates, analyses, keep_logs"
    )
    axis: Annotated[tuple[Axis, ...], Field(strict=False)] = Field(default=(), description="[[axis]] tables")
    published: Annotated[tuple[Published, ...], Field(strict=False)] = Field(
        default=(), description="[[published]] tables"
    )
    base: dict[str, Any] | None = Field(default=None, description="[base.box] and so on: a scene's tables")


@dataclass(frozen=True)
class Point:
    """One point of a sweep: one run.

    index: number of the point. combination: number of its combination of values. replicate: number of its replicate.
    values: value of each axis, by its key, in the order of the axes. scene: the scene to run.
    """

    index: int
    combination: int
    replicate: int
    values: dict[str, Value]
    scene: Scene


@dataclass(frozen=True)
class Sweep:
    """A whole sweep.

    analyses: names of the analyses of each point. keep_logs: whether logs are kept. points: all runs. seed: from which
    their seeds follow. text: the file of the sweep, for its folder. published: values of papers.
    """

    analyses: tuple[str, ...]
    keep_logs: bool
    points: tuple[Point, ...]
    seed: int
    text: str
    published: tuple[Published, ...] = ()


def load_sweep(path: str | PathLike[str]) -> Sweep:
    """Read the file of a sweep and make all of its points.

    Raises:
        SceneError: with all errors of the file, of its base scenes and of its points.
    """
    text, name = read_text(path).replace("\r\n", "\n"), str(path)
    document = parse_document(text, name)
    origin = Origin(text, name)
    try:
        tables = Tables.model_validate(document)
    except ValidationError as error:
        raise SceneError(origin.report(as_issues(error.errors(include_url=False), Tables))) from None
    if found := list(_errors(tables)):
        raise SceneError(origin.report(found))
    points = tuple(_points(tables, _bases(tables, Path(path), origin), origin))
    settings, text = tables.sweep, f"# sweep of {len(points)} points by idealgas\n{text}"
    combinations = points[-1].combination + 1
    if found := list(_wrong_numbers(tables.published, combinations)):
        raise SceneError(origin.report(found))
    return Sweep(settings.analyses, settings.keep_logs, points, settings.seed, text, tables.published)


Base = tuple[dict[str, Any], Origin]


def _bases(tables: Tables, path: Path, origin: Origin) -> dict[Value | None, Base]:
    """Base scenes by their value of the axis "base"; a single base scene has the key None."""
    if tables.base is not None:
        return {None: (tables.base, Origin(origin.text, origin.name, above=("base",)))}
    if tables.sweep.scene is not None:
        return {None: _read_base(path.parent / tables.sweep.scene)}
    (axis,) = (axis for axis in tables.axis if axis.key == BASE)
    return {value: _read_base(path.parent / str(value)) for value in axis.steps}


def _read_base(path: Path) -> Base:
    text = read_text(path).replace("\r\n", "\n")
    return parse_document(text, str(path)), Origin(text, str(path))


def _errors(tables: Tables) -> Iterator[Issue]:
    """Errors that concern several tables."""
    along = [i for i, axis in enumerate(tables.axis) if axis.key == BASE]
    given = ["sweep.scene"] * (tables.sweep.scene is not None) + ["[base]"] * (tables.base is not None)
    given += ["an axis base"] * bool(along)
    if len(given) != 1:
        allowed = "one of sweep.scene, [base] tables, and an axis base of paths"
        yield Issue((("sweep", "scene"), ("base",)), "not one base scene", " and ".join(given) or "nothing", allowed)
    for i in along:
        if not all(isinstance(value, str) for value in tables.axis[i].steps):
            yield Issue((("axis", i, "values"),), "not paths of scenes", toml_value(tables.axis[i].steps), "texts")
    seen: set[str] = set()
    lengths: dict[str, int] = {}
    for i, axis in enumerate(tables.axis):
        given = [name for name in ("values", "range", "log_range") if getattr(axis, name) is not None]
        if len(given) != 1:
            got = " and ".join(given) or "nothing"
            yield Issue((("axis", i),), "not one list of values", got, "exactly one of values, range and log_range")
        if axis.key == "scene.seed":
            yield Issue((("axis", i, "key"),), "seeds are not an axis", axis.key, "sweep.seed and sweep.replicates")
        if axis.key in seen:
            yield Issue((("axis", i, "key"),), "second axis of this key", axis.key, "one axis for each key")
        seen.add(axis.key)
        if axis.zip is not None and lengths.setdefault(axis.zip, len(axis.steps)) != len(axis.steps):
            got, allowed = f"{len(axis.steps)} values", f"{lengths[axis.zip]}, as the others of zip = {axis.zip}"
            yield Issue((("axis", i, "zip"),), "not as long as the axes it goes along with", got, allowed)


def _wrong_numbers(published: Sequence[Published], combinations: int) -> Iterator[Issue]:
    """Errors of lists of published values that are not as long as the sweep has points without replicates."""
    for i, one in enumerate(published):
        for name, numbers in (("values", one.values), ("errors", one.errors)):
            if len(numbers) != combinations and (numbers or name == "values"):
                got = f"{len(numbers)} numbers"
                yield Issue((("published", i, name),), "not one for each point", got, f"{combinations}")


# ── points ──


def _points(tables: Tables, bases: dict[Value | None, Base], origin: Origin) -> Iterator[Point]:
    """Points in the order of the axes, the last axis changing fastest, with replicates of a point together."""
    settings = tables.sweep
    errors: dict[str, None] = {}  # each line once
    points: list[Point] = []
    for combination, steps in enumerate(product(*_groups(tables.axis))):
        pairs = [pair for step in steps for pair in step]
        pairs.sort(key=lambda pair: tables.axis[pair[0]].key == PHI)  # last, as it depends on the discs
        base, base_origin = bases[next((value for i, value in pairs if tables.axis[i].key == BASE), None)]
        document = copy.deepcopy(base)
        places: dict[Key, str] = {}
        try:
            for i, value in pairs:
                axis, line = tables.axis[i], origin.line(("axis", i, "key"))
                place = f"{origin.name}:{line}: {axis.key} = {toml_value(value)}"
                if axis.key == BASE:
                    continue
                if axis.key == PHI:
                    places[("box", "size")] = place
                    scale_box(document, make_scene(document, _placed(base_origin, places)), value, place)
                else:
                    places[_apply(axis.key, value, document, place)] = place
            for replicate in range(settings.replicates):
                document.setdefault("scene", {})["seed"] = seed_of(settings.seed, combination, replicate)
                scene = make_scene(document, _placed(base_origin, places))
                named = {tables.axis[i].key: value for i, value in sorted(pairs, key=lambda pair: pair[0])}
                points.append(Point(len(points), combination, replicate, named, scene))
        except SceneError as error:
            errors |= dict.fromkeys(error.errors)
    if errors:
        raise SceneError(list(errors))
    return iter(points)


def _groups(axes: Sequence[Axis]) -> list[list[tuple[tuple[int, Value], ...]]]:
    """Groups of axes that are combined; each is a list of steps that give one or more axes (by number) a value."""
    together: dict[Any, list[int]] = {}
    for i, axis in enumerate(axes):
        together.setdefault(axis.zip or i, []).append(i)
    return [
        list(zip(*([(i, value) for value in axes[i].steps] for i in members), strict=True))
        for members in together.values()
    ]


def _placed(origin: Origin, places: dict[Key, str]) -> Origin:
    return Origin(origin.text, origin.name, places, origin.above)


def _apply(key: str, value: Value, document: dict[str, Any], place: str) -> Key:
    try:
        return apply(f"{key}={toml_value(value)}", document)
    except OverrideError as error:
        raise SceneError([f"{place}: {error}"]) from None


def seed_of(seed: int, combination: int, replicate: int) -> int:
    """Seed of the scene of one point; it depends neither on other points nor on the worker that runs it."""
    drawn = np.random.SeedSequence(seed, spawn_key=(combination, replicate)).generate_state(1, np.uint64)
    return int(drawn[0]) >> 1


def scale_box(document: dict[str, Any], scene: Scene, phi: Value, place: str) -> None:
    """Scale the box of a document so that its discs have the packing fraction phi.

    Raises:
        SceneError: if phi is not a packing fraction, or if the scene has parts with positions in the box.
    """
    fixed = ["start" if scene.start else "disc"] if len(scene.given) else []
    fixed += [str(effect.keys[0][0]) for effect in scene.active_effects if not effect.properties.is_scalable]
    fixed += ["species.region"] if any(s.region for s in scene.species) else []
    if fixed:
        allowed = "a scene in which nothing but the box has a place"
        raise SceneError([f"{place}: the box alone is scaled (got a scene with {', '.join(fixed)}; allowed {allowed})"])
    if isinstance(phi, bool) or not isinstance(phi, int | float) or not 0 < phi < 1:
        raise SceneError([f"{place}: not a packing fraction (got {toml_value(phi)}; allowed 0 < phi < 1)"])
    width, height = scene.box.size
    scale = math.sqrt(scene.covered_area / (phi * width * height))
    document["box"]["size"] = [width * scale, height * scale]
