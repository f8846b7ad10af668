"""Transport: collision rates, free paths, diffusion, viscosities, thermal conductivity and pair distribution.

Rates and free paths count every event of the window, and so do the currents of momentum and energy. Velocity
correlation and displacement use the exact positions and velocities of discs at evenly spaced instants.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.collisions import (
    CollisionRate,
    FreePath,
    collision_rates,
    expected_rates,
    free_paths,
    theory_of,
)
from idealgas.analysis.core.ensemble import centre_of_mass_velocity, ensemble
from idealgas.analysis.core.equilibration import Window, measure
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.samples import sampled
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.core.stream import sample_trajectories
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.ensemble import Composition, Ensemble, composition
from idealgas.analysis.theory.values import Theory
from idealgas.analysis.transport.coefficients import Collective, collective, flow_in_events, flow_in_samples
from idealgas.analysis.transport.correlations import correlation, mean_square_displacement, velocity_integral
from idealgas.analysis.transport.enskog import Enskog, enskog, mutual_diffusion, self_diffusion
from idealgas.analysis.transport.pair_distribution import PairDistribution, pair_distributions
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log

LAGS = 200  # number of steps of the correlation functions
FEWEST_SEGMENTS, MOST_SEGMENTS = 8, 64
MOST_SAMPLES = 2**21  # largest number of discs times instants
FITTED_FROM = 0.5  # share of the longest lag from which on the displacement is fitted
LEAST_LAG = 10.0  # mean free times; D from shorter lags is too small, as velocities still remember where they came from
LEAST_MEMORIES = 4.0  # velocity correlation times; the same for discs that keep their velocity for longer
LEAST_WINDOW = 16.0  # longest lags; in one of eight, coefficients of the whole gas are too small by up to a fourth
FREE_SHARE = 0.05  # largest displacement, relative to the box between two walls, that walls hardly change


@dataclass(frozen=True)
class Diffusion:
    """Velocity correlation and diffusion of one species at L lags.

    species: name. lag: (L,), time. correlation, correlation_error: (L,), ⟨v(0)·v(t)⟩/⟨v²⟩ and its standard error (no
    unit). displacement, displacement_error: (L,), mean square displacement and its standard error, length². tail: (L,),
    correlation at late times by theory; None for several species or above freezing. running, running_error: (L,), a
    quarter of the slope of the displacement, length²/time, and its standard error. coefficient: diffusion coefficient
    D, a quarter of the slope of the displacement at late lags, length²/time; its theory is Enskog's.
    velocity_correlation_time: integral of the correlation up to the same lags, their mean, time; its theory is that of
    mD/T.
    """

    species: str
    lag: np.ndarray
    correlation: np.ndarray
    correlation_error: np.ndarray
    displacement: np.ndarray
    displacement_error: np.ndarray
    tail: np.ndarray | None
    running: np.ndarray
    running_error: np.ndarray
    coefficient: Estimate
    velocity_correlation_time: Estimate


@dataclass(frozen=True)
class Contact:
    """Contact value χ of the pair distribution of two species (no unit), from their collision rate."""

    species: str
    other: str
    value: Estimate


@dataclass(frozen=True)
class Transport(Result):
    """Transport in the gas of one log.

    window: the time that was used. packing_fraction: φ. number: of discs. free_times: lag up to which discs and
    currents are followed, in mean free times of the slowest species. walled: whether walls reflect diffusing discs.
    collision_rates, contacts, pair_distributions: of each pair of species. free_paths, diffusion: of each species.
    collective: viscosities, thermal conductivity and pressure tensor; None with walls, which change the currents.
    """

    window: Window
    packing_fraction: float
    number: int
    free_times: float
    walled: bool
    collision_rates: tuple[CollisionRate, ...]
    free_paths: tuple[FreePath, ...]
    contacts: tuple[Contact, ...]
    diffusion: tuple[Diffusion, ...]
    collective: Collective | None
    pair_distributions: tuple[PairDistribution, ...]


def transport(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    lag: float = 20.0,
) -> Transport:
    """Measure how discs, momentum and heat spread in a gas between two times of its log, beside Enskog's theory.

    Collision rates and free paths of each species; the contact value χ of each pair of species; mean square
    displacement, velocity autocorrelation and from the first the diffusion coefficient; shear and bulk viscosity,
    thermal conductivity, diffusion of two species in each other and pressure tensor in a periodic box; pair
    distribution functions. Without events the sums of `log.pressure = true` and `log.heat_flow = true` give the
    collision rates and what follows from the currents of a periodic gas.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. lag: longest time for which discs and currents are followed, in mean free times.

    Raises UserError if no disc moves, if there are no events or too few samples in the window, or for a gas with
    effects other than periodic sides.
    """
    equilibrium = ensemble(log)
    if not equilibrium.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")
    if not log.has_events:
        return _from_samples(log, equilibrium, start, end, lag)
    moments, impacts = Moments(), Impacts(len(log.walls), log.periodic)
    window = measure(log, [moments, impacts], start, end, progress, ("uniform", "conserves_motion"))
    gas, discs = log.discs, composition(log.discs)
    box = theory_of(log, discs)
    expected, enskogs = expected_rates(discs, gas.box, equilibrium, box), enskog(log, discs, equilibrium)
    rates = collision_rates(discs, expected, window, impacts)
    free_time = _free_time(discs, rates)
    longest = min(lag * free_time, window.duration / FEWEST_SEGMENTS)
    alone = [enskogs.diffusion] if enskogs else self_diffusion(log, discs, equilibrium, expected)
    diffusion = _diffusion(log, discs, window, longest, (enskogs, alone, equilibrium.of_species))
    whole = None
    if all(log.periodic):
        theories = enskogs, box.pairs, mutual_diffusion(log, discs, equilibrium, expected)
        whole = collective(*flow_in_events(log, window, longest, progress), log, equilibrium, longest, theories)
    return Transport(
        window=window,
        packing_fraction=gas.packing_fraction,
        number=len(gas),
        free_times=(whole.plateau[1] if whole else longest) / free_time,
        walled=not all(log.periodic),
        collision_rates=rates,
        free_paths=free_paths(discs, expected, equilibrium, window, moments, impacts),
        contacts=_contacts(discs, gas.area, equilibrium, rates),
        diffusion=diffusion,
        collective=whole,
        pair_distributions=pair_distributions(log, discs, window.start, window.end),
        caveats=(
            *_short_lags(rates, diffusion),
            *_short_currents(whole, longest / free_time, window.duration / longest),
            *_reflected(log, diffusion),
        ),
    )


def _from_samples(log: Log, equilibrium: Ensemble, start: float | None, end: float | None, lag: float) -> Transport:
    """Transport in a gas without events: what sums in its samples tell."""
    if not all(log.periodic):
        raise NotApplicableError(f"{log.path}: has no events, and samples tell of transport with periodic sides only")
    window, impacts = sampled(log, start, end, ("uniform", "conserves_motion"))
    gas, discs, box = log.discs, composition(log.discs), theory_of(log, composition(log.discs))
    rates = collision_rates(discs, expected_rates(discs, gas.box, equilibrium, box), window, impacts)
    free_time = _free_time(discs, rates)
    longest = min(lag * free_time, window.duration / FEWEST_SEGMENTS)
    currents, theories = flow_in_samples(log, window, longest), (enskog(log, discs, equilibrium), box.pairs, None)
    whole = collective(*currents, log, equilibrium, longest, theories)
    return Transport(
        window=window,
        packing_fraction=gas.packing_fraction,
        number=len(gas),
        free_times=whole.plateau[1] / free_time,
        walled=False,
        collision_rates=rates,
        free_paths=(),
        contacts=_contacts(discs, gas.area, equilibrium, rates),
        diffusion=(),
        collective=whole,
        pair_distributions=(),
        caveats=tuple(_short_currents(whole, longest / free_time, window.duration / longest)),
    )


def _short_lags(rates: Sequence[CollisionRate], diffusion: Sequence[Diffusion]) -> Iterator[str]:
    """Sentence for each species whose displacement is followed for too short a time."""
    for entry in diffusion:
        longest, found = float(entry.lag[-1]), entry.velocity_correlation_time
        free_times = longest * sum(found.rate.value for found in rates if found.species == entry.species)
        if free_times < LEAST_LAG:
            yield (
                f"The window is short: {entry.species} is followed for {free_times:.2g} mean free times at most; its "
                f"diffusion coefficient and velocity correlation time take {LEAST_LAG:g}."
            )
        elif longest < (least := LEAST_MEMORIES * (found.theory or found.value)):
            yield (
                f"{entry.species} is followed for {longest:.3g}, and keeps its velocity for a time: its diffusion "
                f"coefficient and velocity correlation time take {least:.3g}, by a larger --lag."
            )


def _short_currents(whole: Collective | None, free_times: float, lags: float) -> Iterator[str]:
    """Sentence on currents that are followed for too short a time, or in a window of too few such times."""
    if whole and free_times < LEAST_LAG:
        yield (
            f"The window is short: currents are followed for {free_times:.2g} mean free times at most; viscosities and "
            f"thermal conductivity take {LEAST_LAG:g}."
        )
    elif whole and lags < LEAST_WINDOW:
        yield (
            f"The window is short: {lags:.3g} times as long as currents are followed ({LEAST_WINDOW:g} needed); "
            "viscosities and thermal conductivity may be too small by more than their errors."
        )


def _reflected(log: Log, diffusion: Sequence[Diffusion]) -> Iterator[str]:
    """Sentence for each species whose displacement walls make smaller."""
    widths = [size for size, is_periodic in zip(log.box, log.periodic, strict=True) if not is_periodic]
    for entry in diffusion:
        far = math.sqrt(entry.displacement[-1])
        if widths and far > FREE_SHARE * min(widths):
            yield (
                f"Walls reflect discs of {entry.species}, which move {far:.3g} in a box of {min(widths):.3g} while "
                "followed; in an infinite gas D is larger."
            )


def _contacts(
    discs: Composition, area: float, equilibrium: Ensemble, rates: tuple[CollisionRate, ...]
) -> tuple[Contact, ...]:
    """Contact values χ_ij: measured collision rates Γ_ij over those of discs at random positions."""
    contacts = []
    speed = hard_discs.mean_relative_speeds(equilibrium.temperature, discs.mass, equilibrium.dof)
    for k, found in enumerate(rates):
        i, j = divmod(k, len(discs.name))
        alone = 2 * (discs.radius[i] + discs.radius[j]) * (discs.number[j] - (i == j)) / area * speed[i, j]
        if j < i or alone == 0:
            continue
        contacts.append(Contact(found.species, found.other, found.rate.times(1 / alone)))
    return tuple(contacts)


def _free_time(discs: Composition, rates: tuple[CollisionRate, ...]) -> float:
    """Longest mean free time of a species, time; infinite if none collides."""
    per_disc = [sum(r.rate.value for r in rates if r.species == name) for name in discs.name]
    slowest = min((rate for rate in per_disc if rate > 0), default=0.0)
    return 1 / slowest if slowest else math.inf


def _diffusion(
    log: Log,
    discs: Composition,
    window: Window,
    longest: float,
    expected: tuple[Enskog | None, Sequence[Theory | None], np.ndarray],
) -> tuple[Diffusion, ...]:
    """Diffusion of each species up to the longest lag, time; expected: Enskog's theory, D and T of each species."""
    segments = min(int(window.duration / longest), MOST_SEGMENTS)
    lag = np.linspace(0.0, longest, LAGS + 1)
    starts = np.linspace(window.start, window.end - longest, segments)
    times = (starts[:, None] + lag).ravel()
    times = np.minimum(np.maximum.accumulate(times), window.end)
    most = max(MOST_SAMPLES // len(times) // len(discs.name), 1)
    members = [np.flatnonzero(log.discs.species == s) for s in range(len(discs.name))]
    chosen = [ids[:: -(-len(ids) // most)] for ids in members]
    places, velocities = sample_trajectories(log, times, np.concatenate(chosen))
    shape = (segments, len(lag), -1, 2)
    places, velocities = places.reshape(shape), velocities.reshape(shape) - centre_of_mass_velocity(log)
    places = places - lag[:, None, None] * centre_of_mass_velocity(log)
    cuts = np.cumsum([len(ids) for ids in chosen])[:-1]
    parts = zip(discs.name, np.split(places, cuts, axis=2), np.split(velocities, cuts, axis=2), strict=True)
    whole, coefficients, temperatures = expected
    theories = [
        (whole, alone, alone and alone.times(float(mass / temperature)))
        for alone, mass, temperature in zip(coefficients, discs.mass, temperatures, strict=True)
    ]
    return tuple(_of_species(*part, lag, *theory) for part, theory in zip(parts, theories, strict=True))


def _of_species(
    name: str,
    places: np.ndarray,
    velocities: np.ndarray,
    lag: np.ndarray,
    expected: Enskog | None,
    coefficient: Theory | None,
    memory: Theory | None,
) -> Diffusion:
    """Diffusion of one species from positions and velocities (segments, L, discs, 2), with theories of D and mD/T."""
    remembered = correlation(velocities, velocities)
    square = remembered[:, 0].mean()
    displacement = mean_square_displacement(places)
    late = slice(int(FITTED_FROM * LAGS), None)
    slope = np.polyfit(lag[late], displacement[:, late].T, 1)[0] / 4
    running = np.gradient(displacement, lag, axis=1) / 4
    correlation_time = velocity_integral(velocities, places)[:, late].mean(axis=1) / square
    count = math.sqrt(len(places))
    return Diffusion(
        name,
        lag,
        remembered.mean(axis=0) / square,
        remembered.std(axis=0, ddof=1) / square / count,
        displacement.mean(axis=0),
        displacement.std(axis=0, ddof=1) / count,
        tail=np.append(math.inf, _tail(lag[1:], expected)) if expected else None,
        running=running.mean(axis=0),
        running_error=running.std(axis=0, ddof=1) / count,
        coefficient=mean(slope, theory=coefficient),
        velocity_correlation_time=mean(correlation_time, theory=memory),
    )


def _tail(lag: np.ndarray, expected: Enskog) -> np.ndarray:
    return hard_discs.long_time_tail(lag, expected.density, expected.diffusion.value, expected.kinematic_viscosity)
