"""Command `idealgas schema`: print the JSON Schema of scenes or sweeps."""

import click

from ._terminal import data


@click.command(epilog="Example: idealgas schema scene")
@click.argument("kind", type=click.Choice(["scene", "sweep"]), default="scene")
def schema(kind: str) -> None:
    """Print the JSON Schema of scenes or of sweeps, which editors use to complete and check keys.

    A file refers to its schema in its first line, as in `#:schema scene.schema.json`.
    """
    from idealgas.scene import Scene
    from idealgas.sweep.tables import SweepTables
    from idealgas.toml.table import schema_text

    data(schema_text(Scene if kind == "scene" else SweepTables), nl=False)
