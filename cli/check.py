"""`idealgas check`: is this scene sound, and what will running it cost?"""

from typing import TYPE_CHECKING

import click

from ._options import json_option, scene_argument

if TYPE_CHECKING:
    from rich.table import Table

    from idealgas.analysis.forecast import Forecast


@click.command()
@scene_argument
@json_option
def check(path: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Check a scene; show it in full, with what kinetic theory expects of it."""
    from idealgas.scene import dump_scene, load_scene

    scene = load_scene(path, overrides)
    import json
    from dataclasses import asdict

    from rich.console import Console

    from idealgas.analysis.forecast import forecast
    from idealgas.gas import make_gas

    expected = forecast(scene, make_gas(scene))
    if as_json:
        tables = scene.model_dump(mode="json", exclude_none=True)
        click.echo(json.dumps({"scene": tables, "effects": scene.effects, **asdict(expected)}, indent=2))
        return
    click.echo(dump_scene(scene))
    console = Console()
    console.print(_species_table(expected), _gas_table(expected))
    click.echo(f"effects: {', '.join(scene.effects) or 'none beyond elastic discs and a reflecting box'}")


def _species_table(expected: "Forecast") -> "Table":
    from rich.table import Table

    table = Table("species", title="Discs at the start", title_justify="left")
    for head in ("N", "radius", "mass", "φ", "temperature", "collisions per disc and time"):
        table.add_column(head, justify="right")
    for s in expected.species:
        values = (s.radius, s.mass, s.packing_fraction, s.temperature, s.collision_rate)
        table.add_row(s.name, str(s.number), *(f"{value:.5g}" for value in values))
    return table


def _gas_table(expected: "Forecast") -> "Table":
    from rich.filesize import decimal
    from rich.table import Table

    table = Table("the gas", title="Expected in equilibrium", title_justify="left", show_header=False)
    table.add_column(justify="right")
    table.add_row("discs N", f"{expected.number}")
    table.add_row("packing fraction φ", f"{expected.packing_fraction:.5g}")
    table.add_row("temperature T", f"{expected.temperature:.5g}")
    table.add_row("collisions per disc and time Γ", f"{expected.collision_rate:.5g}")
    table.add_row("pair collisions per time", f"{expected.pair_collision_rate:.5g}")
    table.add_row("wall hits per time", f"{expected.wall_hit_rate:.5g}")
    table.add_row("end of the run, time", f"{expected.duration:.5g}")
    table.add_row("events", f"{expected.events:,.0f}")
    table.add_row("rows in the log", f"{expected.rows:,.0f}")
    table.add_row("size of the log", decimal(int(expected.bytes)))
    return table
