"""Tables of heat capacities."""

from idealgas.analysis.core.tables import Table, estimates
from idealgas.analysis.heat_capacity.combine import HeatCapacity

MANY = 12
"""Largest number of logs that are listed one by one."""


def heat_capacity_tables(result: HeatCapacity) -> list[Table]:
    """Tables of energy and temperature of each log, and of the heat capacity by every route."""
    tables = []
    if len(result.logs) <= MANY:
        rows = [(f"{log.path}: E/N", log.energy) for log in result.logs]
        rows += [(f"{log.path}: T by {log.thermometer}", log.temperature) for log in result.logs]
        tables.append(estimates("Logs (energy)", rows))
    routes = [(", ".join(filter(None, (route.name, route.kind, route.gas))), route.value) for route in result.routes]
    refused = [f"no {name}: {why}" for name, why in result.refused.items()]
    return [*tables, estimates("C per disc, and γ (no unit, k_B = 1)", routes, refused)]
