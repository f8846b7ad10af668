"""Estimates that are calibrated, taken of the log of a gas by the names that they have in CSV."""

import fnmatch
import math
import re
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any, Literal, NamedTuple

from idealgas import Log, effusion, shear
from idealgas.analysis import registry
from idealgas.analysis.effusion import EffusionAnalysis
from idealgas.presentation.quantities import rows
from idealgas.statistics.estimates import Estimate


class Of(NamedTuple):
    """Estimates of an analysis: its name, patterns of quantities, options, and parts of the window of curves.

    Patterns are those of the names in CSV, without the analysis; one that starts with = has an exact theory. A place in
    brackets is one of a curve, also as a share of its length.
    """

    analysis: str
    patterns: tuple[str, ...]
    options: dict[str, Any]
    parts: float


def of(analysis: str, *patterns: str, parts: float = math.nan, **options: Any) -> Of:
    """Return the estimates of an analysis."""
    return Of(analysis, patterns, options, parts)


def estimates(log: Log, measured: Of) -> Iterator[tuple[str, Estimate, bool]]:
    """Name, estimate, and whether its theory is exact, of all estimates with an error that is not 0."""
    options = [value for option, value in measured.options.items() if option == "quantity"]
    name = ".".join((measured.analysis.replace("-", "_"), *options))
    known: dict[str, Estimate] = {}
    curves: dict[str, list[float]] = {}
    for row in rows(registry.analyse(log, measured.analysis, **measured.options).as_dict(), name):
        if row.entry is not None:
            value = row.values["value"]
            curves.setdefault(row.quantity, []).append(math.nan if value is None else value)
        elif row.values.get("standard_error"):
            known[row.quantity] = Estimate.from_dict(row.values)
    for entry in measured.patterns:
        exact, pattern = entry.startswith("="), f"{name}.{entry.lstrip('=')}"
        if at := re.fullmatch(r"(.*[a-z])\[(.*)\]", pattern):
            for quantity in fnmatch.filter(curves, at[1]):
                of_error = re.sub(r"value$", "error", quantity) if quantity.endswith(".value") else f"{quantity}_error"
                k = int(Fraction(at[2]) * (len(curves[quantity]) if "/" in at[2] else 1))
                curve = Estimate(curves[quantity][k], curves[of_error][k], measured.parts)
                yield f"{quantity}[{at[2]}]", curve, exact
        else:
            yield from ((quantity, known[quantity], exact) for quantity in fnmatch.filter(known, pattern))


def graham(log: Log) -> Iterable[tuple[str, Estimate]]:
    """Ratios of the fluxes of two species over their densities."""
    return ((f"effusion.{names}", ratio) for names, ratio in EffusionAnalysis.combine([effusion(log)]).ratios.items())


def sheared(log: Log) -> Iterable[tuple[str, Estimate]]:
    """Viscosity and pressure at the temperature T of a sheared gas, whose errors have none of that of T."""
    result = shear(log)
    t = result.temperature.value
    return ("η/√T", result.viscosity.times(t**-0.5)), ("P/T", result.pressure.times(1 / t))


TEMPERATURES = of("temperature", "species.*.both")
GAUGES = of("pressure", "walls.*.pressure", "=forces.all_walls.?")


def in_strips(along: Literal["x", "y"], bins: int, strips: str) -> tuple[Of, ...]:
    """Profiles along an axis in some of the strips, and temperatures."""
    patterns = (f"species.*.density.{strips}", f"species.*.temperature.{strips}", f"pressure.*.{strips}")
    return of("profile", *patterns, "species.*.gradient", along=along, bins=bins), TEMPERATURES


ALONG_X, ALONG_Y = in_strips("x", 10, "[014]"), in_strips("y", 5, "[012]")
BOX = (
    of(
        "pressure",
        "routes.*.compressibility_factor",
        "collision_rates.*.rate",
        "free_paths.*.path",
        "free_paths.*.time",
    ),
    of("pressure", "=free_paths.*.speed"),
    of("temperature", "=species.gas.x"),
    of("heat-capacity", "routes.E_T"),
    of("histogram", "=distributions.*.mean", quantity="vx"),
    *(of("histogram", "distributions.*.mean", quantity=name) for name in ("free-path", "waiting-time")),
)
FLUID = (
    of("pressure", "routes.pairs_virial.*factor"),
    of("pressure", *(f"collision_rates.{two}.rate" for two in ("gas_gas", "light_*", "heavy_heavy"))),
    of("temperature", "=species.light.both", "=species.heavy.both", "species.gas.both"),
)
COEFFICIENTS = of("transport", "collective.*.coefficient")
COOLING = of("cooling", "loss", "haff", "fourth", "first_scatter", "last_flow", "last_scatter", "temperature_ratio")
TRANSPORT = (
    of("pressure", "routes.pairs_virial.compressibility_factor"),
    of(
        "transport", "contacts.*.value", "pair_distributions.gas_gas.value[0]", "diffusion.gas.*coefficient",
        "diffusion.gas.velocity_correlation_time", "diffusion.gas.correlation[1/8]", "diffusion.gas.running[1/8]",
        "diffusion.gas.running[-2]", "collective.*.coefficient", "collective.*.difference",
        "collective.*.running[1/8]", "collective.*.running[-2]", "pressure_tensor.xx", "=pressure_tensor.xy", parts=64,
    ),
)  # fmt: skip
SCATTERING = of(
    "scattering", "waves.*.structure", "=waves.*_square", "waves.*.early", "waves.*.density.value[8]",
    "waves.*.self_part.value[8]", "waves.*.longitudinal.value[4]", "waves.*.transverse.value[4]",
    "waves.*.spectrum.value[3]", "van_hove.*.density.value[8]", "distinct.*.density.value[20]",
    "distinct.*.density.value[40]", "non_gaussian.value[1/2]", parts=32,
)  # fmt: skip
WORK = of(
    "work", "=processes.from_5_to_4_in_2.free_energy", "processes.from_5_to_4_in_2.mean_work",
    "=processes.*.kinetic_energy", "=crossings.*",
)  # fmt: skip
"""Free energy inwards only: outwards few strokes decide, so that errors take 1000 of them."""
