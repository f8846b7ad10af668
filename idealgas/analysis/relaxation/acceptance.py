"""Acceptance of the trials of a Monte Carlo run, compared with kinetic theory and with a published run."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.fields import Key
from idealgas.log import Log
from idealgas.presentation.tables import Cell, Number, Table, estimates
from idealgas.scene import Scene
from idealgas.scene.defaults import reference_speed
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.equilibrium import ensemble
from idealgas.theory import conserved, hard_discs
from idealgas.theory.ensemble import classes

PUBLISHED = 6_552
"""Collisions in the 28 000 trials of Novak & Bortz, Am. J. Phys. 38, 1402 (1970).

Their gas has 200 molecules, and v_ref is 5 times the speed of the molecules. The number is 6.7 % below the theoretical
value.
"""

V_REF = "v_ref"
"""Name of the observable that contains v_ref in logs of runs in which v_ref may rise."""

MANY = 2000  # largest number of discs for which all pairs are averaged


@dataclass(frozen=True)
class ReferenceSpeed:
    """A value of v_ref in a Monte Carlo run, length/time, and the number of trials after which it was set."""

    after_trials: int
    v_ref: float


@dataclass(frozen=True)
class Acceptance:
    """Acceptance of the trials of a Monte Carlo run: the fraction of the trials that became collisions.

    Attributes:
        number: number of trials.
        collisions: number of accepted trials.
        collisions_per_disc: collisions per disc.
        acceptance: measured fraction, compared with the theoretical value for these discs in equilibrium.
        at_start: fraction expected for the initial velocities.
        expected: fraction expected in equilibrium, by the name of the ensemble.
        published: published number of collisions; None if the scene is not that of the published run.
        reference_speeds: all values of v_ref in the run, in order of time.
    """

    number: Annotated[int, Key("trials")]
    collisions: int
    collisions_per_disc: float
    acceptance: Estimate
    at_start: Annotated[float, Key("acceptance_at_start")]
    expected: Annotated[dict[str, float], Key("acceptance_in_equilibrium")]
    published: Annotated[int | None, Key("published_collisions")]
    reference_speeds: Annotated[tuple[ReferenceSpeed, ...], Key("v_ref")]


def acceptance(log: Log) -> Acceptance | None:
    """Return the acceptance of all trials in a log; None if the method of the run has no trials."""
    if "trial" not in log.columns:
        return None
    number, collisions = log.summary["trials"] if log.complete else last_trial(log), len(log) // 2
    share = collisions / max(number, 1)
    error = float(np.sqrt(share * (1 - share) / max(number, 1)))
    equilibrium, speeds = ensemble(log), _reference_speeds(log)
    still = conserved.share_of_motion(log.discs, equilibrium.centre_of_mass_velocity) <= conserved.SAID_FROM
    v_ref = _mean_reference_speed(speeds, number)
    fixed = _equilibrium_acceptance(log, v_ref, equilibrium.temperature, equilibrium.dof)
    maxwell = _equilibrium_acceptance(log, v_ref, log.discs.temperature if still else equilibrium.temperature)
    return Acceptance(
        number,
        collisions,
        2 * collisions / len(log.discs),
        Estimate(share, error, float(number), theory=fixed),
        at_start=_start_acceptance(log, speeds[0].v_ref),
        expected={
            "Maxwell-Boltzmann": maxwell,
            f"fixed energy and momentum ({equilibrium.dof} degrees of freedom)": fixed,
        },
        published=PUBLISHED if _is_published(log.scene) else None,
        reference_speeds=speeds,
    )


def last_trial(log: Log) -> int:
    """Return the number of the last trial that became a collision; 0 if there is no such trial."""
    return sum(int(rows.trial[-1]) for rows in log.chunks(("trial",), max(len(log) - 1, 0)))


def _reference_speeds(log: Log) -> tuple[ReferenceSpeed, ...]:
    """Return all values of v_ref in a log, in order of time."""
    if V_REF not in log.observables:  # v_ref is constant and follows from the scene
        return (ReferenceSpeed(0, reference_speed(log.scene.run, float(np.hypot(*log.discs.velocity.T).max()))),)
    values = log.observables[V_REF][1]
    trials = log.observables["trials"][1][: len(values)]
    first = np.flatnonzero(np.diff(values, prepend=0.0))
    return tuple(map(ReferenceSpeed, trials[first].tolist(), values[first].tolist()))


def _mean_reference_speed(speeds: tuple[ReferenceSpeed, ...], number: int) -> float:
    """Return the harmonic mean of v_ref over all trials, length/time; a constant v_ref of this size accepts as many."""
    starts = np.array([speed.after_trials for speed in speeds] + [max(number, speeds[-1].after_trials + 1)])
    return float(np.diff(starts).sum() / (np.diff(starts) / [speed.v_ref for speed in speeds]).sum())


def _largest_product(log: Log, v_ref: float) -> float:
    """Return the product of sum of radii and relative speed at which a trial is always accepted, length²/time."""
    return float(np.sort(log.discs.radius)[-2:].sum()) * v_ref


def _equilibrium_acceptance(log: Log, v_ref: float, temperature: float, dof: float = math.inf) -> float:
    """Return the acceptance in equilibrium.

    It is the mean product of the sum of radii and the relative speed of a pair, divided by the product at which a trial
    is always accepted. For equal discs it is √(π/2)/5 if v_ref is 5 times the root-mean-square speed.
    """
    discs = classes(log.discs)
    sigma = discs.radius[:, None] + discs.radius
    speed = hard_discs.mean_relative_speeds(temperature, discs.mass, dof)
    pairs = discs.number[:, None] * (discs.number - np.eye(len(discs.number)))
    return float((pairs * sigma * speed).sum() / pairs.sum() / _largest_product(log, v_ref))


def _start_acceptance(log: Log, v_ref: float) -> float:
    """Return the acceptance for the initial velocities: (4/π)/5 for equal speeds in random directions."""
    gas = log.discs
    chosen = slice(None, None, -(-len(gas) // MANY))
    v, r = gas.velocity[chosen], gas.radius[chosen]
    product = (r[:, None] + r) * np.hypot(*(v[:, None] - v).T)
    return float(product.sum() / (len(r) * (len(r) - 1)) / _largest_product(log, v_ref))


def _is_published(scene: Scene) -> bool:
    """Return whether a scene describes the published run of Novak & Bortz (1970)."""
    run = scene.run
    if (
        len(scene.species) != 1
        or len(scene.explicit_discs)
        or run.trials != 28_000
        or run.events
        or run.collisions_per_disc
    ):
        return False
    (gas,) = scene.species
    return gas.count == 200 and gas.speed is not None and (run.v_ref or 5 * gas.speed) == 5 * gas.speed


def acceptance_tables(tried: dict[str, Acceptance]) -> list[Table]:
    """Return the tables of the acceptance in each log, with the theoretical and the published values."""
    counts = [
        (
            path,
            Number(trials_of_log.number, ","),
            Number(trials_of_log.collisions, ","),
            Number(trials_of_log.collisions_per_disc, ".5g"),
        )
        for path, trials_of_log in tried.items()
    ]
    expected = [row for path, trials_of_log in tried.items() for row in _expected(path, trials_of_log)]
    raised = [
        (path, Number(speed.after_trials, ","), Number(speed.v_ref, ".6g"))
        for path, trials_of_log in tried.items()
        for speed in trials_of_log.reference_speeds
    ]
    return [
        Table("Trials of pairs", ("", "trials", "collisions", "collisions per disc"), counts),
        estimates("Acceptance of trials", [(path, trials_of_log.acceptance) for path, trials_of_log in tried.items()]),
        Table("Acceptance expected", ("", "value", "collisions"), expected),
        Table("Reference speed", ("", "after trials", "v_ref"), raised),
    ]


def _expected(path: str, trials_of_log: Acceptance) -> Iterator[tuple[Cell, ...]]:
    shares = {"at the start": trials_of_log.at_start} | {
        f"in equilibrium, {name}": x for name, x in trials_of_log.expected.items()
    }
    for name, share in shares.items():
        yield f"{path}: {name}", Number(share, ".5f"), Number(share * trials_of_log.number, ",.0f")
    if trials_of_log.published is not None:
        share = trials_of_log.published / trials_of_log.number
        yield f"{path}: published, Novak & Bortz (1970)", Number(share, ".5f"), Number(trials_of_log.published, ",")
