"""Tables of profiles of density and temperature."""

from dataclasses import replace

from idealgas.analysis.core.tables import Table, describe, estimates
from idealgas.analysis.profile.measure import Profile


def profile_tables(result: Profile) -> list[Table]:
    """Tables of density and temperature of each species in every strip, and of the heat given by walls."""
    axis = result.axis
    strips = [f"{axis} = {low:.4g} to {high:.4g}" for low, high in zip(result.edges, result.edges[1:], strict=False)]
    tables = []
    for entry in result.species:
        columns = [("density (1/length²)", entry.density), ("temperature, m v²/2", entry.temperature)]
        columns += [("temperature, I ω²", entry.spin)] if entry.spin is not None else []
        tables += [estimates(f"{entry.species}: {name}", zip(strips, column, strict=True)) for name, column in columns]
    if gradients := [(entry.species, entry.gradient) for entry in result.species if entry.gradient is not None]:
        tables.append(estimates(f"Temperature gradient along {axis} (energy/length)", gradients))
    if result.heat:
        tables.append(estimates("Energy from each wall per time", result.heat.items()))
    notes = (f"{describe(result.window)}, {result.frames} frames", f"theory: {result.law or 'none for this scene'}")
    return [replace(tables[0], notes=notes), *tables[1:]]
