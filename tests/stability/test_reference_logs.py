"""Ten logs to compare other programs with: `configs/reference.csv` has the digest of each, and its numbers.

The numbers hold for every gas of the scene, within their errors; the digest holds for this program, or another that
rounds as it does. Once scenes or their logs have changed, this makes the table:

    PYTHONPATH=tests python tests/stability/test_reference_logs.py
"""

import csv
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from helpers.support import ROOT

import idealgas
from idealgas import Log, load_scene, open_log, simulate
from idealgas.log.digest import digest
from idealgas.statistics.estimates import Estimate

TABLE = ROOT / "configs" / "reference.csv"
STANDARD_ERRORS = 4
"""Largest deviation from theory. By chance one of 35 numbers is beyond it in 450 sets of logs."""

Numbers = Iterator[tuple[str, Estimate]]


class Row(NamedTuple):
    """One number of a log. value, error: measured. theory, theory_error: empty without theory."""

    scene: str
    purpose: str
    quantity: str
    value: str
    error: str
    theory: str
    theory_error: str
    events: str
    digest: str


def gas(log: Log) -> Numbers:
    """Pressure by walls or pairs, collision rate and free path."""
    result = idealgas.analyse(log, "pressure")
    for route in result.routes:
        if route.name in ("all walls", "pairs, virial"):
            yield f"PA/NT by {route.name}", route.compressibility_factor
    (free,) = result.free_paths
    yield from (("collisions of a disc per time", result.collision_rates[0].rate), ("mean free path", free.path))


def periodic(log: Log) -> Numbers:
    """The same, and diffusion."""
    yield from gas(log)
    yield "diffusion coefficient", idealgas.analyse(log, "transport").diffusion[0].coefficient


def mixture(log: Log) -> Numbers:
    """Temperatures and collision rates."""
    for entry in idealgas.analyse(log, "temperature").species[:2]:
        yield f"temperature of {entry.species}", entry.both
    for rate in idealgas.analyse(log, "pressure").collision_rates:
        yield f"collisions of a {rate.species} disc with {rate.other} ones per time", rate.rate


def lorentz(log: Log) -> Numbers:
    """Path between hits of scatterers, π A/P: Chernov, J. Stat. Phys. 88, 1 (1997); diffusion."""
    radius, lattice = 1 + 1e-6, 2.25**2 * np.sqrt(3)
    hits = np.zeros(len(log.discs))
    for block in log.chunks(("disc", "partner")):
        hits += np.bincount(block.disc[block.partner < -4], minlength=len(hits))
    rate = hits / log.end_time  # the speed is 1
    theory = 4 * radius / (lattice - 2 * np.pi * radius**2)
    yield "hits per path", Estimate(rate.mean(), rate.std(ddof=1) / np.sqrt(len(rate)), len(rate), float(theory))
    yield "diffusion coefficient", idealgas.analyse(log, "transport").diffusion[0].coefficient


def atmosphere(log: Log) -> Numbers:
    """Density and temperature of the lowest strips."""
    result = idealgas.analyse(log, "profile")
    (air,) = result.species
    for k in range(4):
        place = f"from y = {result.edges[k]:.4g} to {result.edges[k + 1]:.4g}"
        yield from ((f"density {place}", air.density[k]), (f"temperature {place}", air.temperature[k]))


def piston(log: Log) -> Numbers:
    """Pressure on the piston is that outside."""
    mechanical = idealgas.analyse(log, "pressure").mechanical
    assert mechanical is not None
    yield from (("pressure on the piston", w.pressure) for w in mechanical.walls if w.name == "right wall")


def bath(log: Log) -> Numbers:
    """Temperature, and fluctuations of the energy."""
    yield "temperature", idealgas.analyse(log, "temperature").species[0].both
    yield "Var(E)/NT²", idealgas.analyse(log, "heat-capacity").routes["Var(E)/T²"]


def shear(log: Log) -> Numbers:
    """Viscosity, pressure and temperature."""
    result = idealgas.analyse(log, "shear")
    yield from (("viscosity", result.viscosity), ("pressure", result.pressure), ("temperature", result.temperature))


def escape(log: Log) -> Numbers:
    """Rate of escape."""
    result = idealgas.analyse(log, "escape")
    assert result.per_path is not None
    yield "escapes per path", result.per_path


REFERENCES: dict[str, tuple[str, Callable[[Log], Numbers]]] = {
    "quickstart": ("dilute gas between walls", gas),
    "dense": ("dense gas between walls", gas),
    "periodic": ("gas without walls", periodic),
    "mixture": ("two masses and sizes", mixture),
    "lorentz": ("fixed discs", lorentz),
    "atmosphere": ("gravity", atmosphere),
    "piston": ("moving wall under constant pressure", piston),
    "heat-bath": ("thermal walls", bath),
    "shear": ("sheared sides and thermostat", shear),
    "escape": ("arcs and a hole", escape),
}
"""Scenes with what each is for, and its numbers."""


def rows_of(scene: str, folder: Path) -> list[tuple[Row, Estimate]]:
    """Run a scene, and return rows of the table with their numbers in full."""
    path = folder / f"{scene}.h5"
    simulate(load_scene(ROOT / "configs" / f"{scene}.toml"), path)
    purpose, numbers = REFERENCES[scene]
    with open_log(path) as log:
        same = str(len(log)), digest(log)
        return [(Row(scene, purpose, name, *_texts(each), *same), each) for name, each in numbers(log)]


def _texts(result: Estimate) -> tuple[str, str, str, str]:
    """Value, error, theory and its error to six digits, which last bits of sums do not change."""
    theory = ("", "") if result.theory is None else (f"{result.theory:.6g}", f"{result.theory_error:.2g}")
    return f"{result.value:.6g}", f"{result.standard_error:.2g}", *theory


def on_record() -> list[Row]:
    with TABLE.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    assert tuple(header) == Row._fields
    return [Row(*row) for row in rows]


def test_all_are_on_record():
    assert list(dict.fromkeys(row.scene for row in on_record())) == [*REFERENCES]


@pytest.mark.slow
@pytest.mark.parametrize("scene", REFERENCES)
def test_a_reference_log(scene, tmp_path):
    """The log and its numbers are those on record, it has 5 to 40 MB, and its numbers agree with theory."""
    result = rows_of(scene, tmp_path)
    assert [row for row, _ in result] == [row for row in on_record() if row.scene == scene]
    assert 5e6 < (tmp_path / f"{scene}.h5").stat().st_size < 4e7
    for row, each in result:
        assert each.deviation is None or abs(each.deviation) < STANDARD_ERRORS, row


def write_table() -> None:
    """Run every scene and write the table."""
    with tempfile.TemporaryDirectory() as folder, TABLE.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(Row._fields)
        writer.writerows(row for scene in REFERENCES for row, _ in rows_of(scene, Path(folder)))


if __name__ == "__main__":
    write_table()
