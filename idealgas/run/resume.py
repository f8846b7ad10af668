"""Resuming a run from the last checkpoint of its log, with bit for bit the same events as in an uninterrupted run."""

import os
from collections.abc import Callable, Sequence

from idealgas.columns import empty_batch
from idealgas.effects.bundle import Effects
from idealgas.engine.monte_carlo import V_REF
from idealgas.engine.simulation import TRAJECTORY, Simulation, Stop, Totals
from idealgas.files import IN_USE
from idealgas.jit import compile_seconds
from idealgas.log import Checkpoint, DamageError, Log, LogError, LogLayout, LogWriter, open_log
from idealgas.log.recovery import recover
from idealgas.log.schema import CHECKPOINT_COLUMNS
from idealgas.log.summary import Summary
from idealgas.physics.exact_sum import SumRangeError
from idealgas.run.effects import make_effects
from idealgas.run.energy import energy_of
from idealgas.run.layout import layout_of, restore, row_columns, totals
from idealgas.run.logged_run import LoggedRun, Progress, RunHistory, stop_of
from idealgas.run.simulate import method_of
from idealgas.scene import Scene, parse_scene
from idealgas.state import Gas
from idealgas.toml.dump import dump_document

REPLAYED_ROWS = 4096  # number of rows after the checkpoint that must be reproduced before the run is resumed

STOP_RULES = ("until", "events", "collisions_per_disc", "trials")
"""Keys of [run] that end a run; only these keys may change when a run is resumed."""


def resume(
    path: str | os.PathLike[str],
    overrides: Sequence[str] = (),
    *,
    command: str = "",
    on_progress: Callable[[Progress], None] = lambda progress: None,
    interrupted: Callable[[], bool] = lambda: False,
) -> Summary:
    """Continue an interrupted or killed run from the last checkpoint of its log, or extend a run to a later end.

    The log then contains, bit for bit, the events of an uninterrupted run. If the log is already complete, its events
    remain unchanged, and its summary is returned.

    Args:
        path: path of the log, to which events are appended.
        overrides: new ends of the run, such as "run.until=100" or "run.events=1000000" (any of STOP_RULES; other stop
            rules remain unless they are removed, as in "run.until=").
        command: as in `simulate`.
        on_progress: as in `simulate`.
        interrupted: as in `simulate`.

    Returns:
        The summary of the whole run.

    Raises:
        SceneError: an override is invalid.
        LogError or OutputError: another process is writing the log, this program or the changed scene does not
            reproduce its events, the log is already past the new end, or the log cannot be written.
    """
    compiled_before = compile_seconds()
    with open_log(path) as log:
        if log.live:
            raise LogError(f"{log.path}: {IN_USE}")
        text, scene = _scene_to_resume(log, overrides)
        new_end = dump_document(scene) != dump_document(log.scene)
        if new_end:
            _check_end(log, scene)
        done = Summary.of(log.summary) if log.complete and not new_end else None
        unclosed = log.unclosed
        if done is None:
            last = log.checkpoints[-1] if len(log.checkpoints) else None
            _check_reproduces(log, last, _simulation_at(log, last, scene))
            simulation = _simulation_at(log, last, scene)
            past = _history_of(log, last, scene)
    if done is not None:
        if unclosed:  # the disk failed during the very last write
            recover(path)
        return done
    with LogWriter.resume(
        path, None if last is None else -1, fsync=scene.log.fsync, scene_text=text, command=command, commit=log.commit
    ) as writer:
        return LoggedRun(scene, simulation, writer, past, compiled_before).finish(on_progress, interrupted)


def _scene_to_resume(log: Log, overrides: Sequence[str]) -> tuple[str, Scene]:
    """Return the text of the scene with the new end, and this scene with the changes made by a Python program."""
    if (made_with := log.attributes["trajectory"]) != TRAJECTORY:
        versions = f"made with version {made_with} of the laws of motion; this program has version {TRAJECTORY}"
        raise LogError(f"{log.path}: cannot be resumed: {versions}")
    before, given, name = log.scene, log.initial_discs, f"{log.path}: scene"
    requested = scene = parse_scene(log.scene_text, name, overrides, discs=given)
    if log.changes:
        scene = parse_scene(log.scene_text, name, overrides, discs=given, changes=log.changes)
    run = before.run.model_copy(update={key: getattr(scene.run, key) for key in (*STOP_RULES, "threads")})
    expected = before.model_copy(update={"run": run})
    changed = [name for name in Scene.model_fields if getattr(scene, name) != getattr(expected, name)]
    if changed:
        tables = " and ".join(f"[{name}]" for name in changed)
        raise LogError(f"{log.path}: cannot be resumed with another {tables}: only {', '.join(STOP_RULES)} may change")
    return dump_document(requested), scene


def _check_end(log: Log, scene: Scene) -> None:
    """Raise LogError if the new end is before the end of the log, or is a number that has already been reached."""
    run, n = scene.run, len(log.discs)
    stop, time = stop_of(scene, n), log.end_time
    events, collisions, trials = log.counts.values()
    for passed, limit, reached, unit in (
        (time > stop.time, run.until, time, "units of time"),
        (events >= stop.events, run.events, events, "events"),
        (collisions >= stop.disc_collisions, run.collisions_per_disc, 2 * collisions / n, "collisions per disc"),
        (trials >= stop.trials, run.trials, trials, "trials"),
    ):
        if passed and limit is not None:
            where = "is earlier" if limit < reached else "is not a later end"
            raise LogError(f"{log.path}: already at {reached:,.12g} {unit}; {limit:,.12g} {where}")


def _simulation_at(log: Log, checkpoint: Checkpoint | None, scene: Scene) -> Simulation:
    """Return the simulation of a scene at a checkpoint, or at its start."""
    start = log.discs
    effects = make_effects(scene, start)
    v_ref = None if checkpoint is None else checkpoint.values.get(V_REF.name)
    method = method_of(scene, start, v_ref)
    _check_columns(log, layout_of(scene, start, effects, method.has_positions, method.extra_state))
    if checkpoint is None:
        return Simulation(start, method, effects)
    gas = _restored(log, effects, checkpoint)
    done = Totals(**{column.name: int(checkpoint.values[column.name]) for column in totals(effects)})
    return Simulation(gas, method, effects, checkpoint.time, checkpoint.epoch, done)


def _restored(log: Log, effects: Effects, checkpoint: Checkpoint) -> Gas:
    """Return the gas at a checkpoint and set the effects to their state there."""
    try:
        return restore(log.discs, effects, checkpoint)
    except SumRangeError as error:
        raise DamageError(log.path, f"checkpoints at t = {checkpoint.time:g}: {error}") from error


def _check_columns(log: Log, layout: LogLayout) -> None:
    """Raise DamageError if a column of the log does not belong to a run of its scene, or has a wrong type or shape."""
    discs = len(log.discs)
    arrays = [column._replace(shape=(discs, *column.shape)) for column in layout.checkpoint_arrays]
    kept = [*CHECKPOINT_COLUMNS, *arrays, *layout.checkpoint_values]
    for table, columns in {"checkpoints": kept, "observables": layout.observables}.items():
        known = {column.name: (column.dtype, column.shape) for column in columns}
        for column in log.stored(table):
            if known.get(column.name) != (column.dtype, column.shape):
                raise DamageError(log.path, f"{table}/{column.name}: does not belong to a run of this scene")


def _check_reproduces(log: Log, last: Checkpoint | None, simulation: Simulation) -> None:
    """Raise LogError unless this program reproduces the first events after the last checkpoint."""
    first = 0 if last is None else last.row
    batch = empty_batch(REPLAYED_ROWS + 2, row_columns(simulation.effects, simulation.method.has_positions))
    an_event = 1 if simulation.method.has_positions else 2  # fewest rows per event; one event more might raise an error
    events = min(REPLAYED_ROWS, (len(log) - first) // an_event)
    rows = min(simulation.advance(Stop(), batch, events), len(log) - first)
    for stored in log.chunks(None, first, first + rows):
        again, batch = batch.rows(0, len(stored.time)), batch.rows(len(stored.time), REPLAYED_ROWS + 2)
        for name in log.columns:
            differs = (getattr(again, name) != getattr(stored, name)).reshape(len(stored.time), -1).any(axis=1)
            if differs.any():
                row = first + int(differs.argmax())
                why = f"this program on this machine computes a different {name} in event row {row}"
                raise LogError(f"{log.path}: cannot be resumed: {why}")
        first += len(stored.time)


def _history_of(log: Log, last: Checkpoint | None, scene: Scene) -> RunHistory:
    effects = make_effects(scene, log.discs)
    if last is None:
        return RunHistory(energy_of(log.discs, effects))
    gas = _restored(log, effects, log.checkpoints[0])
    deepest = {}
    for name in ("overlap", "outside"):
        times, values = log.observables[name]
        if not (so_far := values[times <= last.time]).size:
            raise DamageError(log.path, f"observables/{name}: no sample up to the last checkpoint")
        deepest[name] = float(so_far.max())
    snapshots = int(log.snapshot_times.searchsorted(last.time, "right"))
    return RunHistory(energy_of(gas, effects), **deepest, snapshots=snapshots, begun=True)
