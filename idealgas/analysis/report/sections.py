"""The analyses of a report: each makes of a log a picture and tables, or raises UserError where it does not apply."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from matplotlib.figure import Figure

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.window import Window
from idealgas.analysis.effusion.figure import effusion_figure
from idealgas.analysis.effusion.measure import effusion
from idealgas.analysis.heat_capacity.measure import heat_capacity, measure_heat
from idealgas.analysis.histogram.figure import histogram_figure
from idealgas.analysis.histogram.measure import histogram
from idealgas.analysis.pressure.figure import pressure_figure
from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.relaxation.acceptance import acceptance
from idealgas.analysis.relaxation.figure import relaxation_figure
from idealgas.analysis.relaxation.measure import LINEAR, SETTLED, relaxation
from idealgas.analysis.temperature.figure import temperature_figure
from idealgas.analysis.temperature.measure import temperature
from idealgas.analysis.transport.figure import transport_figure
from idealgas.analysis.transport.measure import transport
from idealgas.errors import UserError
from idealgas.log import Log


class Table(NamedTuple):
    """title, heads of the columns, and rows of as many cells."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]


class Section(NamedTuple):
    """caption: of the picture, for those who do not see it too."""

    picture: Figure | None
    caption: str
    tables: Sequence[Table]
    notes: Sequence[str] = ()


def estimates(title: str, rows: Iterable[tuple[str, Estimate]]) -> Table:
    """Named estimates, each beside theory."""

    def cells(name: str, estimate: Estimate) -> tuple[str, ...]:
        theory = "" if estimate.theory is None else f"{estimate.theory:.6g}"
        deviation = "" if estimate.deviation is None else f"{estimate.deviation:+.2f}"
        return name, f"{estimate.value:.6g}", f"{estimate.standard_error:.2g}", theory, deviation

    return Table(title, ("", "value", "± s.e.", "theory", "dev./s.e."), [cells(*row) for row in rows])


def _window(window: Window) -> str:
    how = "from detected equilibrium on" if window.detected else "as asked"
    return f"Window: t = {window.start:.6g} to {window.end:.6g}, {how}."


def _relaxation(log: Log) -> Section:
    found = relaxation(log)
    fits = {"time": found.in_time, "collisions per disc": found.in_collisions}
    rows = [(f"relaxation time of the kurtosis, {unit}", fit) for unit, fit in fits.items() if fit is not None]
    notes = [
        f"Near equilibrium theory expects a relaxation time of {LINEAR:g} collisions per disc, farther away more."
        if rows
        else "The kurtosis starts where it fluctuates in equilibrium: there is no relaxation time to fit."
    ]
    if found.in_time is not None:
        notes.append(f"Settled to 5 % after {SETTLED * found.in_time.value:.4g} units of time.")
    if (k := found.first_indistinguishable) is not None:
        notes.append(
            f"After {found.collisions[k]:.3g} collisions per disc the speeds of these {found.number:,} discs cannot be "
            "told from Maxwell and Boltzmann's (Kolmogorov-Smirnov test at 5 %)."
        )
    tables = [estimates("Relaxation", rows)] if rows else []
    caption = "Kurtosis of the velocity, Kolmogorov-Smirnov distance and Boltzmann's H on the way to equilibrium"
    return Section(relaxation_figure([found]), caption, tables, notes)


def _temperature(log: Log) -> Section:
    found = temperature(log)
    rows = [
        (f"{entry.species}: {name}", estimate)
        for entry in found.apart
        for name, estimate in (("m vx²", entry.x), ("m vy²", entry.y), ("m v²/2", entry.both))
    ]
    tables = [estimates("Equipartition (energy)", rows)]
    caption = "Kinetic temperature of each species against time"
    return Section(temperature_figure(found), caption, tables, [_window(found.window)])


def _pressure(log: Log) -> Section:
    found = pressure(log)
    theories = [(name, f"{value:.6f}") for name, value in found.theories.items()]
    tables = [
        estimates("Z = PA/NT (no unit)", [(route.name, route.compressibility) for route in found.routes]),
        Table("Z by theory (no unit)", ("", ""), theories),
    ]
    caption = "Compressibility factor Z by every route with its standard error, and theory as lines"
    return Section(pressure_figure(found), caption, tables, [_window(found.window)])


def _transport(log: Log) -> Section:
    found = transport(log)
    rates = [(f"{rate.species} with {rate.other}", rate.rate) for rate in found.collision_rates]
    paths = [
        row
        for entry in found.free_paths
        for row in (
            (f"{entry.species}: mean free path, length", entry.path),
            (f"{entry.species}: mean free time, time", entry.time),
        )
    ]
    contacts = [(f"{contact.species} and {contact.other}", contact.value) for contact in found.contacts]
    diffusion = [
        row
        for entry in found.diffusion
        for row in (
            (f"{entry.species}: D by displacement, length²/time", entry.coefficient),
            (f"{entry.species}: velocity correlation time, time", entry.velocity_correlation_time),
        )
    ]
    tables = [
        estimates("Collisions per disc (1/time)", rates),
        estimates("Between collisions of a disc", paths),
        estimates("g(r) at contact (no unit)", contacts),
        estimates("Diffusion, theory Enskog's", diffusion),
    ]
    notes = [_window(found.window)]
    if found.walled:
        notes.append("Walls turn discs back: D is that of an endless gas only in a box much wider than their way.")
    caption = "Memory of the velocity, mean square displacement and pair distribution"
    return Section(transport_figure(found), caption, tables, notes)


def _effusion(log: Log) -> Section:
    found = effusion(log)
    name = "this run"
    tables = [estimates("Flux over density (length/time), theory ⟨v⟩/π", [(name, found.speed)])]
    return Section(effusion_figure({name: [found]}, {name: found.speed}), "Discs beyond the gate", tables)


def _heat_capacity(log: Log) -> Section:
    found = heat_capacity([measure_heat(log)])
    rows = [(f"{route.name}, {route.kind}", route.value) for route in found.routes]
    notes = [f"No {name}: {why}" for name, why in found.refused.items()]
    if not rows:
        raise UserError(" ".join(notes) or "no route to it from this log")
    return Section(None, "", [estimates("Heat capacity per disc", rows)], notes)


def _histogram(title: str, quantity: str) -> tuple[str, Callable[[Log], Section]]:
    def section(log: Log) -> Section:
        found = histogram(log, quantity)
        means = [(entry.name, entry.mean) for entry in found.distributions]
        tests = [
            (entry.name, test.law_name, f"{test.distance:.4f}", f"{test.p_value:.3g}", f"{entry.samples:,}")
            for entry in found.distributions
            for test in entry.tests
        ]
        tables = [
            estimates(f"Mean {quantity.replace('-', ' ')} ({found.unit})", means),
            Table("Kolmogorov-Smirnov tests (no unit)", ("", "law", "distance", "p", "samples"), tests),
        ]
        caption = f"Density of {title.lower()}: measured with its standard errors, and its laws as lines"
        return Section(histogram_figure(found), caption, tables, [_window(found.window)])

    return title, section


def _trials(log: Log) -> Section:
    found = acceptance(log)
    if found is None:
        raise UserError(f"{log.scene.run.method} makes no trials")
    expected = [(f"in equilibrium, {name}", f"{share:.5f}") for name, share in found.expected.items()]
    published = [] if found.published is None else [("Novak & Bortz (1970)", f"{found.published / found.number:.5f}")]
    counts = [
        ("trials", f"{found.number:,}"),
        ("collisions", f"{found.collisions:,}"),
        ("collisions per disc, each counted for both", f"{found.collisions_per_disc:.5g}"),
    ]
    theory = [("at the start", f"{found.at_start:.5f}"), *expected, *published]
    tables = [
        Table("Counts", ("", ""), counts),
        estimates("Acceptance", [("measured", found.acceptance)]),
        Table("Acceptance by theory", ("", ""), theory),
    ]
    return Section(None, "", tables)


SECTIONS: tuple[tuple[str, Callable[[Log], Section]], ...] = (
    ("Pressure", _pressure),
    ("Temperature", _temperature),
    _histogram("Speeds", "speed"),
    _histogram("Velocities along x", "vx"),
    _histogram("Energies", "energy"),
    ("Relaxation", _relaxation),
    ("Transport", _transport),
    _histogram("Free paths", "free-path"),
    _histogram("Free times", "free-time"),
    _histogram("Waits between events", "wait"),
    ("Heat capacity", _heat_capacity),
    ("Effusion", _effusion),
    ("Acceptance", _trials),
)
"""Title and analysis of every part of a report, in order."""
