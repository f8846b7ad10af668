"""Flow of discs through a gate that opens, compared with n⟨v⟩/π."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from scipy.integrate import solve_ivp

from idealgas.analysis.core.composition import composition
from idealgas.analysis.core.ensemble import ensemble
from idealgas.analysis.core.fields import OMITTED
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.stream import span
from idealgas.analysis.effusion.slit import Slit, slit_of
from idealgas.analysis.theory import hard_discs
from idealgas.errors import UserError
from idealgas.log import Log

INSTANTS = 256

LAW_OFF, LAW_OFF_PER_PATH = 0.0125, 0.245
"""Error of n⟨v⟩/π for a slit of width w at mean free path λ, relative to it: LAW_OFF + LAW_OFF_PER_PATH w/λ.

A straight line through what was measured: 2.0, 3.9 and 6.6 % more at w/λ = 0.03, 0.11 and 0.22.
"""

CROWDING = 3.2
"""Error of n⟨v⟩/π at a packing fraction φ of the chamber, relative to it and to φ: discs crowd in a slit.

The density in a narrow slit is n exp(3.2 φ) to lowest order, as walls hide a part of the room that a disc takes from
others. Twelve runs at φ = 0.1 had 14 % more, twelve at 0.3 had 120 % more.
"""

DENSEST = 0.03
"""Largest packing fraction of the chamber for that law."""

TINY = 1e-12


@dataclass(frozen=True)
class Effusion(Result):
    """Flow of discs between two chambers through a gate, from its opening on.

    name: of the run. density: number density if all discs were in the chamber that has more discs at first, 1/length².
    temperature: energy. time: (INSTANTS,), times. beyond: (INSTANTS,), number of discs in the other chamber. expected:
    (INSTANTS,), this number by theory. speed: discs per time and open length, divided by the difference of the
    densities, length/time; each density is multiplied by the mean speed in its chamber over that of the gas. Its theory
    is ⟨v⟩/π; its error is not estimated, but that of a Poisson number of passages in both directions. Both theories are
    None for a slit wider than a mean free path, and for a chamber that is denser than DENSEST.
    """

    name: Annotated[str, OMITTED]
    density: float
    temperature: float
    time: np.ndarray
    beyond: np.ndarray
    expected: np.ndarray | None
    speed: Estimate

    @classmethod
    def from_dict(cls, found: dict[str, Any], name: str) -> "Effusion":
        """Make the result again from the values of `as_dict`, under a new name."""
        time, beyond = (np.array(found[key]) for key in ("time", "beyond"))
        expected = None if found["expected"] is None else np.array(found["expected"])
        speed = Estimate.from_dict(found["speed"])
        return cls(name, found["density"], found["temperature"], time, beyond, expected, speed)


def effusion(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Effusion:
    """Measure how fast discs pass through a slit that opens between two chambers, and compare with n⟨v⟩/π.

    n⟨v⟩/π discs per time and open length of the slit leave a gas of number density n and mean speed ⟨v⟩: that is the
    flux of kinetic theory through a slit much narrower than the mean free path; through a wider one more discs pass,
    and for one wider than a mean free path, or from a dense chamber, there is no theory.

    start, end: times; by default from the opening of the slit to the end of the log. progress(done, in all) is called
    as states are read. Raises UserError unless the scene has one gate along an axis, one species and its events in the
    log, if the gate is as high as the box, or if the chambers are in balance.
    """
    discs, equilibrium = composition(log.discs), ensemble(log)
    gate = slit_of(log)
    across, place = gate.across, gate.place
    radius, number, slit = discs.radius[0], len(log.discs), gate.width - 2 * discs.radius[0]
    time = _instants(log, gate, start, end)
    beyond, flux = np.empty(INSTANTS), np.empty((2, INSTANTS))  # flux: the sum of the speeds, below and above
    for k, state in enumerate(log.frames(time)):
        side, pace = state.position[:, across] > place, np.hypot(*state.velocity.T)
        beyond[k], flux[:, k] = side.sum(), (pace[~side].sum(), pace[side].sum())
        if progress is not None:
            progress(k + 1, INSTANTS)
    if beyond[0] > number / 2:
        beyond, flux, place = number - beyond, flux[::-1], log.box[across] - place
    height = log.box[1 - across] - 2 * radius
    inner, outer = (place - 2 * radius) * height, (log.box[across] - place - 2 * radius) * height
    mean_speed = hard_discs.mean_speed(equilibrium.temperature, discs.mass[0], equilibrium.dof)
    there, back = flux / mean_speed / [[inner], [outer]]
    drive, both = np.trapezoid(there - back, time), np.trapezoid(there + back, time)
    if not slit > 0 or not drive > 0:
        raise UserError(f"{log.path}: no effusion: a slit that lets no disc pass, or chambers in balance")
    expected = mean_speed / math.pi
    crowd = (number - beyond[0]) / inner
    phi = crowd * math.pi * radius**2
    paths = slit / hard_discs.mean_free_path(2 * radius, crowd, phi)
    speed = float(beyond[-1] - beyond[0]) / (slit * drive)
    ends = _no_law(paths, phi)
    error = math.sqrt((speed if ends else expected) * slit * both) / (slit * drive)
    doubt = LAW_OFF + LAW_OFF_PER_PATH * paths + CROWDING * phi
    found = Estimate(speed, error, math.inf, expected, expected * doubt)
    inside = f"The law is that of empty chambers, and in these there is {', '.join(gate.others)}."
    said = (inside,) if gate.others else ()
    here = (str(log.path), number / inner, equilibrium.temperature, time, beyond)
    if ends:
        return Effusion(*here, None, replace(found, theory=None, theory_error=0.0), caveats=(*ends, *said))
    rate = expected * slit
    course = number * _share_beyond(time, beyond[0] / number, rate / inner, rate / outer)
    return Effusion(*here, course, found, caveats=said)


def _no_law(paths: float, phi: float) -> tuple[str, ...]:
    """Why ⟨v⟩/π is no theory of a slit so many mean free paths wide, in a chamber of packing fraction phi."""
    if paths > 1:
        return (
            f"The slit is {paths:.2g} mean free paths wide: discs stream out together, not one by one, and ⟨v⟩/π is no "
            "theory of that.",
        )
    if phi > DENSEST:
        return (f"The chamber has a packing fraction of {phi:.2g}: discs crowd in the slit, and ⟨v⟩/π is no theory.",)
    return ()


def _instants(log: Log, gate: Slit, start: float | None, end: float | None) -> np.ndarray:
    """Instants (INSTANTS,) between two times at which the gate is open.

    Raises:
        UserError: if there are none.
    """
    if gate.opens >= log.end_time:
        raise UserError(
            f"{log.path}: no effusion: the gate opens at t = {gate.opens:g}, the log ends at {log.end_time:g}"
        )
    first, last = span(log, start, end)
    if not max(gate.opens, first) < min(gate.closes, last):
        raise UserError(f"{log.path}: no effusion: the gate is open from t = {gate.opens:g} to {gate.closes:g}")
    return np.linspace(max(gate.opens, first), min(gate.closes, last), INSTANTS)


def _share_beyond(time: np.ndarray, at_first: float, leave: float, come: float) -> np.ndarray:
    """Share (INSTANTS,) of all discs beyond the slit by theory; leave, come: rates at equal temperature, 1/time.

    Discs that pass carry the mean energy 3T/2 instead of T, so that one chamber becomes colder and the other hotter.
    """

    def change(_: float, shares: np.ndarray) -> np.ndarray:
        """Rates of the shares of discs and energy: a side with n, e loses √(ne) of discs, 3/2 √(e³/n) of energy."""
        (n, e), (m, f) = np.maximum(1 - shares, TINY), np.maximum(shares, TINY)
        discs = leave * math.sqrt(n * e) - come * math.sqrt(m * f)
        return np.array([discs, 1.5 * (leave * e * math.sqrt(e / n) - come * f * math.sqrt(f / m))])

    return solve_ivp(change, (time[0], time[-1]), [at_first, at_first], t_eval=time, rtol=1e-8).y[0]
