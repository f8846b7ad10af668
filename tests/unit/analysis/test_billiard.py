"""Mean path between walls, and the area and perimeter that centres of discs reach, against geometry by hand."""

import math

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas.analysis.billiard import UNMIXED
from idealgas.analysis.registry import analyse
from idealgas.tallies.reach import reach_of

# Places that discs touch are found within NEAR, 1e-9 of the box: lengths with ten such ends are right within 1e-8.
pytestmark = pytest.mark.usefixtures("uncompiled")


def test_a_polygon_in_a_box():
    """The box loses a frame of the radius, the polygon is wider by it, and its corners become arcs."""
    log = log_of("sinai", "run.events=2")
    radius, corners = log.discs.radius[0], np.array([wall.start for wall in log.scene.pieces])
    sides, (x, y) = np.diff(corners, axis=0, append=corners[:1]), corners.T
    around, inner = np.hypot(*sides.T).sum(), 10 - 2 * radius
    polygon = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    reach = reach_of(log, radius)
    assert reach.area == pytest.approx(inner**2 - (polygon + around * radius + math.pi * radius**2), rel=1e-8)
    assert reach.perimeter == pytest.approx(4 * inner + around + 2 * math.pi * radius, rel=1e-8)
    assert reach.holes == 0


def test_walls_with_free_ends():
    """Three baffles of length 7 that stand on sides: each has two faces and a half circle around its free end."""
    log = log_of("baffle", "run.events=2")
    radius = log.discs.radius[0]
    reach = reach_of(log, radius)
    baffle = 2 * radius * (7 - radius) + math.pi * radius**2 / 2
    assert reach.area == pytest.approx((20 - 2 * radius) * (10 - 2 * radius) - 3 * baffle, rel=1e-8)
    sides = 2 * (20 - 2 * radius) + 2 * (10 - 2 * radius) - 3 * 2 * radius
    assert reach.perimeter == pytest.approx(sides + 3 * (2 * (7 - radius) + math.pi * radius), rel=1e-8)


@pytest.mark.parametrize(
    ("name", "area", "perimeter"),
    [
        ("stadium", math.pi * (2 - 1e-6) ** 2 + 8 * (2 - 1e-6), 2 * math.pi * (2 - 1e-6) + 8),
        ("lorentz", 2.25 * 3.897114317029974 - 2 * math.pi * (1 + 1e-6) ** 2, 4 * math.pi * (1 + 1e-6)),
    ],
)
def test_curved_walls(name, area, perimeter):
    log = log_of(name, "run.events=40")
    reach = reach_of(log, 1e-6)
    assert (reach.area, reach.perimeter) == (pytest.approx(area, rel=1e-8), pytest.approx(perimeter, rel=1e-8))
    result = analyse(log, "billiard", start=0.0)
    assert result.path.theory == pytest.approx(math.pi * area / perimeter, rel=1e-8)
    assert UNMIXED in result.caveats


def test_the_mean_of_all_paths():
    """In a box without anything in it: the path of a disc that flies along x is its width less two radii."""
    log = log_of("sinai", "wall=", "disc.0.velocity=[1, 0]", "run.until=95")
    result = analyse(log, "billiard", start=0.0)
    assert result.hits == 10
    assert result.path.value == pytest.approx(9.5)
    assert result.path.theory == pytest.approx(math.pi * 9.5 / 4)
    time = result.window.edges[1:]
    hits = np.floor((time + log.discs.position[0, 0] - 0.25) / 9.5)
    assert result.series == pytest.approx(time / np.maximum(hits, 1))
    discs = ", ".join(f"{{ position = [{x}, {x}], velocity = [1, 0], radius = 0.25 }}" for x in (2, 8))
    result = analyse(log_of("sinai", "wall=", f"disc=[{discs}]", "run.until=20"), "billiard", start=0.0)
    assert result.path.theory_error == pytest.approx(math.pi * 9.5 / 4 * 2 * (2 * math.pi / 16 / 100))


def test_where_theory_is_silent():
    log = log_of("mixing", "run.until=2")
    result = analyse(log, "billiard", start=0.0)
    assert (result.path.theory, result.reason) == (None, "a wall opens, or lets discs pass")
    assert result.check().agrees is None
