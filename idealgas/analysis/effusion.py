"""The flow of discs through a slit that opens, beside n⟨v⟩/π."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis import theory
from idealgas.analysis.composition import composition
from idealgas.analysis.ensemble import ensemble
from idealgas.analysis.statistics import Estimate
from idealgas.errors import UserError
from idealgas.log import Log

INSTANTS = 256


@dataclass(frozen=True)
class Effusion:
    """time: (INSTANTS,), from the opening on; beyond: (INSTANTS,), discs on the side that had fewer at first.

    density: of the fuller side if all were there. expected: (INSTANTS,), beyond by theory. speed: discs per time and
    open length, over the difference of the densities; theory: ⟨v⟩/π. Its error is that of a Poisson number of passages
    both ways.
    """

    density: float
    temperature: float
    time: np.ndarray
    beyond: np.ndarray
    expected: np.ndarray
    speed: Estimate

    @classmethod
    def from_dict(cls, found: dict[str, Any]) -> "Effusion":
        """What `as_dict` was made from."""
        time, beyond, expected = (np.array(found[name]) for name in ("time", "beyond", "expected"))
        speed = Estimate.from_dict(found["speed"])
        return cls(found["density"], found["temperature"], time, beyond, expected, speed)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "density": self.density,
            "temperature": self.temperature,
            "speed": self.speed.as_dict(),
            "time": self.time.tolist(),
            "beyond": self.beyond.tolist(),
            "expected": self.expected.tolist(),
        }


def effusion(log: Log, start: float | None = None, end: float | None = None) -> Effusion:
    """Measure a log of two chambers and one gate, by default from its opening to the end.

    UserError if there is no gate along an axis, or discs of several species.
    """
    gates = [wall for wall in log.scene.wall if wall.opens_at is not None]
    discs, equilibrium = composition(log.discs), ensemble(log)
    if len(gates) != 1 or len(discs.name) != 1 or not log.has_events:
        raise UserError(f"{log.path}: no effusion: it takes one gate, one species and the events")
    gate = gates[0]
    ends = np.array([gate.start, gate.end])
    across = int(np.ptp(ends[:, 0]) != 0)  # the axis that leads through the slit
    if np.ptp(ends[:, across]) != 0:
        raise UserError(f"{log.path}: no effusion: the gate is not along an axis")
    place, radius, number = ends[0, across], discs.radius[0], len(log.discs)
    opening = max(gate.opens_at or 0.0, log.start_time)
    time = np.linspace(opening if start is None else start, log.end_time if end is None else end, INSTANTS)
    above = np.array([(state.position[:, across] > place).sum() for state in log.frames(time)])
    if above[0] > number / 2:
        above, place = number - above, log.box[across] - place
    height = log.box[1 - across] - 2 * radius
    inner, outer = (place - 2 * radius) * height, (log.box[across] - place - 2 * radius) * height
    slit = float(np.ptp(ends[:, 1 - across])) - 2 * radius
    drive = np.trapezoid((number - above) / inner - above / outer, time)
    both = np.trapezoid((number - above) / inner + above / outer, time)
    if not slit > 0 or not drive > 0:
        raise UserError(f"{log.path}: no effusion: a slit that lets no disc pass, or chambers in balance")
    expected = theory.mean_speed(equilibrium.temperature, discs.mass[0], equilibrium.dof) / math.pi
    passed = float(above[-1] - above[0])
    speed = passed / (slit * drive)
    error = math.sqrt(expected * slit * both) / (slit * drive)
    decay = expected * slit * (1 / inner + 1 / outer)
    rest = number * outer / (inner + outer)
    course = rest + (above[0] - rest) * np.exp(-decay * (time - time[0]))
    found = Estimate(speed, error, max(passed, 1.0), expected)
    return Effusion(number / inner, equilibrium.temperature, time, above, course, found)
