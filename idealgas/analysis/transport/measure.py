"""Transport: collision rates, free paths, diffusion, viscosities, thermal conductivity and pair distribution.

Rates, free paths and the currents of momentum and energy include every event in the window. Velocity correlations and
displacements are calculated from the positions and velocities of discs at evenly spaced instants.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from idealgas.analysis.transport.coefficients import Collective, collective, flow_in_events, flow_in_samples
from idealgas.analysis.transport.diffusion import (
    LEAST_LAG,
    Diffusion,
    LagLimits,
    diffusion,
    diffusion_caveats,
    diffusion_limits,
)
from idealgas.analysis.transport.enskog import coefficients_of, mutual_diffusion, self_diffusion
from idealgas.analysis.transport.pair_distribution import Contact, pair_distributions
from idealgas.analysis.transport.result import Transport
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.scene.walls import walls_inside
from idealgas.state import MOST_PAIRED
from idealgas.tallies.collisions import CollisionRate, collision_rates, expected_rates, free_paths, theory_of
from idealgas.tallies.currents import Currents, pressure_tensor
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.samples import SampledImpacts, sampled
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import Composition, Ensemble, composition

FEWEST_SEGMENTS = 8  # smallest number of segments in the window, each as long as the longest lag
LEAST_WINDOW = 16.0  # in longest lags; with 8, coefficients of the whole gas are too small by up to a quarter
SURE_WINDOW = 200.0  # in longest lags, for correct errors; with 75 the rms deviation is up to 1.25 errors


def transport(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    lag: float = 20.0,
) -> Transport:
    """Measure how discs, momentum and heat spread in a gas between two times of its log, compared with Enskog's theory.

    The result contains the collision rates and free paths of each species, the contact value χ of each pair of species,
    mean square displacements with diffusion coefficients, velocity autocorrelations, pair distributions and the
    pressure tensor. In a periodic box it also contains the shear and bulk viscosities, the thermal conductivity and the
    mutual diffusion coefficient of two species. Among fixed discs in a periodic box only diffusion is measured. Without
    events, the sums of `log.pressure = true` and `log.heat_flow = true` give the collision rates and the coefficients
    that follow from the currents of a periodic gas.

    Args:
        log: the log.
        start: start of the window, time; None to detect it.
        end: end of the window, time; None for the end of the log.
        progress: called as progress(done, total) while the log is read.
        lag: longest lag up to which discs and currents are followed, in mean free times.

    Raises:
        UserError: if no disc moves, if there are no events or too few samples in the window, or if the gas is subject
            to effects other than periodic sides and fixed discs.
    """
    equilibrium, needs = ensemble(log), ("uniform", "conserves_motion", "interacting")
    if not equilibrium.temperature > 0:
        raise UserError(f"{log.path}: no disc moves")
    if (inside := walls_inside(log.scene)) and all(wall.radius for wall in inside) and all(log.periodic):
        return _among_fixed_discs(log, equilibrium, start, end, progress, lag)
    impacts: Impacts | SampledImpacts
    if log.has_events:
        moments, events, currents = Moments(), Impacts(len(log.walls), log.periodic), Currents(log.periodic)
        window, impacts = measure(log, [moments, events, currents], start, end, progress, needs), events
        flow = currents.flow
    else:
        window, impacts = sampled(log, start, end, needs)
        flow = impacts.flow
        if not impacts.collisions.size:
            most = f"collisions by species (kept for up to {MOST_PAIRED} of them)"
            raise UserError(f"{log.path}: has neither events nor {most}")
    gas, discs, box = log.discs, composition(log.discs), theory_of(log)
    expected, enskogs = expected_rates(gas.box, equilibrium, box), coefficients_of(log, discs, equilibrium)
    rates = collision_rates(discs, expected, window, impacts)
    free_time = _free_time(impacts, discs, window)
    longest = min(lag * free_time, window.duration / FEWEST_SEGMENTS)
    limits: list[LagLimits] = []
    spreading: tuple[Diffusion, ...] = ()
    if log.has_events:
        alone = [enskogs.diffusion] if enskogs else self_diffusion(log, equilibrium, expected)
        limits = diffusion_limits(log, discs, window.of(impacts.collisions), equilibrium)
        spreading = diffusion(log, discs, window, longest, limits, (enskogs, alone, equilibrium))
    whole, followed = None, float(spreading[0].lag[-1]) if spreading else longest
    if all(log.periodic):
        parts = (
            flow_in_events(log, window, longest, progress) if log.has_events else flow_in_samples(log, window, longest)
        )
        theories = enskogs, mutual_diffusion(log, discs, equilibrium, expected)
        whole = collective(*parts, log, equilibrium, longest, theories)
        followed = whole.plateau[1]
    return Transport(
        window=window,
        packing_fraction=gas.packing_fraction,
        number=len(gas),
        free_times=followed / free_time,
        walled=not all(log.periodic),
        collision_rates=rates,
        free_paths=free_paths(discs, expected, equilibrium, window, moments, events) if log.has_events else (),
        contacts=_contacts(gas.area, equilibrium, rates),
        diffusion=spreading,
        collective=whole,
        pressure=pressure_tensor(log, equilibrium, box, window.of(flow)),
        pair_distributions=pair_distributions(log, discs, window.start, window.end) if log.has_events else (),
        caveats=(
            *(sentence for pair in zip(spreading, limits, strict=True) for sentence in diffusion_caveats(*pair)),
            *_short_currents(whole, longest / free_time, window.duration / longest),
        ),
    )


def _among_fixed_discs(
    log: Log,
    equilibrium: Ensemble,
    start: float | None,
    end: float | None,
    progress: Callable[[int, int], None] | None,
    lag: float,
) -> Transport:
    """Return the diffusion among fixed discs; a mean free time is the mean time between hits of any discs."""
    impacts = Impacts(len(log.walls), log.periodic)
    window = measure(log, [impacts], start, end, progress, ("conserves_motion",))
    gas, discs = log.discs, composition(log.discs)
    met = float((window.of(impacts.hits).sum(axis=1) + window.of(impacts.collisions).sum(axis=(1, 2))).mean())
    free_time = len(gas) / met if met else math.inf
    longest = min(lag * free_time, window.duration / FEWEST_SEGMENTS)
    limits = [LagLimits(1 / free_time, LEAST_LAG * free_time, equilibrium.temperature, ())] * len(discs.name)
    spreading = diffusion(log, discs, window, longest, limits, (None, [None] * len(limits), equilibrium))
    return Transport(
        window=window,
        packing_fraction=gas.packing_fraction,
        number=len(gas),
        free_times=float(spreading[0].lag[-1]) / free_time,
        walled=False,
        collision_rates=(),
        free_paths=(),
        contacts=(),
        diffusion=spreading,
        collective=None,
        pressure={},
        pair_distributions=(),
        caveats=tuple(
            sentence for pair in zip(spreading, limits, strict=True) for sentence in diffusion_caveats(*pair)
        ),
    )


def _short_currents(whole: Collective | None, free_times: float, lags: float) -> Iterator[str]:
    """Yield a caveat if currents are not followed for long enough, or if the window is too short for the lags."""
    if whole and free_times < LEAST_LAG:
        yield (
            f"The window is short: currents are followed for {free_times:.2g} mean free times at most; viscosities and "
            f"thermal conductivity require {LEAST_LAG:g}."
        )
    elif whole and lags < LEAST_WINDOW:
        yield (
            f"The window is short: {lags:.3g} times as long as currents are followed ({LEAST_WINDOW:g} needed); "
            "viscosities and thermal conductivity may be too small by more than their errors."
        )
    elif whole and lags < SURE_WINDOW:
        yield (
            f"Standard errors of viscosities and thermal conductivity may be up to 1.3 times too small: the window is "
            f"{lags:.3g} times as long as currents are followed, and correct errors require {SURE_WINDOW:g}."
        )


def _contacts(area: float, equilibrium: Ensemble, rates: tuple[CollisionRate, ...]) -> tuple[Contact, ...]:
    """Return contact values χ_ij, the ratios of measured collision rates Γ_ij to those of discs at random positions."""
    discs = equilibrium.discs
    speed = hard_discs.mean_relative_speeds(equilibrium.temperature, discs.mass, equilibrium.dof)
    partners = discs.number - np.eye(len(discs.number))  # a disc does not collide with itself
    random = discs.with_partners(2 * (discs.radius[:, None] + discs.radius) * partners / area * speed)
    groups = random.shape[1]
    return tuple(
        Contact(rate.species, rate.other, rate.rate.times(1 / alone))
        for k, (rate, alone) in enumerate(zip(rates, random.ravel().tolist(), strict=bool(rates)))
        if (groups == 1 or k // groups <= k % groups) and alone > 0
    )


def _free_time(impacts: Impacts | SampledImpacts, discs: Composition, window: Window) -> float:
    """Return the longest of the mean free times of all species, time; infinite if no discs collide."""
    per_disc = window.of(impacts.collisions).sum(axis=2).mean(axis=0) / discs.number
    colliding = per_disc[per_disc > 0]
    return 1 / float(colliding.min()) if len(colliding) else math.inf
