"""Positions of pistons and vibrating sides as functions of time.

The position of a piston is known at hits and samples and follows a parabola in between. The position of a vibrating
side is interpolated linearly between computed positions.
"""

from dataclasses import dataclass

import numpy as np

from idealgas.columns import Kind, axis_of, is_upper
from idealgas.log import Log
from idealgas.scene import Scene, VibratingSide
from idealgas.tallies.chambers import piston_names

STEPS = 32
"""Number of computed positions of a vibrating side per period."""

MOST_PERIODS = 2048
"""Largest number of periods in a film; a side that vibrates more often moves too fast to be seen and is not drawn."""


@dataclass(frozen=True)
class PistonTrack:
    """Motion of a piston or of a vibrating side.

    Attributes:
        axis: 0 for x, 1 for y.
        time: (K,), times at which its position is known.
        place: (K,), position at these times, length.
        pull: (K,), acceleration after these times, length/time².
        limits: smallest and largest position, length.
        outward: +1 if the gas is on the lower side of the piston along this axis, -1 if it is on the upper side, 0 if
            it is on both sides, and for a vibrating side.
        name: name shown in pictures.
    """

    axis: int
    time: np.ndarray
    place: np.ndarray
    pull: np.ndarray
    limits: tuple[float, float]
    outward: float
    name: str

    def at(self, time: float) -> float:
        """Return the position at a time, from the parabola through the known positions before and after that time."""
        k = int(np.clip(self.time.searchsorted(time, "right") - 1, 0, len(self.time) - 2))
        before, after = time - self.time[k], time - self.time[k + 1]
        step = self.time[k + 1] - self.time[k]
        place = (self.place[k + 1] * before - self.place[k] * after) / step + 0.5 * self.pull[k] * before * after
        return float(np.clip(place, *self.limits))


def piston_tracks(log: Log, start: float, end: float) -> list[PistonTrack]:
    """Return the tracks, between two times, of all pistons whose positions are known, and of vibrating sides."""
    tracks = [_track(log, k, start, end) for k in range(len(log.scene.piston))]
    tracks += [_side_track(log.scene, number, start, end) for number in range(len(log.scene.box.sides))]
    return [track for track in tracks if track is not None]


def _side_track(scene: Scene, number: int, start: float, end: float) -> PistonTrack | None:
    """Return the track of a side of the box between two times; None if it does not vibrate, or too fast."""
    side, axis = scene.box.sides[number], axis_of(number)
    if not isinstance(side, VibratingSide) or (end - start) * side.vibrating.frequency > MOST_PERIODS:
        return None
    length, step = scene.box.size[axis], 1 / (side.vibrating.frequency * STEPS)
    steps = np.arange(int(start / step), int(end / step) + 2)
    heights = side.motion_at(np.arange(STEPS) * step)[0, steps % STEPS]
    place = length - heights if is_upper(number) else heights
    return PistonTrack(axis, steps * step, place, np.zeros(len(steps)), (0.0, length), 0.0, "")


def pistons_at_start(scene: Scene) -> list[PistonTrack]:
    """Return a track for each piston in a scene, at rest at its initial position."""
    always = np.array([0.0, 1.0])
    return [
        PistonTrack(
            piston.axis,
            always,
            np.full(2, piston.start(scene.box.size)),
            np.zeros(2),
            (0.0, scene.box.size[piston.axis]),
            piston.outward,
            name,
        )
        for piston, name in zip(scene.piston, piston_names(scene), strict=True)
    ]


def _track(log: Log, k: int, start: float, end: float) -> PistonTrack | None:
    """Return the track of piston k from samples and the positions of discs that hit it; None if it is unknown."""
    piston, wall_id = log.scene.piston[k], [wall.name for wall in log.walls].index(log.scene.piston[k].wall)
    sampled, places = log.observables["piston_position"]
    if not len(sampled):
        return None
    first = max(int(sampled.searchsorted(start, "right")) - 1, 0)
    window = slice(first, int(sampled.searchsorted(end)) + 1)
    times, knots = [sampled[window]], [places[window, k]]
    outward = piston.outward_from(log.discs.position, log.box)
    names, last = ("time", "disc", "kind", "partner", "position"), max(end, float(sampled[window][-1]))
    for rows in log.chunks(names, log.row_at(sampled[first]), log.row_at(last, "right")):
        hits = (rows.kind == Kind.PISTON) & (rows.partner == -1 - wall_id)
        times.append(rows.time[hits])
        knots.append(rows.position[hits, piston.axis] + (outward * log.discs.radius)[rows.disc[hits]])
    time, unique = np.unique(np.concatenate(times), return_index=True)
    if len(time) < 2:
        return None
    pull = piston.acceleration(log.box, log.scene.properties.acceleration, time)
    limits = (0.0, log.box[piston.axis])
    place, name = np.concatenate(knots)[unique], piston_names(log.scene)[k]
    return PistonTrack(piston.axis, time, place, pull, limits, piston.outward, name)
