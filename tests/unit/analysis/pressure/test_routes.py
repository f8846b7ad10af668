"""Pressure of few discs by every route, beside sums over the rows of the log, one by one."""

import numpy as np
import pytest
from helpers.support import gas_of

from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.pressure.routes import PAIRS, WALLS, _across, _average, _on_sides, _reach
from idealgas.theory.values import Theory

pytestmark = [pytest.mark.interpreted, pytest.mark.usefixtures("uncompiled")]

GAS = """
box.size = [5, 4]
disc = [
    { position = [1.5, 1], velocity = [1, 0.3], radius = 0.6 },
    { position = [3.5, 1], velocity = [-0.5, 1.1], radius = 0.6 },
    { position = [2.5, 3], velocity = [0.2, -0.9], radius = 0.6 },
]
run.until = 40
"""


def events(log):
    """Momentum given to each side, Σ of its size times the distance from the middle, and Σ Δp·r of pairs."""
    velocity, rows = log.discs.velocity.copy(), next(log.chunks())
    pushed, virial, pairs, k = np.zeros(4), 0.0, 0.0, 0
    while k < len(rows.time):
        i, partner, change = int(rows.disc[k]), int(rows.partner[k]), rows.velocity[k] - velocity[rows.disc[k]]
        if partner < 0:
            side = -1 - partner
            size = np.abs(change).max()
            pushed[side] += size
            virial += size * abs(rows.position[k][side // 2] - log.box[side // 2] / 2)
            k += 1
        else:
            pairs += change @ (rows.position[k] - rows.position[k + 1])
            velocity[partner] = rows.velocity[k + 1]
            k += 2
        velocity[i] = rows.velocity[k - 1] if partner < 0 else rows.velocity[k - 2]
    return pushed, virial, pairs


def test_every_route(make):
    """T = 2E/D of six degrees of freedom; N T/A = 3 T/20; over the time 40, lengths 5 and 4, and the area 20."""
    log = make()
    result = pressure(log, 0.0)
    pushed, virial, pairs = events(log)
    temperature = (1.09 + 1.46 + 0.85) / 2 * 2 / 6
    ideal = 3 * temperature / 20
    assert result.temperature == pytest.approx(temperature, rel=1e-12)
    z = {route.name: route.compressibility_factor.value for route in result.routes}
    sides = {
        f"{name} wall": pushed[k] / 40 / (4, 4, 5, 5)[k] for k, name in enumerate(("left", "right", "bottom", "top"))
    }
    for name, p in sides.items():
        assert z[name] == pytest.approx(p / ideal, rel=1e-9)
    assert z["all walls"] == pytest.approx(pushed.sum() / 40 / 18 / ideal, rel=1e-9)
    assert z[WALLS] == pytest.approx(virial / 40 / (2 * 20 * ideal), rel=1e-9)
    assert z[PAIRS] == pytest.approx(1 + pairs / 40 / (2 * 20 * ideal), rel=1e-9)
    for route in result.routes:
        assert route.pressure.value == pytest.approx(route.compressibility_factor.value * ideal, rel=1e-12)
    rate = (next(log.chunks()).partner >= 0).sum() / 3 / 40
    assert result.collision_rates[0].rate.value == pytest.approx(rate, rel=1e-12)
    assert result.free_paths[0].time.value == pytest.approx(1 / rate, rel=1e-12)
    assert pairs > 0


def test_rooms_and_shares_of_sides():
    """What centres reach; flows over the axes with walls; forces of an axis on both of its sides; means of theories."""
    gas = gas_of((10, 8), [(1, 1), (2, 2)], 0.0, [0.5, 0.25])
    assert _reach(gas).tolist() == [[9.0, 7.0], [9.5, 7.5]]
    flow = np.array([[1.0, 2.0], [3.0, 4.0]])
    assert [_across(flow, sides).tolist() for sides in ((False, False), (True, False))] == [[3.0, 7.0], [2.0, 4.0]]
    assert _on_sides(flow).tolist() == [[1.0, 3.0], [1.0, 3.0], [2.0, 4.0], [2.0, 4.0]]
    parts = (Theory(1.0, 0.1, "a"), 0.25), (Theory(3.0, 0.5, "b"), 0.75)
    assert _average(parts) == Theory(2.5, pytest.approx(0.4), "a")
    assert _average((*parts, (None, 0.0))) is None


def test_pressures_of_two_discs_in_lanes(lanes):
    """2 m |v| for each hit, over the time 180 and the lengths 8 of left and right, 10 of the others."""
    result = pressure(lanes, 0.0)
    rows = next(lanes.chunks())
    impulse = {0: (4.0, 2.0), 1: (4.0, 2.0)}
    walls = {wall.name: wall.pressure.value for wall in result.mechanical.walls}
    hits = {(d, w): int(((rows.disc == d) & (rows.partner == -1 - w)).sum()) for d in (0, 1) for w in range(5)}
    for side, name in ((0, "left wall"), (1, "right wall")):
        given = sum(impulse[d][0] * hits[d, side] for d in (0, 1))
        assert walls[name] == pytest.approx(given / 180 / 8, rel=1e-9)
    for name, disc, wall in (("bottom wall", 0, 2), ("top wall", 1, 3), ("wall 4, up", 1, 4), ("wall 4, down", 0, 4)):
        assert walls[name] == pytest.approx(impulse[disc][1] * hits[disc, wall] / 180 / 10, rel=1e-9)
    forces = {force.name: (force.x.value, force.y.value) for force in result.mechanical.forces}
    on_wall = (impulse[0][1] * hits[0, 4] - impulse[1][1] * hits[1, 4]) / 180
    along_x = sum(impulse[d][0] * (hits[d, 1] - hits[d, 0]) for d in (0, 1)) / 180
    assert forces["wall 4"][1] == pytest.approx(on_wall, rel=1e-9)
    assert forces["all walls"][0] == pytest.approx(along_x, abs=1e-9)
    assert result.area == 80.0
