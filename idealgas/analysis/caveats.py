"""Caveats of results: sentences about conditions that are not met.

Each analysis tests its own conditions and adds one sentence per unmet condition to its `Result`. This module contains
the caveats that all analyses share, and those that concern several logs together.
"""

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

from idealgas.analysis.result import Origin, Result
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.scene import Scene
from idealgas.scene.scene import describe_gas, draws_random_numbers, gas_digest, gas_kind, is_mixture, run_digest
from idealgas.tallies.equilibration import Window
from idealgas.tallies.exchange import INDEPENDENT
from idealgas.theory import conserved, time_steps

Sample = TypeVar("Sample", bound=Any)

MOST = 6
"""Maximum number of caveats from single logs that are kept when logs are combined."""

NAMED = 3
"""Maximum number of logs or seeds that are listed in full."""

WIDE, WIDE_PERIODIC = 20.0, 5.0
"""Smallest width in diameters of a box that counts as wide: between walls, and with periodic sides."""


def log_caveats(log: Log) -> tuple[str, ...]:
    """Return the caveats that the gas and the simulation method imply for time averages over a log."""
    return (*conserved.caveats(log.scene, log.discs), *time_steps.caveats(log.scene, log.discs))


def path_caveats(log: Log, window: Window) -> tuple[str, ...]:
    """Return a caveat if the discs of an isolated gas hardly collide, so that only walls mix their paths."""
    times, collisions = log.observables["disc_collisions"]
    among = np.diff(np.interp((window.start, window.end), times, collisions))
    if len(log.discs) == 1 or not log.scene.properties.isolated or (each := 2 * float(among[0]) / len(log.discs)) >= 1:
        return ()
    hardly = f"Discs hardly collide with each other ({each:.2g} times each in the window)"
    reason = hardly if log.scene.properties.interacting else "Discs do not interact"
    return (
        f"{reason}: each disc keeps its energy, and only walls mix its path. Standard errors are too small if paths "
        "remain correlated for long.",
    )


def window_caveats(window: Window) -> tuple[str, ...]:
    """Return a caveat if the window is too short compared with the slowest relaxation process of the gas."""
    time, process = window.slowest
    if window.duration >= INDEPENDENT * time:
        return ()
    return (
        f"This gas relaxes slowly: {process} in t = {time:.2g}, and the window is only {window.duration / time:.2g} "
        "times as long. Standard errors may be up to 3 times too small; they are reliable if the window is "
        f"{INDEPENDENT:g} times as long as this time.",
    )


def origin_of(scene: Scene, path: str, label: str = "") -> Origin:
    """Return the origin of a run of a scene.

    Args:
        scene: scene of the run.
        path: path of the log, or another name for the run.
        label: name of the run among several; if empty, `path` is used.
    """
    seed = scene.scene.seed if draws_random_numbers(scene) else None
    return Origin(
        path,
        run_digest(scene),
        gas_digest(scene),
        describe_gas(scene),
        gas_kind(scene),
        is_mixture(scene),
        seed,
        scene.scene.title or path,
        label or path,
    )


def combined_title(results: Sequence[Result]) -> str:
    """Return the title of a figure of one or more runs: their titles, or their number if there are too many titles."""
    titles = list(dict.fromkeys(r.title for r in results))
    if len(titles) > NAMED:
        return f"{len(results)} runs"
    runs = f" ({len(results)} runs)" if len(results) > len(titles) else ""
    return ", ".join(titles) + runs


def combined_caveats(results: Sequence[Result]) -> tuple[str, ...]:
    """Return each caveat of the single results once, with the paths of the logs it applies to; at most MOST caveats."""
    if len(results) == 1:
        return results[0].caveats
    whose: dict[str, list[str]] = {}
    for result in results:
        for sentence in result.caveats:
            whose.setdefault(sentence, []).extend([result.origin.path] if result.origin else [])
    sentences = [f"{named(paths)}: {sentence}" if paths else sentence for sentence, paths in whose.items()]
    if len(sentences) > MOST:
        sentences[MOST:] = [f"{len(sentences) - MOST} more caveats are listed with the individual logs."]
    return tuple(sentences)


def averaging_caveats(results: Sequence[Result]) -> tuple[str, ...]:
    """Return caveats about runs that are averaged but may not be independent.

    Raises:
        UserError: if a run is given twice: the same log, a copy of it, or another log of the same scene and seed.
    """
    runs: dict[str, Origin] = {}
    seeds: dict[int, list[str]] = {}
    for origin in (r.origin for r in results if r.origin is not None):
        if (first := runs.setdefault(origin.run, origin)) is not origin:
            if origin.path == first.path:
                raise UserError(f"{origin.path}: given twice")
            raise UserError(f"{origin.path}: the same run as {first.path} (same scene and seed)")
        if origin.seed is not None:
            seeds.setdefault(origin.seed, []).append(origin.path)
    return tuple(
        f"Runs with the same seed ({seed}) may start from the same state; their errors are then not independent: "
        f"{named(paths)}. Give each run a different seed."
        for seed, paths in seeds.items()
        if len(paths) > 1
    )


def must_be_one_gas(results: Sequence[Result], message: str = "different gases") -> None:
    """Raise UserError with a message that starts with `message` if the results belong to different gases."""
    if len(gases := {r.origin.gas: r.origin.words for r in results if r.origin is not None}) > 1:
        raise UserError(f"{message} ({'; '.join(gases.values())}): analyse them separately")


def by_state(samples: Iterable[Sample]) -> list[tuple[str, list[Sample]]]:
    """Group samples by state, in order of φ; return the kind of gas in words (empty if unknown) and samples of each."""
    states: dict[tuple[float, int, str], list[Sample]] = {}
    for sample in samples:
        kind = sample.origin.kind if sample.origin else ""
        states.setdefault((round(sample.packing_fraction, 9), sample.number, kind), []).append(sample)
    return [(kind, runs) for (_, _, kind), runs in sorted(states.items())]


def seeds_of(runs: Iterable[Result]) -> tuple[int, ...]:
    """Return the distinct seeds of runs in increasing order; runs that draw no random numbers have no seed."""
    return tuple(sorted({run.origin.seed for run in runs if run.origin and run.origin.seed is not None}))


def name_of_state(packing_fraction: float, number: int, kind: str, seeds: Sequence[int]) -> str:
    """Return a name for a state of a gas, composed of φ, N, the seeds of the runs and the kind of gas."""
    last = f" to {seeds[-1]}" if len(seeds) > NAMED else ""
    listed = f"{seeds[0]}{last}" if last else ", ".join(map(str, seeds))
    of_seeds = [f"seed{'s' * (len(seeds) > 1)} {listed}"] if seeds else []
    return ", ".join([f"φ = {packing_fraction:.9g}", f"N = {number}", *of_seeds, *filter(None, [kind])])


def named(paths: Sequence[str]) -> str:
    """Return paths on one line; long lists are cut: 'a, b, c and 5 more'."""
    rest = len(paths) - NAMED
    return ", ".join(paths[:NAMED]) + (f" and {rest} more" if rest > 0 else "")


def narrow(log: Log) -> tuple[str, ...]:
    """Return a caveat if the box is too narrow for theories of a wide box; none if the discs have no positions."""
    if not log.has_positions:
        return ()
    diameter = 2 * float(log.discs.radius.max())
    for size, periodic in zip(log.box, log.periodic, strict=True):
        if size < (WIDE_PERIODIC if periodic else WIDE) * diameter:
            between = "with periodic sides" if periodic else "between walls"
            return (
                f"The box is {size / diameter:.3g} diameters wide {between}; theory assumes a wide box "
                f"({WIDE:g} diameters between walls, {WIDE_PERIODIC:g} with periodic sides).",
            )
    return ()
