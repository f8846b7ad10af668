"""Small gases that meet the conditions of analyses or not, as overrides of one scene, and tests of caveats."""

import zlib

from helpers.logs import gas, log_of
from idealgas.analysis import registry

GAS = gas(40, 0.1, (8, 8), "collisions_per_disc = 30")
PERIODIC = 'box = {size=[8, 8], left="periodic", right="periodic", bottom="periodic", top="periodic"}'
TWO = "species = [{name='gas', count=2, radius=0.5, temperature=1.0}]"
LANES = """
box.size = [10, 8]
wall = [{ from = [0, 4], to = [10, 4] }]
run.until = 180
disc = [
    { position = [2, 2], velocity = [1, 0.5], radius = 0.5, mass = 2, species = "a" },
    { position = [5, 6], velocity = [-2, 1], radius = 0.25, mass = 1, species = "b" },
]
"""
"""Two discs on either side of a wall, which meet nothing but walls: every number of them is known."""
SLIT = (
    "species.gas.region=[0, 0, 4, 8]",
    "species.gas.radius=0.03",
    "wall=[{from=[4, 0], to=[4, 3]}, {from=[4, 5], to=[4, 8]}, {from=[4, 3], to=[4, 5], opens_at=1.0}]",
    "run.collisions_per_disc=",
    "run.until=20",
)
WHOLE = ("species.gas.region=[0, 0, 4, 8]", "wall=[{from=[4, 0], to=[4, 8], opens_at=1.0}]", *SLIT[3:])


def made(*overrides):
    """The log of GAS with overrides, from which the seed follows unless they have one."""
    seed = zlib.crc32("\n".join(overrides).encode())
    return log_of(GAS, f"scene.seed={seed}", *overrides)


def analysed(name, *overrides, **options):
    """The result of an analysis of this log."""
    return registry.analyse(made(*overrides), name, **options)


def only(result, words):
    """The sentence of a result that has these words; there is one."""
    (sentence,) = (each for each in result.caveats if words in each)
    return sentence


def silent(result, words):
    return not any(words in each for each in result.caveats)
