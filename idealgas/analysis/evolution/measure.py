"""Evolution of a gas in time: temperature, pressure, energies, energy given by walls, and discs beyond a gate."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.core.ensemble import centre_of_mass_energy, centre_of_mass_velocity
from idealgas.analysis.core.equilibration import detect_equilibration
from idealgas.analysis.core.fields import OPTIONAL, reported
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.core.stream import span
from idealgas.analysis.evolution.pressure_series import PressureSeries, pressure_series
from idealgas.analysis.evolution.theory import Law, expected_law
from idealgas.analysis.theory.values import Theory
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.physics.piston import piston_energy
from idealgas.scene.walls import walls_inside

INSTANTS = 257


PISTON = "piston"
"""Name of the side with the piston among the sources of energy."""


@dataclass(frozen=True)
class Evolution(Result):
    """Evolution of a gas, at F evenly spaced times and at the P times of the samples stored during the run.

    time: (F,), times. temperature: (F,), mean m v²/2 per disc, energy. spin: (F,), mean I ω² per disc, energy; None
    without spin. beyond: fraction of the discs of each species beyond the first gate along an axis, (F,), by the name
    of the species. law: theory of the temperature at these times; None without one. samples: (P,), times of the
    samples. parts: parts of the energy, (P,), by name. given: energy from each wall, the piston (its work) and a heat
    bath since the start, (P,), by name. piston: (P,), its coordinate, length; None without one. balance: (P,), change
    since the start of the energy of discs and piston minus the energy from outside, relative to the largest part of the
    energy: rounding only. dissipated: energy lost since the start, (P,), in collisions of two discs and at walls, by
    name. pressure: mechanical pressure on walls in bins of time; None without events or hits of walls. rest: mean
    position of a piston with a mass once it is steady, length; None without one, or if it is not steady by the end.
    """

    time: np.ndarray
    temperature: np.ndarray
    spin: Annotated[np.ndarray | None, OPTIONAL]
    beyond: dict[str, np.ndarray]
    law: Law | None
    samples: np.ndarray
    parts: dict[str, np.ndarray]
    given: dict[str, np.ndarray]
    piston: Annotated[np.ndarray | None, OPTIONAL]
    balance: np.ndarray
    dissipated: dict[str, np.ndarray]
    pressure: PressureSeries | None = None
    rest: Estimate | None = None

    @property
    def track(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Times and coordinates of the piston, means over short blocks or samples; None without a piston."""
        if self.pressure and self.pressure.track:
            return self.pressure.track
        return None if self.piston is None else (self.samples, self.piston)

    @property
    @reported
    def end(self) -> dict[str, float]:
        """Last value of each series, by name."""
        series = {"temperature": self.temperature, "spin": self.spin, "piston": self.piston, "balance": self.balance}
        return {name: float(values[-1]) for name, values in series.items() if values is not None and len(values)}


HEAT_BATH = "the heat bath"

ROUNDING = 1e-12
"""Energy that collisions lose, relative to the largest there is, that is rounding."""


def evolution(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Evolution:
    """Follow temperature, pressure, energies, piston and the account of the walls in time, and discs beyond a gate.

    It needs no equilibrium. Theory, where there is one, is that of the temperature: in equilibrium, of a gas that cools
    by its collisions (Haff's law), or of one that a moving piston compresses (the adiabat).

    start, end: times; by default the whole log. progress(done, in all) is called as states are read. Raises UserError
    if the log does not cover the times or has no samples of the energy.
    """
    first, last = span(log, start, end)
    if not len(log.observables["kinetic_energy"][0]):
        raise UserError(f"{log.path}: no samples of the energy")
    observed = {name: values for name, (_, values) in log.observables.items()}
    samples = log.observables["kinetic_energy"][0]
    inside = (samples >= first) & (samples <= last)
    time, temperature, spin, beyond = _frames(log, first, last, progress) if log.has_events else _samples(log, inside)
    parts, given, dissipated, balance = _account(log, observed)
    law = expected_law(log, time)
    pressure = pressure_series(log, first, last)
    return Evolution(
        time,
        temperature,
        spin,
        beyond,
        law,
        samples[inside],
        {name: values[inside] for name, values in parts.items()},
        {name: values[inside] for name, values in given.items()},
        observed["piston_position"][inside] if "piston_position" in observed else None,
        balance[inside],
        {name: values[inside] for name, values in dissipated.items()},
        pressure,
        _rest(log, pressure, law),
        caveats=law.caveats if law else (),
    )


TimeSeries = tuple[np.ndarray, np.ndarray, np.ndarray | None, dict[str, np.ndarray]]


def _samples(log: Log, inside: np.ndarray) -> TimeSeries:
    """Evolution from the samples stored during the run, for a log without events."""
    time, kinetic = log.observables["kinetic_energy"]
    n, kinetic = len(log.discs), kinetic - centre_of_mass_energy(log)
    spin = None
    if "rotational_energy" in log.observables:
        spin = 2 * log.observables["rotational_energy"][1][inside] / n
    return time[inside], kinetic[inside] / n, spin, {}


def _frames(log: Log, first: float, last: float, progress: Callable[[int, int], None] | None) -> TimeSeries:
    """Evolution at evenly spaced times, from the events of a log."""
    gas, frame, inertia, gate = log.discs, centre_of_mass_velocity(log), log.inertia, _gate(log)
    number = np.bincount(gas.species)
    time = np.linspace(first, last, INSTANTS)
    temperature, spin, beyond = np.empty(len(time)), np.empty(len(time)), np.empty((len(time), len(number)))
    for k, state in enumerate(log.frames(time)):
        temperature[k] = (gas.mass * ((state.velocity - frame) ** 2).sum(axis=1)).mean() / 2
        if inertia is not None and state.angular_velocity is not None:
            spin[k] = (inertia * state.angular_velocity**2).mean()
        if gate is not None:
            axis, place = gate
            beyond[k] = np.bincount(gas.species, state.position[:, axis] > place, len(number)) / number
        if progress is not None:
            progress(k + 1, len(time))
    shares = dict(zip(gas.species_names, beyond.T, strict=True)) if gate is not None else {}
    return time, temperature, None if inertia is None else spin, shares


def _gate(log: Log) -> tuple[int, float] | None:
    """Axis (0 or 1) across the first gate that is parallel to an axis, and the coordinate of the gate on it."""
    for wall in walls_inside(log.scene):
        for axis in range(2):
            if wall.is_gate and wall.start[axis] == wall.end[axis]:
                return axis, wall.start[axis]
    return None


def _rest(log: Log, series: PressureSeries | None, law: Law | None) -> Estimate | None:
    """Mean place of a piston with a mass from when on it is steady, beside that of theory."""
    if not log.scene.piston or not log.scene.piston.mass or series is None or series.track is None:
        return None
    places = series.track[1]
    start = detect_equilibration([places])
    if start is None:
        return None
    if law is None or law.piston is None:
        return mean(places[start:])
    return mean(places[start:], Theory(law.piston, law.piston_error, law.text))


Series = dict[str, np.ndarray]


def source_label(name: str) -> str:
    """Heading of the energy that a wall, the piston or a heat bath gave to the discs."""
    return "work done by the piston" if name == PISTON else f"energy from {name}"


def _account(log: Log, observed: Series) -> tuple[Series, Series, Series, np.ndarray]:
    """Parts of the energy, energy from walls and a heat bath, energy lost by kind of collision, and the balance."""
    names = {"motion": "kinetic_energy", "spin": "rotational_energy", "height": "potential_energy"}
    parts = {part: observed[name] for part, name in names.items() if name in observed}
    given = observed.get("wall_energy", np.zeros((len(observed["kinetic_energy"]), 0)))
    lost = observed.get("dissipated_energy", np.zeros((len(given), 1 + len(log.walls))))
    counted, unpaid = np.ones(given.shape[1], bool), lost[:, 0]
    piston = log.scene.piston
    if piston and piston.mass:  # its energy is a part of the energy, so that it gives none from outside
        own = [wall.name for wall in log.walls].index(piston.side)
        counted[own], unpaid = False, unpaid + lost[:, 1 + own]
        pull = piston.acceleration(log.box, log.scene.properties.acceleration)
        place, velocity = observed["piston_position"], observed["piston_velocity"]
        parts["piston"] = piston_energy(piston.mass, place, velocity, pull)
    bath = observed.get("bath_energy", np.zeros(len(given)))
    from_outside = given[:, counted].sum(axis=1) + bath
    total = sum(parts.values()) + unpaid - from_outside
    scale = max(float(np.abs(series).max(initial=0.0)) for series in (*parts.values(), from_outside, unpaid))
    walls = [PISTON if piston and wall.name == piston.side else wall.name for wall in log.walls]
    sources = dict(zip(walls, given.T, strict=False)) | {HEAT_BATH: bath}
    rounding = ROUNDING * scale  # of elastic collisions
    by_source = {name: series for name, series in sources.items() if series.any()}
    sinks = zip(("discs", *walls), lost.T, strict=True)
    losses = {name: series for name, series in sinks if np.abs(series).max(initial=0.0) > rounding}
    return parts, by_source, losses, (total - total[0]) / (scale or 1.0)
