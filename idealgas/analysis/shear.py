"""Measure the viscosity of a gas between sheared sides, its temperature, and its flow profile."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.errors import NotApplicableError
from idealgas.fields import OMITTED
from idealgas.log import Flights, Log
from idealgas.physics.shear import flow_at
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate, estimate, mean, ratio
from idealgas.tallies.equilibration import Observable, Window, after_changes, detect_equilibration, memory_time
from idealgas.tallies.equilibrium import kind_of_state, nonstationary_reason, not_steady
from idealgas.tallies.exchange import Exchange
from idealgas.tallies.stream import add_to, block_edges, frames, stream
from idealgas.tallies.stress import PassedOn
from idealgas.theory import enskog, hard_discs
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.values import Theory, fluid

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRIPS, INSTANTS = 20, 200
"""Number of strips of the flow profile, and number of instants at which it is sampled."""

FAST = 0.1
"""Largest shear rate without a caveat, and largest rate of a heat bath for which theory predicts the viscosity.

Both are in units of the collision rate of a disc. At this shear rate the viscosity of a dilute gas is lower by 2 %.
"""

DRIFT = 0.1
"""Largest relative change in the temperature during the window for which the window counts as a single state."""


@dataclass(frozen=True)
class ShearFlow(Result):
    """Shear flow of a gas, with velocities relative to the mean flow.

    Attributes:
        window: window of time that was used.
        rate: shear rate, 1/time.
        reduced_rate: shear rate over the collision rate of a disc.
        temperature: temperature T, mean of m c²/2, energy.
        viscosity: -P_xy/rate at T, mass/time; it is √T times the mean, over all blocks, of the viscosity divided by √T
            of the block.
        pressure: (P_xx + P_yy)/2 at T, energy/length²; it is T times the mean, over all blocks, of the pressure divided
            by T of the block.
        normal_stress: (P_xx - P_yy) divided by the pressure (no unit).
        slope: slope of the mean velocity against y, divided by the rate (no unit).
        y: (20,), middles of the strips, length.
        velocity: (20,), mean velocity along x in the strips, relative to the flow in the middle of the box,
            length/time.
        temperatures: (B,), temperature of each block that was read, energy.
        viscosities: (B,), viscosity of each block that was read, mass/time.
    """

    window: Window
    rate: float
    reduced_rate: float
    temperature: Estimate
    viscosity: Estimate
    pressure: Estimate
    normal_stress: Estimate
    slope: Estimate
    y: np.ndarray
    velocity: np.ndarray
    temperatures: Annotated[np.ndarray, OMITTED]
    viscosities: Annotated[np.ndarray, OMITTED]

    def plain_tables(self) -> list[Table]:
        """Return the table of temperature, viscosity, pressure, normal stress and slope of the flow."""
        notes = (
            f"{self.window}; shear rate {self.rate:.6g}, {self.reduced_rate:.3g} of the collision rate",
            "theory: viscosity from Enskog theory, pressure from the virial series, for a slow flow of elastic discs",
        )
        return [estimates("Shear flow, velocities relative to the flow", self._rows(), notes)]

    def summary(self) -> str:
        """Return the headline: viscosity and temperature, and whether the viscosity agrees with theory."""
        viscosity = f"η = {format_estimate(self.viscosity)} at T = {format_estimate(self.temperature)}"
        why = "it is known only for equal smooth elastic discs, without a heat bath or with a weak one"
        return f"{viscosity}; {agreement([('viscosity', self.viscosity)], 'Enskog', why)}."

    def figure(self) -> "Figure":
        """Draw viscosity and temperature against time, and the flow profile."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, (above, middle, below) = panels(3)
        viscosity, edges = self.viscosity, self.window.edges
        for ax, values, average, name in (
            (above, self.viscosities, viscosity, "viscosity η (mass/time)"),
            (middle, self.temperatures, self.temperature, "temperature T (energy)"),
        ):
            ax.stairs(values, edges, baseline=None, color=COLOURS[0], linewidth=0.9, label="blocks of time")
            ax.plot([self.window.start, self.window.end], [average.value] * 2, color=COLOURS[1], label="mean")
            if average.theory is not None:
                ax.theory(None, average.theory, average.theory_error, "Enskog")
            if self.window.first:
                ax.axvspan(edges[0], self.window.start, color=GREY, alpha=0.2, linewidth=0, label="left out")
            ax.time_axis()
            ax.set_ylabel(name)
            ax.legend()
        below.plot(self.velocity, self.y, "o", ms=4, color=COLOURS[0], label="measured")
        ends = np.array([0.0, 2 * self.y.mean()])
        below.theory(flow_at(ends, self.rate, ends[1]), ends, 0.0, "rate · (y − height/2)")
        below.set_xlabel("mean velocity along x (length/time)")
        below.set_ylabel("y (length), against the flow")
        below.legend()
        return figure

    def _rows(self) -> list[tuple[str, Estimate]]:
        """Return the names and estimates of all quantities."""
        return [
            ("temperature T (energy)", self.temperature),
            ("viscosity η (mass/time)", self.viscosity),
            ("pressure (energy/length²)", self.pressure),
            ("(P_xx − P_yy)/P (no unit)", self.normal_stress),
            ("slope of the flow over the rate (no unit)", self.slope),
        ]


class Carried:
    """Momentum flux carried by discs relative to the flow, and the correlation of their velocity with y.

    Attributes:
        stress: (B, 3), integrals of m c_x², m c_y² and m c_x c_y over time.
        excess: (B,), integral of m y c_x over time, where y is measured from the middle of the box.
        moment: (B,), integral of m y² over time.
    """

    columns = ("disc", "block", "start", "end", "velocity", "position")
    cut = True

    def __init__(self, rate: float, height: float, drift: float) -> None:
        """Set the shear rate, the height of the box, and the velocity at which the gas and its flow drift along y."""
        self._rate, self._height, self._drift = rate, height, drift

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self._mass, self._sums = gas.mass, np.zeros((5, len(edges) - 1))

    def add(self, flights: Flights) -> None:
        """Add flights, during which c_x, and y relative to the drifting gas, are linear in time."""
        assert flights.position is not None
        mass, t = self._mass.take(flights.disc), flights.end - flights.start
        y, (vx, vy) = flights.position[:, 1], flights.velocity.T
        flow = flow_at(y - self._drift * flights.start, self._rate, self._height)
        height, rise, c, slope = y - 0.5 * self._height, vy + self._drift, vx - flow, -self._rate * vy
        integrals = (
            _product(c, slope, c, slope, t),
            vy * vy * t,
            _product(c, slope, vy, np.zeros_like(vy), t),
            _product(height, rise, c, slope, t),
            _product(height, rise, height, rise, t),
        )
        for sums, values in zip(self._sums, integrals, strict=True):
            add_to(sums, flights.block, mass * values)

    def finish(self) -> None:
        """Set the attributes from the sums."""
        self.stress, self.excess, self.moment = self._sums[:3].T, self._sums[3], self._sums[4]


def _product(a: np.ndarray, da: np.ndarray, b: np.ndarray, db: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the integral of (a + da t)(b + db t) from 0 to t."""
    return t * (a * b + t * ((a * db + b * da) / 2 + t * (da * db / 3)))


def shear(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ShearFlow:
    """Measure viscosity, temperature and normal stress of a gas between sheared sides, between two times of its log.

    The pressure tensor P is calculated with velocities c relative to the flow: P A is the mean of Σ m c c plus the sum,
    per time, of the momentum that each collision transfers times the vector between the two centres. The viscosity is
    -P_xy/rate.

    Raises:
        UserError: if the box has no sheared sides, if the log has no events, or if the gas does not become steady.
    """
    gas, (width, height), rate = log.discs, log.box, log.scene.properties.shear
    if not rate:
        raise NotApplicableError(
            f"{log.path}: shear requires sheared sides, box.bottom and box.top = {{ shear = rate }}"
        )
    edges = block_edges(log, start, end)
    carried = Carried(rate, height, float(centre_of_mass_velocity(log.scene, log.discs)[1]))
    passed_on = PassedOn(1, np.array([0.0, height]), log.periodic, rate)
    stream(log, edges, [carried, passed_on], progress)
    block = edges[1] - edges[0]
    pressure = (carried.stress + passed_on.stress[:, 0]) / (width * height * block)
    temperatures = carried.stress[:, :2].sum(axis=1) / (2 * len(gas) * block)
    if not (temperatures > 0).all():
        raise NotApplicableError(f"{log.path}: no disc moves relative to the flow")
    viscosities = -pressure[:, 2] / rate
    reduced, heats = viscosities / np.sqrt(temperatures), bool(nonstationary_reason(log))
    series = [reduced] if heats else [reduced, temperatures]
    first = _first(log, edges, series) if start is None else 0
    memory = memory_time(values[first:] for values in series) * block
    slowest = Exchange(memory, "the flow and its temperature lose memory of earlier values")
    window = Window(edges, first, start is None, kind_of_state(log), slowest)
    p, t = pressure[first:], temperatures[first:]
    temperature = mean(t)
    collisions = 2 * passed_on.collisions[first:].sum() / (len(gas) * window.duration)
    reduced_rate = rate / collisions if collisions else math.inf
    expected, law = _theories(log, reduced_rate)
    isotropic = p[:, :2].mean(axis=1)
    return ShearFlow(
        window=window,
        rate=rate,
        reduced_rate=reduced_rate,
        temperature=temperature,
        viscosity=mean(reduced[first:], expected).times(math.sqrt(temperature.value)),
        pressure=mean(isotropic / t, law).times(temperature.value),
        normal_stress=ratio(p[:, 0] - p[:, 1], isotropic),
        slope=estimate(lambda a, b: 1 + a / (rate * b), carried.excess[first:], carried.moment[first:], theory=1.0),
        y=(np.arange(STRIPS) + 0.5) * height / STRIPS,
        velocity=_profile(log, np.linspace(window.start, window.end, INSTANTS)),
        temperatures=temperatures,
        viscosities=viscosities,
        caveats=_caveats(t, heats, reduced_rate, expected is not None),
    )


def _first(log: Log, edges: np.ndarray, series: list[np.ndarray]) -> int:
    """Return the index of the first block of the steady state, detected from several series (B,)."""
    begin = after_changes(log, edges)
    first = detect_equilibration(Observable(values[begin:]) for values in series)
    if first is None:
        raise not_steady(log, "the gas still changes in the second half of the log")
    return begin + first


def _theories(log: Log, reduced_rate: float) -> tuple[Theory | None, Theory | None]:
    """Return Enskog's viscosity and the pressure at T = 1 of equal smooth elastic discs; None for other discs.

    A shear rate of a times the collision rate lowers the viscosity by a fraction of about 2a², and a heat bath whose
    rate is x times the collision rate lowers it by a fraction of about x. Both are included in the error of the
    viscosity, which is None if x exceeds FAST.
    """
    gas, properties = log.discs, log.scene.properties
    if not (properties.elastic and properties.collisions_conserve_energy) or properties.spins:
        return None, None
    if len(gas.species_names) > 1 or gas.unlike or gas.packing_fraction > hard_discs.HIGHEST:
        return None, None
    phi, density, z = gas.packing_fraction, len(gas) / gas.area, fluid(gas.packing_fraction)
    chi = hard_discs.fluid_contact_value(phi)
    viscosity = enskog.viscosity(2 * gas.radius[0], density, 1.0, gas.mass[0], chi)
    bath = reduced_rate * properties.thermostat_rate / properties.shear
    of_finite = (z.value - 1) / len(gas)  # relative difference of the collisional part for N discs
    error = enskog.relative_error("viscosity", phi) + bath + 2 * reduced_rate**2
    return (
        Theory(viscosity, error * viscosity, "Enskog") if bath <= FAST and reduced_rate < math.inf else None,
        Theory(z.value, z.error + of_finite, z.source).times(density),
    )


def _profile(log: Log, times: np.ndarray) -> np.ndarray:
    """Return the mean velocity along x in strips, (20,), length/time, over times (T,); nan in strips without discs.

    The velocity is relative to the flow in the middle of the box.
    """
    momentum, mass = np.zeros((2, STRIPS))
    (common, drift), rate = centre_of_mass_velocity(log.scene, log.discs), log.scene.properties.shear
    for state in frames(log, times, None):
        strip = np.clip(state.position[:, 1] / log.box[1] * STRIPS, 0, STRIPS - 1).astype(np.intp)
        relative = state.velocity[:, 0] - common + rate * drift * state.time
        momentum += np.bincount(strip, log.discs.mass * relative, STRIPS)
        mass += np.bincount(strip, log.discs.mass, STRIPS)
    return np.divide(momentum, mass, out=np.full(STRIPS, math.nan), where=mass > 0)


def _caveats(temperatures: np.ndarray, heats: bool, reduced_rate: float, known: bool) -> tuple[str, ...]:
    """Return caveats on a changing temperature (B,) and on a high shear rate.

    heats: whether the shear heats the gas. known: whether the viscosity has a theoretical value.
    """
    sentences = []
    quarter = max(len(temperatures) // 4, 1)
    before, after = float(temperatures[:quarter].mean()), float(temperatures[-quarter:].mean())
    if abs(after - before) > DRIFT * temperatures.mean():
        reason = ", as shear heats the gas" if heats else ""
        which = "is that at the mean temperature, as" if heats else "describes a single state only if"
        sentences.append(
            f"The temperature changes from {before:.4g} to {after:.4g} in the window{reason}: the viscosity {which} "
            "it is proportional to √T."
        )
    if reduced_rate > FAST:
        sentences.append(
            f"The shear rate is {reduced_rate:.2g} of the collision rate of a disc: the viscosity may be less than "
            f"that of a slow flow{', which theory gives' if known else ''}."
        )
    return tuple(sentences)


class ShearAnalysis(Analysis):
    """Viscosity of a gas in shear flow."""

    position = 95
    headline = "viscosity"
    start = "where viscosity/√T is steady"
    supports_shear = True
    results = (ShearFlow,)
    sections = (Section("Shear flow", "Viscosity and temperature in time, and mean velocity against height"),)

    measure = staticmethod(shear)
