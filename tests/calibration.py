"""Calibration of error bars: many seeds of small gases, and how far their numbers are from the truth in stated errors.

For each estimate of each analysis: the root mean square of (value - truth)/error, which is 1 if errors are right and a
little more where they are known from few samples, and the share of the stated 95 % intervals that hold the truth. The
truth is exact theory where there is one, else the mean over all seeds.

    python tests/calibration.py --seeds 2000 --folder FOLDER

goes on with what it has stored in the folder, and prints the table of the README of the analyses.
"""

import argparse
import math
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

from idealgas import Log, open_log, parse_scene, simulate
from idealgas.analysis.core import window
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.effusion.measure import effusion
from idealgas.analysis.heat_capacity.measure import heat_capacity
from idealgas.analysis.histogram.measure import histogram
from idealgas.analysis.order.measure import order
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.profile.measure import profile
from idealgas.analysis.relaxation.measure import relaxation
from idealgas.analysis.sound.measure import sound
from idealgas.analysis.temperature.measure import temperature
from idealgas.analysis.transport.measure import transport

PART = 50
"""Number of seeds that are stored together."""

KEPT = "share kept"
"""Name of the share of a log that is used from detected equilibrium on."""

Named = Iterator[tuple[str, Estimate]]
Found = dict[str, np.ndarray]


class Case(NamedTuple):
    """Gas of a calibration: text of its scene, run lengths as text for [run], and what is measured of a log.

    more: text for [log]. steady: whether the gas is in equilibrium from early on.
    """

    scene: str
    runs: tuple[str, ...]
    measured: Callable[[Log], Named]
    more: str = ""
    steady: bool = True


class Row(NamedTuple):
    """One row of the table: name of an estimate, number of runs, rms deviation, and share of intervals that hold."""

    case: str
    run: str
    name: str
    runs: int
    rms: float
    coverage: float


def box(log: Log) -> Named:
    """Pressure, rates, flights, temperature and the heat capacity of a closed box."""
    found = pressure(log)
    for route in found.routes:
        yield route.name, route.compressibility
    yield "collision rate", found.collision_rates[0].rate
    (free,) = found.free_paths
    yield from (("free path", free.path), ("free time", free.time), ("mean speed", free.speed))
    yield "temperature along x", temperature(log).species[0].x
    yield "heat capacity E/T", heat_capacity(log).routes["E/T"]
    for quantity in ("vx", "free-path", "wait"):
        yield f"mean {quantity} (histogram)", histogram(log, quantity).distributions[0].mean


def strips(log: Log) -> Named:
    """Density and temperature in strips of a closed box."""
    (strips,) = profile(log, "x", 4).species
    for k, place in enumerate(("at the side", "in the middle")):
        yield f"density {place}", strips.density[k]
        yield f"temperature {place}", strips.temperature[k]


def periodic(log: Log) -> Named:
    """Transport in a periodic box."""
    found = transport(log)
    yield "pairs, virial", pressure(log).routes[-1].compressibility
    yield "contact value", found.contacts[0].value
    yield "diffusion coefficient", found.diffusion[0].coefficient
    yield "velocity correlation time", found.diffusion[0].velocity_correlation_time


def currents(log: Log) -> Named:
    """Coefficients and pressure by the currents of a periodic box."""
    found = transport(log)
    assert found.collective is not None
    for name, one in found.collective.coefficients.items():
        yield name.replace("_", " "), one.value
        if one.difference is not None:
            yield f"{name.replace('_', ' ')}, difference of routes", one.difference
    for name in ("xx", "xy"):
        yield f"pressure tensor, {name}", found.collective.pressure[name]


def ordered(log: Log) -> Named:
    """Hexagonal order in a periodic box."""
    found = order(log)
    yield from (("ψ₆ of a disc", found.local), ("Ψ₆ of all discs", found.whole), ("six neighbours", found.hexagons))


def bath(log: Log) -> Named:
    """A gas between thermal walls: fluctuations of its energy, and heat."""
    yield "heat capacity Var(E)/T²", heat_capacity(log).routes["Var(E)/T²"]
    yield "temperature", temperature(log).species[0].both
    yield "heat of a wall", profile(log, "x", 2).heat["left"]


def rough(log: Log) -> Named:
    """Discs with spin: fluctuations of the kinetic energy of motion."""
    found = heat_capacity(log)
    yield "heat capacity, fluctuations", found.routes["fluctuations of the kinetic energy"]
    yield "temperature by kinetic energy", found.temperature


def waves(log: Log) -> Named:
    """Sound in a periodic box."""
    (wave,) = sound(log).waves
    yield from (("speed of sound", wave.speed), ("damping of sound", wave.damping))
    yield from (("thermal diffusivity", wave.spreading), ("adiabatic exponent", wave.exponent))


def mixture(log: Log) -> Named:
    """Two species that start at two temperatures."""
    for entry in temperature(log).species[:2]:
        yield f"temperature, {entry.species}", entry.both
    for rate in pressure(log).collision_rates:
        yield f"rate, {rate.species} {rate.other}", rate.rate


def slit(log: Log) -> Named:
    """Two chambers and a slit."""
    yield "flow through a slit", effusion(log).speed


def equal_speeds(log: Log) -> Named:
    """Relaxation from equal speeds."""
    found = relaxation(log)
    assert found.in_time is not None
    assert found.in_collisions is not None
    yield from (("relaxation time", found.in_time), ("relaxation, collisions per disc", found.in_collisions))


FIFTY = f"count = 50\nradius = {math.sqrt(0.2 / (50 * math.pi))!r}\n"
GAS = "[box]\nsize = [1, 1]\n{sides}\n[[species]]\nname = 'gas'\n" + FIFTY + "temperature = 1\n"
PERIODIC = "".join(f'{side} = "periodic"\n' for side in ("left", "right", "bottom", "top"))
THERMAL = "".join(f"{side} = {{ thermal = 1 }}\n" for side in ("left", "right", "bottom", "top"))
SHORT_AND_LONG = ("collisions_per_disc = 1000", "collisions_per_disc = 4000")
OFTEN, SELDOM = "snapshot_every = 0.2\n", "snapshot_every = 1\n"
"""Samples of the energy: some in the time for which it fluctuates."""

SLOW = ("collisions_per_disc = 3000", "collisions_per_disc = 6000")
"""Runs for what follows the slow exchange of discs and heat across the box: the shorter ones have some 60 times it."""

CURRENTS = ("collisions_per_disc = 4000", "collisions_per_disc = 12000")
"""Runs for the spread of currents: the shorter ones have 200 times the longest lag."""

SLOWEST = ("collisions_per_disc = 6000", "collisions_per_disc = 12000")
"""Runs for the energy of a gas that only its walls change."""

CASES = {
    "closed box": Case(GAS.format(sides=""), SHORT_AND_LONG, box),
    "closed box, strips": Case(GAS.format(sides=""), SLOW, strips),
    "periodic box": Case(GAS.format(sides=PERIODIC), SHORT_AND_LONG, periodic),
    "periodic box, order": Case(GAS.format(sides=PERIODIC), SHORT_AND_LONG, ordered),
    "periodic box, currents": Case(GAS.format(sides=PERIODIC), CURRENTS, currents),
    "heat bath": Case(GAS.format(sides=THERMAL), SLOWEST, bath, SELDOM),
    "rough discs": Case(
        GAS.format(sides="") + "[rotation]\ninertia = 0.5\nroughness = 1\n", SHORT_AND_LONG, rough, OFTEN
    ),
    "waves": Case(
        f"[box]\nsize = [16, 16]\n{PERIODIC}[[species]]\nname = 'gas'\ncount = 100\nradius = 0.5\ntemperature = 1\n",
        ("until = 400", "until = 1600"),
        waves,
    ),
    "mixture": Case(
        "[box]\nsize = [1, 1]\n[[species]]\nname = 'light'\ncount = 30\nradius = 0.03\ntemperature = 1.3\n"
        "[[species]]\nname = 'heavy'\ncount = 20\nradius = 0.045\nmass = 4\ntemperature = 0.5\n",
        SLOW,
        mixture,
    ),
    "two chambers": Case(
        "[box]\nsize = [2, 1]\n[[wall]]\nfrom = [1, 0]\nto = [1, 0.47]\n[[wall]]\nfrom = [1, 0.53]\nto = [1, 1]\n"
        "[[wall]]\nname = 'gate'\nfrom = [1, 0.47]\nto = [1, 0.53]\nopens_at = 1\n[[species]]\nname = 'gas'\n"
        "count = 100\nradius = 0.002\ntemperature = 1\nregion = [0, 0, 1, 1]\n",
        ("until = 11", "until = 41"),
        slit,
        steady=False,
    ),
    "equal speeds": Case(
        "[box]\nsize = [1, 1]\n[[species]]\nname = 'gas'\ncount = 200\nradius = 0.0178\nspeed = 1\n",
        ("collisions_per_disc = 45",),
        equal_speeds,
        steady=False,
    ),
}


def measure(case: Case, run: str, seeds: range, path: Path) -> Found:
    """Values, errors, samples and theory of each estimate, by its name: (seeds, 4); of KEPT only the value is known."""
    found: dict[str, list[tuple[float, ...]]] = {}
    for seed in seeds:
        text = f"[scene]\nseed = {seed}\n{case.scene}\n[log]\ncompression = 'none'\n{case.more}[run]\n{run}\n"
        simulate(parse_scene(text), path, force=True)
        with open_log(path) as log:
            for name, one in case.measured(log):
                exact = one.theory if one.theory is not None and one.theory_error == 0 else math.nan
                row = (one.value, one.standard_error, one.independent_samples, exact)
                found.setdefault(name, []).append(row)
            if case.steady:
                share = window.measure(log, []).duration / (log.end_time - log.start_time)
                found.setdefault(KEPT, []).append((share, math.nan, math.nan, math.nan))
    return {name: np.array(rows) for name, rows in found.items()}


EXACT = (
    "mean speed",
    "temperature along x",
    "temperature, light",
    "temperature, heavy",
    "temperature",
    "mean vx (histogram)",
    "pressure tensor, xy",
)
"""Estimates whose theory is exact for this number of discs; others are compared with their mean over all seeds."""


def row_of(case: str, run: str, name: str, found: np.ndarray) -> Row:
    """Row of the table from values, errors, samples and theory (runs, 4)."""
    value, error, samples, theory = found.T
    n = len(value)
    truth, scale = (theory, 1.0) if name in EXACT else (value.mean(), math.sqrt(n / (n - 1)))
    deviation = (value - truth) * scale / error
    held = np.abs(deviation) < stats.t.ppf(0.975, np.maximum(samples - 1, 1))
    return Row(case, run, name, n, float(np.sqrt((deviation**2).mean())), float(held.mean()))


def collect(folder: Path, seeds: int, seconds: float = math.inf, only: str = "") -> dict[tuple[str, str], Found]:
    """What was measured of the first seeds, by gas and run; what the folder lacks is simulated, for a limited time."""
    collected, end = {}, time.monotonic() + seconds
    memory = "/dev/shm" if Path("/dev/shm").is_dir() else None
    for title, run in ((title, run) for title, case in CASES.items() for run in case.runs):
        if only not in f"{title}, {run}":
            continue
        parts = []
        for first in range(0, seeds, PART):
            stored = folder / f"{title}-{run.replace(' ', '')}-{first}.npz"
            if not stored.exists() and time.monotonic() < end:
                with tempfile.TemporaryDirectory(dir=memory) as place:
                    found = measure(CASES[title], run, range(first, first + PART), Path(place) / "run.h5")
                np.savez(stored, **found)
            if stored.exists():
                with np.load(stored) as file:
                    parts.append(dict(file))
        if parts:
            collected[title, run] = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return collected


def rows_of(collected: dict[tuple[str, str], Found]) -> list[Row]:
    """Rows of the table."""
    return [
        row_of(title, run, name, rows)
        for (title, run), found in collected.items()
        for name, rows in found.items()
        if name != KEPT
    ]


def kept(collected: dict[tuple[str, str], Found]) -> np.ndarray:
    """Shares of all logs of steady gases that are used."""
    return np.concatenate([found[KEPT][:, 0] for found in collected.values() if KEPT in found])


def table(rows: list[Row]) -> str:
    """Table for the README: for each estimate the rms deviation and the coverage in runs of every length."""
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        found.setdefault((row.case, row.name), []).append(row)
    lines = ["| gas | estimate | runs | rms deviation/error | 95 % intervals that hold, % |", "|---|---|---|---|---|"]
    for (case, name), entries in found.items():
        number = min(entry.runs for entry in entries)
        rms = ", ".join(f"{entry.rms:.2f}" for entry in entries)
        coverage = ", ".join(f"{100 * entry.coverage:.1f}" for entry in entries)
        lines.append(f"| {case} | {name} | {number} | {rms} | {coverage} |")
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=2000)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=math.inf, help="go no further after this time")
    parser.add_argument("--only", default="", help="part of the name of a gas and run")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    collected = collect(given.folder, given.seeds, given.seconds, given.only)
    print(table(rows_of(collected)))
    shares = kept(collected)
    print(f"share of {len(shares)} steady logs that is used: median {np.median(shares):.3f},", end=" ")
    print(f"{100 * (shares < 0.9).mean():.1f} % keep less than 0.9, {100 * (shares < 0.5).mean():.1f} % less than 0.5")


if __name__ == "__main__":
    main()
