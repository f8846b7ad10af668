"""Data of the player: what a page computes from them is the motion in the log."""

import base64

import numpy as np
import pytest
from helpers.logs import log_of

from idealgas.report.player import ACCURACY, LEAP, TICKS, player

pytestmark = pytest.mark.interpreted

GAS = """
species = [{name = "gas", count = 40, radius = 0.2, temperature = 1}]
run.until = 20
"""
PERIODIC = 'left = "periodic", right = "periodic"'
SCENES = {
    "walls": "box.size = [10, 5]",
    "periodic": f'box = {{size = [10, 5], {PERIODIC}, bottom = "periodic", top = "periodic"}}',
    "shear": f"box = {{size = [10, 5], {PERIODIC}, bottom = {{shear = 0.5}}, top = {{shear = 0.5}}}}",
    "gravity": "box.size = [10, 5]\ngravity.acceleration = [0.1, -1]",
    "leaving": "box.size = [10, 5]\nwall = [{from = [5, 0], to = [5, 2], absorbing = true}]",
}


@pytest.mark.parametrize("name", SCENES)
def test_discs_fly_to_the_places_in_the_log(name):
    log = log_of(SCENES[name] + GAS)
    played, events = player(log), next(log.chunks())
    start, box = log.state_at(0.0), log.box

    def column(key, kind):
        return np.frombuffer(base64.b64decode(played.arrays[key]), kind)

    leaps = iter(column("event_leap", "<u4").tolist())
    steps = [next(leaps) if step == LEAP else step for step in column("event_step", "<u2").tolist()]
    time = np.cumsum(steps) / TICKS * played.end
    disc, velocity = column("event_disc", "<u2"), column("event_velocity", "<f4").reshape(-1, 2)
    known = dict(zip(column("place_row", "<u4").tolist(), column("place", "<f4").reshape(-1, 2), strict=True))
    states = [(0.0, *state) for state in zip(start.position.astype("f4"), start.velocity.astype("f4"), strict=True)]
    worst, wraps = 0.0, played.head["wraps"]
    assert wraps == ((name in ("periodic", "shear")), name == "periodic")
    assert played.head["slide"] == (2.5 if name == "shear" else 0.0)
    for k, i in enumerate(disc.tolist()):
        since, place, speed = states[i]
        delay = time[k] - since
        place = place.astype(float) + speed.astype(float) * delay + np.array(played.head["gravity"]) * delay**2 / 2
        place = known.get(k, np.where(wraps, place % box, place))
        off = np.abs(place - events.position[k])
        worst = max(worst, np.minimum(off, np.where(wraps, np.array(box) - off, np.inf)).max())
        states[i] = time[k], place, velocity[k]
    assert np.array_equal(disc, events.disc)
    assert time == pytest.approx(events.time, rel=0, abs=played.end / TICKS)
    assert worst < 2 * ACCURACY * max(box)  # a position with 24 bits, and flights from there
    assert len(known) < len(disc) / 3
