"""Vibrating sides of the box."""

import math
from typing import Literal

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.properties import Properties
from idealgas.jit import aligned
from idealgas.physics import vibration as law
from idealgas.state import Gas
from idealgas.toml.table import Positive, Table


class Vibration(Table):
    """Motion of a vibrating side, between the side of the box and a height of twice the amplitude inside the box."""

    amplitude: Positive = Field(description="length > 0: half the distance between the extreme positions")
    frequency: Positive = Field(description="number of periods per unit time > 0, 1/time")
    motion: Literal["parabolas", "sine"] = Field(
        default="parabolas",
        description='"parabolas" in time (nearly harmonic, with contact times in closed form), or "sine"',
    )


class VibratingSide(Table):
    """`{ vibrating = { amplitude = A, frequency = f } }`: a side that starts at rest and moves up and down.

    It moves on parabolas in time or, with `motion = "sine"`, harmonically.
    """

    vibrating: Vibration = Field(description="amplitude and frequency")

    @property
    def action(self) -> str:
        """Short description for output."""
        sine = ", sine" if self.vibrating.motion == "sine" else ""
        return f"vibrating, amplitude {self.vibrating.amplitude:g}, frequency {self.vibrating.frequency:g}{sine}"

    @property
    def record(self) -> np.record:
        """Parameters of the motion, as a VIBRATION record for times since the start of the run."""
        (record,) = aligned(1, law.VIBRATION)
        record.amplitude, record.half = self.vibrating.amplitude, 0.5 / self.vibrating.frequency
        record.acceleration = 8 * record.amplitude / record.half**2
        if self.vibrating.motion == "sine":
            record.omega = math.pi / record.half
            record.acceleration = record.amplitude * record.omega**2
        return record

    def motion_at(self, times: np.ndarray) -> np.ndarray:
        """Return height, velocity and acceleration of the side (3, n) at times (n,), directed into the box."""
        record = self.record
        return np.array([law.motion_at(record, time) for time in times.tolist()], float).reshape(-1, 3).T


def reach(side: object) -> float:
    """Largest height that a side reaches inside the box, length."""
    return 2 * side.vibrating.amplitude if isinstance(side, VibratingSide) else 0.0


class VibrationEffect(Effect[np.recarray]):
    """Vibrating sides of the box."""

    name = "vibrating sides"
    field = "vibration"
    side = VibratingSide
    side_text = "{ vibrating = { amplitude = A, frequency = f } }"
    samples = (BenchmarkSample(box=lambda side: "bottom = { vibrating = { amplitude = 0.1, frequency = 1 } }\n"),)

    def properties(self, tables: Tables) -> Properties | None:
        if not any(map(reach, tables.sides)):
            return None
        return Properties(
            uniform=False,
            fixed_walls=False,
            allows_monte_carlo=False,
            allows_time_steps=False,
            is_scalable=False,
            vibrates=True,
            drives_discs=True,
        )

    def make(self, tables: Tables, _: GasAtStart) -> np.recarray:
        vibration = aligned(len(SIDES), law.VIBRATION)
        for k, side in enumerate(tables.sides):
            if isinstance(side, VibratingSide):
                vibration[k] = side.record
        return vibration

    def gives_energy(self, vibration: np.recarray) -> bool:
        return True

    def driving_speed(self, vibration: np.recarray, gas: Gas) -> float:
        sine, parabolas = vibration.amplitude * vibration.omega, 0.5 * (vibration.acceleration * vibration.half)
        return float(np.where(vibration.omega > 0.0, sine, parabolas).max())

    def begin_epoch(self, vibration: np.recarray, time: float, length: float) -> None:
        law.begin_epoch(vibration, time, length)


EFFECT = VibrationEffect()
