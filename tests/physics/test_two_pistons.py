"""Two pistons: exact hits, and equilibrium of two gases in a row under constant pressure."""

import numpy as np
import pytest
from helpers.against_theory import agrees
from helpers.logs import log_of

from idealgas import evolution
from idealgas.statistics.estimates import mean
from idealgas.theory import hard_discs

HANDS = """
box.size = [12, 2]
piston = [{ inner = "x", position = 4, mass = 1 }, { inner = "x", name = "second", position = 8, mass = 1 }]
disc = [
    { position = [2, 1], velocity = [2, 0], radius = 0.5 },
    { position = [6, 1], velocity = [0, 0], radius = 0.5 },
    { position = [10, 1], velocity = [0, 0], radius = 0.5 },
]
run.events = 5
"""


@pytest.mark.usefixtures("uncompiled")
def test_hits_by_hand():
    """Equal masses exchange velocities: 2 goes from the first disc to the last, through both pistons, to the side."""
    log = log_of(HANDS)
    (rows,) = log.chunks()
    position, velocity = (log.observables[f"piston_{name}"][1] for name in ("position", "velocity"))
    assert rows.disc.tolist() == [0, 1, 1, 2, 2]
    assert rows.partner.tolist() == [-5, -5, -6, -6, -2]
    assert rows.time.tolist() == pytest.approx([0.75, 1.5, 2.25, 3.0, 3.75], rel=1e-14)
    assert rows.velocity[:, 0].tolist() == [0, 2, 0, 2, -2]
    assert position[[0, -1]] == pytest.approx(np.array([[4, 8], [5.5, 9.5]]), rel=1e-14)
    assert (velocity == 0).all()


@pytest.mark.slow
def test_equilibrium():
    """At fixed energy E the lengths x₁, x₂ of the gases' centres have the weight x₁^N₁ x₂^N₂ (E - F (x₁ + x₂))^N.

    All of phase space at an energy is as likely; F = P L is the force from outside, and the momenta of N discs and two
    pistons leave the last power, N + 1 - 1. So F (x₁ + x₂)/E has a Beta law of (N + 2, N + 1), x₁/(x₁ + x₂) one of
    (N₁ + 1, N₂ + 1). Discs of a size push Z times as hard: N Z for N. It means P L x = (N Z + 1) T for each gas.
    """
    log = log_of("two-pistons", "run.until=20000", "log.snapshot_every=4", "log.events=false")
    course = evolution(log)
    assert np.abs(course.balance).max() < 1e-12
    first, second = log.observables["piston_position"][1][200:].T
    number, radius, force = np.array([80, 120]), 0.05, 20.0
    z = [
        float(hard_discs.box_compressibility_factor([radius], [n], (length, 10.0), (False, False)))
        for n, length in zip(number, (4.12, 6.18), strict=True)
    ]
    weight = number * z
    energy = 200 + force * (10 - 4 * radius)
    agrees(mean(force * (second - 4 * radius) / energy, (weight.sum() + 2) / (weight.sum() + 203)), 0.005)
    agrees(mean((first - 2 * radius) / (second - 4 * radius), (weight[0] + 1) / (weight.sum() + 2)), 0.01)
