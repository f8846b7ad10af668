"""Calibration of p-values: those of the right law are uniform over many seeds of one gas.

    PYTHONPATH=tests python -m tools.p_values --first 1000

prints the table of `p_values.csv`: for each gas and quantity the mean p-value, which is 0.5 ± 0.29/√runs, the share of
runs with p < 0.05, and the Kolmogorov-Smirnov p-value of all p-values against a uniform distribution.
"""

import argparse
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from scipy import stats
from tools.calibration_cases import PERIODIC, THERMAL

from idealgas import histogram, open_log, parse_scene, simulate

QUANTITIES = ("speed", "energy", "vx", "vy")

GAS = "[box]\nsize = [1, 1]\n{sides}\n[[species]]\nname = 'gas'\ncount = 40\nradius = 0.04\ntemperature = 1\n"

GASES = {
    "closed": GAS.format(sides=""),
    "periodic": GAS.format(sides=PERIODIC),
    "mixed": "[box]\nsize = [1, 1]\n[[species]]\nname = 'light'\ncount = 30\nradius = 0.03\ntemperature = 1\n"
    "[[species]]\nname = 'heavy'\ncount = 20\nradius = 0.045\nmass = 4\ntemperature = 1\n",
    "thermal walls": GAS.format(sides=THERMAL),
    "thermostat": GAS.format(sides="") + "[thermostat]\ntemperature = 1\nrate = 5\n",
}
"""Gases with φ = 0.2, of 40 discs or 50."""

RUN = "[log]\ncompression = 'none'\n[run]\ncollisions_per_disc = 1000\n"

Row = tuple[str, str, str, int, float, float, float]


def p_values(scene: str, quantities: Iterable[str], seeds: range, path: Path) -> dict[tuple[str, str], np.ndarray]:
    """P-values (seeds,) of the exact law, by species and quantity."""
    found: dict[tuple[str, str], list[float]] = {}
    for seed in seeds:
        simulate(parse_scene(f"[scene]\nseed = {seed}\n{scene}{RUN}"), path, force=True)
        with open_log(path) as log:
            for quantity in quantities:
                for distribution in histogram(log, quantity).distributions:
                    found.setdefault((distribution.name, quantity), []).append(distribution.tests[-1].p_value)
    return {name: np.array(values) for name, values in found.items()}


def rows_of(gas: str, seeds: range, quantities: Iterable[str] = QUANTITIES) -> list[Row]:
    """Rows of the table for one gas."""
    memory = "/dev/shm" if Path("/dev/shm").is_dir() else None
    with tempfile.TemporaryDirectory(dir=memory) as folder:
        result = p_values(GASES[gas], quantities, seeds, Path(folder) / "run.h5")
    return [
        (gas, *name, len(p), float(p.mean()), float((p < 0.05).mean()), float(stats.kstest(p, "uniform").pvalue))
        for name, p in result.items()
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=400, help="number of seeds")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("gases", nargs="*", default=list(GASES), help="by default all")
    given = parser.parse_args()
    print("gas,species,quantity,runs,mean_p,below_0.05,ks_p")
    seeds = range(given.first, given.first + given.seeds)
    for gas in given.gases:
        for *names, runs, mean, low, ks in rows_of(gas, seeds):
            print(*names, runs, f"{mean:.3f}", f"{low:.3f}", f"{ks:.3f}", sep=",", flush=True)


if __name__ == "__main__":
    main()
