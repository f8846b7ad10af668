"""The table of gravity."""

from pydantic import Field

from idealgas.document.table import Table, Vector


class Gravity(Table):
    """`[gravity]`: the same acceleration everywhere."""

    acceleration: Vector = Field(description="[gx, gy], length/time²")
