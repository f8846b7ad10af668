"""Every effect by all methods: a run, the same by brute force, and in pieces that are resumed, bit for bit."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from helpers.log_compare import same_by_brute_force_and_resumed
from helpers.support import ROOT

from idealgas import Log, evolution, open_log
from idealgas.columns import SIDES, Kind

U = 2.0**-53


class Run(NamedTuple):
    """A scene with overrides, the ends of its pieces, its deepest overlap at most, and what else has to hold."""

    scene: str
    overrides: tuple[str, ...]
    ends: tuple[str, ...]
    overlap: float
    holds: Callable[[Log, np.ndarray, np.ndarray], None]


def hits(least: int, *partners: int) -> Callable[[Log, np.ndarray, np.ndarray], None]:
    """Each of these walls is hit more often."""

    def holds(log: Log, kind: np.ndarray, partner: np.ndarray) -> None:
        assert min((partner == each).sum() for each in partners) > least

    return holds


def of_arcs(log, kind, partner):
    hits(10, *range(-9, -4))(log, kind, partner)
    assert (kind[np.isin(partner, (-6, -7, -9))] == Kind.WALL_END).sum() > 10
    end = log.state_at(log.end_time).position
    assert (np.hypot(*(end - (6.5, 6.5)).T) <= 6 - log.discs.radius + 1e-13).all()


def of_holes(log, kind, partner):
    escaped = kind == Kind.ESCAPED
    assert (np.bincount(-5 - partner[escaped], minlength=4) > 0).tolist() == [True, False, True, True]
    assert log.summary["escaped"] == escaped.sum() == (~log.state_at(log.end_time).inside).sum()


def of_a_chute(log, kind, partner):
    assert np.ptp(log.state_at(log.end_time).image[:, 0]) > 0  # discs went round, with gravity and against it


def of_a_piston(log, kind, partner):
    assert (kind == Kind.PISTON).sum() > 50
    assert ((partner == -5) == (kind == Kind.PISTON)).all()
    assert np.abs(evolution(log).balance).max() < 1e-12


def of_two_pistons(log, kind, partner):
    assert {*partner[kind == Kind.PISTON].tolist()} == {-2, -5}
    result = evolution(log)
    assert (result.law, [*result.pistons], [*result.chambers]) == (None, ["piston", "right piston"], ["left", "right"])
    assert np.abs(result.balance).max() < 1e-12


def of_shear(log, kind, partner):
    hits(30, *(-1 - SIDES.index(side) for side in ("bottom", "top")))(log, kind, partner)
    assert (log.summary["threads"], log.summary["epochs"] > 3) == (1, True)


def of_vibrations(log, kind, partner):
    assert len(log) > 800


FALLING = ("gravity.acceleration=[0.1,-0.5]", "restitution.wall=0.9", "rotation={}")
ROUGH = ("restitution.normal=0.9", "rotation.roughness=0.3", "thermostat.temperature=1", "thermostat.rate=0.1")
ONE = ("species.hot.count=12", "species.cold.count=8", "piston.mass=3", "run.until=60")
FEW = ("species.left.count=8", "species.right.count=12", "piston.0.mass=3", "piston.1.mass=3", "piston.1.pressure=0.2")
ROUNDED = 16 * U / 0.4  # roundings of a coordinate over the sum of the radii, times the coordinate
QUICK = {
    "arcs": Run("golden/arcs", (), ("run.events=1500",), 14 * ROUNDED, of_arcs),
    "a piston between two gases": Run("adiabatic-piston", ONE, ("run.until=25",), 1e-14, of_a_piston),
    "two pistons": Run("two-pistons", (*FEW, "run.until=60"), ("run.until=25",), 1e-14, of_two_pistons),
}
SLOW = {
    "arcs, falling": Run("golden/arcs", FALLING, ("run.events=1500",), 14 * ROUNDED, of_arcs),
    "holes, falling": Run("golden/absorbing", (), ("run.until=4", "run.until=11"), 1e-12, of_holes),
    "holes": Run(
        "golden/absorbing", ("gravity=", "rotation=", "box.bottom=reflecting"), ("run.until=4", "run.until=11"), 1e-12,
        of_holes,
    ),
    "gravity along periodic sides": Run("golden/chute", (), ("run.until=4", "run.until=6"), 1e-14, of_a_chute),
    "a piston, a hot floor and losses": Run(
        "golden/piston-inner", ("run.events=", "run.until=60"), ("run.until=25",), 1e-14, of_a_piston
    ),
    "fixed discs, falling": Run("golden/fixed-discs", (), ("run.until=12",), 1e-14, hits(15, -6, -7)),
    "fixed discs": Run("golden/fixed-discs", ("gravity=", "restitution="), ("run.until=12",), 1e-14, hits(15, -6, -7)),
    "permeable walls, falling": Run("golden/permeable", (), ("run.until=11",), 1e-12, hits(3, -5, -6, -7)),
    "permeable walls": Run(
        "golden/permeable", ("gravity=", "box.bottom=reflecting"), ("run.until=11",), 1e-12, hits(3, -5, -6, -7)
    ),
    "shear": Run("golden/sheared", (), ("run.events=1500",), 9 * ROUNDED, of_shear),
    "shear, rough in a heat bath": Run("golden/sheared", ROUGH, ("run.events=1500",), 9 * ROUNDED, of_shear),
    "vibrating sides": Run("golden/vibrating", (), ("run.until=2.7",), 1e-14, of_vibrations),
    "sides that follow sines": Run("golden/vibrating-sine", (), ("run.until=2.7",), 1e-14, of_vibrations),
}  # fmt: skip


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_the_same_by_brute_force_and_resumed(tmp_path, name):
    run = (QUICK | SLOW)[name]
    folder = ROOT / ("tests/cases" if "/" in run.scene else "configs")
    summary = same_by_brute_force_and_resumed(tmp_path, folder / f"{run.scene}.toml", run.overrides, *run.ends)
    assert summary.deepest_overlap < run.overlap
    with open_log(tmp_path / "whole.h5") as log:
        columns = [getattr(rows, column) for column in ("kind", "partner") for rows in log.chunks()]
        half = len(columns) // 2
        run.holds(log, np.concatenate(columns[:half]), np.concatenate(columns[half:]))
