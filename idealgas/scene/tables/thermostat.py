"""The table of a thermostat."""

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.toml.table import Positive, Table

NAME = "thermostat"


class Thermostat(Table):
    """`[thermostat]`: a heat bath gives each disc a new velocity at random times, wherever it is.

    The velocity is that of a gas at the bath's temperature, and so is the spin of a disc that has one (Andersen,
    J. Chem. Phys. 72, 2384 (1980)).
    """

    temperature: Positive = Field(description="temperature > 0 of the heat bath, energy")
    rate: Positive = Field(description="kicks of each disc per time > 0, 1/time")


def effect(thermostat: Thermostat | None) -> Effect | None:
    """What a thermostat changes, if there is one."""
    if thermostat is None:
        return None
    properties = Properties(
        allows_monte_carlo=False,
        allows_time_steps=False,
        drives_discs=True,
        bath=thermostat.temperature,
        kicks=thermostat.rate,
    )
    return Effect(NAME, (("thermostat",),), properties)
