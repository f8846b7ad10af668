"""The effects that a scene may add to smooth elastic discs in a reflecting box.

An effect consists of two files: its law in `idealgas/physics/NAME.py`, and everything else in `NAME.py` in this folder.
`NAMES` is the only list of the effects; the tables of a scene, the checks, the arguments of the engines, the energy
account, the benchmark and the tests are derived from it.
"""

from importlib import import_module
from typing import Any

from idealgas.effects.effect import Effect

NAMES = (
    "gravity",
    "periodic",
    "wall",
    "arc",
    "permeable",
    "absorbing",
    "rotation",
    "restitution",
    "thermal",
    "vibration",
    "shear",
    "piston",
    "thermostat",
    "steering",
    "noninteracting",
)
"""Names of the files of the effects."""

EFFECTS: tuple[Effect[Any], ...] = tuple(import_module(f"{__name__}.{name}").EFFECT for name in NAMES)
"""All effects. The code of effects that a scene does not have is not compiled."""

EFFECT_NAMES = tuple(effect.name for effect in EFFECTS)
"""Names of the effects in output and messages."""
