"""Thermal sides: those that emit the discs they take at a temperature."""

from pydantic import Field

from idealgas.document.table import Positive, Table


class ThermalSide(Table):
    """`{ thermal = T }`: a side that emits the discs it takes at a temperature."""

    thermal: Positive = Field(description="temperature > 0, energy")
