"""Measure how discs leave the gas through holes: the number of remaining discs, and escapes per unit path length.

In the limit of small holes in an ergodic box, theory predicts that a disc of speed v leaves at a rate of v ℓ/(π A)
through holes of total length ℓ in the walls around an area A.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import agreement
from idealgas.analysis.effusion import LAW_OFF_PER_PATH, ratio_sentence, share_beyond
from idealgas.analysis.result import Result
from idealgas.columns import Kind
from idealgas.errors import NotApplicableError, UserError
from idealgas.fields import OPTIONAL
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate, time_series
from idealgas.statistics.estimates import Estimate, parts_of
from idealgas.tallies.reach import NEAR, reach_of
from idealgas.tallies.stream import ReadProgress, span
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import composition
from idealgas.theory.values import NoTheoryError, Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 257
"""Number of times in the time series."""

RARE, OFTEN = 0.1, 10.0
"""Collisions of a disc per escape up to which discs keep their speeds, and above which the gas stays in equilibrium."""

BILLIARD = (
    "Discs hardly ever collide. Theory then requires walls that lead every path to the hole, such as walls that bulge "
    "inwards; the walls of a circle or a rectangle do not."
)
"""Caveat for discs that are deflected almost only by walls."""


@dataclass(frozen=True)
class Escapes:
    """Escape of the discs of a gas, or of one of its species.

    Attributes:
        discs: number of discs at the start of the window.
        escaped: number of these discs that escaped in the window.
        time: (INSTANTS,), times.
        left: (INSTANTS,), number of discs that remain in the gas.
        expected: (INSTANTS,), theoretical mean number of discs that remain; None without theory.
        spread: (INSTANTS,), standard deviation of `left` about `expected`, including the error of theory; None without
            theory.
        per_path: escapes per unit path length, 1/length; None under gravity, and if no disc moves.
        mean_time: total time that all discs spend in the gas, divided by the number of escapes, time; nan if no disc
            escapes. If the escape rate does not depend on the time already spent in the gas, this is the mean escape
            time, even if some discs have not left yet.
        ratio: rate at which a disc of a species escapes, divided by that of a disc of the first species, no unit; None
            for the first species and for the whole gas, and if no discs of one of the two species escape.
    """

    discs: int
    escaped: int
    time: np.ndarray
    left: np.ndarray
    expected: np.ndarray | None
    spread: np.ndarray | None
    per_path: Estimate | None
    mean_time: Estimate
    ratio: Annotated[Estimate | None, OPTIONAL] = None


@dataclass(frozen=True)
class Escape(Escapes, Result):
    """Escape of discs through the holes in one log.

    Attributes:
        species: escape of each species of a mixture, by name; None for a single species.
    """

    species: Annotated[dict[str, Escapes] | None, OPTIONAL] = None

    @property
    def _parts(self) -> dict[str, Escapes]:
        return self.species or {"discs": self}

    @property
    def _ratios(self) -> dict[str, Estimate]:
        first, *_ = self._parts
        return {f"{name} / {first}": part.ratio for name, part in self._parts.items() if part.ratio}

    def plain_tables(self) -> list[Table]:
        """Return the table of escape rates and that of the number of discs in the gas."""
        rates, columns, notes = [], dict[str, np.ndarray | None](), []
        for name, part in self._parts.items():
            of = f"{name}: " if self.species else ""
            rows = {"escapes per path (1/length)": part.per_path, "mean escape time (time)": part.mean_time}
            rates += [(of + row, item) for row, item in rows.items() if item and math.isfinite(item.value)]
            columns |= {"t": part.time, f"{of}discs in the gas": part.left, f"{of}theory": part.expected}
            columns[f"± {of}(s.d.)"] = part.spread
            notes.append(f"{of}{part.escaped} of {part.discs} discs escaped")
        series = time_series("Number of discs in the gas", columns)
        rates += [(f"{names}: ratio of rates (no unit)", ratio) for names, ratio in self._ratios.items()]
        return [estimates("Escape", rates, notes), series]

    def summary(self) -> str:
        """Return the number of discs that escaped, and whether the escape rates agree with theory."""
        estimate = self.per_path or self.mean_time
        quantity = "escapes per unit path length" if self.per_path else "time per escape"
        verdict = agreement((f"species '{s}'", part.per_path or part.mean_time) for s, part in self._parts.items())
        shown = f"{self.escaped} of {self.discs} discs escaped, {format_estimate(estimate)} {quantity}; {verdict}."
        return shown + ratio_sentence(self._ratios)

    def figure(self) -> "Figure":
        """Draw the measured and theoretical numbers of discs, on a logarithmic scale if less than a tenth remains."""
        from idealgas.presentation.style import curve_style, panels

        figure, (ax,) = panels(1)
        for k, (name, part) in enumerate(self._parts.items()):
            ax.step(part.time, part.left, where="post", color=curve_style(k)[0], label=name)
            if part.expected is not None:
                ax.theory(part.time, part.expected, part.spread, None if k else "theory")
        if 0 < min(part.left[-1] / part.discs for part in self._parts.values()) < 0.1:
            ax.set_yscale("log")
        ax.set_ylabel("discs in the gas (no unit)")
        ax.time_axis()
        ax.legend()
        return figure


class EscapeAnalysis(Analysis):
    """Escape through holes."""

    position = 112
    headline = "per_path"
    supports_escapes = True
    results = (Escape,)
    sections = (Section("Escape", "Number of discs in the gas against time, with theory"),)
    start = "the log's start"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Escape:
        """Measure how fast discs leave the gas through absorbing walls.

        The standard errors assume that the number of escapes follows a Poisson distribution. Theory is available for
        species of equal discs in a box without gravity and with walls at rest. The length of the holes and the area are
        those accessible to the centres of the discs.

        Raises:
            UserError: if no wall absorbs discs, if the log has no events, or if no disc escapes in the window.
        """
        if not log.escapes:
            raise NotApplicableError(f"{log.path}: escape requires a wall that absorbs discs, but there is none")
        log.require_events()
        first, last = span(log, start, end)
        at, species, spent, path, collisions = _flights(log, first, last, progress)
        if not len(at):
            raise UserError(f"{log.path}: no disc leaves the gas between t = {first:g} and {last:g}")
        state, time, often = log.state_at(first), np.linspace(first, last, INSTANTS), collisions / len(at)
        kind, speed = log.discs.species[state.inside], np.hypot(*state.velocity[state.inside].T)
        speeds = [speed[kind == s] for s in range(len(spent))]
        caveats, rates, laws = tuple[str, ...](), list[Theory](), None
        paces: list[Theory | None] = [None] * len(spent)
        try:
            rates = _theory(log, spent / (last - first))
            paces, laws = _expected(log, speeds, rates, time - first, often)
        except NoTheoryError as error:
            what = "Theory for the number of remaining discs" if rates else "Theory"
            caveats = (f"{what} is not available: {error}.",)
        if laws is not None and len(paces) > 1 and None in paces:
            caveats = ("Theory for the ratios is not available: the fast discs of each species leave first.",)
        if rates and often < 1:
            caveats = (BILLIARD, *caveats)

        present, parts = np.unique(kind).tolist(), list[Escapes]()
        for chosen in (*([s] for s in present), present):  # each species, then the whole gas
            here, gone = int(np.isin(kind, chosen).sum()), at[np.isin(species, chosen)]
            spent_time, length = math.fsum(spent[chosen]), 0 if log.has_gravity else math.fsum(path[chosen])
            rate = rates[chosen[0]] if rates and len({rates[s].value for s in chosen}) == 1 else None
            pace = paces[chosen[0]] if often < RARE and len(chosen) == 1 else None
            # without escapes, the error of the expected number; that of one escape would overstate the deviation
            number, count = len(gone) or math.nan, len(gone) or (rate.value * length if rate else 1.0)
            known = parts_of(pace.inverse() if pace and pace.value else None)
            mean_time = Estimate(spent_time / number, spent_time / number**1.5, math.inf, *known)
            per_path = None
            if length:
                per_path = Estimate(len(gone) / length, math.sqrt(count) / length, math.inf, *parts_of(rate))
            left, expected, spread = here - gone.searchsorted(time, "right"), None, None
            if laws is not None:
                expected, variance, doubt = laws[:, chosen].sum(axis=1)
                spread = np.hypot(np.sqrt(variance), doubt)
            parts.append(Escapes(here, len(gone), time, left, expected, spread, per_path, mean_time))
        head, *tail = present
        for k, s in enumerate(tail, 1):
            theory, of_head = (Estimate(1.0, 0.0, math.inf, *parts_of(paces[of])) for of in (s, head))
            is_other = species[np.isin(species, (head, s))] == s
            ratio = _ratio(len(speeds[head]), len(speeds[s]), is_other, theory.over(of_head))
            parts[k] = replace(parts[k], ratio=ratio)
        named = {log.discs.species_names[s]: part for s, part in zip(present, parts, strict=False)}
        return Escape(**vars(parts[-1]), species=named if tail else None, caveats=caveats)


def _ratio(first: int, other: int, is_other: np.ndarray, theory: Estimate) -> Estimate | None:
    """Return the ratio of the escape rate of a disc of another species to that of the first; None if either is 0.

    At each escape (`is_other`: whether by a disc of the other species) the discs that are still in the gas are
    compared, so that changes of temperature cancel: Mantel & Haenszel, J. Natl. Cancer Inst. 22, 719 (1959).
    """
    gone = np.cumsum(is_other) - is_other
    firsts, others = first - np.arange(len(is_other)) + gone, other - gone
    weight = np.where(is_other, firsts, others) / (firsts + others)
    there, back = weight[is_other], weight[~is_other]
    if not (there.sum() > 0 and back.sum() > 0):
        return None
    ratio = float(there.sum() / back.sum())
    error = math.sqrt(there @ there + ratio**2 * (back @ back)) / float(back.sum())
    return replace(theory, value=ratio, standard_error=error)


def _flights(
    log: Log, first: float, last: float, progress: ReadProgress | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]:
    """Return times and species of the escapes, flight times and path lengths of the species, and number of collisions.

    The times are in ascending order. A collision between two discs counts twice, once for each disc.
    """
    at, species, collisions, done = [np.empty(0)], [np.empty(0, int)], 0, 0
    sums: list[list[tuple[float, float]]] = [[] for _ in log.discs.species_names]
    rows = log.row_at(last, "right") - log.row_at(first, "right")
    for flights in log.flights([first, last], columns=("start", "end", "kind", "velocity", "species")):
        for s, parts in enumerate(sums):
            chosen = flights.species == s
            duration, speed = (flights.end - flights.start)[chosen], np.hypot(*flights.velocity[chosen].T)
            parts.append((float(duration.sum()), float(speed @ duration)))
        escaped = flights.kind == Kind.ESCAPED
        at.append(flights.end[escaped])
        species.append(flights.species[escaped])
        collisions += int((flights.kind == Kind.DISC).sum())
        done += len(flights.end)
        if progress is not None:
            progress(min(done, rows), rows)
    spent, path = (np.array([math.fsum(part[k] for part in parts) for parts in sums]) for k in (0, 1))
    return np.concatenate(at), np.concatenate(species), spent, path, collisions


# ── theory ──


def _theory(log: Log, number: np.ndarray) -> list[Theory]:
    """Return the theoretical number of escapes of each species per unit path length, ℓ/(π A), 1/length.

    The relative error is the sum of four terms: ℓ/P for the depletion of the gas in front of a hole, where P is the
    total perimeter that discs can touch; 2φ for the density at the wall; the error that `effusion` assigns to a slit of
    width ℓ, from which discs stream out together; and the fraction of ℓ that is uncertain because it lies at corners
    between absorbing and other walls.

    Args:
        log: log of the gas.
        number: (S,), time averages of the numbers of discs in the gas.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    scene, gas, discs, rates = log.scene, log.discs, composition(log.discs), []
    if any(np.ptp(gas.radius[gas.species == s]) > 0 for s in discs.species):
        raise NoTheoryError(f"the discs{' of a species' * (len(number) > 1)} differ in radius")
    if not (scene.properties.straight_flight and scene.properties.fixed_walls):
        raise NoTheoryError("gravity acts on the discs, or walls move")
    if any(wall.absorbing and (wall.absences or wall.is_permeable) for wall in scene.walls):
        raise NoTheoryError("a hole opens or closes, or lets discs pass")
    reaches = {radius: reach_of(log, radius) for radius in discs.radius.tolist()}
    paths = hard_discs.mixture_free_paths(discs.radius, discs.mass, number / gas.area).tolist()
    for radius, path in zip(discs.radius.tolist(), paths, strict=True):
        reach = reaches[radius]
        if not reach.holes > 0 or not reach.area > 0:
            raise NoTheoryError("discs do not reach a hole")
        crowd = (LAW_OFF_PER_PATH * reach.holes / path + 2 * gas.packing_fraction) * scene.properties.interacting
        rate = reach.holes / (math.pi * reach.area)
        doubt = reach.holes / reach.perimeter + reach.shared / reach.holes + crowd
        if doubt >= 1:
            raise NoTheoryError(f"the holes are {reach.holes / path:.2g} mean free paths long, not small")
        rates.append(Theory(rate, rate * doubt, "ℓ/(π A) of a small hole"))
    return rates


def _expected(
    log: Log, speeds: list[np.ndarray], rates: list[Theory], time: np.ndarray, collisions: float
) -> tuple[list[Theory | None], np.ndarray]:
    """Return the escape rates of the species at the start, and the laws of the numbers of remaining discs.

    Discs that hardly ever collide keep their speeds. Their species have no rate unless all speeds are equal, because
    the fast discs leave first. In equilibrium, every disc leaves at the rate that follows from the mean speed of its
    species. If no heat is supplied, the gas cools because each disc that leaves carries an energy of 3T/2 on average;
    the number of discs of a single species then decays as (1 + t/4τ)⁻⁴, where τ is the mean escape time at the start.

    The laws, (3, S, INSTANTS), are the mean, its theoretical variance, and the error of the mean.

    Args:
        log: log of the gas.
        speeds: speeds of the discs of each species at the start of the window, length/time.
        rates: escapes of each species per unit path length, 1/length.
        time: (INSTANTS,), times since the start of the window.
        collisions: number of collisions between discs per escape, where each collision counts for both discs.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    properties, mass = log.scene.properties, composition(log.discs).mass
    number, lossy = np.array([len(speed) for speed in speeds]), properties.dissipative or properties.spins
    least, most = float(mass.min()), float(mass.max())
    # a collision of unequal masses passes on at most a fraction 4mM/(m + M)² of an energy
    mixes = collisions * 4 * (least / most) / (1 + least / most) ** 2 >= OFTEN
    if not (mixes or collisions <= RARE) or len(properties.temperatures) > 1 or properties.varies:
        raise NoTheoryError("discs neither keep their speeds nor reach equilibrium before they leave")
    if mixes and (log.discs.unlike or lossy):
        raise NoTheoryError(
            "the temperature of the remaining gas is not known if masses differ within a species, or with energy "
            "losses or spins"
        )
    if not mixes and (properties.temperatures or lossy):
        raise NoTheoryError("walls or a heat bath change the speeds of discs that hardly ever collide")
    if mixes:
        heat = sum(float(m * (v**2).mean() / 2) * len(v) for m, v in zip(mass, speeds, strict=True) if len(v))
        temperature = next(iter(properties.temperatures), heat / number.sum())
        speeds = [np.array([math.sqrt(math.pi * temperature / (2 * m))]) for m in mass]
    cools = mixes and not properties.temperatures

    def share(per_path: np.ndarray) -> np.ndarray:
        if cools and len(speeds) > 1:
            leave = per_path * np.concatenate(speeds)
            return 1 - share_beyond(time, 0 * leave, leave, 0 * leave, number / number.sum())
        away = [c * np.multiply.outer(time, v if len(v) else [0.0]) for c, v in zip(per_path, speeds, strict=True)]
        return np.array([((1 + a / 4) ** -4.0 if cools else np.exp(-a)).mean(axis=1) for a in away])

    value, error = (np.array([getattr(rate, part) for rate in rates]) for part in ("value", "error"))
    mean, count = share(value), number[:, None]
    doubt = np.abs(share(value - error) - share(value + error)) / 2
    paces = [
        rate.times(float(v.mean())) if len(v) and np.ptp(v) <= NEAR * v.max() else None
        for rate, v in zip(rates, speeds, strict=True)
    ]
    return paces, np.array([count * mean, count * mean * (1 - mean), count * doubt])
