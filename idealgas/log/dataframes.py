"""Convert the rows of a log to columns with one number per row, for tables in other programs."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.columns import EventBatch, Kind, columns_named, empty_batch
from idealgas.errors import install
from idealgas.log.errors import LogError
from idealgas.log.flights import FLIGHT_COLUMNS, NO_EVENT, Flights
from idealgas.log.replay import LogState
from idealgas.log.schema import VECTORS, Wall, components
from idealgas.state import Gas

if TYPE_CHECKING:
    from pandas import DataFrame

Columns = dict[str, np.ndarray]

KIND_NAMES = tuple(kind.name.lower() for kind in Kind)
"""Names of the codes in the event column `kind`."""

CHOSEN_BY = {
    "events": ("disc", "t0", "t1"),
    "flights": ("disc", "times"),
    "discs": ("disc", "times"),
    "observables": ("t0", "t1"),
}
"""Arguments of `Log.to_pandas` that select rows, by table."""


def flat(values: Mapping[str, Any], vectors: Mapping[str, Sequence[str]] = VECTORS) -> Columns:
    """Split columns of shape (n, components) into columns of shape (n,).

    Args:
        values: columns by name; None for a missing column.
        vectors: names of the components, by column; components without names are numbered, as in name_0_1.

    Returns:
        Columns of shape (n,), by name.
    """
    columns: Columns = {}
    for name, column in values.items():
        if name in vectors and column is not None:
            columns |= dict(zip(vectors[name], np.ascontiguousarray(column.T), strict=True))
        elif column is not None and column.ndim > 1:
            for index in np.ndindex(column.shape[1:]):
                columns["_".join(map(str, (name, *index)))] = column[:, *index]
        elif column is not None:
            columns[name] = column
    return columns


def flat_events(blocks: Iterable[EventBatch], names: Sequence[str]) -> Iterator[Columns]:
    """Yield the columns of event rows, block by block; `kind` is an index into KIND_NAMES.

    The first block is empty, so that even a log without events has columns.

    Args:
        blocks: blocks of event rows.
        names: names of the event columns of the log.
    """
    yield flat(empty_batch(0, columns_named(names))._asdict())
    for block in blocks:
        yield flat(block._asdict())


def flat_flights(batches: Iterable[Flights]) -> Iterator[Columns]:
    """Yield the columns of flights, batch by batch.

    `kind` is an index into KIND_NAMES, or -1 if the flight does not end with an event.
    """
    for batch in batches:
        columns = flat(batch._asdict(), {column.name: column.parts for column in FLIGHT_COLUMNS if column.parts})
        yield columns | {"kind": np.where(batch.kind == NO_EVENT, -1, batch.kind.astype(np.int8))}


def flat_discs(gas: Gas, states: Iterable[LogState], disc: int | None = None) -> Iterator[Columns]:
    """Yield the columns of each state, with one row per disc; `species` is an index into `gas.species_names`.

    Args:
        gas: the discs.
        states: states of the discs.
        disc: id of the only disc to include; None for all discs.
    """
    ids = np.arange(len(gas), dtype=np.uint32)
    chosen = ids if disc is None else ids[ids == disc]
    for state in states:
        values = state._asdict()
        time = np.full(len(ids), values.pop("time"))
        if (here := state.inside).any() and np.isnan(state.position[here]).all():  # discs without positions
            del values["position"]
        fixed = {"time": time, "disc": ids, "species": gas.species, "radius": gas.radius, "mass": gas.mass}
        yield {name: column[chosen] for name, column in (fixed | flat(values)).items()}


def flat_samples(
    observables: Mapping[str, tuple[np.ndarray, np.ndarray]], walls: Sequence[Wall], t0: float | None, t1: float | None
) -> Columns:
    """Return the times and values of the samples at t0 ≤ t < t1 as columns.

    Args:
        observables: times (s,) and values (s, …), by name.
        walls: walls of the log, whose names become part of the names of components.
        t0: start of the window; None to begin with the first sample.
        t1: end of the window; None to include the last sample.
    """
    time = next((time for time, _ in observables.values()), np.empty(0))
    rows = slice(*time.searchsorted([-np.inf if t0 is None else t0, np.inf if t1 is None else t1]))
    return flat(
        {"time": time[rows]} | {name: values[rows] for name, (_, values) in observables.items()},
        components([wall.name for wall in walls]),
    )


def check_choice(path: Path, table: str, choice: Mapping[str, Any]) -> None:
    """Raise LogError if the table is unknown or if an argument in `choice`, by name, does not apply to it."""
    if table not in CHOSEN_BY:
        raise LogError(f"{path}: no table of {table} (allowed: {', '.join(CHOSEN_BY)})")
    if useless := [name for name, value in choice.items() if value is not None and name not in CHOSEN_BY[table]]:
        allowed = ", ".join(CHOSEN_BY[table])
        raise LogError(f"{path}: {', '.join(useless)} does not apply to {table} (allowed: {allowed})")


def data_frame(blocks: Iterable[Columns], categories: Mapping[str, Sequence[str]]) -> "DataFrame":
    """Return a DataFrame with the rows of all blocks.

    Args:
        blocks: columns of each block, by name.
        categories: names of the codes in a categorical column, by column.

    Raises:
        LogError: if pandas is missing.
    """
    try:
        from pandas import Categorical, DataFrame
    except ModuleNotFoundError as error:
        raise LogError(f"to_pandas requires {error.name}: {install('notebook')}") from error
    parts: dict[str, list[np.ndarray]] = {}
    for block in blocks:
        for name, column in block.items():
            parts.setdefault(name, []).append(column)
    whole: dict[str, Any] = {
        name: np.concatenate(parts.pop(name)) for name in tuple(parts)
    }  # popped one by one to avoid holding all data in memory twice
    for name, words in categories.items():
        whole[name] = Categorical.from_codes(whole[name], categories=list(words))
    return DataFrame(whole, copy=False)
