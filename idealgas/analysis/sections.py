"""The analyses of a report: each makes of a log a picture and tables, or raises UserError where it does not apply."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from matplotlib.figure import Figure

from idealgas.analysis import figures
from idealgas.analysis.heat_capacity import heat_capacity, measure_heat
from idealgas.analysis.histogram import histogram
from idealgas.analysis.pressure import pressure
from idealgas.analysis.relaxation import LINEAR, SETTLED, relaxation
from idealgas.analysis.relaxation_figure import relaxation_figure
from idealgas.analysis.statistics import Estimate
from idealgas.analysis.temperature import temperature
from idealgas.analysis.trials import trials
from idealgas.analysis.window import Window
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
        else "The gas starts in equilibrium: there is no relaxation time to fit."
    ]
    if found.in_time is not None:
        notes.append(f"Settled to 5 % after {SETTLED * found.in_time.value:.4g} units of time.")
    if (k := found.told_until) is not None:
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
        for entry in found.species
        for name, estimate in (("m vx²", entry.x), ("m vy²", entry.y), ("m v²/2", entry.both))
    ]
    picture = figures.temperature_figure(found)
    return Section(
        picture, "Temperature of each species against time", [estimates("Equipartition", rows)], [_window(found.window)]
    )


def _pressure(log: Log) -> Section:
    found = pressure(log)
    theories = [(name, f"{value:.6f}") for name, value in found.theories.items()]
    paths = [
        (f"{entry.species}: {name}", estimate)
        for entry in found.free_paths
        for name, estimate in (("mean free path", entry.path), ("mean free time", entry.time))
    ]
    rates = [(f"{rate.species} with {rate.other}", rate.rate) for rate in found.collision_rates]
    tables = [
        estimates("Z = PA/NT", [(route.name, route.compressibility) for route in found.routes]),
        Table("Z by theory", ("", ""), theories),
        estimates("Collisions per disc and time", rates),
        estimates("Between collisions", paths),
    ]
    caption = "Compressibility factor Z by every route, beside theory"
    return Section(figures.pressure_figure(found), caption, tables, [_window(found.window)])


def _heat_capacity(log: Log) -> Section:
    found = heat_capacity([measure_heat(log)])
    rows = [(f"{route.name}, {route.kind}", route.value) for route in found.routes]
    notes = [f"No {name}: {why}" for name, why in found.refused.items()]
    if not rows:
        raise UserError(" ".join(notes) or "no route to it from this log")
    return Section(None, "", [estimates("Heat capacity per disc", rows)], notes)


def _histogram(quantity: str) -> Callable[[Log], Section]:
    def section(log: Log) -> Section:
        found = histogram(log, quantity)
        means = [(entry.name, entry.mean) for entry in found.distributions]
        tests = [
            (entry.name, test.law_name, f"{test.distance:.4f}", f"{test.p_value:.3g}", f"{entry.samples:,}")
            for entry in found.distributions
            for test in entry.tests
        ]
        tables = [
            estimates(f"Mean {quantity}", means),
            Table("Kolmogorov-Smirnov tests", ("", "law", "distance", "p", "samples"), tests),
        ]
        caption = f"Distribution of the {quantity} with its laws"
        return Section(figures.histogram_figure(found), caption, tables, [_window(found.window)])

    return section


def _trials(log: Log) -> Section:
    found = trials(log)
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
    ("Speeds", _histogram("speed")),
    ("Velocities along x", _histogram("vx")),
    ("Energies", _histogram("energy")),
    ("Relaxation", _relaxation),
    ("Free paths", _histogram("free-path")),
    ("Free times", _histogram("free-time")),
    ("Waits", _histogram("wait")),
    ("Heat capacity", _heat_capacity),
    ("Trials", _trials),
)
"""Title and analysis of every part of a report, in order."""
