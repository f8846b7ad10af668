"""Tables in a sweep file, and checks of their contents."""

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from idealgas.catalogue import commands
from idealgas.scene.tables import AnalysisName
from idealgas.toml.dump import toml_value
from idealgas.toml.issues import Issue
from idealgas.toml.table import NotNegative, Number, Positive, Table

PHI, BASE = "phi", "base"
"""Keys of an axis that are not scene keys: the packing fraction, which scales the box, and the base scene."""


MOST_POINTS = 100_000
"""Largest number of runs in a sweep, counting all replicates of all points."""

Value = bool | int | float | str | tuple[Any, ...]
Count = Annotated[int, Field(ge=1, le=100_000)]


class Settings(Table):
    """Table `[sweep]`: base scene, seed, replicates and analyses."""

    scene: str | None = Field(default=None, description="path of the base scene, from this file's folder")
    seed: int = Field(default=0, ge=0, lt=2**63, description="whole number from which the points' seeds are derived")
    replicates: Count = Field(default=1, description="runs of each point that differ in their seeds, 1 to 100000")
    analyses: Annotated[tuple[AnalysisName, ...], Field(strict=False)] = Field(
        default=(), description=f"names of {', '.join(commands())}"
    )
    keep_logs: bool = Field(default=True, description="whether logs are kept after their analyses")


class Axis(Table):
    """Table `[[axis]]`: a key and its values. All axes are combined, but axes with the same `zip` vary together."""

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
    zip: str | None = Field(
        default=None, description="a word; axes with the same word vary together and have equal lengths"
    )

    @property
    def steps(self) -> list[Value]:
        """Values of the axis in order; whole numbers in a range are integers, as keys such as `count` require."""
        if self.range:
            steps = np.linspace(*self.range).tolist()
        elif self.log_range:
            steps = np.geomspace(*self.log_range).tolist()
        else:
            return list(self.values or ())
        return [round(step) if math.isclose(step, round(step), rel_tol=1e-12) else step for step in steps]


class Published(Table):
    """Table `[[published]]`: published values of a quantity, one for each combination of the axes, in order."""

    source: str = Field(description="the paper")
    quantity: str = Field(description='its name in results.csv, such as "run.events"')
    values: Annotated[tuple[Number, ...], Field(strict=False)] = Field(description="one for each point")
    errors: Annotated[tuple[NotNegative, ...], Field(strict=False)] = Field(
        default=(), description="their standard errors; exact if absent"
    )
    note: str = Field(default="", description="a known difference, in one sentence")


class SweepTables(Table):
    """Tables in a sweep file."""

    sweep: Settings = Field(
        default_factory=Settings, description="[sweep]: scene, seed, replicates, analyses, keep_logs"
    )
    axis: Annotated[tuple[Axis, ...], Field(strict=False)] = Field(default=(), description="[[axis]] tables")
    published: Annotated[tuple[Published, ...], Field(strict=False)] = Field(
        default=(), description="[[published]] tables"
    )
    base: dict[str, Any] | None = Field(default=None, description="[base.box] and so on: a scene's tables")


def axis_groups(axes: Sequence[Axis]) -> list[list[tuple[tuple[int, Value], ...]]]:
    """Return the groups of axes that vary together.

    Each group is a list of steps. A step is a tuple of pairs (number of the axis, value).
    """
    together: dict[Any, list[int]] = {}
    for i, axis in enumerate(axes):
        together.setdefault(axis.zip or i, []).append(i)
    return [
        list(zip(*([(i, value) for value in axes[i].steps] for i in members), strict=True))
        for members in together.values()
    ]


def table_errors(tables: SweepTables) -> Iterator[Issue]:
    """Yield errors that involve several tables."""
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
        if any(name != name.strip() for name in axis.key.split(".")):
            yield Issue((("axis", i, "key"),), "blanks in a key", toml_value(axis.key), "names between dots")
        if axis.key in seen:
            yield Issue((("axis", i, "key"),), "second axis of this key", axis.key, "one axis for each key")
        seen.add(axis.key)
        if axis.zip is not None and lengths.setdefault(axis.zip, len(axis.steps)) != len(axis.steps):
            got, allowed = f"{len(axis.steps)} values", f"{lengths[axis.zip]}, as for the others with zip = {axis.zip}"
            yield Issue((("axis", i, "zip"),), "length differs from the other axes with this zip", got, allowed)


def size_errors(tables: SweepTables) -> Iterator[Issue]:
    """Yield an error if a sweep has too many runs; to be called before the points are made."""
    numbers = [len(group) for group in axis_groups(tables.axis)]
    total = math.prod(numbers) * tables.sweep.replicates
    if total > MOST_POINTS:
        product_of = " x ".join(f"{number:,}" for number in (*numbers, tables.sweep.replicates))
        key = ("axis", 0) if numbers else ("sweep", "replicates")
        yield Issue((key,), "too many runs", f"{product_of} = {total:,}", f"at most {MOST_POINTS:,}")


def published_errors(published: Sequence[Published], combinations: int) -> Iterator[Issue]:
    """Yield an error for each list of published values that does not have one number per combination of the axes."""
    for i, paper in enumerate(published):
        for name, numbers in (("values", paper.values), ("errors", paper.errors)):
            if len(numbers) != combinations and (numbers or name == "values"):
                got = f"{len(numbers)} numbers"
                yield Issue((("published", i, name),), "not one for each point", got, f"{combinations}")
