"""The tables of the discs: whole species, and single ones."""

from typing import Annotated, Literal

from pydantic import Field

from idealgas.toml.table import NotNegative, Number, Positive, Table, Vector, Whole, Word


class Species(Table):
    """`[[species]]`: discs of one kind. Exactly one of temperature, speed and velocities says how they move."""

    name: Word = Field(description="a word, its own for each species")
    count: Whole = Field(ge=1, lt=2**31, description="number of discs, >= 1")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")
    temperature: NotNegative | None = Field(
        default=None, description="energy; Gaussian velocities, kinetic energy count * T"
    )
    speed: NotNegative | None = Field(default=None, description="length/time; equal speeds, random directions")
    velocities: Annotated[tuple[Vector, ...], Field(strict=False)] | None = Field(
        default=None, description="length/time; one [vx, vy] for each disc"
    )
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")
    spin_temperature: NotNegative | None = Field(
        default=None, description="energy; with [rotation]: Gaussian spins, rotational energy count * T/2"
    )
    placement: Literal["random", "lattice", "triangular", "compressed"] = Field(
        default="random", description="how the discs are put into the region"
    )
    region: Annotated[tuple[Number, Number, Number, Number], Field(strict=False)] | None = Field(
        default=None,
        description="[x0, y0, x1, y1], length: whole discs lie in it; if absent the box, up to the piston",
    )


class Disc(Table):
    """`[[disc]]`: one disc."""

    position: Vector = Field(description="[x, y] of the centre, length")
    velocity: Vector = Field(default=(0.0, 0.0), description="[vx, vy], length/time")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")
