"""Tables of relaxations: times in both units, trials of Monte Carlo runs, and speed distributions."""

from collections.abc import Iterator

import numpy as np

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.tables import Cell, Number, Table, estimates
from idealgas.analysis.relaxation.acceptance import Acceptance
from idealgas.analysis.relaxation.measure import LINEAR, SETTLED, Relaxation, Relaxations
from idealgas.analysis.relaxation.speeds import SpeedDistributions

HEADS = ("", "N", "relaxation time", "± s.e.", "settled", "indistinguishable")

NOTES = (
    "Relaxation time: of the kurtosis; after three of them 5 % of the distance is left, and the gas has settled.",
    "Indistinguishable: from the first time on at which the speeds pass a Kolmogorov-Smirnov test at 5 %.",
    "A collision counts for both discs. Near equilibrium theory expects a relaxation time of "
    f"{LINEAR:g} collisions per disc, farther away more.",
)


def relaxation_tables(found: Relaxations) -> list[Table]:
    """Tables of speed distributions, if they were counted, of relaxation times, and of Monte Carlo trials."""
    in_time = [_row(r, r.in_time, r.time - r.time[0]) for r in found.logs]
    in_collisions = [_row(r, r.in_collisions, r.collisions) for r in found.logs]
    tried = {r.path: r.acceptance for r in found.logs if r.acceptance is not None}
    return [
        *(_speeds(r.path, r.speeds) for r in found.logs if r.speeds is not None),
        Table("Relaxation to Maxwell-Boltzmann, in units of time", HEADS, in_time, NOTES),
        Table("The same in collisions per disc", HEADS, in_collisions),
        *(_trials(tried) if tried else ()),
    ]


def _row(result: Relaxation, fit: Estimate | None, series: np.ndarray) -> tuple[Cell, ...]:
    first = result.first_indistinguishable
    return (
        result.path,
        Number(result.number, "d"),
        Number(fit.value if fit else None, ".4g", absent="none seen"),
        Number(fit.standard_error if fit else None, ".2g"),
        Number(SETTLED * fit.value if fit else None, ".4g"),
        Number(None if first is None else float(series[first]), ".3g", absent="not reached"),
    )


def _trials(tried: dict[str, Acceptance]) -> list[Table]:
    """Tables of the acceptance of each log, compared with theory and with the value of the published run."""
    counts = [
        (path, Number(found.number, ","), Number(found.collisions, ","), Number(found.collisions_per_disc, ".5g"))
        for path, found in tried.items()
    ]
    expected = [row for path, found in tried.items() for row in _expected(path, found)]
    raised = [
        (path, Number(trials, ","), Number(v_ref, ".6g"))
        for path, found in tried.items()
        for trials, v_ref in found.raises
    ]
    return [
        Table("Trials of pairs", ("", "trials", "collisions", "collisions per disc"), counts),
        estimates("Acceptance of trials", [(path, found.acceptance) for path, found in tried.items()]),
        Table("Acceptance expected", ("", "value", "collisions"), expected),
        Table("Reference speed", ("", "after trials", "v_ref"), raised),
    ]


def _expected(path: str, found: Acceptance) -> Iterator[tuple[Cell, ...]]:
    shares = {"at the start": found.at_start} | {f"in equilibrium, {name}": x for name, x in found.expected.items()}
    for name, share in shares.items():
        yield f"{path}: {name}", Number(share, ".5f"), Number(share * found.number, ",.0f")
    if found.published is not None:
        share = found.published / found.number
        yield f"{path}: published, Novak & Bortz (1970)", Number(share, ".5f"), Number(found.published, ",")


def _speeds(path: str, found: SpeedDistributions) -> Table:
    """Table of the numbers of discs by speed, one row for each instant; Maxwell-Boltzmann's numbers in the last row."""
    title = f"{path}: discs by speed, in classes from multiples of {found.rms:.4g} (rms)"
    classes = (f"{edge / found.rms:.1f}" for edge in found.edges)
    clock = [Number(t, ".4g") for t in found.time.tolist()]
    if found.trials is not None:
        clock = [Number(trial, ",") for trial in found.trials.tolist()]
    rows: list[tuple[Cell, ...]] = [
        (clock[k], Number(collisions, ".2f"), Number(distance, ".3f"), *(Number(n, "d") for n in counts))
        for k, (collisions, distance, counts) in enumerate(
            zip(found.collisions.tolist(), found.distance.tolist(), found.counts.tolist(), strict=True)
        )
    ]
    rows.append(("law", "", "", *(Number(number, ".1f") for number in found.expected.tolist())))
    return Table(title, ("time" if found.trials is None else "trials", "coll/disc", "KS", *classes), rows)
