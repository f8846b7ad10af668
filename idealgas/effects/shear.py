"""Sheared sides: bottom and top are periodic, and the periodic images above and below the box move along x."""

from collections.abc import Iterator

from pydantic import Field

from idealgas.columns import SIDES
from idealgas.effects.effect import BenchmarkSample, Effect, GasAtStart, Tables
from idealgas.effects.periodic import PERIODIC
from idealgas.effects.properties import Properties
from idealgas.physics import shear as law
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Positive, Table


class ShearedSide(Table):
    """`{ shear = rate }`: bottom or top of a box in uniform shear flow along x, between periodic left and right sides.

    The periodic image above the box moves along x at velocity rate * height of the box (Lees & Edwards, J. Phys. C 5,
    1921 (1972)).
    """

    shear: Positive = Field(
        description="shear rate > 0, 1/time: change in the mean velocity along x per length along y"
    )

    @property
    def action(self) -> str:
        """Short description for output."""
        return f"sheared, rate {self.shear:g}"


class ShearEffect(Effect[law.Shear]):
    """Sheared sides: bottom and top are periodic, and the periodic images above and below the box move along x."""

    name = "sheared sides"
    field = "shear"
    side = ShearedSide
    side_text = "at bottom and top { shear = rate }"
    shearable = True
    samples = (
        BenchmarkSample(
            box=lambda side: (
                f'left = "{PERIODIC}"\nright = "{PERIODIC}"\nbottom = {{ shear = 0.05 }}\ntop = {{ shear = 0.05 }}\n'
            )
        ),
    )
    sample_together = BenchmarkSample()

    def properties(self, tables: Tables) -> Properties | None:
        rates = [side.shear for side in tables.sides if isinstance(side, ShearedSide)]
        if not rates:
            return None
        return Properties(
            uniform=False,
            fixed_walls=False,
            allows_monte_carlo=False,
            allows_time_steps=False,
            driven=True,
            drives_discs=True,
            periodic=(False, True),
            shear=rates[0],
        )

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield issues unless bottom and top have the same shear rate and the left and right sides are periodic."""
        left, right, bottom, top = tables.sides
        across: tuple[Key, ...] = tuple(("box", name) for name in SIDES[:2])
        if left != PERIODIC or right != PERIODIC:
            yield Issue(
                across,
                "sheared sides require periodic left and right sides",
                "left and right not periodic",
                f'both "{PERIODIC}"',
            )
        if bottom != top:
            keys: tuple[Key, ...] = (("box", "bottom"), ("box", "top"))
            yield Issue(
                keys, "different shear at bottom and top", "two different sides", "the same { shear = rate } for both"
            )

    def make(self, tables: Tables, start: GasAtStart) -> law.Shear:
        return law.make_shear(tables.sides[3].shear, tables.size)

    def gives_energy(self, shear: law.Shear) -> bool:
        return True

    def begin_epoch(self, shear: law.Shear, time: float, length: float) -> None:
        law.begin_epoch(shear, time, length)


EFFECT = ShearEffect()
